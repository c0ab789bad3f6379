"""Clients x FMI versions x interfaces x platforms: who runs the same closed loop, scores the same.

Each row is one loop of `cases.py`. It is compared with our host in the same stepping order, to 1e-9, on
other platforms to the bit, or to 1e-4 if an adaptive solver moves the arm, and with our host in sequential
order, to 1 %, what a sample of delay may change. `conftest.py` prints all rows as one table.
"""

import json
import os
import subprocess
import sys
import sysconfig
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pytest
from lxml import etree

from bare import BareCoSimulation
from cases import CASES
from conftest import DIST, ROOT, UNITS, VERSIONS, edited, fmu, run
from exchange import ExchangeLoop
from fmus import CoSimulation, EventfulCoSimulation
from score import score
from test_ssp import closed, columns, system

CLIENTS = ROOT / "tests" / "clients"
CRATES = ("fmi", "fmi-rs")
HERE = "x86_64-linux"
ORDERS = ("sequential", "side-by-side")
# Experiments of dist/ssp/ that hold a case.
STRUCTURES = {"pendulum": ("disturbance", "LQRI-MPC"), "T-flex": ("FlexArm", "T-flex")}


@dataclass(frozen=True)
class Row:
    """Who runs a case, and how."""

    client: str
    case: str
    version: str
    interface: str
    order: str
    platform: str = HERE

    @property
    def is_slow(self) -> bool:
        """Emulated, a crate whose first build takes minutes, or 100 000 steps from Python."""
        in_python = self.case == "pendulum" and self.client in ("FMPy", "fmuloader")
        return in_python or self.client in CRATES or self.platform != HERE

    def __str__(self) -> str:
        return "-".join(word.replace(" ", "_") for word in vars(self).values())


def rows(client: str, interface: str, orders=("sequential",), **limits) -> list[Row]:
    """All rows of a client, less what it cannot do."""
    return [
        Row(client, case, version, interface, order, platform)
        for platform in limits.get("platforms", [HERE])
        for case in limits.get("cases", CASES)
        for version in limits.get("versions", VERSIONS)
        for order in orders
    ]


def pair(version: str) -> list:
    """Arguments of `flexarm simulate` that name both units."""
    return [word for unit in UNITS for word in (f"--{unit[7:].lower()}", fmu(version, unit))]


def by_host(simulate: Callable, row: Row, folder: Path) -> float:
    """Our host, which scores the pair itself."""
    arguments = [*pair(row.version), *CASES[row.case].for_host(folder), "--order", row.order]
    simulate("simulate", *arguments, "--record", 1000, "-o", folder / "out")
    return json.loads((folder / "out" / "summary.json").read_text())["score"]["squared_error_rad2"]


def structure_by_host(simulate: Callable, row: Row, folder: Path) -> float:
    """Our host with a system structure, which carries inputs and parameters."""
    name, variant = STRUCTURES[row.case]
    package = system(row.version) if name == "FlexArm" else DIST / "ssp" / row.version / f"{name}.ssp"
    case = CASES[row.case]
    simulate(
        *("simulate", package, "--variant", variant, "--until", case.until),
        *("--order", row.order, "-o", folder / "out"),
    )
    return case.score(columns(folder / "out" / "results.csv")["plant.angle"][: case.samples].tolist())


def exchange_by_fmpy(row: Row) -> float:
    """Model Exchange in CVode."""
    case = CASES[row.case]
    with ExchangeLoop(row.version, case.at, case.values, case.controller) as loop:
        first = loop.plant.get("angle")
        return case.score([first, *(loop.sample()[1] for _ in range(case.samples - 1))])


# See test_ssp.py for why it leaves early.
ECOS = """
import json, os, sys
from ecospy import EcosSimulation
inputs, angles = dict(json.loads(sys.argv[2])), []
with EcosSimulation(ssp_path="closed.ssp", step_size=0.00025) as simulation:
    simulation.init(parameter_set="T-flex")
    for k in range(int(sys.argv[1])):
        angles.append(simulation.get_real("plant::angle"))
        if k in inputs:
            simulation.set_real("controller::setpoint", inputs[k])
        simulation.step(1)
    print("angles", json.dumps(angles), flush=True)
    os._exit(0)
"""


def structure_by_ecos(row: Row, folder: Path) -> float:
    """ecos with a system structure, whose inputs it is given step by step."""
    case = CASES[row.case]
    edited(system(row.version), folder / "closed.ssp", closed)
    setpoints = json.dumps([(k, setpoint) for k, (setpoint, _) in case.inputs.items()])
    command = [sys.executable, "-c", ECOS, str(case.samples), setpoints]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=folder)
    if "libtbb" in done.stderr:
        pytest.skip("ecos needs libtbb12")
    assert done.returncode == 0, done.stdout + done.stderr
    (line,) = (line for line in done.stdout.splitlines() if line.startswith("angles "))
    return case.score(json.loads(line.removeprefix("angles ")))


