"""The problem in CasADi's expressions, for all peers.

The state e is left out: its weight is zero for both arms, and nothing else sees it.
"""

import casadi as ca
from model import rk4

# States of the peers, (θ, ω, θr, ωr, T), and their places among the six of eq 23.
STATES = (0, 1, 2, 3, 5)
NX = len(STATES)
REFERENCE_ANGLE, THERMAL_LOAD = 2, 4


def reduced(state):
    """The peers' states of the six."""
    return [state[i] for i in STATES]


def discrete(problem):
    """x, u, p = (goal, cost scale), the next x and the cost of one move over the scale, as expressions."""
    if problem.weight_integral != 0.0:
        raise ValueError("e has a weight: the peers' model must know it")
    x, u, p = ca.SX.sym("x", NX), ca.SX.sym("u"), ca.SX.sym("p", 2)
    full = [x[0], x[1], x[2], x[3], ca.SX(0.0), x[4]]
    after, cost = rk4(problem, full, u, p[0], ca.cos, ca.sin)
    return x, u, p, ca.vertcat(*reduced(after)), cost / p[1]


def first_guess(problem, initial, goal):
    """States and moves of a straight line to the goal at rest, the load as it is."""
    horizon = problem.horizon
    start = reduced(initial)
    end = [goal, 0.0, goal, 0.0, start[THERMAL_LOAD]]
    states = [start]
    for k in range(1, horizon + 1):
        share = min(1.0, k / (0.25 * horizon))
        states.append([a + share * (b - a) for a, b in zip(start, end, strict=True)])
    return states, [0.0] * horizon
