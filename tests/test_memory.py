"""Valgrind over the life of the packaged units: load, use many instances, unload.

Both easy plans, which need no iterations, and those of a hot pendulum. No error, and nothing definitely lost;
only with Clarabel chosen is there what `valgrind.supp` names and explains.
"""

import shutil
import subprocess
from pathlib import Path

import fmpy
import pytest

from conftest import UNITS, fmu, target
from fmus import hot_pendulum

SUPPRESSIONS = Path(__file__).with_name("valgrind.supp")


def finds_nothing(path: Path, *arguments, suppressions: Path | None = None) -> str:
    """Run the example under Valgrind; returns what it says."""
    valgrind = shutil.which("valgrind")
    assert valgrind, "valgrind is needed: apt-get install valgrind"
    lifecycle = target() / "examples" / "lifecycle"
    assert lifecycle.is_file(), f"{lifecycle} is missing: cargo build --release --example lifecycle"
    command = [
        valgrind,
        "--quiet",
        "--error-exitcode=99",
        "--keep-debuginfo=yes",
        "--leak-check=full",
        "--show-leak-kinds=definite",
        "--errors-for-leak-kinds=definite",
        *([f"--suppressions={suppressions}"] if suppressions else []),
        str(lifecycle),
        str(path),
        *arguments,
    ]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return run.stderr


@pytest.mark.parametrize("unit", UNITS)
def test_valgrind_finds_nothing(version, unit):
    finds_nothing(fmu(version, unit))


@pytest.mark.parametrize("solver", [None, "clarabel"])
def test_valgrind_finds_nothing_in_the_solver(version, solver):
    path = fmu(version, "FlexArmController")
    names = {v.name for v in fmpy.read_model_description(str(path)).modelVariables}
    values = {n: v for n, v in hot_pendulum().items() if n in names}
    if solver == "clarabel":
        values["nmpc.solver"] = 3
    settings = [f"{n}={v}" for n, v in values.items()]
    suppressions = SUPPRESSIONS if solver else None
    said = finds_nothing(path, "3", "1", *settings, "angle=1", "setpoint=0.3", suppressions=suppressions)
    most = float(said.split("most iterations of a plan:")[1])
    assert most > 0, "this test is about plans that need the solver"
