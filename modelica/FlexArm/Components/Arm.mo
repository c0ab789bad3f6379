within FlexArm.Components;
model Arm "Flexure arm: inertia, damping, stiffness, cogging and Dahl hysteresis (eqs 12, 13)"
  parameter FlexArm.Parameters.Arm arm "Parameter vector of eq 12";
  parameter Modelica.Units.SI.Angle angle_start = 1.3 "Angle at the start";
  parameter Modelica.Units.SI.AngularVelocity velocity_start = 0 "Angular velocity at the start";
  constant Modelica.Units.SI.Angle displacement = 1.5e-2 "Displacement of the hysteresis (eq 13)";
  Modelica.Mechanics.Rotational.Interfaces.Flange_a flange_a "Where the motor drives the arm"
    annotation (Placement(transformation(extent = {{-110, -10}, {-90, 10}})));
  Modelica.Mechanics.Rotational.Interfaces.Flange_b flange_b "Where loads and disturbances act"
    annotation (Placement(transformation(extent = {{90, -10}, {110, 10}})));
  Modelica.Units.SI.Angle angle(start = angle_start, fixed = true, stateSelect = StateSelect.always) "Angle of the arm";
  Modelica.Units.SI.AngularVelocity velocity(start = velocity_start, fixed = true, stateSelect = StateSelect.always) "Angular velocity";
  Real hysteresis_state(unit = "1", start = 0, fixed = true) "State z of the Dahl hysteresis, between -1 and 1";
  Modelica.Units.SI.Torque position_torque "Torque g that holds the arm, hysteresis excluded";
protected
  Real sums[10](each unit = "N.m") "Position torque up to each harmonic";
equation
  flange_a.phi = angle;
  flange_b.phi = angle;
  der(angle) = velocity;
  // g of eq 12, a harmonic at a time
  sums[1] = arm.stiffness*angle + arm.offset;
  for i in 1:9 loop
    sums[i + 1] = sums[i] + arm.cogging_cos[i]*cos(i*arm.cogging_frequency*angle) + arm.cogging_sin[i]*sin(i*arm.cogging_frequency*angle);
  end for;
  position_torque = sums[10];
  // Eq 12
  arm.inertia*der(velocity) = flange_a.tau + flange_b.tau - arm.damping*velocity - position_torque - arm.hysteresis*hysteresis_state;
  // Eq 13; the absolute value has a kink at rest but no jump
  der(hysteresis_state) = (velocity - smooth(0, abs(velocity))*hysteresis_state)/(2*displacement);

  annotation (
    Documentation(info = "<html>
<p>A rigid arm on a flexure joint; its angle is absolute, that of the encoder.</p>
<pre>
J&middot;d&omega;/dt = &tau;_a + &tau;_b &minus; d&middot;&omega; &minus; g(&theta;) &minus; C&middot;z                          (eq 12)
g(&theta;)    = k&middot;&theta; + o + &Sigma; a_i&middot;cos(i&middot;w&middot;&theta;) + b_i&middot;sin(i&middot;w&middot;&theta;),  i = 1 &hellip; 9
dz/dt   = (&omega; &minus; |&omega;|&middot;z)/(2&middot;&delta;),  &delta; = 0.015 rad                       (eq 13, in continuous time)
</pre>
<p>J, d, k, o, C, w, a and b are <code>arm.inertia</code>, <code>damping</code>, <code>stiffness</code>, <code>offset</code>, <code>hysteresis</code>,
<code>cogging_frequency</code>, <code>cogging_cos</code> and <code>cogging_sin</code>; the torques are those of both flanges.
The simplified pendulum is the same arm with one harmonic (<a href=\"modelica://FlexArm.Parameters.Pendulum\">Parameters.Pendulum</a>).</p>
</html>"),
    Icon(graphics = {
      Rectangle(extent = {{-90, 10}, {90, -10}}, lineColor = {64, 64, 64}, fillColor = {192, 192, 192}, fillPattern = FillPattern.HorizontalCylinder),
      Ellipse(extent = {{-24, 24}, {24, -24}}, lineColor = {64, 64, 64}, fillColor = {255, 255, 255}, fillPattern = FillPattern.Solid),
      Polygon(points = {{-8, 10}, {8, 10}, {5, 90}, {-5, 90}, {-8, 10}}, lineColor = {0, 90, 160}, fillColor = {0, 90, 160}, fillPattern = FillPattern.Solid),
      Line(points = {{-40, -40}, {-20, -60}, {0, -40}, {20, -60}, {40, -40}}, color = {64, 64, 64}),
      Text(extent = {{-150, -70}, {150, -100}}, textString = "%name", textColor = {0, 0, 255})}));
end Arm;
