"""The reference numbers through the `flexarm` host, both FMI versions and both stepping orders."""

import csv
import itertools
import json
import math
import os
import subprocess
import threading
from pathlib import Path

import pytest

from conftest import DIST, fmu, golden, run
from test_disturbance import GOLDEN as TABLE_3
from test_disturbance import settings

PENDULUM = DIST / "parameters" / "pendulum.ssv"
MODEL_ERROR = DIST / "parameters" / "pendulum-model-error.ssv"
SEQUENCES = [(arm, i) for arm in ("pendulum", "tflex") for i in range(8)]


def simulate(flexarm: Path, out: Path, version: str, *arguments) -> dict:
    """Run the host; returns its summary."""
    command = [
        flexarm,
        "simulate",
        "--controller",
        fmu(version, "FlexArmController"),
        "--plant",
        fmu(version, "FlexArmPlant"),
        "-o",
        out,
        *arguments,
    ]
    run = subprocess.run([str(c) for c in command], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    assert (out / "report.html").stat().st_size > 100_000
    return json.loads((out / "summary.json").read_text())


def sets(values: dict) -> list[str]:
    return list(itertools.chain.from_iterable(("--set", f"{k}={v}") for k, v in values.items()))


def schedule(path: Path, columns: list[str], rows: list) -> Path:
    with path.open("w", newline="") as file:
        csv.writer(file).writerows([columns, *rows])
    return path


def pendulum() -> list:
    return ["--parameters", PENDULUM, "--parameters", f"controller={MODEL_ERROR}"]


@pytest.mark.parametrize("order", ["sequential", "side-by-side"])
@pytest.mark.parametrize("case", TABLE_3)
def test_table_3(flexarm, tmp_path, version, order, case):
    pushes = [(0, 1, 0), (5, 1, 30), (5.25, 1, 0), (12, 1, 27), (20, 1, 0)]
    file = schedule(tmp_path / "setpoints.csv", ["time", "setpoint", "disturbance_torque"], pushes)
    arguments = ["--setpoints", file, "--until", 25, "--order", order, *pendulum(), *sets(settings(case))]
    summary = simulate(flexarm, tmp_path / "out", version, *arguments)
    error = summary["score"]["squared_error_rad2"]
    print(f"\n{version}, {order}, {case}: {error:.1f}, independent {TABLE_3[case]:.1f}")
    assert error == pytest.approx(TABLE_3[case], rel=0.01)


def track(flexarm, tmp_path, arm: str, index: int, version: str, *arguments) -> tuple[dict, dict]:
    run = golden(f"setpoint_tracking_{arm}")["runs"][index]
    interval, setpoints = run["interval_s"], run["setpoints_rad"]
    rows = [(k * interval, repr(goal)) for k, goal in enumerate(setpoints)]
    file = schedule(tmp_path / "setpoints.csv", ["time", "setpoint"], rows)
    until = interval * len(setpoints)
    chosen = pendulum() if arm == "pendulum" else []
    summary = simulate(
        flexarm, tmp_path / "out", version, "--setpoints", file, "--until", until, *chosen, *arguments
    )
    return run, summary


@pytest.mark.parametrize(("arm", "index"), SEQUENCES)
def test_planner_tracks_setpoints(flexarm, tmp_path, arm, index):
    run, summary = track(flexarm, tmp_path, arm, index, "fmi3" if index % 2 else "fmi2")
    tolerance = 0.02 if run["nmpc"]["solves_that_needed_thermal_slack"] else 0.01
    assert summary["score"]["violations"] == 0
    assert summary["score"]["squared_error_rad2"] == pytest.approx(run["nmpc"]["cost"], rel=tolerance)


@pytest.mark.parametrize("index", range(8))
def test_profile_tracks_setpoints(flexarm, tmp_path, index):
    arguments = sets({"reference.source": "profile", "feedback.law": "pid"})
    run, summary = track(flexarm, tmp_path, "pendulum", index, "fmi3", *arguments)
    (profile,) = run["profile"].values()
    assert summary["score"]["squared_error_rad2"] == pytest.approx(profile["cost"], rel=0.01)


def test_a_parameter_file_may_be_a_pipe(flexarm, tmp_path):
    """As `--parameters <(...)` in a shell: it can be read once."""
    text, pipe = (DIST / "parameters" / "pendulum.ssv").read_text(), tmp_path / "pipe.ssv"
    os.mkfifo(pipe)
    writer = threading.Thread(target=pipe.write_text, args=[text], daemon=True)
    writer.start()
    pair = ["--controller", fmu("fmi3", "FlexArmController"), "--plant", fmu("fmi3", "FlexArmPlant")]
    words = [flexarm, "simulate", *pair, "--parameters", pipe, "--until", 0.01, "-o", tmp_path / "out"]
    # Read twice, it would wait for ever.
    run(*words, timeout=60)
    header, first = (tmp_path / "out" / "results.csv").read_text().splitlines()[:2]
    angle = dict(zip(header.split(","), first.split(","), strict=True))["plant.angle"]
    assert float(angle) == pytest.approx(math.pi / 4), "that of the pendulum"
