"""The problem in CasADi's expressions, for all peers, and as small as it gets.

The tracking error (θ-θr, ω-ωr) obeys a linear equation of its own, whatever the moves are: both rows of eq 22
get the same u. It is known as soon as the start is, so it enters as parameters of each stage. The state e has
no weight in either arm. What is left are the states (θr, ωr, T); our solvers make the same exact reduction.
"""

from dataclasses import dataclass

import casadi as ca
from model import derivative, loss

# States of the peers, (θr, ωr, T), and their places among the six of eq 23.
STATES = (2, 3, 5)
NX = len(STATES)
REFERENCE_ANGLE, REFERENCE_VELOCITY, THERMAL_LOAD = 0, 1, 2
# Parameters of a stage: goal, cost scale, and (θ-θr, ω-ωr) at the four RK4 stages.
NP = 10
ELAPSED = (0.0, 0.5, 0.5, 1.0)
QUADRATURE = (1 / 6, 1 / 3, 1 / 3, 1 / 6)


def reduced(state):
    """The peers' states of the six."""
    return [state[i] for i in STATES]


def discrete(problem):
    """x, u, p, the next x and the cost of one move over the scale, as expressions (eqs 24, 28)."""
    if problem.weight_integral != 0.0 or problem.growth != 1.0:
        raise ValueError("the peers' model knows neither a weight on e nor growing intervals")
    h = problem.period
    x, u, p = ca.SX.sym("x", NX), ca.SX.sym("u"), ca.SX.sym("p", NP)
    after, slope, cost = x, ca.SX.zeros(NX), 0.0
    for j, (elapsed, weight) in enumerate(zip(ELAPSED, QUADRATURE, strict=True)):
        angle, velocity, load = ca.vertsplit(x + elapsed * h * slope)
        full = [angle + p[2 + 2 * j], velocity + p[3 + 2 * j], angle, velocity, ca.SX(0.0), load]
        slope = ca.vertcat(*reduced(derivative(problem, full, u, p[0], ca.cos, ca.sin)))
        after += weight * h * slope
        cost += weight * h * loss(problem, full, u, p[0])
    return x, u, p, after, cost / p[1]


@dataclass
class Task:
    """An instance in the peers' terms."""

    start: list
    # (θr, ωr) that put the arm to rest at the goal (eq 27).
    end: list
    # Parameters of each stage [N][NP].
    stages: list


def task(problem, instance):
    """The tracking error followed through RK4 (eq 24)."""
    h = problem.period
    goal, x = instance.goal, instance.initial
    error = [x[0] - x[2], x[1] - x[3]]
    stages = []
    for _ in range(problem.horizon):
        parameters = [goal, instance.cost_scale]
        slope, after = [0.0, 0.0], list(error)
        for elapsed, weight in zip(ELAPSED, QUADRATURE, strict=True):
            angle, velocity = (e + elapsed * h * s for e, s in zip(error, slope, strict=True))
            parameters += [angle, velocity]
            feedback = -problem.gain_angle * angle - problem.gain_velocity * velocity
            slope = [velocity, feedback / problem.feedback_inertia]
            after = [a + weight * h * s for a, s in zip(after, slope, strict=True)]
        error = after
        stages.append(parameters)
    return Task(reduced(x), [goal - error[0], -error[1]], stages)


def first_guess(problem, task):
    """States and moves of a straight line to the end, the load as it is."""
    horizon = problem.horizon
    end = [*task.end, task.start[THERMAL_LOAD]]
    states = [task.start]
    for k in range(1, horizon + 1):
        share = min(1.0, k / (0.25 * horizon))
        states.append([a + share * (b - a) for a, b in zip(task.start, end, strict=True)])
    return states, [0.0] * horizon
