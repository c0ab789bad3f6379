within FlexArm.Components;
model Encoder "Ideal encoder: angle and angular velocity of a flange"
  Modelica.Mechanics.Rotational.Interfaces.Flange_a flange "What is measured"
    annotation (Placement(transformation(extent = {{-110, -10}, {-90, 10}})));
  Modelica.Blocks.Interfaces.RealOutput angle(unit = "rad") "Absolute angle"
    annotation (Placement(transformation(extent = {{100, 30}, {120, 50}})));
  Modelica.Blocks.Interfaces.RealOutput velocity(unit = "rad/s") "Angular velocity"
    annotation (Placement(transformation(extent = {{100, -50}, {120, -30}})));
equation
  flange.tau = 0;
  angle = flange.phi;
  velocity = der(flange.phi);

  annotation (
    Documentation(info = "<html>
<p>Measures without load and without noise. The controller samples the angle itself and derives its velocity from two samples, as the paper does.</p>
</html>"),
    Icon(graphics = {
      Ellipse(extent = {{-70, 70}, {70, -70}}, lineColor = {64, 64, 64}, fillColor = {245, 245, 245}, fillPattern = FillPattern.Solid),
      Line(points = {{0, 0}, {30, 50}}, color = {0, 90, 160}, thickness = 1),
      Line(points = {{-90, 0}, {-70, 0}}, color = {64, 64, 64}),
      Text(extent = {{-150, 120}, {150, 80}}, textString = "%name", textColor = {0, 0, 255})}));
end Encoder;
