"""The plant's two interfaces are the same plant: Model Exchange in CVode against Co-Simulation."""

import numpy as np
import pytest
from fmpy import simulate_fmu

from conftest import fmu

STOP = 2.0


def torque_steps() -> np.ndarray:
    """A stair of torques around the holding torque at 1.3 rad, changing at instants both solvers hit."""
    rows = [(0.0, 3.1), (0.5, 3.1), (0.5, 3.5), (1.0, 3.5), (1.0, 2.9), (1.5, 2.9), (1.5, 3.2), (STOP, 3.2)]
    return np.array(rows, dtype=[("time", float), ("torque", float)])


def angle(
    version: str, interface: str, hysteresis: float, step: float = 0.00025
) -> tuple[np.ndarray, np.ndarray]:
    result = simulate_fmu(
        str(fmu(version, "FlexArmPlant")),
        fmi_type=interface,
        solver="CVode",
        relative_tolerance=1e-9,
        stop_time=STOP,
        step_size=step,
        output_interval=step if interface == "CoSimulation" else 0.01,
        start_values={"arm.hysteresis": hysteresis, "arm.damping": 0.5, "sample_period": step},
        input=torque_steps(),
        output=["angle"],
        record_events=False,
    )
    return result["time"], result["angle"]


def deviation(version: str, hysteresis: float, step: float = 0.00025) -> tuple[float, float]:
    """Largest difference of the angle and largest movement, rad."""
    time, exchange = angle(version, "ModelExchange", hysteresis)
    cs_time, cosim = angle(version, "CoSimulation", hysteresis, step)
    difference = np.abs(exchange - np.interp(time, cs_time, cosim)).max()
    return difference, np.ptp(cosim)


def test_without_hysteresis_both_agree(version):
    difference, moved = deviation(version, 0.0)
    print(f"\n{version}: ME against CS without hysteresis {difference:.2e} rad over {moved:.3f} rad")
    assert moved > 0.05
    assert difference < 1e-5


def test_with_hysteresis_the_discretisation_of_eq_13_is_what_differs(version):
    """Eq 13 is one explicit Euler step of the Dahl model in the angle: half the step, half the difference."""
    whole, moved = deviation(version, 0.0732)
    half, _ = deviation(version, 0.0732, step=0.000125)
    print(f"\n{version}: ME against CS with hysteresis {whole:.2e} rad, {half:.2e} at half the step")
    assert moved > 0.05
    assert whole < 5e-5
    assert whole / half == pytest.approx(2.0, rel=0.1)


@pytest.mark.parametrize("interface", ["CoSimulation", "ModelExchange"])
def test_violations_are_counted_in_both_interfaces(version, interface):
    """A torque that throws the arm over its upper limit, where it stays: every later 4 kHz sample counts."""
    limit = 1.4
    result = simulate_fmu(
        str(fmu(version, "FlexArmPlant")),
        fmi_type=interface,
        stop_time=1.0,
        step_size=0.001,
        output_interval=0.001,
        start_values={"torque": 6.0, "arm.damping": 0.5, "limits.angle_upper": limit},
        output=["angle", "violations"],
    )
    outside = result["angle"] > limit
    crossing = outside.argmax()
    assert crossing > 0 and outside[crossing:].all()
    # Rows are no measure of time: an event adds one.
    samples = (result["time"][-1] - result["time"][crossing]) / 0.00025
    assert samples > 1000
    assert result["violations"][-1] == pytest.approx(samples, rel=0.005)


@pytest.mark.parametrize("unit", ["FlexArmPlant", "FlexArmController"])
def test_each_unit_runs_alone(version, unit):
    result = simulate_fmu(str(fmu(version, unit)), fmi_type="CoSimulation", stop_time=0.2, validate=True)
    assert len(result) > 100
    assert all(np.isfinite(result[name]).all() for name in result.dtype.names)
