"""Many instances at once give the same bits as one."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import fmpy

from conftest import fmu
from fmus import SAMPLE, CoSimulation


def run(path: Path, directory: Path) -> list[float]:
    with CoSimulation(path, directory) as controller:
        controller.initialize(angle=1.3, setpoint=1.45)
        torques = []
        for k in range(450):
            controller.set("angle", 1.3 + 1e-4 * k)
            controller.step(k * SAMPLE)
            torques.append(controller.get("torque"))
    return torques


def test_64_controllers_on_8_threads(version):
    path = fmu(version, "FlexArmController")
    directory = Path(fmpy.extract(str(path)))
    alone = run(path, directory)
    assert len(set(alone)) > 400, "the torque must move for this test to say anything"
    with ThreadPoolExecutor(8) as pool:
        together = list(pool.map(lambda _: run(path, directory), range(64)))
    assert all(torques == alone for torques in together)
