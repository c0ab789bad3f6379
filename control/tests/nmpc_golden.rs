//! The planner against optima that IPOPT found for the same problem (`golden/nmpc_*.json`).
use arm::{Limits, Motor, Parameters};
use control::nmpc::planner::{PlanStatus, Planner};
use control::nmpc::problem::{FeedbackModel, Initial, Weights};
use control::nmpc::settings::Settings;
use serde_json::Value;

fn planner(model: &str) -> Planner {
    let (settings, arm, motor, limits, feedback) = match model {
        "pendulum" => (
            Settings {
                weights: Weights {
                    angle: 1.0,
                    velocity: 1e-3,
                    integral: 0.0,
                    thermal: 0.0,
                    acceleration: 1e-4,
                },
                ..Settings::default()
            },
            Parameters::pendulum_mismodelled(),
            Motor::pendulum(),
            Limits::pendulum(),
            FeedbackModel {
                inertia: 1.0,
                gain_angle: 100.0,
                gain_velocity: 14.4914,
                gain_integral: 0.0,
            },
        ),
        _ => (
            Settings::default(),
            Parameters::tflex(),
            Motor::tflex(),
            Limits::tflex(),
            FeedbackModel {
                inertia: 0.0818,
                gain_angle: 31.62,
                gain_velocity: 2.756,
                gain_integral: 0.0,
            },
        ),
    };
    Planner::new(&settings, &arm, &motor, &limits, &feedback).expect("admissible")
}

#[test]
fn golden() {
    for model in ["pendulum", "tflex"] {
        let text = std::fs::read_to_string(format!(
            "{}/tests/golden/nmpc_{model}.json",
            env!("CARGO_MANIFEST_DIR")
        ))
        .expect("golden");
        let golden: Value = serde_json::from_str(&text).expect("json");
        let mut planner = planner(model);
        for case in golden["cases"].as_array().expect("cases") {
            let x: Vec<f64> = case["x0"]
                .as_array()
                .unwrap()
                .iter()
                .map(|v| v.as_f64().unwrap())
                .collect();
            let initial = Initial {
                angle: x[0],
                velocity: x[1],
                reference_angle: x[2],
                reference_velocity: x[3],
                integral: x[4],
                thermal_load: x[5],
                feedback_integral: 0.0,
            };
            let t = std::time::Instant::now();
            let plan = planner.plan(&initial, case["goal"].as_f64().unwrap());
            let dt = t.elapsed().as_secs_f64() * 1e3;
            let u: Vec<f64> = case["U"]
                .as_array()
                .unwrap()
                .iter()
                .map(|v| v.as_f64().unwrap())
                .collect();
            let umax = u.iter().fold(0.0f64, |m, u| m.max(u.abs()));
            let du = u
                .iter()
                .zip(&plan.moves)
                .fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
            let c = case["cost"].as_f64().unwrap();
            println!(
                "{model} {:?} cp {} it {} cost {:.9e} rel {:+.2e} du {:.2e} excess {:.2e} {:.3} ms",
                plan.status,
                plan.convex_problems,
                plan.iterations,
                plan.trajectory.cost,
                plan.trajectory.cost / c - 1.0,
                du / umax,
                plan.trajectory.excess,
                dt
            );
            let _ = PlanStatus::Idle;
        }
    }
}
