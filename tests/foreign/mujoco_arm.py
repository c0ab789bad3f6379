"""A vendor's arm: a hinge in MuJoCo as an FMU of FMI 2.0, with names, units and friction of its own.

`pythonfmu build -f mujoco_arm.py` makes MuJoCoArm.fmu. The controller knows nothing of its inertia, damping,
stiffness or friction; its angle is in degrees and grows the other way.
"""

import math

import mujoco
from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

HINGE = """
<mujoco>
  <option timestep="0.00025" gravity="0 0 0" integrator="RK4" iterations="20"/>
  <worldbody>
    <body>
      <joint name="hinge" type="hinge" axis="0 0 1" stiffness="1.3" springref="20" damping="0.03"
             frictionloss="0.04" limited="false"/>
      <geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.02" mass="1.9"/>
    </body>
  </worldbody>
  <actuator><motor name="motor" joint="hinge" gear="1"/></actuator>
</mujoco>
"""


class MuJoCoArm(Fmi2Slave):
    """Torque in, angle out."""

    author = "flexarm tests"
    description = "Hinge with spring, damper and dry friction"

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.model = mujoco.MjModel.from_xml_string(HINGE)
        self.data = mujoco.MjData(self.model)
        self.drive = 0.0
        self.phi = -74.484507  # degrees: 1.30 rad for the controller
        self.register_variable(Real("drive", causality=Fmi2Causality.input))
        self.register_variable(Real("phi", causality=Fmi2Causality.output))
        self.register_variable(
            Real("phi_start", causality=Fmi2Causality.parameter, variability=Fmi2Variability.fixed)
        )
        self.phi_start = self.phi

    def exit_initialization_mode(self):
        """The arm rests where it starts."""
        self.data.qpos[0] = -math.radians(self.phi_start)
        self.phi = self.phi_start

    def do_step(self, current_time, step_size):
        """As many steps of the simulator as fit."""
        self.data.ctrl[0] = self.drive
        for _ in range(max(1, round(step_size / self.model.opt.timestep))):
            mujoco.mj_step(self.model, self.data)
        self.phi = -math.degrees(self.data.qpos[0])
        return math.isfinite(self.phi)
