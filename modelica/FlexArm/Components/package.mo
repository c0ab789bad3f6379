within FlexArm;
package Components "Arm, motor, encoder and controller"
  extends Modelica.Icons.Package;

  annotation (Documentation(info = "<html>
<p><a href=\"modelica://FlexArm.Components.Plant\">Plant</a> is motor, arm and encoder connected: what <code>FlexArmPlant.fmu</code> is, noise of the drive and count of
violations left out. <a href=\"modelica://FlexArm.Components.Controller\">Controller</a> is what <code>FlexArmController.fmu</code> is.</p>
</html>"));
end Components;
