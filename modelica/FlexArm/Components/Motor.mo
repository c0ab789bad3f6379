within FlexArm.Components;
model Motor "Torque motor with its saturation and its thermal load (eqs 10, 19, 20)"
  parameter FlexArm.Parameters.Motor motor "Torque constant, thermal time constant and limits";
  parameter Real thermal_load_start(unit = "A2") = 0 "Thermal load at the start";
  Modelica.Blocks.Interfaces.RealInput torque(unit = "N.m") "Torque asked of the motor"
    annotation (Placement(transformation(extent = {{-140, -20}, {-100, 20}})));
  Modelica.Mechanics.Rotational.Interfaces.Flange_b flange "What the motor drives"
    annotation (Placement(transformation(extent = {{90, -10}, {110, 10}})));
  Modelica.Blocks.Interfaces.RealOutput current(unit = "A") "Motor current"
    annotation (Placement(transformation(extent = {{100, 50}, {120, 70}})));
  Modelica.Blocks.Interfaces.RealOutput thermal_load(unit = "A2", start = thermal_load_start, fixed = true)
    "Thermal load: filtered square of the current"
    annotation (Placement(transformation(extent = {{100, -50}, {120, -30}})));
  Modelica.Blocks.Interfaces.RealOutput thermal_fraction(unit = "1") "Thermal load divided by its limit"
    annotation (Placement(transformation(extent = {{100, -90}, {120, -70}})));
equation
  // The drive gives no more than the peak torque (appendix B.1)
  flange.tau = -smooth(0, max(-motor.peak_torque, min(motor.peak_torque, torque)));
  // Eq 10
  current = -flange.tau/motor.torque_constant;
  // Eq 20
  motor.thermal_time_constant*der(thermal_load) = current^2 - thermal_load;
  // Eq 19: at most one
  thermal_fraction = thermal_load/motor.continuous_current^2;

  annotation (
    Documentation(info = "<html>
<p>An ideal source of torque that saturates, and heats with the square of its current.</p>
<pre>
&tau; = clamp(torque, &plusmn;peak_torque),   i = &tau;/Ki                  (eq 10, appendix B.1)
dT/dt = (i&sup2; &minus; T)/T_tc,   T &le; I_lim&sup2;                     (eqs 19, 20)
</pre>
<p>Ki, T_tc and I_lim are <code>motor.torque_constant</code>, <code>thermal_time_constant</code> and <code>continuous_current</code>. The limit is not enforced:
<code>thermal_fraction</code> above one tells that the controller failed. Noise of the drive is left out; add a source to <code>torque</code>.</p>
</html>"),
    Icon(graphics = {
      Rectangle(extent = {{-80, 60}, {60, -60}}, lineColor = {64, 64, 64}, fillColor = {0, 90, 160}, fillPattern = FillPattern.HorizontalCylinder, radius = 10),
      Rectangle(extent = {{60, 10}, {100, -10}}, lineColor = {64, 64, 64}, fillColor = {192, 192, 192}, fillPattern = FillPattern.HorizontalCylinder),
      Text(extent = {{-60, 40}, {40, -40}}, textString = "M", textColor = {255, 255, 255}),
      Text(extent = {{-150, 110}, {150, 70}}, textString = "%name", textColor = {0, 0, 255})}));
end Motor;
