"""Bad input gets one clear error that names the thing, a non-zero exit, and no half-written output."""

import itertools
import math
import subprocess
import zipfile

import pytest

from conftest import DIST, fmu
from fmus import SAMPLE, CoSimulation


def refused(flexarm, tmp_path, *arguments, controller=None, plant=None) -> str:
    """Run the host on something bad; returns its message."""
    out = tmp_path / "out"
    command = [
        flexarm,
        "simulate",
        "--controller",
        controller or fmu("fmi3", "FlexArmController"),
        "--plant",
        plant or fmu("fmi3", "FlexArmPlant"),
        "--until",
        0.1,
        "-o",
        out,
        *arguments,
    ]
    run = subprocess.run([str(c) for c in command], capture_output=True, text=True, check=False)
    assert run.returncode == 2, f"exit code {run.returncode}\n{run.stderr}"
    assert "error:" in run.stderr
    assert "panicked" not in run.stderr
    assert not out.exists() or not list(out.iterdir()), "nothing may be half-written"
    return run.stderr


@pytest.mark.parametrize(
    ("setting", "names"),
    [
        ("arm.inertia=-1", ["arm.inertia", "-1", "kg.m2"]),
        ("arm.inertia=nan", ["arm.inertia"]),
        ("nmpc.horizon=0", ["nmpc.horizon", "0", "2", "400"]),
        ("nmpc.period=-0.1", ["nmpc.period", "-0.1", "s"]),
        ("nmpc.thermal_share=1.5", ["nmpc.thermal_share", "1.5", "1"]),
        ("limits.angle_lower=2", ["limits.angle_lower", "2", "rad"]),
        ("initial.angle=3", ["initial.angle", "3", "rad"]),
        ("nmpc.angle_margin=1", ["nmpc.angle_margin", "1", "rad"]),
        ("nmpc.model=qp", ["nmpc.solver = 2", "clarabel", "nmpc.terminal", "rest_at_goal"]),
        ("nmpc.terminal=rest", ["nmpc.terminal", "rest_at_goal", "safe_set", "free"]),
        ("feedback.law=mpc", ["feedback.law", "mpc", "lqr", "lqri", "pid"]),
        ("no.such.thing=1", ["no.such.thing"]),
        ("arm.inertia=heavy", ["arm.inertia", "heavy"]),
    ],
)
def test_parameters(flexarm, tmp_path, setting, names):
    message = refused(flexarm, tmp_path, "--set", setting)
    assert all(name in message for name in names), message


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("time,setpoint\n0,1.3\n0.05,high\n", ["3", "setpoint", "high"]),
        ("time,setpoint\n0,1.3\n0.05,\n", ["3", "setpoint"]),
        ("time,setpoint\n0,1.3\n0.05,nan\n", ["3", "setpoint"]),
        ("time,setpoint\n0,1.3\n0.05,1.2\n0.04,1.3\n", ["4", "time", "0.04"]),
        ("time,setpoint\n0,1.3\n0.05\n", ["3"]),
        ("time,setpoint\n0,5\n", ["setpoint", "5", "rad", "1.53"]),
        ("time,setpont\n0,1.3\n", ["setpont"]),
        ("", ["setpoints.csv"]),
    ],
)
def test_setpoint_files(flexarm, tmp_path, text, names):
    file = tmp_path / "setpoints.csv"
    file.write_text(text)
    message = refused(flexarm, tmp_path, "--setpoints", file)
    assert all(name in message for name in [*names, "setpoints.csv"]), message


@pytest.mark.parametrize(
    ("change", "names"),
    [
        (("arm.inertia", "arm.inertial"), ["arm.inertial"]),
        (('unit="kg.m2"', 'unit="N.m"'), ["arm.inertia", "N.m", "kg.m2"]),
        (("</ssv:ParameterSet>", ""), ["bad.ssv"]),
    ],
)
def test_parameter_files(flexarm, tmp_path, change, names):
    text = (DIST / "parameters" / "tflex.ssv").read_text()
    assert change[0] in text
    file = tmp_path / "bad.ssv"
    file.write_text(text.replace(*change))
    message = refused(flexarm, tmp_path, "--parameters", file)
    assert all(name in message for name in [*names, "bad.ssv"]), message


def rewritten(tmp_path, edit) -> str:
    """The plant's package with its entries edited."""
    path = tmp_path / "edited.fmu"
    with zipfile.ZipFile(fmu("fmi3", "FlexArmPlant")) as source, zipfile.ZipFile(path, "w") as package:
        entries = {name: source.read(name) for name in source.namelist()}
        edit(entries)
        for name, data in entries.items():
            info = zipfile.ZipInfo(name)
            if isinstance(data, tuple):
                info.external_attr, data = data
            info.compress_type = zipfile.ZIP_DEFLATED
            with package.open(info, "w", force_zip64=True) as entry:
                for part in [data] if isinstance(data, bytes) else data:
                    entry.write(part)
    return path


