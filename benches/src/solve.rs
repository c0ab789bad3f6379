//! Single plans on the reference instances, cold.

use std::path::Path;

use control::nmpc::planner::PlannerState;
use serde_json::Value;

use crate::Failure;
use crate::planners::{ARMS, SOLVERS, initial, planner};
use crate::statistics::{Durations, time};

const REPEATS: usize = 40;

/// Prints the solve times over `golden/nmpc_*.json`.
pub fn run(golden: &Path) -> Result<(), Failure> {
    println!(
        "NMPC, N = 40, 15 instances each, cold   median        p99        max   iterations (max)"
    );
    for arm in ARMS {
        let (durations, best, iterations) = measure(arm, golden)?;
        println!(
            "  {arm:<10} single calls          {} {iterations:>10}",
            durations.row()
        );
        println!("  {arm:<10} best of {REPEATS} per instance {}", best.row());
    }
    Ok(())
}

fn measure(arm: &str, golden: &Path) -> Result<(Durations, Durations, u32), Failure> {
    let text = std::fs::read_to_string(golden.join(format!("nmpc_{arm}.json")))?;
    let reference: Value = serde_json::from_str(&text)?;
    let mut planner = planner(arm, SOLVERS[0])?;
    let cold = PlannerState::default();
    let (mut all, mut best, mut most) = (Vec::new(), Vec::new(), 0);
    for case in reference["cases"].as_array().ok_or("no cases")? {
        let initial = initial(&case["x0"])?;
        let goal = case["goal"].as_f64().ok_or("no goal")?;
        let mut durations = Vec::new();
        for _ in 0..REPEATS {
            planner.set_state(&cold);
            let (duration, iterations) = time(|| planner.plan(&initial, goal).iterations);
            durations.push(duration);
            most = most.max(iterations);
        }
        best.extend(durations.iter().min());
        all.append(&mut durations);
    }
    Ok((Durations::new(all), Durations::new(best), most))
}
