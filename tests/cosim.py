"""Prints the score of a closed loop through libcosim, FMI 2.0: a master that steps side by side.

python cosim.py <case>
"""

import sys
from pathlib import Path

import fmpy
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

from cases import CASES, Case, resolve
from conftest import fmu
from fmus import SAMPLE


class Unit:
    """A unit of a `CosimLoop`."""

    def __init__(self, loop: "CosimLoop", path: Path, values: dict):
        self.loop = loop
        self.slave = CosimLocalSlave(str(path), path.stem)
        self.index = loop.execution.add_local_slave(self.slave)
        assert self.index >= 0, f"{path} is not loaded"
        self.variables = {v.name: v for v in fmpy.read_model_description(str(path)).modelVariables}
        starts = {v.valueReference: v.start for v in self.variables.values()}
        execution = loop.execution
        setters = {
            "Real": execution.real_initial_value,
            "Integer": execution.integer_initial_value,
            "Boolean": execution.boolean_initial_value,
        }
        for parameter in resolve(path, values):
            kind, reference, (value,) = (parameter[key] for key in ("type", "reference", "values"))
            if kind in setters:
                assert setters[kind](self.index, reference, value), parameter
            else:
                # It sets no enumerations.
                assert value == int(starts[reference]), parameter

    def reference(self, name: str) -> int:
        return self.variables[name].valueReference

    def get(self, name: str) -> float:
        (value,) = self.loop.observer.last_real_values(self.index, [self.reference(name)])
        return value

    def set(self, name: str, value: float) -> None:
        """From the next step on."""
        assert self.loop.manipulator.slave_real_values(self.index, [self.reference(name)], [value])


class CosimLoop:
    """Controller and plant, coupled by libcosim."""

    def __init__(self, case: Case):
        self.execution = CosimExecution.from_step_size(round(SAMPLE * 1e9))
        self.manipulator = CosimManipulator.create_override()
        self.observer = CosimObserver.create_last_value()
        self.controller = Unit(self, fmu("fmi2", "FlexArmController"), case.values | case.controller)
        self.plant = Unit(self, fmu("fmi2", "FlexArmPlant"), case.values)
        for source, target, name in (
            (self.controller, self.plant, "torque"),
            (self.plant, self.controller, "angle"),
        ):
            ends = (source.index, source.reference(name), target.index, target.reference(name))
            assert self.execution.connect_real_variables(*ends) == 0, name

    def initialize(self, setpoint: float) -> None:
        reference = self.controller.reference("setpoint")
        assert self.execution.real_initial_value(self.controller.index, reference, setpoint)
        assert self.execution.add_manipulator(self.manipulator)
        assert self.execution.add_observer(self.observer)

    def side_by_side(self, _time: float) -> None:
        assert self.execution.step()


if __name__ == "__main__":
    log_output_level(CosimLogLevel.ERROR)
    case = CASES[sys.argv[1]]
    print(repr(case.run(CosimLoop(case), "side-by-side")))
