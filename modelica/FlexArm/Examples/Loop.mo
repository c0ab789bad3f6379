within FlexArm.Examples;
partial model Loop "Controller and plant connected, with setpoints and pushes"
  extends Modelica.Icons.Example;
  parameter FlexArm.Parameters.TFlex set "Parameters of the plant";
  parameter FlexArm.Parameters.TFlex belief = set "Parameters of the controller: what it believes";
  parameter Modelica.Units.SI.Angle goals[:] = {1.3} "Setpoints, one after the other";
  parameter Modelica.Units.SI.Time goalTimes[size(goals, 1)] = {0} "Times from which they hold";
  parameter Modelica.Units.SI.Torque pushes[:] = {0} "Disturbance torques, one after the other";
  parameter Modelica.Units.SI.Time pushTimes[size(pushes, 1)] = {0} "Times from which they hold";
  FlexArm.Components.Controller controller(parameters = belief) "Controller"
    annotation (Placement(transformation(extent = {{-40, -10}, {-20, 10}})));
  FlexArm.Components.Plant plant(arm = set.arm, motor = set.motor, initial_ = set.initial_) "Arm and motor"
    annotation (Placement(transformation(extent = {{20, -10}, {40, 10}})));
protected
  Integer goal "Number of the setpoint";
  Integer push "Number of the push";
equation
  goal = max(1, sum(if time >= goalTimes[i] then 1 else 0 for i in 1:size(goals, 1)));
  push = max(1, sum(if time >= pushTimes[i] then 1 else 0 for i in 1:size(pushes, 1)));
  controller.setpoint = goals[goal];
  plant.disturbance_torque = pushes[push];
  connect(controller.torque, plant.torque) annotation (Line(points = {{-19, 0}, {0, 0}, {0, 4}, {18, 4}}, color = {0, 0, 127}));
  connect(plant.angle, controller.angle) annotation (Line(points = {{41, 8}, {60, 8}, {60, -30}, {-60, -30}, {-60, -6}, {-42, -6}}, color = {0, 0, 127}));

  annotation (Documentation(info = "<html>
<p>The loop of every example: setpoints in turn, pushes in turn.</p>
</html>"));
end Loop;
