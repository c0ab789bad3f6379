within FlexArm.Internal;
class Instance "An instance of the controller's binary"
  extends ExternalObject;

  function constructor "Loads the binary and sets its parameters"
    extends Modelica.Icons.Function;
    input String libraries "Folder with a folder of binaries for each platform";
    input String token "What the binary must be made from";
    input Real period "Sample period";
    input Integer inputs[:] "Value references of the inputs";
    input Integer realOutputs[:] "Value references of the Real outputs";
    input Integer integerOutputs[:] "Value references of the Integer outputs";
    input Integer realParameters[:] "Value references of the Real parameters";
    input Real reals[size(realParameters, 1)] "Their values";
    input Integer integerParameters[:] "Value references of the Integer parameters";
    input Integer integers[size(integerParameters, 1)] "Their values";
    input Integer booleanParameters[:] "Value references of the Boolean parameters";
    input Boolean booleans[size(booleanParameters, 1)] "Their values";
    output Instance instance "The controller";
  external "C" instance = FlexArmController_new(
    libraries, token, period,
    inputs, size(inputs, 1), realOutputs, size(realOutputs, 1), integerOutputs, size(integerOutputs, 1),
    realParameters, reals, size(realParameters, 1),
    integerParameters, integers, size(integerParameters, 1),
    booleanParameters, booleans, size(booleanParameters, 1))
    annotation (
      Include = "#include \"FlexArmController.h\"",
      IncludeDirectory = "modelica://FlexArm/Resources/Include");
    annotation (Documentation(info = "<html><p>Errors of the binary end the simulation with its own words.</p></html>"));
  end constructor;

  function destructor "Frees the instance and what it loaded"
    extends Modelica.Icons.Function;
    input Instance instance "The controller";
  external "C" FlexArmController_free(instance)
    annotation (
      Include = "#include \"FlexArmController.h\"",
      IncludeDirectory = "modelica://FlexArm/Resources/Include");
    annotation (Documentation(info = "<html><p>Called by the tool at the end of the simulation.</p></html>"));
  end destructor;

  annotation (Documentation(info = "<html>
<p>The binary of <code>FlexArmController.fmu</code>, driven through its FMI 2.0 Co-Simulation functions. It is loaded when the simulation starts and not
linked: its <code>fmi2*</code> functions would otherwise be taken for those of an FMU that the tool exports or imports.</p>
</html>"));
end Instance;
