"""A panic inside a step becomes Fatal and a log message, and the process lives.

The failing unit is an example of `fmi-unit`, packaged here: the products carry no such hook.
"""

import subprocess
import zipfile

import pytest

from conftest import ROOT, VERSIONS, fmu, target
from fmus import CoSimulation

PANIC = 2


@pytest.fixture(scope="session")
def packages(tmp_path_factory) -> dict:
    """The failing unit as an FMU of each version."""
    binary = target() / "examples" / "libfault.so"
    assert binary.is_file(), f"{binary} is missing: cargo build --release --examples"
    made = {}
    for version, folder in zip(VERSIONS, ("linux64", "x86_64-linux"), strict=True):
        made[version] = tmp_path_factory.mktemp(version) / "fault.fmu"
        with zipfile.ZipFile(made[version], "w") as package:
            package.write(ROOT / f"fmi-unit/examples/fault.{version}.xml", "modelDescription.xml")
            package.write(binary, f"binaries/{folder}/fault.so")
    return made


def test_panic_becomes_fatal_in_fmpy(packages, version):
    messages = []

    def log(*arguments):
        messages.append(str(arguments[-1]))

    unit = CoSimulation(packages[version], log=log)
    unit.initialize()
    unit.step(0.0, 0.1)
    assert unit.get("steps") == 1
    unit.set("fault", PANIC)
    with pytest.raises(Exception, match=r"status 4|fatal"):
        unit.step(0.1, 0.1)
    assert any("panic" in message for message in messages), messages
    # The instance is lost, the binary is not.
    with CoSimulation(packages[version]) as other:
        other.initialize()
        other.step(0.0, 0.1)
        assert other.get("steps") == 1


def test_panic_stops_the_host_with_a_message(flexarm, packages, version, tmp_path):
    """The host runs a real controller against the failing unit, which panics at once."""
    connections = tmp_path / "connections.toml"
    connections.write_text('[[connection]]\nfrom = "plant.steps"\nto = "controller.angle"\n')
    command = [
        flexarm,
        "simulate",
        "--controller",
        fmu("fmi3", "FlexArmController"),
        "--plant",
        packages[version],
        "--connections",
        connections,
        "--set",
        f"plant:fault={PANIC}",
        "--until",
        "0.01",
        "-o",
        tmp_path / "out",
    ]
    run = subprocess.run([str(c) for c in command], capture_output=True, text=True, check=False)
    assert run.returncode == 1, run.stderr
    assert "error:" in run.stderr and "Fatal" in run.stderr
    assert not (tmp_path / "out").exists()
