"""Who solves a plan, and with which instructions, is a parameter; the motion is the same."""

from fmus import SAMPLE, Loop, hot_pendulum

CHOICES = {
    "default": {},
    "automatic": {"nmpc.solver": "automatic"},
    "baseline": {"nmpc.instruction_set": "baseline"},
    "clarabel": {"nmpc.solver": "clarabel"},
}
SOLVED = 1


def move(version: str, choice: str) -> tuple[list[float], int, int]:
    """Half a second towards 1.2 rad: angles at 20 Hz, most iterations, convex problems in all."""
    angles, iterations, convex_problems = [], 0, 0
    with Loop(version, hot_pendulum(), controller=CHOICES[choice]) as loop:
        loop.initialize(setpoint=1.2)
        for k in range(2000):
            loop.sequential(k * SAMPLE)
            if k % 200 == 0:
                angles.append(loop.plant.get("angle"))
                assert loop.controller.get("nmpc.status") == SOLVED
                iterations = max(iterations, loop.controller.get("nmpc.iterations"))
                convex_problems += loop.controller.get("nmpc.convex_problems")
    return angles, iterations, convex_problems


def test_every_solver_moves_the_arm_alike(version):
    runs = {choice: move(version, choice) for choice in CHOICES}
    for choice, (angles, iterations, convex_problems) in runs.items():
        assert iterations > 0, f"{choice}: the limit must bind for this test to say anything"
        assert (convex_problems > 0) == (choice == "clarabel")
        off = max(abs(a - b) for a, b in zip(angles, runs["clarabel"][0], strict=True))
        assert off <= 1e-4, f"{choice} is {off} rad off"
