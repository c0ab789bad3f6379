"""Communication points are counted, not summed: odd steps, a late start and many steps change nothing."""

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
    """A master that sums its time drifts by rounding; no step may be refused, no time may be lost.

    With zero torque, friction and thermal load the run must end where the exact decay of the thermal
    load says, which only counts time: T = T0 exp(-t/29 s).
    """
    steps, load = 1_000_000, 15.0
    with CoSimulation(fmu(version, "FlexArmPlant")) as plant:
        # Samples of 1/60 s keep the run short: the plant integrates once a step.
        plant.configure(
            {"sample_period": step, "initial.thermal_load": load, "motor.thermal_time_constant": 1e4}
        )
        plant.configure({"arm.stiffness": 0, "arm.offset": 0, "arm.hysteresis": 0})
        plant.configure({f"arm.cogging_{f}[{i}]": 0 for f in ("cos", "sin") for i in range(1, 10)})
        plant.initialize()
        time = 0.0
        for _ in range(steps):
            plant.step(time, step)
            time += step
        decay = 2.718281828459045 ** (-steps * step / 1e4)
        assert plant.get("thermal_load") == pytest.approx(load * decay, rel=1e-6)


def test_controller_samples_once_a_period_over_a_million_steps(version):
    """Steps of 0.25 ms summed over 250 s: each holds exactly one sample.

    A profile reference makes every sample cheap; the reference's phase counts the samples.
    """
    with CoSimulation(fmu(version, "FlexArmController")) as controller:
        controller.configure({"reference.source": "profile", "profile.max_acceleration": 1e-5})
        controller.initialize(angle=1.2, setpoint=1.2 + 0.078125)
        time, steps = 0.0, 1_000_000
        controller.set("angle", 1.2)
        for _ in range(steps):
            controller.step(time, SAMPLE)
            time += SAMPLE
        # Eq 35: the move lasts sqrt(8 * 0.078125 / 1e-5) = 250 s.
        assert controller.get("reference.angle") == pytest.approx(1.2 + 0.078125, abs=1e-7)
        assert controller.get("reference.velocity") == pytest.approx(0.0, abs=1e-7)
