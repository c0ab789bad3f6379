//! Single plans on the reference instances, cold.

use std::path::Path;

use control::nmpc::plan::PlannerState;
use serde_json::Value;

use crate::Failure;
use crate::planners::{ARMS, SOLVERS, initial, planner};
use crate::statistics::{Durations, time};

const REPEATS: usize = 40;

/// What was measured of an arm and a solver.
struct Measured {
    /// All calls.
    calls: Durations,
    /// The least of the calls of each instance.
    best: Durations,
    /// The least of the calls of each instance whose closed form exceeds a limit; none: there is no such.
    limited: Option<Durations>,
    most_iterations: u32,
}

/// Prints the solve times over `golden/nmpc_*.json`.
pub fn run(golden: &Path) -> Result<(), Failure> {
    println!(
        "NMPC, N = 40, 15 instances each, cold                  median        p99        max   iterations (max)"
    );
    for arm in ARMS {
        for solver in SOLVERS {
            let measured = measure(arm, solver, golden)?;
            let name = format!("{arm}, {solver}");
            let row = measured.calls.row();
            println!(
                "  {name:<20} single calls           {row} {:>10}",
                measured.most_iterations
            );
            let row = measured.best.row();
            println!("  {name:<20} best of {REPEATS}             {row}");
            if let Some(limited) = measured.limited {
                let row = limited.row();
                println!("  {name:<20} best of {REPEATS}, at a limit {row}");
            }
        }
    }
    Ok(())
}

fn measure(arm: &str, solver: &str, golden: &Path) -> Result<Measured, Failure> {
    let text = std::fs::read_to_string(golden.join(format!("nmpc_{arm}.json")))?;
    let reference: Value = serde_json::from_str(&text)?;
    let mut planner = planner(arm, solver)?;
    let cold = PlannerState::default();
    let (mut calls, mut best, mut limited) = (Vec::new(), Vec::new(), Vec::new());
    let mut most_iterations = 0;
    for case in reference["cases"].as_array().ok_or("no cases")? {
        let initial = initial(&case["x0"])?;
        let goal = case["goal"].as_f64().ok_or("no goal")?;
        let (mut durations, mut iterations) = (Vec::new(), 0);
        for _ in 0..REPEATS {
            planner.set_state(&cold);
            let duration;
            (duration, iterations) = time(|| planner.plan(&initial, goal).iterations);
            durations.push(duration);
        }
        most_iterations = most_iterations.max(iterations);
        best.extend(durations.iter().min());
        if iterations > 0 {
            limited.extend(durations.iter().min());
        }
        calls.append(&mut durations);
    }
    Ok(Measured {
        calls: Durations::new(calls),
        best: Durations::new(best),
        limited: (!limited.is_empty()).then(|| Durations::new(limited)),
        most_iterations,
    })
}
