"""The packaged units through FMPy, one interface for FMI 2.0 and FMI 3.0.

Names are those of FMI 2.0: an element of an array is `arm.cogging_cos[1]`.
"""

import re
import shutil
import xml.etree.ElementTree as ET
from ctypes import byref
from pathlib import Path

import fmpy
from fmpy.fmi2 import FMU2Model, FMU2Slave
from fmpy.fmi3 import FMU3Model, FMU3Slave
from fmpy.logging import addLoggerProxy

from conftest import DIST, fmu

SAMPLE = 0.00025
LOGGERS = []
EXCHANGE = (FMU2Model, FMU3Model)
ENUMERATIONS = {
    "reference.source": {"nmpc": 1, "profile": 2},
    "feedback.law": {"lqr": 1, "lqri": 2, "pid": 3},
    "feedback.design": {"weights": 1, "gains": 2},
    "nmpc.model": {"nonlinear": 1, "qp": 2},
    "nmpc.terminal": {"rest_at_goal": 1, "safe_set": 2, "free": 3},
    "nmpc.solver": {"automatic": 1, "riccati": 2, "clarabel": 3},
    "nmpc.instruction_set": {"automatic": 1, "baseline": 2},
}


def parameters(name: str) -> dict[str, str]:
    """The values of a shipped parameter set, as text."""
    tree = ET.parse(DIST / "parameters" / f"{name}.ssv")
    ns = {"ssv": "http://ssp-standard.org/SSP1/SystemStructureParameterValues"}
    found = {p.get("name"): p[0].get("value") for p in tree.iterfind(".//ssv:Parameter", ns)}
    assert found, f"{name}.ssv holds no parameters"
    return found


def hot_pendulum() -> dict[str, str]:
    """The pendulum when its motor is nearly too hot: moves need the planner's solver, not only its formula.

    The T-flex never does, so tests of states, threads and memory would miss the solver.
    """
    return parameters("pendulum") | {"initial.thermal_load": "11"}


