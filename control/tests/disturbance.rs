//! Table 3: rejection of disturbances with integrators in the feedback, in the planner, in both.

mod common;

use arm::Parameters;
use common::{Loop, feedback_of_equation_36};
use control::Settings;
use control::feedback::Law;
use control::nmpc::problem::Weights;
use control::nmpc::settings;

/// Squared distance to 1 rad, summed over the samples of 25 s; also with every torque one sample late.
fn cost(law: Law, planner_knows_integrator: bool, weight_integral: f64) -> [f64; 2] {
    let settings = Settings {
        initial_thermal_load: 0.0,
        feedback: feedback_of_equation_36(law),
        nmpc: settings::Settings {
            weights: Weights {
                angle: 1.0,
                velocity: 1e-3,
                integral: weight_integral,
                thermal: 0.0,
                acceleration: 1e-3,
            },
            thermal_limit: false,
            models_integrator: planner_knows_integrator,
            ..settings::Settings::default()
        },
        ..Settings::pendulum()
    };
    let closed_loop = || Loop::new(&settings, Parameters::pendulum(), 1.0);
    [closed_loop(), closed_loop().delayed()].map(|mut closed_loop| {
        (0..100_000)
            .map(|sample| {
                let disturbance = match f64::from(sample) * settings.sample_period {
                    t if (5.0..5.25).contains(&t) => 30.0,
                    t if (12.0..20.0).contains(&t) => 27.0,
                    _ => 0.0,
                };
                let error = closed_loop.motion.angle - 1.0;
                closed_loop.step(1.0, disturbance);
                error * error
            })
            .sum()
    })
}

fn reproduces(column: &str, got: [f64; 2]) {
    let golden: serde_json::Value =
        serde_json::from_str(include_str!("golden/disturbance.json")).unwrap();
    let expected = golden["independent_python_simulation"][column]
        .as_f64()
        .unwrap();
    eprintln!("{column}: {got:.1?}, reference {expected}");
    for got in got {
        assert!(
            (got / expected - 1.0).abs() < 0.01,
            "{column}: {got} for {expected}"
        );
    }
}

#[test]
fn feedback_and_planner_without_integrator() {
    reproduces("LQR/MPC", cost(Law::Lqr, false, 0.0));
}

#[test]
fn integrator_in_the_feedback() {
    reproduces("LQRI/MPC", cost(Law::Lqri, false, 0.0));
}

#[test]
fn integrator_in_the_feedback_and_known_to_the_planner() {
    reproduces("LQRII/MPC", cost(Law::Lqri, true, 0.0));
}

#[test]
fn integrator_in_the_planner() {
    reproduces("LQR/MPCI", cost(Law::Lqr, false, 10.0));
}

#[test]
fn integrators_in_feedback_and_planner() {
    reproduces("LQRI/MPCI", cost(Law::Lqri, false, 10.0));
}

#[test]
fn integrators_in_both_and_known_to_the_planner() {
    reproduces("LQRII/MPCI", cost(Law::Lqri, true, 10.0));
}
