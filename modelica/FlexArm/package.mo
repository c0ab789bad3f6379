within;
package FlexArm "Precision flexure arm and its nonlinear model predictive controller"
  extends Modelica.Icons.Package;

  annotation (
    version = "@version@",
    uses(Modelica(version = "4.0.0")),
    Documentation(info = "<html>
<p>A motor on a flexure moves an arm between setpoints as fast as it can, without ever leaving its angle range or overheating, while cogging,
hysteresis and an imperfect model push it off course.</p>
<ul>
<li><a href=\"modelica://FlexArm.Components\">Components</a>: arm, motor and encoder in Modelica, on the flanges of <code>Modelica.Mechanics.Rotational</code>,
and the controller as a sampled block around the binary of <code>FlexArmController.fmu</code>.</li>
<li><a href=\"modelica://FlexArm.Examples\">Examples</a>: the connected loops of the paper. Start with
<a href=\"modelica://FlexArm.Examples.TFlexSetpoints\">TFlexSetpoints</a>.</li>
<li><a href=\"modelica://FlexArm.Parameters\">Parameters</a> and <a href=\"modelica://FlexArm.Types\">Types</a>: every parameter with unit, default and range, as the FMUs declare them.</li>
</ul>
<p>Names are those of the FMUs. Where such a name is taken in Modelica (<code>initial</code>, <code>model</code>, <code>terminal</code>) it ends in an underscore.</p>
<p>Source of the model, the controller and the examples: <em>MPC design for a precision, flexure based, pendulum</em>, MSc Systems &amp; Control, Universiteit Twente.
&quot;eq n&quot; points into it.</p>
<p>Licensed under MIT or Apache-2.0, as you like.</p>
</html>"));
end FlexArm;
