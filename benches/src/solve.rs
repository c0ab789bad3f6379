//! Single plans on the reference instances, cold.

use std::path::Path;

use control::Settings;
use control::nmpc::planner::Planner;
use control::nmpc::problem::{FeedbackModel, Initial};
use serde_json::Value;

use crate::Failure;
use crate::statistics::{Durations, time};

const REPEATS: usize = 40;

/// Prints the solve times over `golden/nmpc_*.json`.
pub fn run(golden: &Path) -> Result<(), Failure> {
    println!(
        "NMPC, N = 40, 15 instances each, cold   median        p99        max   iterations (max)"
    );
    for (arm, settings) in [
        ("pendulum", Settings::pendulum()),
        ("tflex", Settings::tflex()),
    ] {
        let (durations, best, iterations) = measure(arm, &settings, golden)?;
        println!(
            "  {arm:<10} single calls          {} {iterations:>10}",
            durations.row()
        );
        println!("  {arm:<10} best of {REPEATS} per instance {}", best.row());
    }
    Ok(())
}

fn measure(
    arm: &str,
    settings: &Settings,
    golden: &Path,
) -> Result<(Durations, Durations, u32), Failure> {
    let text = std::fs::read_to_string(golden.join(format!("nmpc_{arm}.json")))?;
    let reference: Value = serde_json::from_str(&text)?;
    let number = |key: &str| reference[key].as_f64().ok_or("a gain is missing");
    let feedback = FeedbackModel {
        inertia: settings.feedback.inertia,
        gain_angle: number("Kp")?,
        gain_velocity: number("Kd")?,
        gain_integral: 0.0,
    };
    let new = || {
        Planner::new(
            &settings.nmpc,
            &settings.arm,
            &settings.motor,
            &settings.limits,
            &feedback,
        )
        .map_err(|errors| errors[0].to_string())
    };
    let mut planner = new()?;
    let cold = new()?;
    let (mut all, mut best, mut most) = (Vec::new(), Vec::new(), 0);
    for case in reference["cases"].as_array().ok_or("no cases")? {
        let x = case["x0"].as_array().ok_or("no x0")?;
        let x = |i: usize| x[i].as_f64().unwrap_or(f64::NAN);
        let initial = Initial {
            angle: x(0),
            velocity: x(1),
            reference_angle: x(2),
            reference_velocity: x(3),
            integral: x(4),
            feedback_integral: 0.0,
            thermal_load: x(5),
        };
        let goal = case["goal"].as_f64().ok_or("no goal")?;
        let mut durations = Vec::new();
        for _ in 0..REPEATS {
            planner.set_state(cold.state());
            let (duration, iterations) = time(|| planner.plan(&initial, goal).iterations);
            durations.push(duration);
            most = most.max(iterations);
        }
        best.extend(durations.iter().min());
        all.append(&mut durations);
    }
    Ok((Durations::new(all), Durations::new(best), most))
}
