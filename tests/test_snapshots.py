"""Save, step, restore, step: the same bits, in the same process and in another one."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from conftest import fmu
from fmus import SAMPLE, CoSimulation, hot_pendulum

MIDDLE_OF_A_PLAN = 333
HOT = "hot pendulum"
CASES = ["FlexArmPlant", "FlexArmController", HOT]


def advance(unit: CoSimulation, first: int, count: int) -> list[float]:
    """Step with inputs that depend on the sample number alone; returns every output."""
    values = []
    for k in range(first, first + count):
        if unit.has("setpoint"):
            unit.set("angle", 1.2 + 1e-4 * (k % 700))
            unit.set("setpoint", 1.4 if k < 800 else unit.low)
        else:
            unit.set("torque", 3.0 + 0.01 * (k % 300))
        unit.step(k * SAMPLE)
        values += [unit.get(v) for v in unit.variables if is_scalar_output(unit, v)]
    return values


def is_scalar_output(unit: CoSimulation, name: str) -> bool:
    variable = unit.variables[name]
    return variable.causality == "output" and not variable.dimensions


def initialized(version: str, name: str) -> CoSimulation:
    unit = CoSimulation(fmu(version, "FlexArmController" if name == HOT else name))
    unit.low = 0.3 if name == HOT else 1.1
    if name == HOT:
        unit.configure(hot_pendulum())
    if name == "FlexArmPlant":
        unit.set("noise.current", 0.0003)
    unit.initialize()
    return unit


@pytest.mark.parametrize("name", CASES)
def test_restore_in_the_same_instance(version, name):
    with initialized(version, name) as unit:
        advance(unit, 0, MIDDLE_OF_A_PLAN)
        state = unit.save()
        first = advance(unit, MIDDLE_OF_A_PLAN, 1000)
        unit.restore(state)
        second = advance(unit, MIDDLE_OF_A_PLAN, 1000)
        unit.restore(state)
        third = advance(unit, MIDDLE_OF_A_PLAN, 1000)
        unit.forget(state)
        if name == HOT:
            assert unit.get("nmpc.iterations") > 0, "the solver must be at work for this test to say anything"
    assert len(set(first)) > 1000
    assert first == second == third


@pytest.mark.parametrize("name", CASES)
def test_restore_in_another_process(version, name, tmp_path):
    file = tmp_path / "snapshot.bin"
    with initialized(version, name) as unit:
        advance(unit, 0, MIDDLE_OF_A_PLAN)
        state = unit.save()
        file.write_bytes(unit.serialize(state))
        unit.forget(state)
        expected = advance(unit, MIDDLE_OF_A_PLAN, 1000)
    here = Path(__file__).resolve()
    printed = subprocess.run(
        [sys.executable, str(here), version, name, str(file)],
        check=True,
        capture_output=True,
        text=True,
        cwd=here.parent,
        env=os.environ,
    ).stdout
    assert [float.fromhex(v) for v in printed.split()] == [float(v) for v in expected]


@pytest.mark.parametrize("damage", ["truncated", "flipped", "empty", "foreign"])
def test_damaged_snapshot_is_refused(version, damage):
    with initialized(version, "FlexArmPlant") as unit:
        state = unit.save()
        good = unit.serialize(state)
        unit.forget(state)
        if damage == "foreign":
            with initialized(version, "FlexArmController") as other:
                state = other.save()
                bad = other.serialize(state)
                other.forget(state)
        else:
            bad = {"truncated": good[:-9], "flipped": b"\xff" * 8 + good[8:], "empty": b"\0"}[damage]
        with pytest.raises(Exception, match=r"[Ee]rror|status|failed"):
            unit.deserialize(bad)
        advance(unit, 0, 10)


if __name__ == "__main__":
    _, version_, name_, file_ = sys.argv
    with initialized(version_, name_) as unit_:
        unit_.restore(unit_.deserialize(Path(file_).read_bytes()))
        print(*(float(v).hex() for v in advance(unit_, MIDDLE_OF_A_PLAN, 1000)))
