"""The C header of the Modelica package's controller, called as a Modelica tool calls it, against the FMU."""

import ctypes
import functools
import os
import re
import subprocess

import numpy as np
import pytest

import emulation
from conftest import ROOT, fmu
from fmus import SAMPLE, CoSimulation
from modelica_package import PACKAGE, STAND_IN

LIBRARIES = PACKAGE / "Resources" / "Library"
INCLUDE = ["-I", STAND_IN, "-I", PACKAGE / "Resources" / "Include"]
STRICT = ["-std=gnu99", "-Wall", "-Wextra", "-Werror", *INCLUDE]
SAMPLES = 2000
# Where `cargo xtask test --platforms` keeps zig, and what it has built of its C libraries.
TOOLCHAIN = ROOT / "target" / "toolchain"
# By the fixture that runs their programs.
TARGETS = {"wine": "x86_64-windows-gnu", "qemu": "aarch64-linux-gnu.2.17"}


@functools.cache
def constants() -> dict[str, list[int] | str]:
    """The constants of FlexArm.Internal.Contract."""
    text = (PACKAGE / "Internal" / "Contract.mo").read_text()
    token = re.search(r'constant String token = "(\w+)"', text).group(1)
    found = re.findall(r"constant Integer (\w+)\[\d+\] = \{([\d, ]*)\}", text)
    return {name: [int(v) for v in values.split(",")] for name, values in found} | {"token": token}


class Wrapper:
    """The header, compiled as a Modelica tool does, called as one does."""

    def __init__(self, folder):
        library = folder / "driver.so"
        shared = ["-shared", "-fPIC", STAND_IN / "driver.c", "-o", library, "-ldl"]
        subprocess.run(["cc", *STRICT, *shared], check=True)
        self.c = ctypes.CDLL(str(library))
        self.c.construct.restype = ctypes.c_void_p
        self.c.why.restype = ctypes.c_char_p

    def construct(self, values: dict[str, list], libraries=None, **changed):
        contract = constants() | changed
        lists = []
        for name, kind in (("real", ctypes.c_double), ("integer", ctypes.c_int), ("boolean", ctypes.c_int)):
            references = contract[f"{name}Parameters"]
            count = len(references)
            lists += [ints(references), (kind * count)(*values[name]), ctypes.c_size_t(count)]
        self.reals, self.integers = len(contract["realOutputs"]), len(contract["integerOutputs"])
        self.object = self.c.construct(
            str(libraries or LIBRARIES).encode(),
            contract["token"].encode(),
            ctypes.c_double(SAMPLE),
            ints(contract["inputs"]),
            ints(contract["realOutputs"]),
            ctypes.c_size_t(self.reals),
            ints(contract["integerOutputs"]),
            ctypes.c_size_t(self.integers),
            *lists,
        )
        return self.object

    def sample(self, now: float, angle: float, setpoint: float) -> tuple[list[float], list[int]]:
        reals, integers = (ctypes.c_double * self.reals)(), (ctypes.c_int * self.integers)()
        inputs = (ctypes.c_double * 2)(angle, setpoint)
        sizes = ctypes.c_size_t(self.reals), ctypes.c_size_t(self.integers)
        at = ctypes.c_void_p(self.object), ctypes.c_double(now)
        failed = self.c.take(*at, inputs, reals, sizes[0], integers, sizes[1])
        assert not failed, self.c.why()
        return list(reals), list(integers)

    def destroy(self) -> None:
        self.c.destroy(ctypes.c_void_p(self.object))


def ints(values: list[int]):
    return (ctypes.c_int * len(values))(*values)


def start_values(unit: CoSimulation) -> dict[str, list]:
    """The FMU's own values of all parameters, by the contract's references."""
    contract = constants()
    getters = {"real": unit.fmu.getReal, "integer": unit.fmu.getInteger, "boolean": unit.fmu.getBoolean}
    values = {kind: list(get(contract[f"{kind}Parameters"])) for kind, get in getters.items()}
    return values | {"boolean": [int(v) for v in values["boolean"]]}


@pytest.fixture(scope="module")
def wrapper(tmp_path_factory) -> Wrapper:
    return Wrapper(tmp_path_factory.mktemp("modelica"))


def operation(k: int) -> tuple[float, float, float]:
    """Time, angle and setpoint of a sample."""
    now = k * SAMPLE
    return now, 1.3 + 0.01 * np.sin(20 * now), 1.2 if now < 0.25 else 1.35


def short_horizon(unit: CoSimulation) -> dict[str, list]:
    """Parameters that are not all defaults, set in the unit and given as the contract's lists."""
    values = start_values(unit)
    reference = unit.variables["nmpc.horizon"].valueReference
    values["integer"][constants()["integerParameters"].index(reference)] = 20
    unit.set("nmpc.horizon", 20)
    return values


def outputs_of_the_fmu(unit: CoSimulation, k: int) -> tuple[list[float], list[int]]:
    """Takes a sample of `operation`."""
    now, angle, setpoint = operation(k)
    unit.set("angle", angle)
    unit.set("setpoint", setpoint)
    unit.step(now)
    contract = constants()
    return unit.fmu.getReal(contract["realOutputs"]), unit.fmu.getInteger(contract["integerOutputs"])