class Instance:
    """One instance of a packaged (or any other) FMU."""

    # Clients of FMPy for FMI 2.0 and 3.0.
    clients: tuple

    def __init__(self, path: Path, directory: Path | None = None, log=None):
        self.description = fmpy.read_model_description(str(path))
        self._owns_directory = directory is None
        self.directory = directory or Path(fmpy.extract(str(path)))
        self.fmi3 = self.description.fmiVersion.startswith("3")
        client = self.clients[self.fmi3]
        interface = self.description.modelExchange if client in EXCHANGE else self.description.coSimulation
        kwargs = {
            "unzipDirectory": str(self.directory),
            "modelIdentifier": interface.modelIdentifier,
            "instanceName": path.stem,
        }
        kwargs["guid"] = self.description.instantiationToken if self.fmi3 else self.description.guid
        if self.fmi3:
            self.fmu = client(**kwargs)
            self.fmu.instantiate(loggingOn=log is not None, logMessage=log)
        else:
            self.fmu = client(**kwargs)
            callbacks = None
            if log is not None:
                callbacks = fmpy.fmi2.fmi2CallbackFunctions()
                callbacks.logger = fmpy.fmi2.fmi2CallbackLoggerTYPE(
                    lambda env, name, status, category, message: log(env, status, category, message)
                )
                callbacks.allocateMemory = fmpy.fmi2.fmi2CallbackAllocateMemoryTYPE(fmpy.calloc)
                callbacks.freeMemory = fmpy.fmi2.fmi2CallbackFreeMemoryTYPE(fmpy.free)
                # The logger of FMI 2.0 is variadic: FMPy's proxy formats the message.
                addLoggerProxy(byref(callbacks))
                # The proxy keeps one logger for the whole process and calls it for later instances too.
                LOGGERS.append(callbacks)
            self.fmu.instantiate(loggingOn=log is not None, callbacks=callbacks)
        self.variables = {v.name: v for v in self.description.modelVariables}
        self._getters, self._setters = {}, {}

    def _access(self, name: str, verb: str):
        variable = self.variables[name]
        kind = "Int64" if variable.type == "Enumeration" and self.fmi3 else variable.type
        kind = "Integer" if kind == "Enumeration" else kind
        return [variable.valueReference], getattr(self.fmu, verb + kind)

    def get(self, name: str):
        """Value of a scalar."""
        if name not in self._getters:
            self._getters[name] = self._access(name, "get")
        reference, getter = self._getters[name]
        return getter(reference)[0]

    def get_array(self, name: str) -> list:
        """Values of an array, by its name without subscripts."""
        if not self.fmi3:
            elements = [n for n in self.variables if re.fullmatch(re.escape(name) + r"\[\d+\]", n)]
            return [self.get(n) for n in elements]
        variable = self.variables[name]
        # As long as its structural parameter says, which nobody changes here.
        return self.fmu.getFloat64([variable.valueReference], nValues=variable.shape[0])

    def set(self, name: str, value) -> None:
        """Set a scalar, or in FMI 3.0 an element of an array."""
        if name not in self.variables and self.fmi3 and name.endswith("]"):
            base, index = name[:-1].split("[")
            values = list(self.get_array(base))
            values[int(index) - 1] = float(value)
            self.fmu.setFloat64([self.variables[base].valueReference], values)
            return
        if name not in self._setters:
            self._setters[name] = self._access(name, "set")
        reference, setter = self._setters[name]
        setter(reference, [value])

    def has(self, name: str) -> bool:
        """Whether a variable, or the array of an element, is declared."""
        return name in self.variables or name.split("[")[0] in self.variables

    def configure(self, values: dict) -> None:
        """Set those parameters that this unit has; text is converted to the declared type."""
        for name, value in values.items():
            if not self.has(name):
                continue
            kind = self.variables.get(name, self.variables.get(name.split("[")[0])).type
            if kind in ("Real", "Float64"):
                value = float(value)
            elif kind == "Boolean":
                value = value in (True, "true", "1")
            elif kind == "Enumeration":
                value = ENUMERATIONS[name].get(value, value)
                value = int(value)
            else:
                value = int(value)
            self.set(name, value)

    def enter_initialization(self, start: float = 0.0, stop: float | None = None) -> None:
        """Into Initialization Mode."""
        if self.fmi3:
            self.fmu.enterInitializationMode(startTime=start, stopTime=stop)
        else:
            self.fmu.setupExperiment(startTime=start, stopTime=stop)
            self.fmu.enterInitializationMode()

    def initialize(self, start: float = 0.0, stop: float | None = None, **inputs) -> None:
        """Go through Initialization Mode with the inputs set."""
        self.enter_initialization(start, stop)
        for name, value in inputs.items():
            self.set(name, value)
        self.fmu.exitInitializationMode()

    def save(self):
        """Take a snapshot."""
        return self.fmu.getFMUState() if self.fmi3 else self.fmu.getFMUstate()

    def restore(self, state) -> None:
        """Go back to a snapshot."""
        (self.fmu.setFMUState if self.fmi3 else self.fmu.setFMUstate)(state)

    def forget(self, state) -> None:
        """Free a snapshot."""
        (self.fmu.freeFMUState if self.fmi3 else self.fmu.freeFMUstate)(state)

    def serialize(self, state) -> bytes:
        """A snapshot as bytes."""
        return (self.fmu.serializeFMUState if self.fmi3 else self.fmu.serializeFMUstate)(state)

    def deserialize(self, data: bytes):
        """A snapshot from bytes."""
        return (self.fmu.deserializeFMUState if self.fmi3 else self.fmu.deSerializeFMUstate)(data)

    def close(self) -> None:
        """Free the instance and the extracted files."""
        self.fmu.freeInstance()
        if self._owns_directory:
            shutil.rmtree(self.directory, ignore_errors=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


class CoSimulation(Instance):
    """One instance for Co-Simulation."""

    clients = (FMU2Slave, FMU3Slave)

    def step(self, time: float, size: float = SAMPLE) -> None:
        """One communication step."""
        self.fmu.doStep(currentCommunicationPoint=time, communicationStepSize=size)


class Eventful(FMU3Slave):
    """Co-Simulation with Event Mode and early return."""

    def instantiate(self, **arguments):
        """As FMPy does, with both."""
        super().instantiate(eventModeUsed=True, earlyReturnAllowed=True, **arguments)


class EventfulCoSimulation(CoSimulation):
    """Co-Simulation in which the importer handles the events (FMI 3.0 sec 4.2.3)."""

    clients = (None, Eventful)

    def step(self, time: float, size: float = SAMPLE) -> None:
        """One communication step, which begins and ends in Event Mode."""
        self.fmu.updateDiscreteStates()
        self.fmu.enterStepMode()
        *_, early, reached = self.fmu.doStep(time, size)
        assert not early and abs(reached - time - size) < 1e-9, (time, size, reached)
        self.fmu.enterEventMode()


class ModelExchange(Instance):
    """One instance for Model Exchange."""

    clients = EXCHANGE

    def events(self) -> float:
        """Event iteration until nothing is left to do; returns the instant of the next time event."""
        iterate = self.fmu.updateDiscreteStates if self.fmi3 else self.fmu.newDiscreteStates
        while True:
            again, _, _, _, defined, instant = iterate()
            if not again:
                return instant if defined else float("inf")

    def event(self, time: float, **inputs) -> float:
        """What an importer does at an event in Continuous-Time Mode; returns the instant of the next one."""
        self.fmu.setTime(time)
        self.fmu.enterEventMode()
        for name, value in inputs.items():
            self.set(name, value)
        instant = self.events()
        self.fmu.enterContinuousTimeMode()
        return instant


class Loop:
    """Controller and plant, coupled as a co-simulation master does it."""

    def __init__(self, version: str, *sets: dict, controller: dict | None = None, clients=None):
        steers, moves = clients or (CoSimulation, CoSimulation)
        self.controller = steers(fmu(version, "FlexArmController"))
        self.plant = moves(fmu(version, "FlexArmPlant"))
        for values in sets:
            self.controller.configure(values)
            self.plant.configure(values)
        self.controller.configure(controller or {})

    def initialize(self, setpoint: float, start: float = 0.0) -> None:
        """Initialise both units, the controller with the plant's angle."""
        self.plant.initialize(start)
        self.controller.initialize(start, angle=self.plant.get("angle"), setpoint=setpoint)

    def sequential(self, time: float, size: float = SAMPLE) -> None:
        """Controller first, the plant with its fresh torque: no delay."""
        self.controller.set("angle", self.plant.get("angle"))
        self.controller.step(time, size)
        self.plant.set("torque", self.controller.get("torque"))
        self.plant.step(time, size)

    def side_by_side(self, time: float, size: float = SAMPLE) -> None:
        """Both with the values of the last communication point: one sample of delay."""
        angle, torque = self.plant.get("angle"), self.controller.get("torque")
        self.controller.set("angle", angle)
        self.plant.set("torque", torque)
        self.controller.step(time, size)
        self.plant.step(time, size)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.controller.close()
        self.plant.close()
