"""System structures: ours in other tools, another's in ours."""

import csv
import json
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy.ssp
import numpy
import pytest
from fmpy.ssp.simulation import simulate_ssp
from lxml import etree

from conftest import DIST, ROOT, edited, fmu, run
from fmus import SAMPLE
from test_foreign import wheel

SCHEMAS = Path(fmpy.ssp.__file__).parent / "schema"
NAMESPACES = {
    "ssd": "http://ssp-standard.org/SSP1/SystemStructureDescription",
    "ssc": "http://ssp-standard.org/SSP1/SystemStructureCommon",
    "oms": "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd",
}
SHIPPED = sorted(DIST.glob("FlexArm.ssp")) + sorted((DIST / "ssp").glob("*/*.ssp"))


def system(version: str) -> Path:
    """The connected pair with the FMUs of a version."""
    return DIST / "FlexArm.ssp" if version == "fmi2" else DIST / "ssp" / "fmi3" / "FlexArm.ssp"


def columns(results: Path) -> dict[str, numpy.ndarray]:
    with results.open() as file:
        rows = list(csv.reader(file))
    return dict(zip(rows[0], numpy.array(rows[1:], dtype=float).T, strict=True))


def assert_same(found: dict, expected: dict) -> None:
    """Every column to 1e-9 of its largest value."""
    assert found.keys() == expected.keys()
    for name, values in expected.items():
        if name != "controller.nmpc.solve_time":
            scale = max(abs(values).max(), 1e-300)
            assert abs(found[name] - values).max() <= 1e-9 * scale, name


def test_everything_ships():
    assert len(SHIPPED) >= 20, SHIPPED


@pytest.mark.parametrize("path", SHIPPED, ids=lambda p: f"{p.parent.name}/{p.stem}")
def test_structures_are_valid_and_drawn(path):
    """By the schemas of the standard, with what OMSimulator needs to run them."""
    with zipfile.ZipFile(path) as package:
        names = package.namelist()
        assert "SystemStructure.ssd" in names
        for name in names:
            kind = {".ssd": "Description", ".ssv": "ParameterValues"}.get(Path(name).suffix)
            if kind is None:
                continue
            schema = etree.XMLSchema(file=str(SCHEMAS / f"SystemStructure{kind}.xsd"))
            tree = etree.fromstring(package.read(name))
            assert schema.validate(tree), (name, schema.error_log)
            if kind != "Description":
                continue
            for element in tree.iterfind(".//*[@source]"):
                assert element.get("source") in names
            master = tree.find("ssd:System/ssd:Annotations//oms:FixedStepMaster", NAMESPACES)
            assert float(master.get("stepSize")) > 0
            boxes = tree.findall(".//ssd:ElementGeometry", NAMESPACES)
            places = tree.findall(".//ssd:ConnectorGeometry", NAMESPACES)
            connectors = tree.findall(".//ssd:Connector", NAMESPACES)
            connections = tree.findall(".//ssd:Connection", NAMESPACES)
            lines = tree.findall(".//ssd:Connection/ssd:ConnectionGeometry", NAMESPACES)
            assert len(boxes) == 2 and len(places) == len(connectors) and len(lines) == len(connections)
            assert tree.find(".//ssd:SystemGeometry", NAMESPACES) is not None


@pytest.mark.parametrize("variant", ["T-flex", "pendulum"])
def test_our_host_runs_it_as_the_pair(flexarm, tmp_path, version, variant):
    run(flexarm, "simulate", system(version), "--variant", variant, "--until", 4, "-o", tmp_path / "ssp")
    setpoints = ROOT / "packaging" / "assets" / "tflex-setpoints.csv"
    if variant == "pendulum":
        setpoints = tmp_path / "setpoints.csv"
        setpoints.write_text("time,setpoint\n0,0.785\n2,0.3\n")
    pair = ["--controller", fmu(version, "FlexArmController"), "--plant", fmu(version, "FlexArmPlant")]
    parameters = DIST / "parameters" / f"{variant.replace('-', '').lower()}.ssv"
    run(
        *(flexarm, "simulate", *pair, "--parameters", parameters, "--setpoints", setpoints),
        *("--until", 4, "-o", tmp_path / "pair"),
    )
    assert_same(columns(tmp_path / "ssp" / "results.csv"), columns(tmp_path / "pair" / "results.csv"))


def test_an_experiment_is_what_its_file_says(flexarm, tmp_path, version):
    """A push with all that an experiment can give: two parameter files, values, a second input."""
    run(flexarm, "run", ROOT / "experiments" / "disturbance.toml", "-o", tmp_path / "run")
    name = "LQRII-MPCI"
    package = DIST / "ssp" / version / "disturbance.ssp"
    run(flexarm, "simulate", package, "--variant", name, "--record", 10, "-o", tmp_path / "ssp")
    expected = columns(tmp_path / "run" / "disturbance" / name / "results.csv")
    found = columns(tmp_path / "ssp" / "results.csv")
    renamed = {"plant.disturbance_torque": "disturbance_torque"}
    assert_same(found, {renamed.get(k, k): v for k, v in expected.items()})


