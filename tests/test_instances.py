"""Many instances at once give the same bits as one."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import fmpy
import pytest

from conftest import fmu
from fmus import SAMPLE, CoSimulation, hot_pendulum


def run(path: Path, directory: Path, values: dict) -> tuple[list[float], int]:
    """Torques of a run and the iterations of its hardest plan."""
    with CoSimulation(path, directory) as controller:
        controller.configure(values)
        controller.initialize(angle=1.3, setpoint=1.45)
        torques, iterations = [], 0
        for k in range(450):
            controller.set("angle", 1.3 + 1e-4 * k)
            controller.set("setpoint", 1.45 if k < 200 or not values else 0.3)
            controller.step(k * SAMPLE)
            torques.append(controller.get("torque"))
            iterations = max(iterations, controller.get("nmpc.iterations"))
    return torques, iterations


@pytest.mark.parametrize("hot", [False, True])
def test_64_controllers_on_8_threads(version, hot):
    path = fmu(version, "FlexArmController")
    directory = Path(fmpy.extract(str(path)))
    values = hot_pendulum() if hot else {}
    alone = run(path, directory, values)
    torques, iterations = alone
    assert len(set(torques)) > 400, "the torque must move for this test to say anything"
    assert not hot or iterations > 0, "nor does it without work for the solver"
    with ThreadPoolExecutor(8) as pool:
        together = list(pool.map(lambda _: run(path, directory, values), range(64)))
    assert all(outcome == alone for outcome in together)
