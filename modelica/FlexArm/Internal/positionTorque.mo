within FlexArm.Internal;
function positionTorque "g of eq 12: torque that holds the arm at an angle, hysteresis excluded"
  extends Modelica.Icons.Function;
  input Real angle(unit = "rad") "Angle of the arm";
  input Real stiffness(unit = "N.m/rad") "k";
  input Real offset(unit = "N.m") "o";
  input Real cogging_frequency(unit = "1/rad") "w";
  input Real cogging_cos[9](each unit = "N.m") "a_1 to a_9";
  input Real cogging_sin[9](each unit = "N.m") "b_1 to b_9";
  output Real torque(unit = "N.m") "g";
algorithm
  torque := stiffness*angle + offset
    + sum(cogging_cos[i]*cos(i*cogging_frequency*angle) + cogging_sin[i]*sin(i*cogging_frequency*angle) for i in 1:9);

  annotation (
    smoothOrder = 100,
    Inline = true,
    Documentation(info = "<html>
<pre>
g(&theta;) = k&middot;&theta; + o + &Sigma; a_i&middot;cos(i&middot;w&middot;&theta;) + b_i&middot;sin(i&middot;w&middot;&theta;),  i = 1 &hellip; 9     (eq 12)
</pre>
</html>"));
end positionTorque;