def test_fmpy_runs_it(flexarm, tmp_path):
    """FMPy steps side by side; it applies no parameter bindings, which the T-flex does not need."""
    # Between two plans: both see the move in time for the same one.
    move = 1.49

    def setpoint(time):
        return 1.1271 if time < move - 1e-9 else 1.1735

    found = simulate_ssp(str(system("fmi2")), stop_time=2, step_size=SAMPLE, input={"setpoint": setpoint})
    inputs = tmp_path / "setpoints.csv"
    inputs.write_text(f"time,setpoint\n0,1.1271\n{move},1.1735\n")
    run(
        *(flexarm, "simulate", system("fmi2"), "--setpoints", inputs, "--until", 2),
        *("--order", "side-by-side", "-o", tmp_path / "out"),
    )
    ours = columns(tmp_path / "out" / "results.csv")
    # FMPy's row holds outputs at the end of its step. It feeds the first step with zeros: the controller
    # believes that the arm is at 0 rad and takes a second to find out; the hysteresis remembers it.
    settled = round(1 / SAMPLE)
    theirs, ours = found["plant.angle"][settled : len(ours["time"]) - 1], ours["plant.angle"][settled + 1 :]
    difference = abs(theirs - ours).max()
    print(f"{difference:.1e} rad apart after a second, {abs(theirs[1:] - ours[:-1]).max():.1e} a step later")
    assert theirs[-1] == pytest.approx(1.1735, abs=1e-5)
    assert difference < 2e-6


def closed(name: str, data: bytes) -> bytes:
    """A package without inputs and outputs of the root system, which ecos does not know."""
    if name == "SystemStructure.ssd":
        tree = etree.fromstring(data)
        root = tree.find("ssd:System", NAMESPACES)
        tree.remove(tree.find("ssd:DefaultExperiment", NAMESPACES))
        for outer in ("Connectors", "ParameterBindings"):
            root.remove(root.find(f"ssd:{outer}", NAMESPACES))
        connections = root.find("ssd:Connections", NAMESPACES)
        for connection in list(connections):
            if not {"startElement", "endElement"} <= set(connection.keys()):
                connections.remove(connection)
        return etree.tostring(tree)
    if name == "resources/T-flex-controller.ssv":
        start = b'<ssv:Parameter name="setpoint"><ssv:Real value="1.1"/></ssv:Parameter>'
        return data.replace(b"</ssv:Parameters>", start + b"</ssv:Parameters>")
    return data


# Its reader of FMI 3.0 frees a string of a description with clocks twice in the end: leave before.
ECOS = """
import os
from ecospy import EcosSimulation
with EcosSimulation(ssp_path="closed.ssp", step_size=0.00025) as simulation:
    simulation.init(parameter_set="T-flex")
    for time in (0.05, 0.1, 0.2):
        simulation.step_until(time)
        print("angle", repr(simulation.get_real("plant::angle")), flush=True)
    os._exit(0)
"""


def test_ecos_runs_it(flexarm, tmp_path, version):
    """A co-simulation tool that applies our parameter sets, with FMUs of both versions."""
    edited(system(version), tmp_path / "closed.ssp", closed)
    command = [sys.executable, "-c", ECOS]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)
    if "libtbb" in done.stderr:
        pytest.skip("ecos needs libtbb12")
    assert done.returncode == 0, done.stdout + done.stderr
    theirs = [float(line.split()[1]) for line in done.stdout.splitlines() if line.startswith("angle ")]
    run(
        *(flexarm, "simulate", "closed.ssp", "--order", "side-by-side", "--until", 0.2, "-o", "out"),
        cwd=tmp_path,
    )
    ours = columns(tmp_path / "out" / "results.csv")["plant.angle"]
    # In the midst of the move, to the bit. ecos stops a step before the instant that it is told.
    assert theirs == [ours[round(time / SAMPLE) - 1] for time in (0.05, 0.1, 0.2)]


