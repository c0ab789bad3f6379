"""Reference results inside the FMUs (FMI-LS-REF): FMPy sets the stored inputs, gets the stored outputs."""

import hashlib
import zipfile

import numpy as np
import pytest
from fmpy import simulate_fmu
from lxml import etree

from conftest import UNITS, fmu

FOLDER = "extra/org.fmi-standard.fmi-ls-ref/"
# Of the largest value of each output. The files are made with the baseline instructions, the run here with
# the processor's best.
TOLERANCE = 1e-9


@pytest.fixture(params=UNITS)
def unit(request) -> str:
    return request.param


def related(package: zipfile.ZipFile) -> dict[str, str]:
    """Names of the files by their roles; the manifest must be what the layered standard's schema asks for."""
    manifest = etree.fromstring(package.read(f"{FOLDER}fmi-ls-manifest.xml"))
    assert manifest.tag == "fmiReferences"
    namespace = "{http://fmi-standard.org/fmi-ls-manifest}"
    assert manifest.get(f"{namespace}fmi-ls-name") == "org.fmi-standard.fmi-ls-ref"
    assert manifest.get(f"{namespace}fmi-ls-version") == "1.0.0-alpha.1"
    assert (
        manifest.get(f"{namespace}fmi-ls-description")
        == "Layered Standard providing information on related files included in an FMU."
    )
    assert {child.tag for child in manifest} == {"Related"}
    return {child.get("role"): child.get("source") for child in manifest}


def read(package: zipfile.ZipFile, name: str) -> np.ndarray:
    lines = package.read(FOLDER + name).decode().splitlines()
    return np.genfromtxt(lines, delimiter=",", names=True, deletechars="")


def test_stored_inputs_give_stored_outputs(version, unit):
    with zipfile.ZipFile(fmu(version, unit)) as package:
        files = related(package)
        assert set(files) == {"testcase", "result"}
        inputs, outputs = read(package, files["testcase"]), read(package, files["result"])
    names = [name for name in outputs.dtype.names if name != "time"]
    step = 0.00025
    result = simulate_fmu(
        str(fmu(version, unit)),
        fmi_type="CoSimulation",
        stop_time=float(outputs["time"][-1]),
        step_size=step,
        output_interval=step,
        input=inputs,
        output=names,
    )
    result = result[20::20]
    assert len(result) == len(outputs) == 49
    assert np.allclose(result["time"], outputs["time"], rtol=0, atol=1e-12)
    for name in names:
        expected, found = outputs[name], result[name]
        largest = np.abs(expected).max()
        difference = np.abs(found - expected).max()
        print(f"{version} {unit} {name}: {difference / largest:.1e} of {largest:.3g}")
        assert largest > 0, f"{name} does not move"
        assert difference <= TOLERANCE * largest, name


def test_both_versions_carry_the_same_and_little(unit):
    digests = []
    for version in ("fmi2", "fmi3"):
        with zipfile.ZipFile(fmu(version, unit)) as package:
            infos = [info for info in package.infolist() if info.filename.startswith(FOLDER)]
            assert sum(info.compress_size for info in infos) < 40_000
            digests.append({info.filename: hashlib.sha256(package.read(info)).hexdigest() for info in infos})
    assert digests[0] == digests[1]
    assert len(digests[0]) == 3
