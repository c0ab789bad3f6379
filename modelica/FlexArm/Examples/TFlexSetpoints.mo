within FlexArm.Examples;
model TFlexSetpoints "T-flex: setpoints, a second each (table 1, figures 10 and 11)"
  extends Loop(
    goals = {1.3201950934251279, 1.041278533100341, 1.2229753757551614, 1.3633918296340972, 1.2436525960406448,
      1.303347276679795, 0.9648486577206785, 1.2001583600741186, 1.0553366825603168, 1.2613823289854487},
    goalTimes = 0:9);

  annotation (
    experiment(StopTime = 10, Tolerance = 1e-8, Interval = 0.001),
    Documentation(info = "<html>
<p>The beginning of a sequence of the experiment <code>tracking-tflex</code>, without noise of the drive.
Plot <code>controller.setpoint</code>, <code>controller.outputs.reference_angle</code> and <code>plant.angle</code>.</p>
</html>"));
end TFlexSetpoints;