@pytest.mark.parametrize("start", [0.0, 5.0, -0.1])
def test_the_c_interface_gives_what_the_fmu_gives_to_the_bit(wrapper, start):
    with CoSimulation(fmu("fmi2", "FlexArmController")) as unit:
        values = short_horizon(unit)
        unit.initialize()
        assert wrapper.construct(values), wrapper.c.why()
        torques = set()
        for k in range(SAMPLES):
            now, angle, setpoint = operation(k)
            reals, integers = wrapper.sample(start + now, angle, setpoint)
            assert (reals, integers) == outputs_of_the_fmu(unit, k), now
            # An event iteration is no sample.
            assert wrapper.sample(start + now, angle + 1, setpoint) == (reals, integers)
            torques.add(reals[0])
        print(f"\n{SAMPLES} samples from {start} s on, {len(torques)} torques, all equal to the bit")
        assert len(torques) > 1000
        wrapper.destroy()


@pytest.mark.xdist_group("platforms")
@pytest.mark.usefixtures("all_platforms")
@pytest.mark.parametrize("emulator", TARGETS)
def test_the_header_works_on_other_platforms(request, emulator, tmp_path):
    """Its branches for Windows and ARM: a program made by zig's C compiler, in Wine and in qemu."""
    run = request.getfixturevalue(emulator)
    program = tmp_path / "samples.exe"
    sources = [STAND_IN / "driver.c", STAND_IN / "samples.c"]
    python = TOOLCHAIN / "python" / "bin" / "python"
    assert python.is_file(), f"{python} is missing: run `cargo xtask test --platforms`"
    compile_ = [python, "-m", "ziglang", "cc", "-target", TARGETS[emulator], *STRICT, *sources]
    cache = os.environ | {"ZIG_GLOBAL_CACHE_DIR": str(TOOLCHAIN / "zig")}
    emulation.run(*compile_, "-o", program, env=cache)
    contract = constants()
    with CoSimulation(fmu("fmi2", "FlexArmController")) as unit:
        values = short_horizon(unit)
        lists = [contract[name] for name in ("inputs", "realOutputs", "integerOutputs")]
        for kind in ("real", "integer", "boolean"):
            lists += [contract[f"{kind}Parameters"], values[kind]]
        lines = [f"{contract['token']} {SAMPLE!r}"]
        lines += [" ".join(map(repr, [len(numbers), *numbers])) for numbers in lists]
        lines += [" ".join(repr(float(value)) for value in operation(k)) for k in range(SAMPLES)]
        unit.initialize()
        printed = run(program, LIBRARIES, SAMPLES, input="\n".join(lines)).splitlines()
        assert len(printed) == SAMPLES
        for k, line in enumerate(printed):
            reals, integers = outputs_of_the_fmu(unit, k)
            words = line.split()
            assert [float.fromhex(word) for word in words[: len(reals)]] == reals, k
            assert [int(word) for word in words[len(reals) :]] == integers, k


def test_the_generated_defaults_are_those_of_the_fmu():
    """What Modelica hands over by default: the values of the records, against the FMU's start values."""
    with CoSimulation(fmu("fmi2", "FlexArmController")) as unit:
        expected = start_values(unit)
    functions = (PACKAGE / "Internal" / "Contract.mo").read_text()
    for kind, values in expected.items():
        body = functions.split(f"function {kind}s ")[1].split(f"end {kind}s;")[0]
        paths = re.findall(r":= (?:Integer\()?parameters\.([\w.]+)", body)
        assert [value for path in paths for value in default(path)] == values


def default(path: str) -> list:
    """The default of a parameter in its record, as the C interface takes it."""
    group, _, name = path.rpartition(".")
    record = PACKAGE / "Parameters" / f"{group.strip('_').capitalize() or 'TFlex'}.mo"
    declaration = rf'^  parameter \S+ {name}(?:\[\d+\])?(?:\([^"]*(?:"[^"]*"[^"]*)?\))? = (.*?) "'
    text = re.search(declaration, record.read_text(), re.MULTILINE).group(1)
    if text.startswith("FlexArm.Types."):
        *_, kind, item = text.split(".")
        items = re.findall(r"^    (\w+) \"", (PACKAGE / "Types" / f"{kind}.mo").read_text(), re.MULTILINE)
        return [items.index(item) + 1]
    if text in ("true", "false"):
        return [int(text == "true")]
    return [float(value) for value in text.strip("{}").split(", ")]


def test_errors_end_the_simulation_with_the_binarys_own_words(wrapper, tmp_path):
    with CoSimulation(fmu("fmi2", "FlexArmController")) as unit:
        values = start_values(unit)
    assert not wrapper.construct(values, libraries=tmp_path)
    assert b"loading the binary" in wrapper.c.why() and str(tmp_path).encode() in wrapper.c.why()
    assert not wrapper.construct(values, token="another")
    assert b"instantiation failed" in wrapper.c.why()
    values["real"][0] = -1.0
    assert not wrapper.construct(values)
    print(f"\n{wrapper.c.why().decode()}")
    assert b"arm.inertia = -1 kg.m2 is outside" in wrapper.c.why()
