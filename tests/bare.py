"""fmuloader as a client: bare calls by ctypes, with the interface of `fmus.CoSimulation`.

It reads no model description. That comes from FMPy, so that what differs are the calls alone.
"""

from pathlib import Path

import fmpy
from fmuloader.fmi2 import Fmi2Slave, Fmi2Type
from fmuloader.fmi3 import Fmi3Slave

from cases import resolve
from fmus import SAMPLE


class BareCoSimulation:
    """One instance for Co-Simulation."""

    def __init__(self, path: Path):
        self.path = path
        description = fmpy.read_model_description(str(path))
        self.references = {v.name: v.valueReference for v in description.modelVariables}
        identifier = description.coSimulation.modelIdentifier
        if description.fmiVersion.startswith("3"):
            self.slave = Fmi3Slave(path, model_identifier=identifier)
            token = description.instantiationToken
            self.slave.instantiate_co_simulation(path.stem, instantiation_token=token)
            names = {"Real": "float64", "Integer": "int32", "Enumeration": "int64", "Boolean": "boolean"}
        else:
            self.slave = Fmi2Slave(path, model_identifier=identifier)
            self.slave.instantiate(path.stem, Fmi2Type.CO_SIMULATION, guid=description.guid)
            self.slave.setup_experiment()
            names = {"Real": "real", "Integer": "integer", "Enumeration": "integer", "Boolean": "boolean"}
        self.setters = {kind: getattr(self.slave, f"set_{name}") for kind, name in names.items()}
        self.getter = getattr(self.slave, f"get_{names['Real']}")

    def configure(self, values: dict) -> None:
        """Set those parameters that this unit has."""
        for variable in resolve(self.path, values):
            self.setters[variable["type"]]([variable["reference"]], variable["values"])

    def initialize(self, _start: float, **inputs) -> None:
        """Go through Initialization Mode with the inputs set."""
        self.slave.enter_initialization_mode()
        for name, value in inputs.items():
            self.set(name, value)
        self.slave.exit_initialization_mode()

    def get(self, name: str) -> float:
        """Value of a real scalar."""
        return self.getter([self.references[name]])[0]

    def set(self, name: str, value: float) -> None:
        """Set a real scalar."""
        self.setters["Real"]([self.references[name]], [value])

    def step(self, time: float, size: float = SAMPLE) -> None:
        """One communication step."""
        self.slave.do_step(time, size)

    def close(self) -> None:
        """Free the instance and the extracted files."""
        self.slave.__exit__()
