"""Valgrind finds nothing over the life of the packaged units: load, use 100 instances, unload."""

import shutil
import subprocess

import pytest

from conftest import UNITS, fmu, target


LEAK = pytest.mark.xfail(reason="open defect: one block of 1 kB is lost when the controller is unloaded")


@pytest.mark.parametrize("unit", [UNITS[0], pytest.param(UNITS[1], marks=LEAK)])
def test_valgrind_finds_nothing(version, unit):
    valgrind = shutil.which("valgrind")
    assert valgrind, "valgrind is needed: apt-get install valgrind"
    lifecycle = target() / "examples" / "lifecycle"
    assert lifecycle.is_file(), f"{lifecycle} is missing: cargo build --release --example lifecycle"
    command = [
        valgrind,
        "--quiet",
        "--error-exitcode=99",
        "--leak-check=full",
        "--errors-for-leak-kinds=definite",
        str(lifecycle),
        str(fmu(version, unit)),
    ]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