@pytest.fixture(scope="session")
def crates() -> Path:
    """Where the clients in Rust are, built if need be. libclang from PyPI, for bindgen, has no headers."""
    clang = Path(sysconfig.get_path("platlib"), "clang", "native")
    headers = run("cc", "-print-file-name=include").stdout.strip()
    found = {"LIBCLANG_PATH": str(clang), "BINDGEN_EXTRA_CLANG_ARGS": f"-I{headers}"}
    built = ROOT / "target" / "clients"
    cargo = [os.environ.get("CARGO", "cargo"), "build", "--release", "--locked", "--target-dir", built]
    run(*cargo, "--manifest-path", CLIENTS / "Cargo.toml", env=os.environ | found)
    return built / "release"


def without_units(name: str, data: bytes) -> bytes:
    """An FMU without units: the crate fmi 0.8 knows neither `unit` nor the ampere in FMI 3.0."""
    if name != "modelDescription.xml":
        return data
    tree = etree.fromstring(data)
    tree.remove(tree.find("UnitDefinitions"))
    for variable in tree.iterfind("ModelVariables/*[@unit]"):
        del variable.attrib["unit"]
    return etree.tostring(tree)


def by_crate(crates: Path, row: Row, folder: Path) -> float:
    """An importer in Rust."""
    loop = folder / "loop.json"
    units = [fmu(row.version, unit) for unit in ("FlexArmController", "FlexArmPlant")]
    if row.client == "fmi" and row.version == "fmi3":
        units = [edited(unit, folder / unit.name, without_units) for unit in units]
    loop.write_text(CASES[row.case].as_json(*units, row.order))
    return float(run(crates / f"client-{row.client}", loop).stdout)


ROWS = [
    *rows("flexarm", "CS", ORDERS),
    *rows("flexarm", "SSP", ORDERS),
    *rows("FMPy", "CS", ORDERS),
    *rows("FMPy", "CS, events", versions=["fmi3"]),
    *rows("FMPy", "ME"),
    *rows("fmuloader", "CS", ORDERS),
    *rows("ecos", "SSP", ["side-by-side"], cases=["T-flex"]),
    *rows("libcosim", "CS", ["side-by-side"], cases=["T-flex"], versions=["fmi2"]),
    *(row for crate in CRATES for row in rows(crate, "CS", ORDERS)),
    *rows("flexarm", "CS", ORDERS, platforms=["x86_64-windows", "aarch64-linux"]),
    *rows("FMPy", "CS", platforms=["x86_64-windows"]),
]


def scored(row: Row, request, folder: Path) -> float:
    """The score of a row."""
    fixture = request.getfixturevalue
    match row.client, row.interface:
        case "flexarm", interface:
            here = row.platform == HERE
            flexarm = fixture("flexarm") if here else fixture("foreign_flexarm")(row.platform)
            simulate = (lambda *words: run(flexarm, *words)) if here else flexarm
            return (by_host if interface == "CS" else structure_by_host)(simulate, row, folder)
        case "FMPy", "CS" if row.platform != HERE:
            script = ROOT / "tests" / "score.py"
            return float(fixture("windows_python")(script, row.case, row.version, row.order))
        case "FMPy", "CS":
            return score(row.case, row.version, row.order)
        case "FMPy", "CS, events":
            return score(row.case, row.version, row.order, (EventfulCoSimulation, CoSimulation))
        case "FMPy", "ME":
            return exchange_by_fmpy(row)
        case "fmuloader", _:
            return score(row.case, row.version, row.order, (BareCoSimulation, BareCoSimulation))
        case "ecos", _:
            return structure_by_ecos(row, folder)
        case "libcosim", _:
            pytest.importorskip("libcosimpy.CosimExecution", reason="libcosim is on PyPI for Linux on x86-64")
            return float(run(sys.executable, ROOT / "tests" / "cosim.py", row.case).stdout)
        case _:
            return by_crate(fixture("crates"), row, folder)


# Of the independent simulation in table 3, and of ours before any of these clients was connected.
SCORES = {"pendulum": 493.8, "T-flex": 138.7}


@pytest.fixture(scope="session")
def reference(flexarm, tmp_path_factory) -> Callable[[str, str], float]:
    """The score of a case by our host on this platform in an order, FMI 3.0."""

    @cache
    def known(case: str, order: str) -> float:
        row = Row("flexarm", case, "fmi3", "CS", order)
        score = by_host(lambda *words: run(flexarm, *words), row, tmp_path_factory.mktemp("reference"))
        # All rows are relative to this: it must itself be right.
        assert score == pytest.approx(SCORES[case], rel=2e-3)
        return score

    return known


# Emulators in one worker, as in test_platforms.py.
GROUPS = [
    pytest.param(row, marks=[pytest.mark.xdist_group("platforms")] * (row.platform != HERE)) for row in ROWS
]


@pytest.mark.parametrize("row", GROUPS, ids=str)
def test_score_is_that_of_our_host(row, request, reference, tmp_path, record_property):
    if row.is_slow and not request.config.getoption("--slow"):
        pytest.skip("slow rows need --slow, which `cargo xtask test --platforms` gives")
    found = scored(row, request, tmp_path)
    same, sequential = (found / reference(row.case, order) - 1 for order in (row.order, "sequential"))
    record_property("matrix", {**vars(row), "score": found, "same": same, "sequential": sequential})
    assert abs(same) <= (0 if row.platform != HERE else 1e-4 if row.interface == "ME" else 1e-9)
    assert abs(sequential) <= 0.01
