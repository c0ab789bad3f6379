"""The closed loop in Model Exchange: samples are time events, an adaptive solver moves the arm."""

from collections.abc import Callable

from fmpy.sundials import CVodeSolver

from conftest import fmu
from fmus import ModelExchange


class ExchangeLoop:
    """Controller and plant as an importer with an adaptive solver couples them.

    `inputs` says setpoint and disturbance torque at a time, `controller` what its unit alone is set to.
    """

    def __init__(
        self,
        version: str,
        inputs: Callable[[float], tuple[float, float]],
        values: dict,
        controller: dict | None = None,
        log=None,
    ):
        self.controller = ModelExchange(fmu(version, "FlexArmController"), log=log)
        self.plant = ModelExchange(fmu(version, "FlexArmPlant"), log=log)
        self.inputs, self.values, self.controller_alone = inputs, values, controller or {}
        self.initialize()
        plant = self.plant.fmu
        derivatives = plant.getContinuousStateDerivatives if self.plant.fmi3 else plant.getDerivatives
        self.solver = CVodeSolver(
            nx=4,
            nz=0,
            get_x=plant.getContinuousStates,
            set_x=self.set_states,
            get_dx=derivatives,
            get_z=lambda z, nz: None,
            get_nominals=plant.getNominalsOfContinuousStates,
            set_time=plant.setTime,
            input=None,
            startTime=0.0,
            relativeTolerance=1e-8,
        )

    def initialize(self) -> None:
        """Both units to Continuous-Time Mode, the first sample taken."""
        setpoint, push = self.inputs(0.0)
        self.plant.configure(self.values)
        self.controller.configure(self.values | self.controller_alone)
        self.plant.initialize(disturbance_torque=push)
        self.plant.events()
        start = self.plant.get("angle")
        self.controller.initialize(angle=start, setpoint=setpoint)
        self.next = self.controller.events()
        self.plant.set("torque", self.controller.get("torque"))
        for unit in (self.controller, self.plant):
            unit.fmu.enterContinuousTimeMode()

    def set_states(self, states, n: int) -> None:
        """What the solver does before it asks for derivatives."""
        self.plant.fmu.setContinuousStates(states, n)

    def sample(self) -> tuple[float, float]:
        """To the controller's next time event and through it; returns its instant and the angle there."""
        time = self.next
        self.solver.step(0.0, time)
        self.plant.fmu.setTime(time)
        self.plant.fmu.completedIntegratorStep()
        angle = self.plant.get("angle")
        setpoint, push = self.inputs(time)
        self.next = self.controller.event(time, angle=angle, setpoint=setpoint)
        self.plant.event(time, torque=self.controller.get("torque"), disturbance_torque=push)
        self.solver.reset(time)
        return time, angle

    def close(self) -> None:
        """Free both."""
        self.controller.close()
        self.plant.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()
