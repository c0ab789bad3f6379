"""The structural parameter of FMI 3.0: arrays of the plan in the size that Configuration Mode gave them."""

import numpy as np
import pytest
from fmpy import extract, read_model_description
from fmpy.fmi3 import FMU3Slave

from conftest import fmu, run

PLAN = ("time", "angle", "reference_angle", "reference_velocity", "acceleration", "thermal_load")
NAMES = [f"nmpc.plan.{name}" for name in PLAN]


@pytest.fixture(scope="module")
def controller(tmp_path_factory):
    path = fmu("fmi3", "FlexArmController")
    folder = extract(str(path), str(tmp_path_factory.mktemp("controller")))
    return read_model_description(str(path)), folder


def variables(description):
    return {v.name: v for v in description.modelVariables}


def instance(controller) -> FMU3Slave:
    description, folder = controller
    slave = FMU3Slave(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="c",
    )
    slave.instantiate()
    return slave


def configure(slave: FMU3Slave, description, points: int) -> None:
    slave.enterConfigurationMode()
    slave.setUInt64([variables(description)["nmpc.plan.points"].valueReference], [points])
    slave.exitConfigurationMode()


def plan(controller, points: int | None, horizon: int = 40) -> dict[str, np.ndarray]:
    """The plan of the first sample."""
    description, _ = controller
    by_name = variables(description)
    slave = instance(controller)
    if points:
        configure(slave, description, points)
    slave.setInt32([by_name["nmpc.horizon"].valueReference], [horizon])
    slave.enterInitializationMode(startTime=0.0)
    slave.setFloat64([by_name["angle"].valueReference, by_name["setpoint"].valueReference], [1.2, 1.35])
    slave.exitInitializationMode()
    slave.doStep(0.0, 0.00025)
    length = points or 41
    arrays = {n: np.array(slave.getFloat64([by_name[n].valueReference], nValues=length)) for n in NAMES}
    slave.terminate()
    slave.freeInstance()
    return arrays


def test_the_description_says_it(controller):
    description, _ = controller
    by_name = variables(description)
    points = by_name["nmpc.plan.points"]
    assert (points.type, points.causality, points.variability) == ("UInt64", "structuralParameter", "fixed")
    assert points.start == "41"
    for name in NAMES:
        assert [d.valueReference for d in by_name[name].dimensions] == [points.valueReference]


def test_every_second_of_81_points_is_one_of_41(controller):
    """Positions in the plan are k N / (points - 1): twice as many intervals halve them exactly."""
    coarse, fine = plan(controller, None), plan(controller, 81)
    for name in NAMES:
        assert np.array_equal(fine[name][::2], coarse[name]), name
    assert np.ptp(coarse["nmpc.plan.angle"]) > 0.1, "nothing is planned"
    # Between them the reference goes on as u says.
    middle = fine["nmpc.plan.reference_velocity"]
    assert np.allclose(middle[1::2], 0.5 * (middle[:-1:2] + middle[2::2]), atol=1e-12)


@pytest.mark.parametrize("points", [2, 401])
def test_smallest_and_largest(controller, points):
    arrays = plan(controller, points, horizon=points - 1 if points > 2 else 40)
    assert arrays["nmpc.plan.time"][0] == 0.0
    assert np.all(np.diff(arrays["nmpc.plan.time"]) > 0)
    assert arrays["nmpc.plan.reference_angle"][-1] == pytest.approx(1.35, abs=1e-9)


def test_what_is_refused(controller):
    description, _ = controller
    by_name = variables(description)
    reference = [by_name["nmpc.plan.points"].valueReference]
    slave = instance(controller)
    with pytest.raises(Exception, match="fmi3SetUInt64"):
        slave.setUInt64(reference, [81])
    slave.enterConfigurationMode()
    for outside in (0, 1, 402):
        with pytest.raises(Exception, match="fmi3SetUInt64"):
            slave.setUInt64(reference, [outside])
    slave.exitConfigurationMode()
    with pytest.raises(Exception, match="fmi3GetFloat64"):
        slave.getFloat64([by_name["nmpc.plan.angle"].valueReference], nValues=81)
    slave.freeInstance()


def test_a_state_restores_into_another_size(controller):
    description, _ = controller
    by_name = variables(description)
    angle = [by_name["nmpc.plan.angle"].valueReference]
    first = instance(controller)
    configure(first, description, 7)
    for slave in (first, second := instance(controller)):
        slave.enterInitializationMode(startTime=0.0)
        slave.setFloat64([by_name["angle"].valueReference, by_name["setpoint"].valueReference], [1.2, 1.35])
        slave.exitInitializationMode()
    first.doStep(0.0, 0.00025)
    state = first.getFMUState()
    bytes_ = first.serializeFMUState(state)
    first.freeFMUState(state)
    expected = first.getFloat64(angle, nValues=7)
    second.setFMUState(second.deserializeFMUState(bytes_))
    assert second.getUInt64([by_name["nmpc.plan.points"].valueReference]) == [7]
    assert second.getFloat64(angle, nValues=7) == expected
    for slave in (first, second):
        slave.freeInstance()


def test_our_host_configures(flexarm, tmp_path):
    """By Configuration Mode, as the unit refuses it elsewhere."""
    controller = fmu("fmi3", "FlexArmController")
    shown = run(flexarm, "inspect", controller).stdout
    assert "Structural parameters" in shown and "nmpc.plan.points" in shown
    pair = ["--controller", controller, "--plant", fmu("fmi3", "FlexArmPlant")]
    common = [flexarm, "simulate", *pair, "--until", "0.1"]
    results = []
    for n, arguments in enumerate([[], ["--set", "nmpc.plan.points=81"]]):
        out = tmp_path / str(n)
        run(*common, *arguments, "-o", out)
        results.append((out / "results.csv").read_bytes())
    assert results[0] == results[1], "the size of the arrays changes no other output"
    last = tmp_path / "connections.toml"
    last.write_text('[[role]]\nname = "angle"\nfrom = "controller.nmpc.plan.angle[81]"\n')
    wired = [*common, "--connections", last]
    run(*wired, "--set", "nmpc.plan.points=81", "-o", tmp_path / "wired")
    missing = run(*wired, "-o", tmp_path / "missing", code=2)
    assert "nmpc.plan.angle[81]" in missing.stderr
    refused = run(*common, "--set", "nmpc.plan.points=402", "-o", tmp_path / "none", code=2)
    assert "nmpc.plan.points" in refused.stderr and "[2, 401]" in refused.stderr
