"""The binaries for other platforms, run under emulation: Linux on ARM in qemu, Windows in Wine.

They must do what linux64 does, to the last bit. The other platforms are in the packages after
`cargo xtask package --all-platforms` only; `cargo xtask test --platforms` makes all that is needed here.
"""

import re
import sys
import zipfile
from pathlib import Path

import pytest

from conftest import DIST, ROOT, UNITS, fmu
from emulation import HOSTS, run
from test_host import schedule, sets

BINARIES = {
    "fmi2": {"linux64": ".so", "win64": ".dll", "aarch64-linux": ".so"},
    "fmi3": {"x86_64-linux": ".so", "x86_64-windows": ".dll", "aarch64-linux": ".so"},
}
LINUX = {"libc.so.6", "libm.so.6", "libpthread.so.0", "libdl.so.2"}
LINUX |= {"ld-linux-x86-64.so.2", "ld-linux-aarch64.so.1"}
WINDOWS = {"kernel32.dll", "ntdll.dll", "msvcrt.dll", "advapi32.dll", "userenv.dll", "ws2_32.dll"}
HOT = {"initial.thermal_load": 11}  # only then does the pendulum's planner need its solver
CASES = {
    "tflex": {},
    "pendulum": HOT,
    "pendulum clarabel": HOT | {"controller:nmpc.solver": "clarabel"},
}
TRAJECTORIES = [("tflex", 2000), ("hot-pendulum", 2000)]

# One worker: Wine and the Python for it are set up once, and emulators slow each other down.
pytestmark = [pytest.mark.xdist_group("platforms"), pytest.mark.usefixtures("all_platforms")]


def names(version: str, unit: str) -> set[str]:
    """What a package holds."""
    with zipfile.ZipFile(fmu(version, unit)) as package:
        return set(package.namelist())


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


@pytest.mark.parametrize("platform", HOSTS)
@pytest.mark.parametrize("instructions", ["baseline", "automatic"])
@pytest.mark.parametrize("case", CASES)
def test_hosts_agree_to_the_last_bit(
    flexarm, foreign_flexarm, platform, version, case, instructions, tmp_path
):
    start = 1.30 if case == "tflex" else 0.785
    steps = [(0, start + 0.1), (0.5, start - 0.15), (1, start + 0.05), (1.5, start)]
    setpoints = schedule(tmp_path / "setpoints.csv", ["time", "setpoint"], steps)
    pair = [word for unit in UNITS for word in (f"--{unit[7:].lower()}", fmu(version, unit))]
    parameters = ["--parameters", DIST / "parameters" / f"{case.split()[0]}.ssv"]
    values = sets(CASES[case] | {"controller:nmpc.instruction_set": instructions})
    arguments = ["simulate", *pair, *parameters, *values, "--setpoints", setpoints, "--until", 2, "-o"]
    run(flexarm, *arguments, tmp_path / "here")
    foreign_flexarm(platform)(*arguments, tmp_path / "there")
    here, there = ((tmp_path / side / "results.csv").read_text() for side in ("here", "there"))
    assert here.count("\n") > 8000
    assert here.splitlines() == there.splitlines()


@pytest.mark.parametrize(("name", "samples"), TRAJECTORIES)
def test_fmpy_on_windows_agrees_to_the_last_bit(windows_python, name, samples):
    script = [ROOT / "tests" / "trajectory.py", name, samples]
    here, there = run(sys.executable, *script).splitlines(), windows_python(*script).splitlines()
    assert len(here) == 2 * samples
    assert here == there
