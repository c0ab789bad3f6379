//! Plans that take their time: `nmpc.latency`, with the state predicted to the time of use and without.

mod common;

use common::Loop;
use control::nmpc::plan::PlanStatus;
use control::nmpc::settings;
use control::{Controller, Settings};

/// A controller whose plans apply `latency` \[s\] after their measurement.
fn late(latency: f64, models_latency: bool, settings: Settings) -> Settings {
    let nmpc = settings::Settings {
        latency,
        models_latency,
        ..settings.nmpc
    };
    Settings { nmpc, ..settings }
}

/// Largest distance from the goal in the last of 10 s after a step from 1.30 to 1.10 rad \[rad\].
fn left_over(settings: &Settings) -> f64 {
    let mut closed_loop = Loop::new(settings, settings.arm, 1.30);
    let mut most: f64 = 0.0;
    for sample in 0..40_000 {
        closed_loop.step(1.10, 0.0);
        if sample >= 36_000 {
            most = most.max((closed_loop.motion.angle - 1.10).abs());
        }
    }
    most
}

#[test]
fn late_plans_are_unstable_on_the_tflex_unless_the_delay_is_predicted() {
    for latency in [0.01, 0.025, 0.05] {
        let [predicted, ignored] = [true, false]
            .map(|models_latency| left_over(&late(latency, models_latency, Settings::tflex())));
        eprintln!(
            "T-flex, {latency} s late: {predicted:.1e} rad left over, not predicted {ignored:.1e} rad"
        );
        assert!(predicted < 1e-4, "{latency}: {predicted}");
        if latency >= 0.025 {
            assert!(ignored > 0.1, "{latency}: {ignored}");
        }
    }
}

#[test]
fn the_first_move_waits_for_the_latency() {
    let settings = late(0.02, true, Settings::tflex());
    let mut controller = Controller::new(&settings).unwrap();
    for sample in 0..80 {
        let command = controller.sample(1.30, 1.10);
        assert_eq!(command.reference.acceleration, 0.0, "{sample}");
        assert_eq!(command.plan_status, PlanStatus::Idle);
        assert_eq!(command.new_plan, sample == 0);
    }
    let command = controller.sample(1.30, 1.10);
    assert_eq!(command.plan_status, PlanStatus::Solved);
    assert_eq!(
        command.reference.acceleration,
        controller.plan().expect("at hand").moves[0]
    );
    assert!(command.reference.acceleration < -1.0);
}

/// Plans are never closer than a period, and each applies when its latency has gone by, also after a restore.
#[test]
fn plans_apply_on_time() {
    // Periods of 13⅓ and 66⅔ samples, the latter one whose multiples round either way; latencies that are
    // no whole number of samples.
    for (rate, latencies) in [
        (300.0, [0.0, 1e-3, 0.0033, 1.0 / 300.0]),
        (60.0, [0.0, 1e-3, 0.01, 1.0 / 60.0]),
    ] {
        for latency in latencies {
            let mut settings = late(latency, true, Settings::tflex());
            settings.nmpc.period = 1.0 / rate;
            settings.nmpc.duration = 2.0;
            let period = (4000.0 / rate) as u32;
            let expected = f64::min((latency * 4000.0 - 1e-9).ceil(), f64::from(period)) as u32;
            let mut closed_loop = Loop::new(&settings, settings.arm, 1.30);
            let (mut waiting, mut made) = (None, None);
            for sample in 0..9000 {
                if sample == 2003 {
                    let state = closed_loop.controller.state().clone();
                    closed_loop.controller = Controller::new(&settings).unwrap();
                    closed_loop.controller.set_state(&state);
                }
                let setpoint = if sample < 4500 { 1.10 } else { 1.40 };
                let command = closed_loop.step(setpoint, 0.0);
                let now = command.reference.acceleration;
                if command.new_plan {
                    assert!(
                        made.is_none_or(|made| sample - made >= period),
                        "{rate}, {latency}, {sample}"
                    );
                    made = Some(sample);
                    if let Some((due, u)) = waiting.replace((
                        sample + expected,
                        closed_loop.controller.plan().expect("at hand").moves[0],
                    )) {
                        // The one before applies at the latest when the next one is made.
                        assert!(
                            expected == 0 || (due == sample && u == now),
                            "{rate}, {latency}, {sample}"
                        );
                    }
                }
                if let Some((due, u)) = waiting.filter(|(due, _)| *due <= sample) {
                    assert!(due == sample && u == now, "{rate}, {latency}, {sample}");
                    waiting = None;
                }
            }
            assert!((closed_loop.motion.angle - 1.40).abs() < 1e-3);
        }
    }
}
