"""Seeded instances: start, goal, and what they test.

| class | start |
|---|---|
| golden | `control/tests/golden/nmpc_*.json` |
| random | anywhere within the bounds, moving, cool or hot |
| active | hot: the thermal limit decides |
| starved | thermal budget of 0.2 to 3 % above the start's load |
| over | load above the limit by up to 0.2 % |
| far over | load above the limit by up to 50 % |

Of active and starved ones only those are taken whose inequality-free optimum breaks the thermal limit. The
T-flex has so strong a motor that only a fast start the wrong way heats it: 8 to 16 rad/s in these classes.
"""

import json
import math
import random
from dataclasses import dataclass, replace

from model import simulate

CLASSES = ("golden", "random", "active", "starved", "over", "far over")
# Classes that no plan keeps within the thermal limit; every solver prices the excess instead.
SOFT = ("over", "far over")


@dataclass(frozen=True)
class Instance:
    """One problem to solve; start and goal in the order and units of eq 23."""

    arm: str
    kind: str
    initial: list
    goal: float
    soft: bool
    # Cost of the inequality-free optimum.
    cost_scale: float = math.nan
    # IPOPT's cost, or merit where soft, at tight tolerances.
    optimum: float = math.nan
    # Cost that an independent simulation noted for a golden instance.
    noted_cost: float = math.nan


def draw(generator, problem, kind):
    """A start and goal of a class; whether they truly belong to it, their optimum tells."""
    lower, upper, limit = problem.angle_lower, problem.angle_upper, problem.thermal_limit
    span = upper - lower
    reference = generator.uniform(lower + 0.02 * span, upper - 0.02 * span)
    goal = generator.uniform(lower + 0.01 * span, upper - 0.01 * span)
    velocity = generator.gauss(0.0, 0.5)
    strong = problem.arm == "tflex"
    if strong and kind in ("active", "starved"):
        velocity = math.copysign(generator.uniform(8.0, 16.0), reference - goal)
    share = {
        "random": generator.uniform(0.0, 0.97),
        "active": generator.uniform(0.998 if strong else 0.7, 1.0),
        "starved": 1.0 / (1.0 + generator.uniform(0.002, 0.03)),
        "over": generator.uniform(1.0, 1.002),
        "far over": generator.uniform(1.002, 1.5),
    }[kind]
    initial = [
        reference + generator.gauss(0.0, 0.005),
        velocity + generator.gauss(0.0, 0.05),
        reference,
        velocity,
        0.0,
        share * limit,
    ]
    return Instance(problem.arm, kind, initial, goal, soft=kind in SOFT)


def golden(problem, folder):
    """The golden instances of an arm."""
    cases = json.loads((folder / f"nmpc_{problem.arm}.json").read_text())["cases"]
    return [
        Instance(problem.arm, "golden", case["x0"], case["goal"], soft=False, noted_cost=case["cost"])
        for case in cases
    ]


def pairs(problem, yardstick, folder, counts, seed, progress):
    """Instances of an arm, each with the one a move later along IPOPT's plan; `counts` per class."""
    chosen = []
    for instance in golden(problem, folder):
        chosen.append(pair(yardstick, instance))
        progress(1)
    for kind, count in counts.items():
        # A stream for every class: its instances do not depend on how many of others are drawn.
        generator = random.Random(f"{seed} {problem.arm} {kind}")
        found = 0
        while found < count:
            drawn = pair(yardstick, draw(generator, problem, kind))
            if drawn is not None:
                chosen.append(drawn)
                found += 1
                progress(1)
    return chosen


def pair(yardstick, instance):
    """An instance and its successor with their optima; none where the first is not of its class."""
    instance, moves = yardstick.complete(instance)
    if moves is None:
        return None
    nodes = simulate(yardstick.problem, instance.initial, instance.goal, moves).nodes
    after = replace(instance, initial=nodes[1], noted_cost=math.nan)
    after, moves = yardstick.complete(after, successor=True)
    return None if moves is None else (instance, after)
