"""The linear model, plans into safe sets, and the moving mass of sec 2.4.2, by the packages' parameters."""

import pytest

from fmus import SAMPLE, Loop, hot_pendulum

SOLVED = 1
NO_ARM = {name: 0.0 for name in ("damping", "stiffness", "offset", "hysteresis", "cogging_frequency")} | {
    f"cogging_{kind}[{i}]": 0.0 for kind in ("cos", "sin") for i in range(1, 10)
}
MASS = {f"arm.{name}": value for name, value in NO_ARM.items()} | {
    "arm.inertia": 1.0,
    "motor.peak_torque": 1.0,
    "limits.angle_lower": 0.0,
    "limits.angle_upper": 2.0,
    "initial.angle": 1.0,
    "nmpc.model": "qp",
    "nmpc.solver": "clarabel",
    "nmpc.period": 0.1,
    "nmpc.horizon": 5,
    "nmpc.weight_velocity": 0.0,
    "nmpc.weight_thermal": 0.0,
    "nmpc.angle_margin": 0.0,
    "nmpc.thermal_limit": "false",
    "feedback.inertia": 1.0,
    "feedback.damping": 0.0,
    "feedback.lowpass_frequency": 0.0,
}


def run(version: str, seconds: float, *sets: dict, setpoint: float, controller: dict) -> dict:
    """From rest towards one setpoint: what there is to see."""
    seen = {"status": set(), "angle": [], "thermal": 0.0, "convex_problems": 0, "violations": 0}
    with Loop(version, *sets, controller=controller) as loop:
        loop.initialize(setpoint=setpoint)
        for k in range(round(seconds / SAMPLE)):
            loop.sequential(k * SAMPLE)
            seen["status"].add(loop.controller.get("nmpc.status"))
            seen["convex_problems"] = max(
                seen["convex_problems"], loop.controller.get("nmpc.convex_problems")
            )
            seen["angle"].append(loop.plant.get("angle"))
            seen["thermal"] = max(seen["thermal"], loop.plant.get("thermal_fraction"))
        seen["violations"] = loop.plant.get("violations")
    return seen


def test_the_moving_mass_needs_a_safe_set(version):
    safe = run(version, 4.0, MASS, setpoint=0.01, controller={"nmpc.terminal": "safe_set"})
    assert safe["status"] == {SOLVED} and safe["violations"] == 0
    assert min(safe["angle"]) >= 0 and abs(safe["angle"][-1] - 0.01) < 1e-4
    free = run(version, 4.0, MASS, setpoint=0.01, controller={"nmpc.terminal": "free"})
    assert min(free["angle"]) < -0.05 and free["violations"] > 0
    assert free["status"] > {SOLVED}, "the planner says so"


def test_short_horizons_end_in_a_safe_set(version):
    short = {"nmpc.horizon": 5, "nmpc.solver": "automatic"}
    safe = run(version, 3.0, hot_pendulum(), setpoint=1.2, controller=short | {"nmpc.terminal": "safe_set"})
    assert safe["status"] == {SOLVED} and safe["convex_problems"] > 0 and safe["violations"] == 0
    assert abs(safe["angle"][-1] - 1.2) < 1e-2
    rest = run(version, 0.2, hot_pendulum(), setpoint=1.2, controller=short)
    assert rest["status"] - {SOLVED}, "no plan ends at rest in 0.25 s"


def test_the_linear_model_is_one_quadratic_programme(version):
    linear = {"nmpc.model": "qp", "nmpc.solver": "automatic"}
    seen = run(version, 3.0, hot_pendulum(), setpoint=1.2, controller=linear)
    assert seen["status"] == {SOLVED} and seen["convex_problems"] == 1 and seen["violations"] == 0
    assert seen["thermal"] < 0.73, "the share of the plan, 0.85 squared, and what the feedback adds"
    assert abs(seen["angle"][-1] - 1.2) < 1e-2


@pytest.mark.parametrize(
    "other", [{"nmpc.model": "qp"}, {"nmpc.terminal": "safe_set"}, {"nmpc.terminal": "free"}]
)
def test_what_riccati_cannot_solve_is_refused(version, other):
    with Loop(version, controller=other) as loop, pytest.raises(Exception, match=r"[Ee]rror|status"):
        loop.initialize(setpoint=1.3)