HEAD = """<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription version="1.0" name="two masses"
    xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"
    xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"
    xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues">
"""
MASSES = (
    HEAD
    + """<ssd:System name="masses">
<ssd:ParameterBindings><ssd:ParameterBinding source="resources/masses.ssv" prefix="left."/>
</ssd:ParameterBindings>
<ssd:Elements>
<ssd:Component name="left" source="resources/MassSpringSubSystem1.fmu">
<ssd:Connectors>
<ssd:Connector name="x2" kind="input"><ssc:Real/></ssd:Connector>
<ssd:Connector name="x1" kind="output"><ssc:Real/></ssd:Connector>
</ssd:Connectors>
</ssd:Component>
<ssd:Component name="right" source="resources/MassSpringSubSystem2.fmu">
<ssd:Connectors>
<ssd:Connector name="x1" kind="input"><ssc:Real/></ssd:Connector>
<ssd:Connector name="x2" kind="output"><ssc:Real/></ssd:Connector>
</ssd:Connectors>
<ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues>
<ssv:ParameterSet version="1.0" name="right"><ssv:Parameters>
<ssv:Parameter name="m2"><ssv:Real value="2"/></ssv:Parameter>
</ssv:Parameters></ssv:ParameterSet>
</ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>
</ssd:Component>
</ssd:Elements>
<ssd:Connections>
<ssd:Connection startElement="left" startConnector="x1" endElement="right" endConnector="x1">
<ssc:LinearTransformation factor="0.5" offset="0.25"/></ssd:Connection>
<ssd:Connection startElement="right" startConnector="x2" endElement="left" endConnector="x2"/>
</ssd:Connections>
</ssd:System>
<ssd:DefaultExperiment startTime="0" stopTime="2"/>
</ssd:SystemStructureDescription>
"""
)
VALUES = """<?xml version="1.0" encoding="UTF-8"?>
<ssv:ParameterSet version="1.0" name="left" xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues">
<ssv:Parameters>
<ssv:Parameter name="k1"><ssv:Real value="3"/></ssv:Parameter>
<ssv:Parameter name="m1"><ssv:Real value="0.5"/></ssv:Parameter>
</ssv:Parameters>
</ssv:ParameterSet>
"""


@pytest.fixture(scope="module")
def masses(tmp_path_factory) -> dict[str, bytes]:
    """Content of an SSP of two FMUs of OpenModelica: a mass between springs each, coupled by position."""
    entries = {"SystemStructure.ssd": MASSES.encode(), "resources/masses.ssv": VALUES.encode()}
    with zipfile.ZipFile(wheel(tmp_path_factory)) as archive:
        for name in archive.namelist():
            if "linux/MassSpringSubSystem" in name:
                entries[f"resources/{Path(name).name}"] = archive.read(name)
    assert len(entries) == 4
    return entries


def pack(path: Path, entries: dict[str, bytes]) -> Path:
    with zipfile.ZipFile(path, "w") as package:
        for name, data in entries.items():
            package.writestr(name, data)
    return path


def exact_masses(times: numpy.ndarray) -> numpy.ndarray:
    """Positions by small Runge-Kutta steps: m1 a1 = -k1 x1 + k2 (x2 - x1), m2 a2 = -k3 x2 + k2 (u - x2)."""

    def slope(s):
        (v1, x1, v2, x2), u = s, 0.5 * s[1] + 0.25
        return numpy.array([(-3 * x1 + (x2 - x1)) / 0.5, v1, (-x2 + (u - x2)) / 2, v2])

    step = 1e-3
    state, last, rows = None, 0.0, []
    for time in times:
        if state is None:
            state = numpy.array([1.0, 0.0, 0.0, 1.0])
        else:
            for _ in range(round((time - last) / step)):
                k1 = slope(state)
                k2 = slope(state + step / 2 * k1)
                k3 = slope(state + step / 2 * k2)
                k4 = slope(state + step * k3)
                state = state + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        last = time
        rows.append([state[1], state[3]])
    return numpy.array(rows)


def test_our_host_runs_anothers(flexarm, tmp_path, masses):
    """Linear transformation and parameter bindings of both kinds, against the equations of motion."""
    path = pack(tmp_path / "masses.ssp", masses)
    errors = []
    for step in (0.004, 0.002):
        run(flexarm, "simulate", path, "--step", step, "-o", tmp_path / "out")
        found = columns(tmp_path / "out" / "results.csv")
        exact = exact_masses(found["time"])
        positions = numpy.array([found["left.x1"], found["right.x2"]]).T
        errors.append(abs(positions - exact).max())
    print(f"largest errors {errors}")
    # Positions hold for a communication step, and the FMUs make one Euler step of it: first order.
    assert errors[0] < 0.016 and 1.9 < errors[0] / errors[1] < 2.1
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert [name for name, _ in summary["components"]] == ["left", "right"]
    assert "left.x1" in (tmp_path / "out" / "plot.svg").read_text()


