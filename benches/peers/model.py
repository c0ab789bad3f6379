"""The optimal control problem in numbers, and the check that every solver's moves must pass.

States (θ, ω, θr, ωr, e, T), eq 22, one RK4 step of 50 ms per move, eq 24, cost eq 28. `derivative` and
`rk4` take numbers and CasADi expressions alike, so that the check and the peers share one model.
"""

import math
from dataclasses import dataclass
from types import SimpleNamespace

# What counts as kept: thermal limit [A²], angle bounds and rest at the goal [rad, rad/s].
THERMAL_TOLERANCE = 1e-6
ANGLE_TOLERANCE = 1e-6
# Objective above the optimum that counts as solved, relative. Where excess is priced, what is left of it is
# multiplied by its price.
COST_TOLERANCE = 1e-5
MERIT_TOLERANCE = 1e-4
# Price of thermal excess, in units of the inequality-free optimum's cost [1/A²].
EXCESS_WEIGHT = 1e3


class Problem(SimpleNamespace):
    """The numbers that `flexarm-benches serve` answers to `{"problem": arm}`; SI units."""


def position_torque(problem, angle, cos=math.cos, sin=math.sin):
    """g(θ) of eq 12 [N·m]; the harmonics by angle addition."""
    c1, s1 = cos(problem.cogging_frequency * angle), sin(problem.cogging_frequency * angle)
    torque = problem.stiffness * angle + problem.offset
    c, s = c1, s1
    for a, b in zip(problem.cogging_cos, problem.cogging_sin, strict=True):
        torque += a * c + b * s
        c, s = c * c1 - s * s1, s * c1 + c * s1
    return torque


def derivative(problem, x, u, goal, cos=math.cos, sin=math.sin):
    """d(θ, ω, θr, ωr, e, T)/dt (eqs 20 to 22)."""
    angle, velocity, reference_angle, reference_velocity, _, load = x
    feedback = -problem.gain_angle * (angle - reference_angle)
    feedback -= problem.gain_velocity * (velocity - reference_velocity)
    torque = position_torque(problem, angle, cos, sin)
    torque += problem.damping * reference_velocity + problem.inertia * u
    current = torque / problem.torque_constant
    return [
        velocity,
        u + feedback / problem.feedback_inertia,
        reference_velocity,
        u,
        angle - goal,
        (current * current - load) / problem.thermal_time_constant,
    ]


def loss(problem, x, u, goal):
    """Integrand of the cost (eq 28)."""
    distance = x[0] - goal
    return (
        problem.weight_angle * distance * distance
        + problem.weight_velocity * x[1] * x[1]
        + problem.weight_integral * x[4] * x[4]
        + problem.weight_thermal * x[5] * x[5]
        + problem.weight_acceleration * u * u
    )


def rk4(problem, x, u, goal, cos=math.cos, sin=math.sin):
    """State after one move, and its cost (eq 24)."""
    h = problem.period
    stages, slopes = [], []
    for elapsed in (0.0, 0.5, 0.5, 1.0):
        before = slopes[-1] if slopes else [0.0] * len(x)
        stages.append([xi + elapsed * h * k for xi, k in zip(x, before, strict=True)])
        slopes.append(derivative(problem, stages[-1], u, goal, cos, sin))
    weights = (h / 6, h / 3, h / 3, h / 6)
    after = list(x)
    cost = 0.0
    for weight, stage, slope in zip(weights, stages, slopes, strict=True):
        after = [xi + weight * k for xi, k in zip(after, slope, strict=True)]
        cost += weight * loss(problem, stage, u, goal)
    return after, cost


@dataclass
class Check:
    """What a solver's moves do in the full model."""

    cost: float
    # Largest and summed excess of T over its limit at the nodes 1..N [A²].
    excess: float
    total_excess: float
    # Largest excess of θr over its bounds at the nodes 1..N-1, and distance from rest at the goal.
    angle_excess: float
    rest_error: float
    nodes: list

    def objective(self, instance):
        """Cost over its scale; where no plan keeps the limit, with the exact L1 penalty on thermal excess."""
        price = EXCESS_WEIGHT * self.total_excess if instance.soft else 0.0
        return self.cost / instance.cost_scale + price

    def gap(self, instance):
        """Objective above the optimum, relative."""
        return self.objective(instance) / instance.optimum - 1.0

    # Comparisons below are such that not-a-number fails them.

    def admissible(self, instance):
        """Whether the moves keep the limits and end at rest at the goal."""
        return (
            (instance.soft or self.excess <= THERMAL_TOLERANCE)
            and self.angle_excess <= ANGLE_TOLERANCE
            and self.rest_error <= ANGLE_TOLERANCE
        )

    def optimal(self, instance):
        """Whether the moves are as good as the instance's optimum."""
        return self.gap(instance) <= (MERIT_TOLERANCE if instance.soft else COST_TOLERANCE)


def simulate(problem, initial, goal, moves):
    """Follows `moves` from `initial` in the full model."""
    nodes, cost = [list(initial)], 0.0
    for u in moves:
        after, step_cost = rk4(problem, nodes[-1], u, goal)
        nodes.append(after)
        cost += step_cost
    excesses = [max(0.0, x[5] - problem.thermal_limit) for x in nodes[1:]]
    angles = [max(problem.angle_lower - x[2], x[2] - problem.angle_upper, 0.0) for x in nodes[1:-1]]
    return Check(
        cost=cost,
        excess=max(excesses),
        total_excess=sum(excesses),
        angle_excess=max(angles),
        rest_error=max(abs(nodes[-1][0] - goal), abs(nodes[-1][1])),
        nodes=nodes,
    )
