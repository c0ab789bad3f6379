within FlexArm.Components;
block Controller "NMPC with feedforward, computed torque and LQR: the binary of FlexArmController as a sampled block"
  extends Modelica.Blocks.Icons.DiscreteBlock;
  parameter FlexArm.Parameters.TFlex parameters "All parameters of the controller; initial_.thermal_load alone of initial_";
  parameter Modelica.Units.SI.Time startTime = 0 "Time of the first sample; if the simulation starts later, a whole number of periods after it";
  parameter String libraries = Modelica.Utilities.Files.loadResource("modelica://FlexArm/Resources/Library")
    "Folder with a folder of binaries for each platform"
    annotation (Dialog(tab = "Advanced"));
  Modelica.Blocks.Interfaces.RealInput angle(unit = "rad") "Measured angle of the arm"
    annotation (Placement(transformation(extent = {{-140, -80}, {-100, -40}})));
  Modelica.Blocks.Interfaces.RealInput setpoint(unit = "rad") "Angle where the arm shall rest"
    annotation (Placement(transformation(extent = {{-140, 40}, {-100, 80}})));
  Modelica.Blocks.Interfaces.RealOutput torque(unit = "N.m") "Torque asked of the motor, within the peak torque"
    annotation (Placement(transformation(extent = {{100, -10}, {120, 10}})));
  FlexArm.Internal.Outputs outputs "All outputs of the FMU but the planned trajectory";
protected
  FlexArm.Internal.Instance instance = FlexArm.Internal.Instance(
    libraries, FlexArm.Internal.Contract.token, parameters.sample_period,
    FlexArm.Internal.Contract.inputs, FlexArm.Internal.Contract.realOutputs, FlexArm.Internal.Contract.integerOutputs,
    FlexArm.Internal.Contract.realParameters, FlexArm.Internal.Contract.reals(parameters),
    FlexArm.Internal.Contract.integerParameters, FlexArm.Internal.Contract.integers(parameters),
    FlexArm.Internal.Contract.booleanParameters, FlexArm.Internal.Contract.booleans(parameters)) "The loaded binary";
equation
  when sample(startTime, parameters.sample_period) then
    outputs = FlexArm.Internal.Contract.sample(instance, time, angle, setpoint);
  end when;
  torque = outputs.torque;

  annotation (Documentation(info = "<html>
<p>Plans each move with a nonlinear model predictive controller, twenty times a second by default,</p>
<pre>
minimise    &int; q_&theta; (&theta; &minus; &theta;_goal)&sup2; + q_&omega; &omega;&sup2; + q_int e&sup2; + q_T T&sup2; + q_u u&sup2; dt                      (eq 28)
subject to  d&omega;/dt = u + feedback,  dT/dt = ((&tau;(&theta;, &omega;r, u)/Ki)&sup2; &minus; T)/T_tc            (eqs 20 to 22)
            &theta;_lower + &sigma; &le; &theta;r &le; &theta;_upper &minus; &sigma;,  T &le; (0.85 I_lim)&sup2;,  rest at the goal  (eqs 25 to 27)
</pre>
<p>and follows the plan 4000 times a second with feedforward, computed torque and LQR. Samples <code>angle</code> and <code>setpoint</code> at the sample instants; the torque
applies at once and holds until the next: a loop without delay.</p>
<p>Set parameters as in the FMU: <code>controller(parameters(nmpc(horizon = 20)))</code>, or <code>controller(parameters = FlexArm.Parameters.Pendulum())</code>.</p>
</html>"));
end Controller;
