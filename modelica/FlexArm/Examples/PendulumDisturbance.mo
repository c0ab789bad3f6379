within FlexArm.Examples;
model PendulumDisturbance "Simplified pendulum: rejection of two pushes by a mistaken controller (table 3, LQR/MPC)"
  extends Loop(
    set = pendulum,
    belief = mistaken,
    goals = {1},
    pushes = {0, 30, 0, 27, 0},
    pushTimes = {0, 5, 5.25, 12, 20});
  parameter FlexArm.Parameters.Pendulum pendulum(initial_(angle = 1)) "The arm, at rest at 1 rad";
  parameter FlexArm.Parameters.PendulumModelError mistaken(
    nmpc(thermal_limit = false, weight_velocity = 1e-3, weight_acceleration = 1e-3),
    feedback(weight_velocity = 1e-3, weight_torque = 1e-3, weight_integral = 10)) "What the controller believes (eqs 32, 36)";

  annotation (
    experiment(StopTime = 25, Tolerance = 1e-8, Interval = 0.00025),
    Documentation(info = "<html>
<p>30 N.m for 0.25 s, then 27 N.m for 8 s. The controller's stiffness and inertia are wrong by 8 % and 3 %; the thermal limit is left out, as in the paper.
<code>mistaken.feedback.law</code> and <code>mistaken.nmpc.weight_integral</code> give the other columns of table 3.</p>
</html>"));
end PendulumDisturbance;