def token(entries):
    text = entries["modelDescription.xml"]
    head, tail = text.split(b'instantiationToken="')
    entries["modelDescription.xml"] = head + b'instantiationToken="0000' + tail[4:]


@pytest.mark.parametrize(
    ("edit", "names"),
    [
        (lambda e: e.update({"../outside.txt": b"x"}), ["../outside.txt"]),
        (lambda e: e.update({"/etc/outside.txt": b"x"}), ["/etc/outside.txt"]),
        (lambda e: e.update({"resources/link": (0o120777 << 16, b"/etc/passwd")}), ["resources/link"]),
        (
            lambda e: e.update({"resources/zeros": itertools.repeat(bytes(1 << 20), 1025)}),
            ["resources/zeros", "1024 MiB"],
        ),
        (lambda e: e.pop("modelDescription.xml"), ["modelDescription.xml"]),
        (lambda e: e.pop("binaries/x86_64-linux/FlexArmPlant.so"), ["x86_64-linux"]),
        (
            lambda e: e.update({"modelDescription.xml": e["modelDescription.xml"][:4000]}),
            ["modelDescription.xml"],
        ),
        (token, ["oken"]),
    ],
    ids=["parent", "absolute", "link", "bomb", "no-description", "no-binary", "cut-description", "token"],
)
def test_hostile_packages(flexarm, tmp_path, edit, names):
    message = refused(flexarm, tmp_path, plant=rewritten(tmp_path, edit))
    assert all(name in message for name in names), message


def test_truncated_package(flexarm, tmp_path):
    path = tmp_path / "cut.fmu"
    path.write_bytes(fmu("fmi3", "FlexArmPlant").read_bytes()[:-5000])
    assert "cut.fmu" in refused(flexarm, tmp_path, plant=path)


@pytest.mark.parametrize("name", ["arm.inertia", "nmpc.period"])
@pytest.mark.parametrize("value", [-1.0, math.nan, math.inf])
def test_units_refuse_parameters_by_name(version, name, value):
    messages = []

    def log(_environment, _status, _category, message):
        messages.append(message.decode() if isinstance(message, bytes) else message)

    with (
        CoSimulation(fmu(version, "FlexArmController"), log=log) as controller,
        pytest.raises(Exception, match=r"[Ee]rror|status"),
    ):
        controller.set(name, value)
    assert any(name in m for m in messages), messages


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_bad_measurement_holds_the_last_good_command(version, bad):
    messages = []

    def log(_environment, _status, _category, message):
        messages.append(message.decode() if isinstance(message, bytes) else message)

    with CoSimulation(fmu(version, "FlexArmController"), log=log) as controller:
        controller.initialize(angle=1.3, setpoint=1.4)
        controller.set("angle", 1.3)
        for k in range(100):
            controller.step(k * SAMPLE)
        good = controller.get("torque")
        status = controller.get("nmpc.status")
        controller.set("angle", bad)
        messages.clear()
        for k in range(100, 500):
            controller.step(k * SAMPLE)
            assert controller.get("torque") == good
            assert controller.get("nmpc.status") == 7, "measurement_held"
        (warning,) = messages
        assert "angle = " in warning and str(bad) in warning.lower() and "held" in warning
        controller.set("angle", 1.3)
        for k in range(500, 700):
            controller.step(k * SAMPLE)
            assert math.isfinite(controller.get("torque"))
        assert controller.get("nmpc.status") == status


@pytest.mark.parametrize("read_before", [False, True])
def test_initial_outputs_do_not_depend_on_who_read_them(version, read_before):
    with CoSimulation(fmu(version, "FlexArmController")) as controller:
        controller.configure({"initial.thermal_load": 9.8})
        if read_before:
            controller.get("reference.angle")
        controller.initialize(angle=1.3, setpoint=1.4)
        assert controller.get("reference.angle") == 1.3
        assert controller.get("thermal_load") == 9.8
        assert controller.get("torque") == 0.0


def test_plant_refuses_a_torque_that_is_no_number(version):
    with CoSimulation(fmu(version, "FlexArmPlant")) as plant:
        plant.initialize()
        plant.set("torque", math.nan)
        with pytest.raises(Exception, match=r"[Ee]rror|status"):
            plant.step(0.0)
