//! Tables 1 and 2: tracking of setpoint sequences, against an independent simulation of the same sequences.

mod common;

use arm::Parameters;
use common::{Loop, Score, track, with_profile};
use control::Settings;
use control::feedback::Law;
use serde_json::Value;

struct Run {
    label: String,
    interval: f64,
    setpoints: Vec<f64>,
    golden: Value,
}

fn runs(json: &str) -> Vec<Run> {
    let golden: Value = serde_json::from_str(json).unwrap();
    let numbers = |v: &Value| {
        v.as_array()
            .unwrap()
            .iter()
            .map(|x| x.as_f64().unwrap())
            .collect()
    };
    golden["runs"]
        .as_array()
        .unwrap()
        .iter()
        .map(|run| Run {
            label: format!("sequence {}, {} s", run["sequence"], run["interval_s"]),
            interval: run["interval_s"].as_f64().unwrap(),
            setpoints: numbers(&run["setpoints_rad"]),
            golden: run.clone(),
        })
        .collect()
}

fn pendulum() -> Vec<Run> {
    runs(include_str!("golden/setpoint_tracking_pendulum.json"))
}

fn tflex() -> Vec<Run> {
    runs(include_str!("golden/setpoint_tracking_tflex.json"))
}

fn reproduces(run: &Run, score: &Score, expected: &Value, tolerance: f64) {
    let expected = expected.as_f64().unwrap();
    let deviation = score.cost / expected - 1.0;
    eprintln!(
        "{}: {score:.3?}, reference {expected:.3} ({:+.3} %)",
        run.label,
        100.0 * deviation
    );
    assert!(
        deviation.abs() < tolerance,
        "{}: {score:?} for {expected}",
        run.label
    );
}

/// The planner reproduces cost and causes no violation; where the thermal limit bites, two solvers may
/// spend the last of the budget differently. The largest deviation, 1 % less than the pendulum's
/// sequence 21 at 3 s, lies in the reference: IPOPT, run again on that sequence, gives 1520.961 as well.
fn nmpc_reproduces(run: &Run, score: &Score) {
    let golden = &run.golden["nmpc"];
    let slack = golden["solves_that_needed_thermal_slack"].as_u64().unwrap() > 0;
    reproduces(run, score, &golden["cost"], if slack { 0.02 } else { 0.01 });
    assert_eq!(score.violations, 0, "{}", run.label);
}

#[test]
fn tflex_follows_the_planner() {
    for run in tflex() {
        let score = track(Loop::tflex(), &run.setpoints, run.interval);
        nmpc_reproduces(&run, &score);
        reproduces(&run, &score, &run.golden["nmpc"]["cost"], 1e-3);
    }
}

#[test]
fn pendulum_follows_the_planner() {
    for run in pendulum() {
        let closed_loop = Loop::pendulum(&Settings::pendulum());
        nmpc_reproduces(&run, &track(closed_loop, &run.setpoints, run.interval));
    }
}

/// The baseline of the reference runs: a PID of the LQR's bandwidth.
fn baseline(settings: Settings, max_acceleration: f64) -> Settings {
    let mut settings = with_profile(settings, max_acceleration);
    settings.feedback.law = Law::Pid;
    settings
}

#[test]
fn pendulum_follows_the_profile() {
    let settings = baseline(Settings::pendulum(), 1.9973);
    for run in pendulum() {
        let score = track(Loop::pendulum(&settings), &run.setpoints, run.interval);
        let expected = &run.golden["profile"]["single 0.85: (0.85*Ilim*Ki-tau_th)/I"]["cost"];
        reproduces(&run, &score, expected, 1e-3);
    }
}

#[test]
fn tflex_follows_the_profile() {
    let range = 32_f64.to_radians();
    for (name, max_acceleration) in [
        ("66", 66.0),
        ("whole range in 0.5 s", 8.0 * range / f64::powi(0.5, 2)),
        ("whole range in 0.66 s", 8.0 * range / f64::powi(0.66, 2)),
    ] {
        let settings = baseline(Settings::tflex(), max_acceleration);
        for run in tflex() {
            let closed_loop = Loop::new(&settings, Parameters::tflex(), 1.30);
            let score = track(closed_loop, &run.setpoints, run.interval);
            reproduces(&run, &score, &run.golden["profile"][name]["cost"], 1e-3);
        }
    }
}

/// The ratios of tables 1 and 2: the planner beats the profile by as much as in the paper.
#[test]
fn planner_beats_the_profile() {
    let ratio = |closed_loop: Loop, follower: Loop, run: &Run| {
        let planned = track(closed_loop, &run.setpoints, run.interval).cost;
        track(follower, &run.setpoints, run.interval).cost / planned
    };
    for run in pendulum() {
        let profile = Loop::pendulum(&baseline(Settings::pendulum(), 1.9973));
        let ratio = ratio(Loop::pendulum(&Settings::pendulum()), profile, &run);
        eprintln!("pendulum, {}: {ratio:.2}", run.label);
        assert!((3.2..5.2).contains(&ratio), "{}: {ratio}", run.label);
    }
    for run in tflex() {
        let settings = baseline(Settings::tflex(), 46.5);
        let profile = Loop::new(&settings, Parameters::tflex(), 1.30);
        let ratio = ratio(Loop::tflex(), profile, &run);
        eprintln!("T-flex, {}: {ratio:.2}", run.label);
        assert!((1.7..2.0).contains(&ratio), "{}: {ratio}", run.label);
    }
}

/// A host that steps controller and arm side by side delays every torque by one sample.
#[test]
fn one_sample_of_delay_costs_half_a_percent_at_most() {
    let compare = |make: &dyn Fn() -> Loop, run: &Run| {
        let prompt = track(make(), &run.setpoints, run.interval).cost;
        let delayed = track(make().delayed(), &run.setpoints, run.interval);
        let loss = delayed.cost / prompt - 1.0;
        eprintln!("{}: {:+.3} %", run.label, 100.0 * loss);
        assert!(loss.abs() < 0.005, "{}: {loss}", run.label);
        assert_eq!(delayed.violations, 0, "{}", run.label);
    };
    for run in pendulum() {
        compare(&|| Loop::pendulum(&Settings::pendulum()), &run);
    }
    for run in tflex() {
        compare(&Loop::tflex, &run);
    }
}
