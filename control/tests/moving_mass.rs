//! The moving mass of sec 2.4.2 (eq 8, figure 2), by parameters alone: m = J = 1, a bounded force, N = 5, from
//! x = 1 to 0.01 with x ≥ 0.

mod common;

use arm::{Limits, Motor, Parameters};
use common::Loop;
use control::Settings;
use control::feedback::{self, Design};
use control::nmpc::plan::PlanStatus;
use control::nmpc::problem::{Model, Terminal, Weights};
use control::nmpc::settings::{self, Method};

const GOAL: f64 = 0.01;
const FORCE: f64 = 1.0;

fn mass(terminal: Terminal) -> Settings {
    Settings {
        arm: Parameters {
            inertia: 1.0,
            damping: 0.0,
            stiffness: 0.0,
            offset: 0.0,
            hysteresis: 0.0,
            cogging_frequency: 0.0,
            cogging_cos: [0.0; 9],
            cogging_sin: [0.0; 9],
        },
        motor: Motor {
            peak_torque: FORCE,
            ..Motor::tflex()
        },
        limits: Limits {
            angle_lower: 0.0,
            angle_upper: 2.0,
        },
        sample_period: 1e-3,
        nmpc: settings::Settings {
            period: 0.1,
            horizon: 5,
            weights: Weights {
                angle: 1.0,
                velocity: 0.0,
                integral: 0.0,
                thermal: 0.0,
                acceleration: 1e-6,
            },
            angle_margin: 0.0,
            thermal_limit: false,
            model: Model::Qp,
            terminal,
            solver: Method::Clarabel,
            ..settings::Settings::default()
        },
        feedback: feedback::Settings {
            design: Design::Weights,
            lowpass_frequency: 0.0,
            inertia: 1.0,
            damping: 0.0,
            ..feedback::Settings::tflex()
        },
        ..Settings::tflex()
    }
}

/// What a run of 6 s led to.
#[derive(Debug, Default)]
struct Run {
    /// Least position \[m\].
    least: f64,
    /// Largest speed \[m/s\].
    fastest: f64,
    /// Largest force that plans ask for \[N\].
    force: f64,
    /// Distance from the goal at the end \[m\].
    left: f64,
    plans: u32,
    unsolved: u32,
}

fn run(terminal: Terminal) -> Run {
    let settings = mass(terminal);
    let mut closed_loop = Loop::new(&settings, settings.arm, 1.0);
    let mut run = Run {
        least: 1.0,
        ..Run::default()
    };
    for _ in 0..6000 {
        let command = closed_loop.step(GOAL, 0.0);
        let motion = &closed_loop.motion;
        run.least = run.least.min(motion.angle);
        run.fastest = run.fastest.max(motion.velocity.abs());
        run.force = run.force.max(command.feedforward_torque.abs());
        run.plans += u32::from(command.new_plan);
        let solved = command.plan_status == PlanStatus::Solved;
        run.unsolved += u32::from(command.new_plan && !solved);
    }
    run.left = (closed_loop.motion.angle - GOAL).abs();
    run
}

/// Figure 2a: with the kinetic set the mass follows a second-order profile, nearly all of the force to and
/// fro, and stops before the limit.
#[test]
fn with_safe_sets_the_limit_is_kept() {
    let run = run(Terminal::SafeSet);
    eprintln!("{run:?}");
    assert!(run.least >= 0.0);
    assert_eq!((run.plans, run.unsolved), (60, 0));
    assert!(run.left < 1e-6, "arrives");
    assert!(run.force <= FORCE * (1.0 + 1e-6));
    // The quickest way, half of it at the full force, reaches √(F/m·(1 − 0.01)) = 0.995.
    assert!((0.9..1.0).contains(&run.fastest));
}

/// Figure 2b: within 0.5 s plans see too late that there is no stopping any more.
#[test]
fn without_them_it_is_violated() {
    let run = run(Terminal::Free);
    eprintln!("{run:?}");
    assert!(run.least < -0.05);
    assert!(run.fastest > 1.05);
    assert!(run.unsolved > 0, "and the planner says so");
}
