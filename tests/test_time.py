"""Communication points are counted, not summed: odd steps, a late start and many steps change nothing."""

import math

import pytest

from conftest import fmu
from fmus import SAMPLE, CoSimulation, Loop


def final_angle(version: str, step: float, until: float, start: float = 0.0) -> float:
    """The closed loop at a communication step of its own; only the plant's inputs are coarser."""
    with Loop(version) as loop:
        loop.initialize(setpoint=1.4, start=start)
        for k in range(round(until / step)):
            loop.sequential(start + k * step, step)
        return loop.plant.get("angle")


def test_start_time_shifts_the_run_and_nothing_else(version):
    reference = final_angle(version, SAMPLE, 1.0)
    assert reference == pytest.approx(1.4, abs=5e-3)
    assert final_angle(version, SAMPLE, 1.0, start=1234.5) == pytest.approx(reference, abs=1e-9)


def test_steps_that_are_no_multiple_of_the_sample(version):
    """At 1e-4 s two or three steps fall between samples: the torque holds, the loop settles alike."""
    assert final_angle(version, 1e-4, 1.0) == pytest.approx(final_angle(version, SAMPLE, 1.0), abs=1e-4)


@pytest.mark.parametrize("step", [1 / 60, 1e-4])
def test_plant_takes_a_million_summed_steps(version, step):
    """A master that sums its time drifts by rounding; no step may be refused, lost or done twice.

    Without torque the thermal load only counts time: T = T0 exp(-t/T_tc). With T_tc of a hundred steps
    and a load that starts anew every 2000 steps, one step more or less is 1 % of it.
    """
    constant = 100 * step
    with CoSimulation(fmu(version, "FlexArmPlant")) as plant:
        plant.configure({"sample_period": step, "motor.thermal_time_constant": constant})
        plant.configure({"arm.stiffness": 0, "arm.offset": 0, "arm.hysteresis": 0})
        plant.configure({f"arm.cogging_{f}[{i}]": 0 for f in ("cos", "sin") for i in range(1, 10)})
        plant.initialize()
        time = 0.0
        for k in range(1_000_000):
            if k % 2000 == 0:
                plant.set("torque", 5.57 * (k % 4000 == 0))
            plant.step(time, step)
            time += step
            if k % 100_000 == 100 or k % 100_000 == 2100:
                expected = math.exp(-1.01) if k % 4000 >= 2000 else 1 - math.exp(-1.01)
                assert plant.get("thermal_load") == pytest.approx(expected, rel=1e-6)
        assert time == pytest.approx(1_000_000 * step, rel=1e-9)


@pytest.mark.parametrize("period", [SAMPLE, 1 / 60])
def test_controller_samples_once_a_period_over_a_million_steps(version, period):
    """Each of a million steps of a period, whose times are summed, holds exactly one sample.

    A profile reference makes every sample cheap, and its phase counts the samples: half-way through a
    move of twice that time one sample is a hundred times the tolerance.
    """
    duration = 2_000_000 * period
    acceleration = max(1e-6, 2.5 / duration**2)
    distance = acceleration * duration**2 / 8
    with CoSimulation(fmu(version, "FlexArmController")) as controller:
        controller.configure(
            {"reference.source": "profile", "profile.max_acceleration": acceleration}
            | {"limits.angle_lower": -1000, "limits.angle_upper": 1000, "sample_period": period}
            | {"nmpc.period": 0.05}
        )
        controller.initialize(angle=1.2, setpoint=1.2 + distance)
        time, steps = 0.0, 1_000_000
        for _ in range(steps):
            controller.step(time, period)
            time += period
        last = steps - 1
        peak = acceleration * duration / 4
        expected = 1.2 + distance / 2 - (duration / 2 - last * period) * peak
        assert controller.get("reference.angle") == pytest.approx(expected, abs=1e-2 * peak * period)
