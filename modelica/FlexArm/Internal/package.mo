within FlexArm;
package Internal "What the components are made of; not for use by others"
  extends Modelica.Icons.InternalPackage;

  annotation (Documentation(info = "<html>
<p>The C interface of the controller's binary. Names and contents may change with any version.</p>
</html>"));
end Internal;
