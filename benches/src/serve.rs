//! Plans on request, for benchmarks in other languages: one JSON object a line in, one out.
//!
//! | request | answer |
//! |---|---|
//! | `{"solvers": true}` | `solvers`, the names of the two kinds; `automatic` is the one, then the other |
//! | `{"problem": arm}` | the problem's numbers, SI units |
//! | `{"arm", "solver", "initial": [θ, ω, θr, ωr, e, T], "goal", "warm", "repeats"}` | `seconds` of each repeat, `status`, `iterations`, `convex_problems`, `cost`, `moves` of the last |
//! | any other | `error` |
//!
//! A cold plan knows no plan before it; a warm one follows the last cold plan of its arm and solver. Only
//! the plan itself is timed.

use std::collections::HashMap;
use std::io::{BufRead, Write};

use control::nmpc::plan::PlannerState;
use control::nmpc::planner::Planner;
use serde_json::{Value, json};

use crate::Failure;
use crate::planners::{SOLVERS, initial, planner};
use crate::statistics::time;

/// A planner and what it remembered after its last cold plan.
struct Served {
    planner: Planner,
    after_cold: PlannerState,
}

/// Answers until the input ends.
pub fn run() -> Result<(), Failure> {
    let mut served = HashMap::new();
    let mut out = std::io::stdout().lock();
    for line in std::io::stdin().lock().lines() {
        let answer = answer(&line?, &mut served)
            .unwrap_or_else(|failure| json!({ "error": failure.to_string() }));
        writeln!(out, "{answer}")?;
        out.flush()?;
    }
    Ok(())
}

fn answer(line: &str, served: &mut HashMap<String, Served>) -> Result<Value, Failure> {
    let request: Value = serde_json::from_str(line)?;
    if request["solvers"] == true {
        return Ok(json!({ "solvers": SOLVERS[..2] }));
    }
    if let Some(arm) = request["problem"].as_str() {
        return problem(arm);
    }
    let text = |key: &str| {
        request[key]
            .as_str()
            .ok_or_else(|| format!("{key} is missing"))
    };
    let (arm, solver) = (text("arm")?, text("solver")?);
    let key = format!("{arm} {solver}");
    if !served.contains_key(&key) {
        let new = Served {
            planner: planner(arm, solver)?,
            after_cold: PlannerState::default(),
        };
        served.insert(key.clone(), new);
    }
    let served = served.get_mut(&key).ok_or("no planner")?;
    plan(&request, served)
}

fn plan(request: &Value, served: &mut Served) -> Result<Value, Failure> {
    let start = initial(&request["initial"])?;
    let goal = request["goal"].as_f64().ok_or("goal is missing")?;
    let warm = request["warm"].as_bool().ok_or("warm is missing")?;
    let repeats = request["repeats"].as_u64().ok_or("repeats is missing")?;
    let cold = PlannerState::default();
    let mut seconds = Vec::new();
    for _ in 0..repeats.max(1) {
        let before = if warm { &served.after_cold } else { &cold };
        served.planner.set_state(before);
        let (duration, _) = time(|| served.planner.plan(&start, goal).iterations);
        seconds.push(duration.as_secs_f64());
    }
    if !warm {
        served.after_cold.clone_from(served.planner.state());
    }
    let plan = served.planner.latest();
    Ok(json!({
        "seconds": seconds,
        "status": format!("{:?}", plan.status),
        "iterations": plan.iterations,
        "convex_problems": plan.convex_problems,
        "cost": plan.trajectory.cost,
        "moves": plan.moves,
    }))
}

/// The numbers of eqs 12 and 20 to 28.
fn problem(arm: &str) -> Result<Value, Failure> {
    let planner = planner(arm, SOLVERS[0])?;
    let problem = planner.problem();
    Ok(json!({
        "version": env!("CARGO_PKG_VERSION"),
        "horizon": problem.horizon,
        "period": problem.period,
        "growth": problem.growth,
        "weight_angle": problem.weights.angle,
        "weight_velocity": problem.weights.velocity,
        "weight_integral": problem.weights.integral,
        "weight_thermal": problem.weights.thermal,
        "weight_acceleration": problem.weights.acceleration,
        "angle_lower": problem.angle_lower,
        "angle_upper": problem.angle_upper,
        "thermal_limit": problem.thermal_limit,
        "inertia": problem.arm.inertia,
        "damping": problem.arm.damping,
        "stiffness": problem.arm.stiffness,
        "offset": problem.arm.offset,
        "cogging_frequency": problem.arm.cogging_frequency,
        "cogging_cos": problem.arm.cogging_cos,
        "cogging_sin": problem.arm.cogging_sin,
        "torque_constant": problem.motor.torque_constant,
        "thermal_time_constant": problem.motor.thermal_time_constant,
        "feedback_inertia": problem.feedback.inertia,
        "gain_angle": problem.feedback.gain_angle,
        "gain_velocity": problem.feedback.gain_velocity,
    }))
}
