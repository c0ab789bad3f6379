within FlexArm;
package Examples "The connected loops of the paper"
  extends Modelica.Icons.ExamplesPackage;

  annotation (Documentation(info = "<html>
<p>Each simulates as it is. <a href=\"modelica://FlexArm.Examples.TorqueStep\">TorqueStep</a> needs no binary.</p>
</html>"));
end Examples;