def test_fmpy_agrees_on_anothers(flexarm, tmp_path, masses):
    """Without what FMPy ignores: inline bindings, transformations."""
    plain = MASSES.replace('<ssc:LinearTransformation factor="0.5" offset="0.25"/>', "")
    start, end = (
        plain.index("<ssd:ParameterBindings><ssd:ParameterBinding><ssd:P"),
        plain.rindex("</ssd:ParameterBindings>"),
    )
    plain = plain[:start] + plain[end + len("</ssd:ParameterBindings>") :]
    start, end = plain.index("<ssd:ParameterBindings>"), plain.index("</ssd:ParameterBindings>")
    plain = plain[:start] + plain[end + len("</ssd:ParameterBindings>") :]
    path = pack(tmp_path / "plain.ssp", masses | {"SystemStructure.ssd": plain.encode()})
    theirs = simulate_ssp(str(path), stop_time=2, step_size=0.001)
    run(flexarm, "simulate", path, "--step", 0.001, "--order", "side-by-side", "-o", tmp_path / "out")
    ours = columns(tmp_path / "out" / "results.csv")
    for name in ("left.x1", "right.x2"):
        # FMPy feeds the first step with zeros: 7.2e-4 is measured.
        difference = abs(theirs[name][: len(ours["time"]) - 1] - ours[name][1:]).max()
        print(f"{name}: {difference:.1e}")
        assert difference < 8e-4


BAD = {
    "missing FMU": (
        None,
        None,
        "SystemStructure.ssd:16: source `resources/MassSpringSubSystem2.fmu` is not in",
    ),
    "dangling connection": (
        'endElement="right" endConnector="x1"',
        'endElement="right" endConnector="x9"',
        "SystemStructure.ssd:29: connection: element right has no connector x9",
    ),
    "duplicate connector": (
        '<ssd:Connector name="x2" kind="input"><ssc:Real/></ssd:Connector>\n',
        '<ssd:Connector name="x2" kind="input"><ssc:Real/></ssd:Connector>\n' * 2,
        "Connector x2: `left` has this connector already",
    ),
    "unknown element": ('endElement="left"', 'endElement="middle"', "the system has no element middle"),
    "wrong type": ('kind="output"><ssc:Real/>', 'kind="output"><ssc:String/>', "its type is String"),
    "path out of it": (
        "resources/masses.ssv",
        "../masses.ssv",
        "source `../masses.ssv` leads out of the package",
    ),
    "unknown tag": (
        "<ssd:Connections>",
        "<ssd:Wires/><ssd:Connections>",
        "unknown element `Wires` in `System`",
    ),
    "value that is none": (
        'value="3"',
        'value="stiff"',
        "masses.ssv:4: parameter k1: value `stiff` is not of type Real",
    ),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_ones_are_refused_by_line(flexarm, tmp_path, masses, case):
    old, new, message = BAD[case]
    entries = dict(masses)
    if new is None:
        del entries["resources/MassSpringSubSystem2.fmu"]
    else:
        for name in ("SystemStructure.ssd", "resources/masses.ssv"):
            entries[name] = entries[name].replace(old.encode(), new.encode(), 1)
        assert entries != masses
    done = run(flexarm, "simulate", pack(tmp_path / "bad.ssp", entries), "-o", tmp_path / "out", code=2)
    assert message in done.stderr and "bad.ssp/" in done.stderr, done.stderr
    assert not (tmp_path / "out").exists() and not done.stdout


def test_an_algebraic_loop_is_refused(flexarm, tmp_path):
    """Two controllers that each take the other's torque for an angle."""
    ends = [("a", "b"), ("b", "a")]
    connectors = "".join(
        f'<ssd:Connector name="{n}" kind="{k}"/>' for n, k in (("angle", "input"), ("torque", "output"))
    )
    structure = HEAD + '<ssd:System name="loop">\n<ssd:Elements>\n'
    for name in "ab":
        structure += f'<ssd:Component name="{name}" source="resources/c.fmu"><ssd:Connectors>{connectors}'
        structure += "</ssd:Connectors></ssd:Component>\n"
    structure += "</ssd:Elements>\n<ssd:Connections>\n"
    for start, end in ends:
        structure += f'<ssd:Connection startElement="{start}" startConnector="torque" endElement="{end}" '
        structure += 'endConnector="angle" suppressUnitConversion="true"/>\n'
    structure += "</ssd:Connections>\n</ssd:System>\n</ssd:SystemStructureDescription>\n"
    controller = fmu("fmi3", "FlexArmController").read_bytes()
    path = pack(
        tmp_path / "loop.ssp", {"SystemStructure.ssd": structure.encode(), "resources/c.fmu": controller}
    )
    done = run(flexarm, "simulate", path, code=2)
    assert "loop.ssp/SystemStructure.ssd:" in done.stderr and "algebraic loop" in done.stderr
    assert "a.torque feeds b.angle" in done.stderr and "b.torque feeds a.angle" in done.stderr
    run(flexarm, "simulate", path, "--order", "side-by-side", "--until", 0.01)
