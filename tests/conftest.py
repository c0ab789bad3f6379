"""Where the packaged FMUs, the host binary and the reference data lie.

The tests use what a user gets: the files in `dist/` and the `flexarm` binary. `cargo xtask test`
makes both before it calls pytest.
"""

import json
import os
import subprocess
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
DIST = ROOT / "dist"
GOLDEN = ROOT / "control" / "tests" / "golden"
pytest_plugins = ["emulation"]
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


def edited(source: Path, target: Path, edit) -> Path:
    """The same archive, of each entry what `edit` makes of its name and bytes; None leaves it out."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        for name in old.namelist():
            data = edit(name, old.read(name))
            if data is not None:
                new.writestr(name, data)
    return target


def golden(name: str) -> dict:
    """Reference data of an independent simulation."""
    return json.loads((GOLDEN / f"{name}.json").read_text())


def run(*command, code: int = 0, **options) -> subprocess.CompletedProcess:
    """A program that must end with this code; `options` are those of `subprocess.run`."""
    words = [str(word) for word in command]
    done = subprocess.run(words, capture_output=True, text=True, check=False, **options)
    assert done.returncode == code, done.stdout + done.stderr
    return done


def pytest_addoption(parser):
    """What takes minutes is asked for."""
    parser.addoption("--slow", action="store_true", help="also slow rows of the matrix: crates, emulation")


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


def pytest_terminal_summary(terminalreporter):
    """The rows of test_matrix.py as one table."""
    reports = [*terminalreporter.getreports("passed"), *terminalreporter.getreports("failed")]
    rows = [value for report in reports for name, value in report.user_properties if name == "matrix"]
    if not rows:
        return
    header = ("case", "client", "FMI", "interface", "order", "platform", "score / rad2", "same", "sequential")
    table = [header]
    key = ("case", "platform", "client", "interface", "version", "order")
    for row in sorted(rows, key=lambda row: [row[name].lower() for name in key]):
        deviations = [f"{row[to]:+.1e}" if row[to] else "0" for to in ("same", "sequential")]
        words = [row["client"], f"{row['version'][3]}.0", row["interface"], row["order"], row["platform"]]
        table.append([row["case"], *words, f"{row['score']:.9f}", *deviations])
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    terminalreporter.section("scores, and their relative deviation from our host's: same order, sequential")
    for line in table:
        words = zip(line, widths, strict=True)
        aligned = [w.ljust(n) if i < 6 else w.rjust(n) for i, (w, n) in enumerate(words)]
        terminalreporter.write_line("  ".join(aligned))
