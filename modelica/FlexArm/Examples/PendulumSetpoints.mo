within FlexArm.Examples;
model PendulumSetpoints "Simplified pendulum: setpoints near the thermal limit (table 2)"
  extends Loop(
    set = FlexArm.Parameters.Pendulum(),
    goals = {0.3, 1.2, 0.4, 1.4, 0.2, 0.8},
    goalTimes = 0:2:10);

  annotation (
    experiment(StopTime = 12, Tolerance = 1e-8, Interval = 0.001),
    Documentation(info = "<html>
<p>Large moves of the arm of eq 32, whose motor starts warm. Plot <code>plant.thermal_fraction</code>: the planner keeps it below one.</p>
</html>"));
end PendulumSetpoints;
