"""Table 3 of the paper from the packaged FMUs, coupled by FMPy: how feedback and planner share an integrator.

At rest at 1 rad, pushed by 30 N·m for 0.25 s and by 27 N·m for 8 s; the controller's model is wrong
by 8 % in stiffness and 3 % in inertia (eq 32); the thermal limit is ignored. The cost is the squared
error summed over 4 kHz samples.
"""

import pytest

from conftest import golden
from fmus import SAMPLE, Loop, parameters

GOLDEN = golden("disturbance")["independent_python_simulation"]
EQ_36 = {
    "initial.angle": 1,
    "nmpc.thermal_limit": "false",
    "nmpc.weight_velocity": 1e-3,
    "nmpc.weight_acceleration": 1e-3,
    "feedback.weight_velocity": 1e-3,
    "feedback.weight_torque": 1e-3,
    "feedback.weight_integral": 10,
}
FEEDBACK = {
    "LQR": {"feedback.law": "lqr"},
    "LQRI": {"feedback.law": "lqri"},
    "LQRII": {"feedback.law": "lqri", "nmpc.models_integrator": "true"},
}
PLANNER = {"MPC": {"nmpc.weight_integral": 0}, "MPCI": {"nmpc.weight_integral": 10}}


def settings(case: str) -> dict:
    feedback, planner = case.split("/")
    return EQ_36 | FEEDBACK[feedback] | PLANNER[planner]


def disturbance(time: float) -> float:
    if 5 <= time < 5.25:
        return 30.0
    return 27.0 if 12 <= time < 20 else 0.0


@pytest.mark.parametrize("order", ["sequential", "side_by_side"])
@pytest.mark.parametrize("case", GOLDEN)
def test_cost_through_fmpy(version, case, order):
    with Loop(
        version, parameters("pendulum"), settings(case), controller=parameters("pendulum-model-error")
    ) as loop:
        loop.initialize(setpoint=1.0)
        cost = 0.0
        for k in range(100_000):
            cost += (1.0 - loop.plant.get("angle")) ** 2
            loop.plant.set("disturbance_torque", disturbance(k * SAMPLE))
            getattr(loop, order)(k * SAMPLE)
    assert cost == pytest.approx(GOLDEN[case], rel=0.01)
