"""What independent checkers say of the packages, and what the packages hold."""

import re
import subprocess
import sys
import zipfile

import pytest
from fmpy.validation import validate_fmu

from conftest import DIST, ROOT, UNITS, edited, fmu, run

BINARIES = {"fmi2": "binaries/linux64", "fmi3": "binaries/x86_64-linux"}


@pytest.fixture(params=UNITS)
def unit(request) -> str:
    return request.param


def test_fmpy_finds_nothing(version, unit):
    assert validate_fmu(str(fmu(version, unit))) == []


def test_fmutool_finds_nothing(version, unit):
    """The tool's exit code says nothing: its output is read for findings."""
    tool = [sys.executable, "-m", "fmu_manipulation_toolbox", "-check", "-input", str(fmu(version, unit))]
    run = subprocess.run(tool, capture_output=True, text=True, check=False)
    lines = [line.lower() for line in (run.stdout + run.stderr).splitlines()]
    assert any("seems to be compliant" in line for line in lines), lines
    assert any("no semantic error" in line for line in lines), lines
    assert not [line for line in lines if not line.startswith("info")], lines


def test_contents(version, unit):
    with zipfile.ZipFile(fmu(version, unit)) as package:
        names = set(package.namelist())
        assert {"modelDescription.xml", f"{BINARIES[version]}/{unit}.so", "documentation/index.html"} <= names
        icon = "model.png" if version == "fmi2" else "terminalsAndIcons/icon.png"
        assert package.read(icon).startswith(b"\x89PNG")
        assert any(name.startswith("documentation/licenses/") or "license" in name for name in names)
        page = package.read("documentation/index.html").decode()
    assert "<svg" in page and "arm.inertia" in page and "kg.m2" in page
    assert "http://" not in page.replace("http://www.w3.org", ""), "the page must work offline"


def test_both_versions_carry_the_same_binary(unit):
    binaries = []
    for version, folder in BINARIES.items():
        with zipfile.ZipFile(fmu(version, unit)) as package:
            binaries.append(package.read(f"{folder}/{unit}.so"))
    assert binaries[0] == binaries[1]


def test_binary_needs_system_libraries_only(unit, tmp_path):
    with zipfile.ZipFile(fmu("fmi3", unit)) as package:
        path = package.extract(f"{BINARIES['fmi3']}/{unit}.so", tmp_path)
    dynamic = subprocess.run(["readelf", "-d", path], capture_output=True, text=True, check=True).stdout
    needed = {line.split("[")[1].split(".so")[0] for line in dynamic.splitlines() if "NEEDED" in line}
    assert needed <= {"libc", "libm", "libpthread", "libdl", "libgcc_s", "ld-linux-x86-64"}, needed


def test_parameter_sets_are_complete_and_shipped():
    assert {p.name for p in (DIST / "parameters").iterdir()} >= {"tflex.ssv", "pendulum.ssv"}


def test_wrong_token_is_refused(version, unit, tmp_path):
    """A description that does not belong to the binary must not be instantiated."""
    from fmus import CoSimulation

    def token(name: str, data: bytes) -> bytes:
        if name != "modelDescription.xml":
            return data
        _, tail = data.split(b'guid="' if version == "fmi2" else b'instantiationToken="')
        return data[: len(data) - len(tail)] + b"0000" + tail[4:]

    broken = edited(fmu(version, unit), tmp_path / f"{unit}.fmu", token)
    with pytest.raises(Exception, match=r"[Ii]nstantiat"):
        CoSimulation(broken)


def test_readme_names_what_exists():
    readme = (ROOT / "README.md").read_text()
    assert "cargo xtask demo" in readme and "cargo xtask test" in readme


def test_the_page_for_fmpy_does_what_it_says():
    page = (ROOT / "docs" / "tools" / "fmpy.md").read_text()
    script = re.search(r"```python\n(from fmpy import .*?)```", page, re.DOTALL)[1]
    done = run(sys.executable, "-c", script + "print(len(result), result.dtype.names)", cwd=ROOT)
    assert done.stdout == "8001 ('time', 'angle', 'velocity', 'thermal_fraction')\n"
    commands = re.findall(r"^    fmpy (.*)", page, re.MULTILINE)
    assert len(commands) == 2
    for command in commands:
        run(sys.executable, "-m", "fmpy", *command.split(), cwd=ROOT)
