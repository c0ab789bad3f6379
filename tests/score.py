"""Prints the score of a closed loop through FMPy, for a Python on another platform.

python score.py <case> <fmi2 or fmi3> <sequential or side-by-side>
"""

import sys

from cases import CASES
from fmus import CoSimulation, Loop


def score(name: str, version: str, order: str, clients: tuple = (CoSimulation, CoSimulation)) -> float:
    """The score of a case through clients for controller and plant."""
    case = CASES[name]
    with Loop(version, case.values, controller=case.controller, clients=clients) as loop:
        return case.run(loop, order)


if __name__ == "__main__":
    print(repr(score(*sys.argv[1:])))
