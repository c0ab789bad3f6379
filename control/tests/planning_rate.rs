//! Planning at 20 Hz, as the paper does, and up to the rate of the feedback: what it buys, and that the limits
//! hold. Horizons last 2 s and have 40 intervals, the first of them one period long.

mod common;

use arm::Parameters;
use common::Loop;
use control::Settings;
use control::nmpc::plan::PlanStatus;
use control::nmpc::settings;

/// Periods of the plans \[s\].
const PERIODS: [f64; 4] = [0.05, 5e-3, 1e-3, 2.5e-4];

/// The same controller, planning every `period` \[s\] over 2 s.
fn every(period: f64, settings: Settings) -> Settings {
    let nmpc = settings::Settings {
        period,
        duration: 2.0,
        ..settings.nmpc
    };
    Settings { nmpc, ..settings }
}

/// What 10 s led to.
#[derive(Debug, Default)]
struct Run {
    /// Σ (goal − θ)² over the samples.
    score: f64,
    plans: u32,
    /// Plans that are neither solved nor solved for the least excess.
    unsolved: u32,
    /// Plans that took iterations.
    iterated: u32,
    iterations: u32,
    most_iterations: u32,
    /// Largest excess of the thermal load over the limit that plans keep, at the nodes where they keep it \[A²\].
    excess: f64,
    violations: u32,
}

/// 10 s with a setpoint and a disturbing torque \[N·m\] for every time \[s\].
fn run(mut closed_loop: Loop, settings: &Settings, at: impl Fn(f64) -> [f64; 2]) -> Run {
    let mut run = Run::default();
    let limit = settings.nmpc.thermal_share.powi(2) * settings.motor.thermal_limit();
    run.excess = f64::NEG_INFINITY;
    for sample in 0..(10.0 / settings.sample_period).round() as u32 {
        let [setpoint, disturbance] = at(f64::from(sample) * settings.sample_period);
        run.score += (setpoint - closed_loop.motion.angle).powi(2);
        let command = closed_loop.step(setpoint, disturbance);
        run.violations += u32::from(closed_loop.violates());
        if command.new_plan {
            run.excess = run.excess.max(command.thermal_load - limit);
            let plan = closed_loop.controller.plan();
            run.plans += 1;
            run.iterated += u32::from(plan.iterations > 0);
            run.iterations += plan.iterations;
            run.most_iterations = run.most_iterations.max(plan.iterations);
            run.unsolved += u32::from(!matches!(
                plan.status,
                PlanStatus::Solved | PlanStatus::GoalProjected | PlanStatus::ThermalSlack
            ));
        }
    }
    run
}

/// One run for every period; prints a line for each.
fn runs(
    name: &str,
    settings: Settings,
    arm: Parameters,
    angle: f64,
    at: impl Fn(f64) -> [f64; 2],
) -> [Run; 4] {
    PERIODS.map(|period| {
        let settings = every(period, settings);
        let run = run(Loop::new(&settings, arm, angle), &settings, &at);
        let mean = f64::from(run.iterations) / f64::from(run.iterated.max(1));
        eprintln!(
            "{name:<32} {:>5.0} Hz  score {:>10.3}  {:>5} of {:>5} plans iterated, {mean:>4.1} times, at most {:>2}, \
             excess {:>+9.1e} A2",
            1.0 / period,
            run.score,
            run.iterated,
            run.plans,
            run.most_iterations,
            run.excess
        );
        assert_eq!((run.unsolved, run.violations), (0, 0), "{name}, {period} s");
        run
    })
}

/// A setpoint a second.
fn setpoints(sequence: [f64; 10]) -> impl Fn(f64) -> [f64; 2] {
    move |time| [sequence[(time as usize).min(9)], 0.0]
}

#[test]
fn the_tflex_gets_there_sooner() {
    let sequence = setpoints([1.1, 1.4, 1.0, 1.3, 1.45, 0.96, 1.2, 1.5, 1.0, 1.3]);
    let runs = runs(
        "T-flex, setpoints",
        Settings::tflex(),
        Parameters::tflex(),
        1.3,
        sequence,
    );
    assert!(runs.iter().all(|run| run.excess <= 1e-6));
    assert!(runs[3].score < 0.85 * runs[0].score);
}

#[test]
fn the_pendulum_keeps_its_thermal_limit() {
    let sequence = [0.1, 1.4, 0.4, 1.5, 0.1, 1.5, 0.8, 1.3, 0.2, 1.5];
    let exact = Settings {
        arm: Parameters::pendulum(),
        ..Settings::pendulum()
    };
    for (name, settings, tolerances) in [
        // RK4 over 50 ms is off by a little more.
        ("pendulum, setpoints", exact, [1e-4, 1e-6, 1e-6, 1e-6]),
        // The torque of its feedback is not planned.
        (
            "pendulum mis-modelled, setpoints",
            Settings::pendulum(),
            [0.02; 4],
        ),
    ] {
        let arm = Parameters::pendulum();
        let runs = runs(name, settings, arm, 0.785, setpoints(sequence));
        for (run, tolerance) in runs.iter().zip(tolerances) {
            assert!(run.excess <= tolerance, "{name}");
        }
        assert!(runs.iter().all(|run| run.iterated > 20));
        assert!(runs[3].score < 0.99 * runs[0].score);
    }
}

#[test]
fn disturbances_move_the_arm_less() {
    let pulse = |setpoint: f64, torque: f64| {
        move |time: f64| {
            [
                setpoint,
                if (2.0..6.0).contains(&time) {
                    torque
                } else {
                    0.0
                },
            ]
        }
    };
    let tflex = runs(
        "T-flex, 1 N.m",
        Settings::tflex(),
        Parameters::tflex(),
        1.2,
        pulse(1.2, 1.0),
    );
    assert!(tflex[3].score < 0.25 * tflex[0].score);
    let settings = Settings::pendulum();
    let pendulum = runs(
        "pendulum, 2 N.m",
        settings,
        Parameters::pendulum(),
        0.785,
        pulse(0.785, 2.0),
    );
    assert!(pendulum[3].score < 0.8 * pendulum[0].score);
}
