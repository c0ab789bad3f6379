"""When plans are made, how long they may take, when they apply, with which instructions: in the packages."""

import itertools
import math

import pytest

from fmus import SAMPLE, Loop, hot_pendulum

SOLVED, THERMAL_SLACK, ITERATION_LIMIT, SHIFTED, REST, DEADLINE = 1, 3, 4, 5, 6, 9
SEPARATE, FUSED = 1, 2


def swing(version: str, seconds: float, *sets: dict, controller: dict) -> dict:
    """From rest at 1.30 rad, or pi/4 for a pendulum, 0.2 rad up: what there is to see."""
    seen = {"status": set(), "angle": [], "iterations": 0, "time": 0.0, "plans": 0}
    with Loop(version, *sets, controller=controller) as loop:
        start = math.pi / 4 if sets else 1.30
        loop.plant.set("initial.angle", start)
        loop.initialize(setpoint=start + 0.2)
        seen["instructions"] = loop.controller.get("nmpc.instructions")
        for k in range(round(seconds / SAMPLE)):
            loop.sequential(k * SAMPLE)
            seen["status"].add(loop.controller.get("nmpc.status"))
            seen["iterations"] = max(seen["iterations"], loop.controller.get("nmpc.iterations"))
            seen["time"] = max(seen["time"], loop.controller.get("nmpc.solve_time"))
            seen["angle"].append(loop.plant.get("angle"))
        seen["plan"] = {name: loop.controller.get_array(f"nmpc.plan.{name}") for name in ("time", "angle")}
        seen["left"] = abs(seen["angle"][-1] - start - 0.2)
    return seen


def test_the_planner_runs_at_the_rate_of_the_feedback(version):
    fast = {"nmpc.period": SAMPLE, "nmpc.duration": 2.0}
    seen = swing(version, 1.0, controller=fast)
    assert seen["status"] == {SOLVED}
    assert seen["left"] < 1e-3
    time = seen["plan"]["time"]
    steps = [b - a for a, b in itertools.pairwise(time)]
    assert time[0] == 0 and abs(time[40] - 2.0) < 1e-9
    assert abs(steps[0] - SAMPLE) < 1e-12
    assert all(a <= b * (1 + 1e-9) and b <= 1.5 * a * (1 + 1e-9) for a, b in itertools.pairwise(steps))
    slow = swing(version, 1.0, controller={})
    cost = [sum((1.5 - angle) ** 2 for angle in run["angle"]) for run in (seen, slow)]
    assert cost[0] < cost[1]


def test_a_late_plan_needs_the_state_at_its_time(version):
    late = {"nmpc.latency": 0.05}
    predicted = swing(version, 4.0, controller=late)
    ignored = swing(version, 4.0, controller=late | {"nmpc.models_latency": "false"})
    assert predicted["left"] < 1e-3, "stable"
    assert ignored["left"] > 1e-2, "unstable, as the docs say"
    assert abs(predicted["plan"]["time"][0] - 0.05) < 1e-12


@pytest.mark.parametrize("deadline", [1e-6, 1e-4, 10.0])
def test_a_deadline_leaves_a_plan_that_moves_on(version, deadline):
    settings = {"nmpc.deadline": deadline, "nmpc.reports_time": "true"}
    seen = swing(version, 2.0, hot_pendulum(), controller=settings)
    # No claim about time, which the machine's load decides: about what becomes of the plans.
    assert seen["status"] <= {SOLVED, THERMAL_SLACK, ITERATION_LIMIT, SHIFTED, REST, DEADLINE}
    assert seen["time"] > 0
    if deadline == 1e-6:
        assert seen["iterations"] <= 1, "no time for more than the first, whose length is not known yet"
        assert seen["status"] & {SHIFTED, REST, DEADLINE}
    if deadline == 10.0:
        assert seen["status"] == {SOLVED} and seen["left"] < 1e-2
    assert all(math.isfinite(angle) for angle in seen["angle"])


def test_the_time_of_a_solve_is_told_only_when_asked_for(version):
    assert swing(version, 0.1, controller={})["time"] == 0


def test_both_instruction_sets_give_one_motion(version):
    runs = {
        name: swing(version, 1.0, hot_pendulum(), controller={"nmpc.instruction_set": name})
        for name in ("automatic", "baseline")
    }
    assert runs["baseline"]["instructions"] == SEPARATE
    assert runs["automatic"]["instructions"] in (SEPARATE, FUSED)
    assert runs["baseline"]["iterations"] > 0, "the limit must bind for this test to say anything"
    both = zip(runs["automatic"]["angle"], runs["baseline"]["angle"], strict=True)
    off = max(abs(a - b) for a, b in both)
    print(f"{version}: instructions {runs['automatic']['instructions']} and baseline are {off:.1e} rad apart")
    assert off < 1e-5
