"""Valgrind over the life of the packaged units: load, use 100 instances, unload.

No error, and nothing definitely lost but what `valgrind.supp` names and explains.
"""

import shutil
import subprocess
from pathlib import Path

import pytest

from conftest import UNITS, fmu, target

SUPPRESSIONS = Path(__file__).with_name("valgrind.supp")


@pytest.mark.parametrize("unit", UNITS)
def test_valgrind_finds_nothing(version, unit):
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
        f"--suppressions={SUPPRESSIONS}",
        str(lifecycle),
        str(fmu(version, unit)),
    ]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
