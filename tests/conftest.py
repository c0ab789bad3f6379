"""Where the packaged FMUs, the host binary and the reference data lie.

The tests use what a user gets: the files in `dist/` and the `flexarm` binary. `cargo xtask test`
makes both before it calls pytest.
"""

import json
import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
DIST = ROOT / "dist"
GOLDEN = ROOT / "control" / "tests" / "golden"
VERSIONS = ("fmi2", "fmi3")
UNITS = ("FlexArmPlant", "FlexArmController")


def target() -> Path:
    """Where cargo builds to."""
    return Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release"


def fmu(version: str, unit: str) -> Path:
    """The packaged FMU of a unit for an FMI version."""
    path = DIST / version / f"{unit}.fmu"
    assert path.is_file(), f"{path} is missing: run `cargo xtask package`"
    return path


def golden(name: str) -> dict:
    """Reference data of an independent simulation."""
    return json.loads((GOLDEN / f"{name}.json").read_text())


def run(*command, code: int = 0, **options) -> subprocess.CompletedProcess:
    """A program that must end with this code; `options` are those of `subprocess.run`."""
    words = [str(word) for word in command]
    done = subprocess.run(words, capture_output=True, text=True, check=False, **options)
    assert done.returncode == code, done.stdout + done.stderr
    return done


@pytest.fixture(params=VERSIONS)
def version(request) -> str:
    """Each FMI version."""
    return request.param


@pytest.fixture(scope="session")
def flexarm() -> Path:
    """The host binary."""
    path = target() / "flexarm"
    assert path.is_file(), f"{path} is missing: run `cargo build --release`"
    return path
