"""The paper's experiments from the packaged FMUs, as `cargo xtask reproduce` runs them."""

import json
import subprocess
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from conftest import ROOT, fmu

# The one on identified parameters takes those that `cargo xtask reproduce` finds: the last test has its own.
FILES = sorted(p for p in (ROOT / "experiments").glob("*.toml") if p.stem != "identification")


def run(flexarm: Path, *arguments) -> subprocess.CompletedProcess:
    command = [str(argument) for argument in (flexarm, "run", *arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def paper(flexarm, tmp_path_factory) -> Path:
    """The folder of a run of all experiments."""
    out = tmp_path_factory.mktemp("paper")
    done = run(flexarm, *FILES, "-o", out, "--title", "All of <them>")
    assert done.returncode == 0, done.stdout + done.stderr
    return out


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_figures_are_as_expected(paper, file):
    experiment = json.loads((paper / file.stem / "experiment.json").read_text())
    assert all(run["error"] is None for run in experiment["runs"])
    judged = [row for row in experiment["table"] if row["met"] is not None]
    assert judged, "nothing is expected"
    for row in judged:
        print(f"{row['name']}: {row['ours']} ({row['admissible']})")
        assert row["met"], row
    for run_ in experiment["runs"]:
        folder = paper / file.stem / run_["folder"]
        header = (folder / "results.csv").open().readline()
        assert header.startswith("time,setpoint,")
        assert json.loads((folder / "summary.json").read_text()) == run_["summary"]


def test_every_figure_is_an_image_and_on_the_page(paper):
    page = (paper / "index.html").read_text()
    assert "<h1>All of &lt;them&gt;</h1>" in page and "all met" in page
    figures = sorted((paper / "figures").glob("*/*.svg"))
    assert len(figures) >= 14
    for figure in figures:
        root = ET.parse(figure).getroot()
        curves = [e for e in root.iter() if e.tag.rpartition("}")[2] in ("polyline", "circle")]
        assert len(curves) > 2, figure.name
        assert f'<img src="figures/{figure.parent.name}/{figure.name}"' in page


def absolute(name: str) -> str:
    """An experiment with paths that hold anywhere."""
    text = (ROOT / "experiments" / f"{name}.toml").read_text()
    return text.replace("../dist/", f"{ROOT}/dist/").replace("../packaging/", f"{ROOT}/packaging/")


def test_one_thing_changed_is_another_result(flexarm, tmp_path, paper):
    """What the files are for: the arm a tenth heavier in table 3."""
    text = absolute("disturbance")
    changed = text.replace("[common.set]", '[common.set]\n"plant:arm.inertia" = 1.1')
    assert changed != text
    file = tmp_path / "disturbance.toml"
    file.write_text(changed)
    done = run(flexarm, file, "-o", tmp_path / "out")
    assert done.returncode in (0, 3), done.stderr
    ours = json.loads((tmp_path / "out" / "disturbance" / "experiment.json").read_text())
    paper_ = json.loads((paper / "disturbance" / "experiment.json").read_text())
    pairs = zip(ours["table"], paper_["table"], strict=True)
    assert all(abs(a["ours"] / b["ours"] - 1) > 1e-3 for a, b in pairs)


def test_the_controller_performs_with_identified_parameters(flexarm, tmp_path):
    pair = ["--controller", fmu("fmi3", "FlexArmController"), "--plant", fmu("fmi3", "FlexArmPlant")]
    command = [flexarm, "identify", *pair, "--set", "plant:noise.current=3e-4", "-o", tmp_path]
    subprocess.run([str(part) for part in command], check=True, capture_output=True)
    text = absolute("identification")
    text = text.replace(f"{ROOT}/dist/paper/identification/", f"{tmp_path}/")
    file = tmp_path / "identification.toml"
    file.write_text(text)
    done = run(flexarm, file)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count("met:") == 2
