within FlexArm.Components;
model Plant "Motor, arm and encoder connected: the native FlexArmPlant"
  parameter FlexArm.Parameters.Arm arm "Parameter vector of eq 12";
  parameter FlexArm.Parameters.Motor motor "Motor and its thermal limit";
  parameter FlexArm.Parameters.Initial initial_ "Where the run starts";
  Modelica.Blocks.Interfaces.RealInput torque(unit = "N.m") "Torque asked of the motor"
    annotation (Placement(transformation(extent = {{-140, 20}, {-100, 60}})));
  Modelica.Blocks.Interfaces.RealInput disturbance_torque(unit = "N.m") "Torque that acts on the arm from outside"
    annotation (Placement(transformation(extent = {{-140, -60}, {-100, -20}})));
  Modelica.Blocks.Interfaces.RealOutput angle(unit = "rad") "Angle of the arm as the encoder measures it"
    annotation (Placement(transformation(extent = {{100, 70}, {120, 90}})));
  Modelica.Blocks.Interfaces.RealOutput velocity(unit = "rad/s") "Angular velocity of the arm"
    annotation (Placement(transformation(extent = {{100, 30}, {120, 50}})));
  Modelica.Blocks.Interfaces.RealOutput current(unit = "A") "Motor current"
    annotation (Placement(transformation(extent = {{100, -10}, {120, 10}})));
  Modelica.Blocks.Interfaces.RealOutput thermal_load(unit = "A2") "Thermal load of the motor"
    annotation (Placement(transformation(extent = {{100, -50}, {120, -30}})));
  Modelica.Blocks.Interfaces.RealOutput thermal_fraction(unit = "1") "Thermal load divided by its limit"
    annotation (Placement(transformation(extent = {{100, -90}, {120, -70}})));
  Motor drive(motor = motor, thermal_load_start = initial_.thermal_load) "Motor"
    annotation (Placement(transformation(extent = {{-70, -10}, {-50, 10}})));
  Arm joint(arm = arm, angle_start = initial_.angle, velocity_start = initial_.velocity) "Arm on its joint"
    annotation (Placement(transformation(extent = {{-20, -10}, {0, 10}})));
  Encoder encoder "Encoder"
    annotation (Placement(transformation(extent = {{30, 30}, {50, 50}})));
  Modelica.Mechanics.Rotational.Interfaces.Flange_b flange "The arm, for further loads"
    annotation (Placement(transformation(extent = {{-10, -110}, {10, -90}})));
  Torque disturbance "Disturbance"
    annotation (Placement(transformation(extent = {{-70, -50}, {-50, -30}})));
protected
  model Torque "Source of torque"
    Modelica.Blocks.Interfaces.RealInput tau(unit = "N.m") "Torque"
      annotation (Placement(transformation(extent = {{-140, -20}, {-100, 20}})));
    Modelica.Mechanics.Rotational.Interfaces.Flange_b flange "What is driven"
      annotation (Placement(transformation(extent = {{90, -10}, {110, 10}})));
  equation
    flange.tau = -tau;
    annotation (Documentation(info = "<html><p>Drives its flange with the torque of its input.</p></html>"),
      Icon(graphics = {Line(points = {{-80, 0}, {80, 0}}, color = {0, 90, 160}, thickness = 1, arrow = {Arrow.None, Arrow.Filled})}));
  end Torque;
equation
  connect(torque, drive.torque) annotation (Line(points = {{-120, 40}, {-90, 40}, {-90, 0}, {-72, 0}}, color = {0, 0, 127}));
  connect(drive.flange, joint.flange_a) annotation (Line(points = {{-50, 0}, {-20, 0}}));
  connect(joint.flange_b, encoder.flange) annotation (Line(points = {{0, 0}, {20, 0}, {20, 40}, {30, 40}}));
  connect(disturbance_torque, disturbance.tau) annotation (Line(points = {{-120, -40}, {-72, -40}}, color = {0, 0, 127}));
  connect(disturbance.flange, joint.flange_b) annotation (Line(points = {{-50, -40}, {0, -40}, {0, 0}}));
  connect(joint.flange_b, flange) annotation (Line(points = {{0, 0}, {0, -100}}));
  connect(encoder.angle, angle) annotation (Line(points = {{51, 44}, {70, 44}, {70, 80}, {110, 80}}, color = {0, 0, 127}));
  connect(encoder.velocity, velocity) annotation (Line(points = {{51, 36}, {80, 36}, {80, 40}, {110, 40}}, color = {0, 0, 127}));
  connect(drive.current, current) annotation (Line(points = {{-49, 6}, {-40, 6}, {-40, 20}, {90, 20}, {90, 0}, {110, 0}}, color = {0, 0, 127}));
  connect(drive.thermal_load, thermal_load) annotation (Line(points = {{-49, -4}, {-40, -4}, {-40, -60}, {80, -60}, {80, -40}, {110, -40}}, color = {0, 0, 127}));
  connect(drive.thermal_fraction, thermal_fraction) annotation (Line(points = {{-49, -8}, {-44, -8}, {-44, -80}, {110, -80}}, color = {0, 0, 127}));

  annotation (
    Documentation(info = "<html>
<p>Inputs, outputs and parameters have the names of <code>FlexArmPlant.fmu</code>. Not here: noise of the drive, the count of violations and the angle limits, which the FMU only counts by.
The equations are in <a href=\"modelica://FlexArm.Components.Arm\">Arm</a> and <a href=\"modelica://FlexArm.Components.Motor\">Motor</a>.</p>
<p>The FMU's Model Exchange integrates the same equations. Its Co-Simulation takes eq 13 as one explicit Euler step a sample, as the paper does, and differs by that.</p>
</html>"),
    Icon(graphics = {
      Rectangle(extent = {{-100, 100}, {100, -100}}, lineColor = {64, 64, 64}, fillColor = {255, 255, 255}, fillPattern = FillPattern.Solid),
      Ellipse(extent = {{-24, -26}, {24, -74}}, lineColor = {64, 64, 64}, fillColor = {192, 192, 192}, fillPattern = FillPattern.Solid),
      Polygon(points = {{-8, -40}, {8, -40}, {45, 60}, {35, 62}, {-8, -40}}, lineColor = {0, 90, 160}, fillColor = {0, 90, 160}, fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textString = "%name", textColor = {0, 0, 255})}));
end Plant;
