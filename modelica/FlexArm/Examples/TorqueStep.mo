within FlexArm.Examples;
model TorqueStep "T-flex without controller, under a step of the motor's torque"
  extends Modelica.Icons.Example;
  parameter Modelica.Units.SI.Torque before = 3.1 "Torque before the step: it holds the arm at 1.3 rad, nearly";
  parameter Modelica.Units.SI.Torque after = 3.5 "Torque after the step";
  parameter Modelica.Units.SI.Time stepTime = 0.5 "Time of the step";
  FlexArm.Components.Plant plant(arm(damping = 0.5)) "T-flex, damped so that it comes to rest"
    annotation (Placement(transformation(extent = {{0, -10}, {20, 10}})));
equation
  plant.torque = if time < stepTime then before else after;
  plant.disturbance_torque = 0;

  annotation (
    experiment(StopTime = 2, Tolerance = 1e-9, Interval = 0.001),
    Documentation(info = "<html>
<p>The response that the project's tests compare with the FMU.</p>
</html>"));
end TorqueStep;
