//! The planner against optima that IPOPT found for the same problems (`golden/nmpc_*.json`).

mod nmpc_arms;

use control::nmpc::plan::PlanStatus;
use control::nmpc::problem::Initial;
use control::nmpc::settings::Method;
use nmpc_arms::{pendulum, tflex};
use serde_json::Value;

/// A start, its goal, and IPOPT's answer.
struct Case {
    initial: Initial,
    goal: f64,
    cost: f64,
    moves: Vec<f64>,
}

fn cases(model: &str) -> Vec<Case> {
    let folder = env!("CARGO_MANIFEST_DIR");
    let path = format!("{folder}/tests/golden/nmpc_{model}.json");
    let text = std::fs::read_to_string(path).expect("golden file");
    let golden: Value = serde_json::from_str(&text).expect("JSON");
    let number = |value: &Value| value.as_f64().expect("number");
    let numbers = |value: &Value| -> Vec<f64> {
        value
            .as_array()
            .expect("array")
            .iter()
            .map(number)
            .collect()
    };
    let cases = golden["cases"].as_array().expect("cases").iter();
    cases
        .map(|case| {
            let x = numbers(&case["x0"]);
            Case {
                initial: Initial {
                    angle: x[0],
                    velocity: x[1],
                    reference_angle: x[2],
                    reference_velocity: x[3],
                    integral: x[4],
                    feedback_integral: 0.0,
                    thermal_load: x[5],
                },
                goal: number(&case["goal"]),
                cost: number(&case["cost"]),
                moves: numbers(&case["U"]),
            }
        })
        .collect()
}

fn check(model: &str, solver: Method, most_convex_problems: u32, most_iterations: u32) {
    let mut arm = match model {
        "pendulum" => pendulum(),
        _ => tflex(),
    };
    arm.settings.solver = solver;
    let mut planner = arm.planner();
    let cases = cases(model);
    assert_eq!(cases.len(), 15);
    for (i, case) in cases.iter().enumerate() {
        // Each case is a cold start.
        planner.set_state(&Default::default());
        let plan = planner.plan(&case.initial, case.goal);
        assert_eq!(plan.status, PlanStatus::Solved, "{model} {i}");
        assert_eq!(plan.goal, case.goal);

        let largest = case
            .moves
            .iter()
            .fold(0.0, |most, u| f64::max(most, u.abs()));
        let pairs = plan.moves.iter().zip(&case.moves);
        let difference = pairs.fold(0.0, |most, (u, v)| f64::max(most, (u - v).abs()));
        assert!(
            difference <= 1e-3 * largest,
            "{model} {i}: moves differ by {difference}"
        );
        let cost = plan.trajectory.cost / case.cost - 1.0;
        assert!(cost.abs() <= 1e-6, "{model} {i}: cost differs by {cost:e}");
        let excess = plan.trajectory.excess;
        assert!(excess <= 1e-6, "{model} {i}: thermal excess {excess:e}");
        let end = plan.trajectory.angle[40] - case.goal;
        assert!(end.abs() <= 1e-9, "{model} {i}: misses the goal by {end:e}");

        // The work, so that a slower algorithm fails.
        assert!(plan.convex_problems <= most_convex_problems, "{model} {i}");
        assert!(
            plan.iterations <= most_iterations,
            "{model} {i}: {}",
            plan.iterations
        );
    }
}

#[test]
fn pendulum_plans_of_the_interior_point_equal_the_golden_ones() {
    check("pendulum", Method::Riccati, 0, 12);
}

#[test]
fn pendulum_plans_of_clarabel_equal_the_golden_ones() {
    check("pendulum", Method::Clarabel, 2, 36);
}

/// No limit is active on these: the closed form needs no solver.
#[test]
fn tflex_plans_equal_the_golden_ones() {
    check("tflex", Method::Automatic, 0, 0);
}
