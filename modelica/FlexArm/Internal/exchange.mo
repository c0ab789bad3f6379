within FlexArm.Internal;
impure function exchange "Gives the inputs of a sample and takes its outputs"
  extends Modelica.Icons.Function;
  input Instance instance "The controller";
  input Real now(unit = "s") "Time";
  input Real inputs[:] "Inputs";
  input Integer realCount "Number of Real outputs";
  input Integer integerCount "Number of Integer outputs";
  output Real reals[realCount] "Real outputs";
  output Integer integers[integerCount] "Integer outputs";
external "C" FlexArmController_sample(
  instance, now, inputs, size(inputs, 1), reals, size(reals, 1), integers, size(integers, 1))
  annotation (
    Include = "#include \"FlexArmController.h\"",
    IncludeDirectory = "modelica://FlexArm/Resources/Include");

  annotation (Documentation(info = "<html>
<p>Called again at an instant that was sampled already, it gives the same outputs: an event iteration is no sample.</p>
</html>"));
end exchange;
