"""Prints the loop of both units sample by sample, every bit, for comparison between platforms.

python trajectory.py <parameter set> <samples> [name=value ...]
"""

import sys

from conftest import VERSIONS
from fmus import Loop, hot_pendulum, parameters

SETS = {"tflex": lambda: parameters("tflex"), "hot-pendulum": hot_pendulum}
WATCHED = ("torque", "reference.angle", "feedback_torque", "nmpc.cost")


def main(name: str, samples: str, *overrides: str) -> None:
    values = SETS[name]() | dict(o.split("=") for o in overrides)
    for version in VERSIONS:
        with Loop(version, values) as loop:
            start = loop.plant.get("initial.angle")
            loop.initialize(setpoint=start)
            for i in range(int(samples)):
                if i % 400 == 200:
                    loop.controller.set("setpoint", start + (0.2 if i % 800 == 200 else -0.1))
                loop.sequential(i / 4000)
                row = [loop.plant.get("angle"), *map(loop.controller.get, WATCHED)]
                print(version, *(value.hex() for value in row))


if __name__ == "__main__":
    main(*sys.argv[1:])
