//! Planning at 20 Hz, as the paper does, and up to the rate of the feedback: what it buys, and that the limits
//! hold. Horizons last 2 s and have 40 intervals, the first of them one period long.

mod common;

use arm::Parameters;
use common::Loop;
use common::rates::{self, PENDULUM, Run, TFLEX, every};
use control::Settings;

/// Periods of the plans \[s\].
const PERIODS: [f64; 4] = [0.05, 5e-3, 1e-3, 2.5e-4];

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
        let run = rates::run(Loop::new(&settings, arm, angle), &settings, &at, |_, _| ());
        let mean = run.mean_iterations();
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

#[test]
fn the_tflex_gets_there_sooner() {
    let runs = runs(
        "T-flex, setpoints",
        Settings::tflex(),
        Parameters::tflex(),
        1.3,
        |time| rates::setpoint(&TFLEX, time),
    );
    assert!(runs.iter().all(|run| run.excess <= 1e-6));
    assert!(runs[3].score < 0.85 * runs[0].score);
}

#[test]
fn the_pendulum_keeps_its_thermal_limit() {
    let exact = Settings {
        arm: Parameters::pendulum(),
        ..Settings::pendulum()
    };
    for (name, settings, tolerance) in [
        ("pendulum, setpoints", exact, 1e-6),
        // The torque of its feedback is not planned.
        (
            "pendulum mis-modelled, setpoints",
            Settings::pendulum(),
            0.02,
        ),
    ] {
        let arm = Parameters::pendulum();
        let runs = runs(name, settings, arm, 0.785, |time| {
            rates::setpoint(&PENDULUM, time)
        });
        assert!(runs.iter().all(|run| run.excess <= tolerance), "{name}");
        assert!(runs.iter().all(|run| run.iterated > 20));
        assert!(runs[3].score < 0.99 * runs[0].score);
    }
}

#[test]
fn disturbances_move_the_arm_less() {
    let tflex = runs(
        "T-flex, 1 N.m",
        Settings::tflex(),
        Parameters::tflex(),
        1.2,
        |time| rates::push(1.2, 1.0, time),
    );
    assert!(tflex[3].score < 0.25 * tflex[0].score);
    let settings = Settings::pendulum();
    let pendulum = runs(
        "pendulum, 2 N.m",
        settings,
        Parameters::pendulum(),
        0.785,
        |time| rates::push(0.785, 2.0, time),
    );
    assert!(pendulum[3].score < 0.8 * pendulum[0].score);
}
