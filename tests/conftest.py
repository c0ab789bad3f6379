"""Where the packaged FMUs, the host binary and the reference data lie.

The tests use what a user gets: the files in `dist/` and the `flexarm` binary. `cargo xtask test`
makes both before it calls pytest.
"""

import json
import os
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
