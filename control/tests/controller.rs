//! What a controller promises to its caller: order of events, held commands, snapshots, refusals.

mod common;

use arm::{Inadmissible, hysteresis, thermal};
use common::{Loop, feedback_of_equation_36, with_profile};
use control::feedback::Law;
use control::nmpc::plan::PlanStatus;
use control::nmpc::settings;
use control::{Command, Controller, Reference, Settings, State, When};
use proptest::prelude::*;

fn controllers() -> [(&'static str, Settings); 5] {
    let pendulum = Settings::pendulum();
    [
        ("T-flex", Settings::tflex()),
        ("T-flex, profile", with_profile(Settings::tflex(), 46.5)),
        ("pendulum", pendulum),
        ("pendulum, profile", with_profile(pendulum, 1.9973)),
        (
            "pendulum, integrators",
            Settings {
                feedback: feedback_of_equation_36(Law::Lqri),
                nmpc: settings::Settings {
                    models_integrator: true,
                    ..pendulum.nmpc
                },
                ..pendulum
            },
        ),
    ]
}

fn refusals(settings: &Settings) -> Vec<Inadmissible> {
    Controller::new(settings).err().unwrap_or_default()
}

#[test]
fn reference_starts_at_rest_at_the_measured_angle() {
    for (name, settings) in controllers() {
        let command = Controller::new(&settings).unwrap().sample(1.2, 1.2);
        let Reference {
            angle, velocity, ..
        } = command.reference;
        assert_eq!((angle, velocity), (1.2, 0.0), "{name}");
        assert_eq!(command.thermal_load, settings.initial_thermal_load);
        assert_eq!(command.feedback_torque, 0.0);
    }
}

/// Feedforward, feedback, velocity, hysteresis and reference of one sample, reckoned by hand.
#[test]
fn one_sample_is_the_sum_of_its_parts() {
    let mut settings = Settings::tflex();
    settings.feedback.lowpass_frequency = 0.0;
    let arm = settings.arm;
    let h = settings.sample_period;
    let mut controller = Controller::new(&settings).unwrap();
    let first = controller.sample(1.30, 1.35);
    let second = controller.sample(1.3001, 1.35);

    let u = first.reference.acceleration;
    assert_eq!(u, controller.plan().expect("at hand").moves[0]);
    assert!(u > 1.0);
    assert_eq!(second.reference.angle, 1.30 + 0.5 * u * h * h);
    assert_eq!(second.reference.velocity, u * h);
    assert_eq!(second.reference.acceleration, u);

    let z = hysteresis::update(0.0, 1.3001 - 1.30);
    let feedforward =
        arm.position_torque(1.3001) + arm.hysteresis * z + arm.damping * u * h + arm.inertia * u;
    assert!((second.feedforward_torque - feedforward).abs() < 1e-12);
    let gains = settings.feedback.resolve().unwrap();
    let velocity = (1.3001 - 1.30) / h;
    let feedback = -gains.angle * (1.3001 - second.reference.angle)
        - gains.velocity * (velocity - second.reference.velocity);
    assert!((second.feedback_torque - feedback).abs() < 1e-12);
    assert!((second.torque - feedforward - feedback).abs() < 1e-12);
    assert_eq!(second.current, second.torque / 5.57);
    assert_eq!(
        second.thermal_load,
        thermal::update(&settings.motor, 0.0, first.torque, h)
    );
}

/// Samples at which plans are made.
fn plan_samples(settings: &Settings, samples: u64) -> Vec<u64> {
    let mut controller = Controller::new(settings).unwrap();
    (0..samples)
        .filter(|_| controller.sample(1.3, 1.3).new_plan)
        .collect()
}

#[test]
fn plans_are_made_every_period() {
    let settings = Settings::tflex();
    assert_eq!(plan_samples(&settings, 801), [0, 200, 400, 600, 800]);
}

/// A period of 3.3 samples: the first samples at or after 0, 3.3, 6.6, 9.9, 13.2 …
#[test]
fn plan_period_need_not_be_a_multiple_of_the_sample_period() {
    let mut settings = Settings::tflex();
    settings.sample_period = 0.05 / 3.3;
    settings.feedback.lowpass_frequency = 0.0;
    let expected: Vec<u64> = (0..30)
        .map(|m| (f64::from(m) * 3.3).ceil() as u64)
        .collect();
    assert_eq!(plan_samples(&settings, expected[29] + 1), expected);
}

/// 0.05/0.00125 and the like are whole numbers only up to rounding.
#[test]
fn rounding_does_not_delay_a_plan() {
    for (sample_period, samples) in [(0.05 / 7.0, 7), (0.05 / 49.0, 49), (1e-3, 50)] {
        let mut settings = Settings::tflex();
        settings.sample_period = sample_period;
        let expected: Vec<u64> = (0..100).map(|m| m * samples).collect();
        assert_eq!(plan_samples(&settings, 99 * samples + 1), expected);
    }
}

#[test]
fn an_unusable_angle_holds_the_last_command() {
    for (name, settings) in controllers() {
        for angle in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
            let mut controller = Controller::new(&settings).unwrap();
            let mut last = Command::default();
            for _ in 0..10 {
                last = controller.sample(1.0, 1.1);
            }
            let held = controller.sample(angle, 1.1);
            assert!(held.measurement_held && !held.new_plan, "{name}");
            assert_eq!(held.plan_status, PlanStatus::MeasurementHeld);
            assert_eq!(held.torque, last.torque);
            assert_eq!(held.reference, last.reference);
            assert_ne!(held.thermal_load, last.thermal_load);
            let next = controller.sample(1.0, 1.1);
            assert!(!next.measurement_held);
            assert_ne!(next.plan_status, PlanStatus::MeasurementHeld);
        }
    }
}

/// The arm must not be left to itself because the operator's display sent nonsense.
#[test]
fn an_unusable_setpoint_leaves_the_last_one_in_force() {
    for (name, settings) in controllers() {
        for setpoint in [f64::NAN, f64::INFINITY, 1e300] {
            let mut controller = Controller::new(&settings).unwrap();
            let mut other = Controller::new(&settings).unwrap();
            for sample in 0..500 {
                let angle = 1.0 + 1e-4 * f64::from(sample);
                let bad = sample > 100;
                let command = controller.sample(angle, if bad { setpoint } else { 1.1 });
                let expected = other.sample(angle, 1.1);
                assert_eq!(command.torque, expected.torque, "{name}");
                assert_eq!(command.measurement_held, bad);
            }
        }
    }
}

#[test]
fn nothing_is_commanded_before_the_first_usable_measurement() {
    let mut controller = Controller::new(&Settings::tflex()).unwrap();
    assert_eq!(controller.sample(f64::NAN, 1.3).torque, 0.0);
    assert_eq!(controller.samples(), 1);
    let first = controller.sample(1.25, 1.3);
    assert_eq!(
        (first.reference.angle, first.reference.velocity),
        (1.25, 0.0)
    );
    assert!(first.new_plan);
}

/// Time goes on while a command is held: the velocity spans the gap, and a plan that was due is made late.
#[test]
fn time_goes_on_while_a_command_is_held() {
    let mut settings = with_profile(Settings::tflex(), 46.5);
    settings.feedback.lowpass_frequency = 0.0;
    let velocity = 0.5;
    let gains = settings.feedback.resolve().unwrap();
    let mut controller = Controller::new(&settings).unwrap();
    let measured = |k: u32| 1.3 + velocity * settings.sample_period * f64::from(k);
    controller.sample(measured(0), measured(0));
    for _ in 1..5 {
        controller.sample(f64::NAN, measured(0));
    }
    let command = controller.sample(measured(5), measured(0));
    let expected = -gains.angle * (measured(5) - measured(0)) - gains.velocity * velocity;
    assert!((command.feedback_torque - expected).abs() < 1e-9);

    let mut controller = Controller::new(&Settings::tflex()).unwrap();
    let plans: Vec<u32> = (0..450)
        .filter(|k| {
            let angle = if (190..230).contains(k) {
                f64::NAN
            } else {
                1.3
            };
            controller.sample(angle, 1.3).new_plan
        })
        .collect();
    assert_eq!(plans, [0, 230, 400]);
}

#[test]
fn torque_stays_within_the_peak_and_heats_as_commanded() {
    let mut settings = Settings::tflex();
    settings.motor.peak_torque = 0.5;
    let mut controller = Controller::new(&settings).unwrap();
    let mut load = 0.0;
    for sample in 0..1000 {
        let angle = 1.2 + 0.1 * f64::from(sample).sin();
        let command = controller.sample(angle, 1.4);
        assert!(command.torque.abs() <= 0.5);
        assert_eq!(command.thermal_load, load);
        load = thermal::update(&settings.motor, load, command.torque, 2.5e-4);
    }
}

fn any_input() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => 0.9..1.6_f64,
        1 => prop::num::f64::ANY,
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn no_input_gets_a_bad_number_through(
        which in 0..5_usize, inputs in prop::collection::vec((any_input(), any_input()), 1..60),
    ) {
        let mut settings = controllers()[which].1;
        settings.sample_period = 0.02;
        settings.feedback.lowpass_frequency = 0.0;
        let mut controller = Controller::new(&settings).unwrap();
        for (angle, setpoint) in inputs {
            let c = controller.sample(angle, setpoint);
            let r = c.reference;
            let all = [
                c.torque, c.current, c.feedforward_torque, c.feedback_torque, c.thermal_load,
                r.angle, r.velocity, r.acceleration,
            ];
            prop_assert!(all.iter().all(|v| v.is_finite()), "{c:?}");
            prop_assert!(c.torque.abs() <= settings.motor.peak_torque);
        }
    }
}

/// A run, saved at some sample, sent through bytes, and resumed by a fresh controller. The moves span the
/// joint, so that the pendulum's plans reach the thermal limit and are found by the conic solver.
#[test]
fn snapshot_continues_to_the_bit() {
    let mut conic = 0;
    for (name, settings) in controllers() {
        let limits = settings.limits;
        let at =
            |share: f64| limits.angle_lower + share * (limits.angle_upper - limits.angle_lower);
        let setpoint = |k: u32| {
            at(if (k / 1500).is_multiple_of(2) {
                0.9
            } else {
                0.1
            })
        };
        for saved_at in [0, 1, 199, 200, 2345] {
            let mut original = Loop::new(&settings, settings.arm, at(0.1));
            for k in 0..saved_at {
                original.step(setpoint(k), 0.0);
            }
            let bytes = postcard::to_stdvec(original.controller.state()).unwrap();
            let state: State = postcard::from_bytes(&bytes).unwrap();
            let mut resumed = Loop::new(&settings, settings.arm, at(0.1));
            resumed.controller.set_state(&state);
            resumed.motion = original.motion;
            for k in saved_at..saved_at + 4000 {
                let expected = original.step(setpoint(k), 0.0);
                let got = resumed.step(setpoint(k), 0.0);
                assert_eq!(got, expected, "{name}, {saved_at}, {k}");
                conic += original.controller.plan().expect("at hand").iterations;
            }
            assert_eq!(original.controller.state(), resumed.controller.state());
        }
    }
    assert!(conic > 0);
}

#[test]
fn going_back_in_time_repeats_the_run() {
    let settings = Settings::pendulum();
    let mut closed_loop = Loop::new(&settings, settings.arm, 1.0);
    for _ in 0..300 {
        closed_loop.step(0.4, 0.0);
    }
    let (state, motion) = (closed_loop.controller.state().clone(), closed_loop.motion);
    let first: Vec<_> = (0..900).map(|_| closed_loop.step(0.4, 0.0)).collect();
    closed_loop.controller.set_state(&state);
    closed_loop.motion = motion;
    let second: Vec<_> = (0..900).map(|_| closed_loop.step(0.4, 0.0)).collect();
    assert_eq!(first, second);
}

#[test]
fn all_inadmissible_settings_are_named_at_once() {
    let mut settings = Settings::tflex();
    settings.arm.inertia = 0.0;
    settings.motor.torque_constant = f64::NAN;
    settings.limits.angle_upper = 0.0;
    settings.sample_period = 2.0;
    settings.initial_thermal_load = -1.0;
    settings.profile_max_acceleration = 0.0;
    settings.feedback.weights.torque = 0.0;
    let names: Vec<_> = refusals(&settings).iter().map(|e| e.name).collect();
    assert_eq!(
        names,
        [
            "arm.inertia",
            "motor.torque_constant",
            "limits.angle_upper",
            "sample_period",
            "initial.thermal_load",
            "profile.max_acceleration",
            "nmpc.period",
            "feedback.weight_torque",
        ]
    );
}

#[test]
fn settings_of_the_planner_are_checked_too() {
    let mut settings = Settings::tflex();
    settings.nmpc.horizon = 1;
    settings.nmpc.thermal_share = 2.0;
    let names: Vec<_> = refusals(&settings).iter().map(|e| e.name).collect();
    assert_eq!(names, ["nmpc.horizon", "nmpc.thermal_share"]);
}

/// A planner that is late, or never comes, leaves the plan in force: it goes on to rest at its goal.
#[test]
fn without_a_next_plan_the_last_one_goes_on_to_rest() {
    let settings = Settings::pendulum();
    let per_plan = (settings.nmpc.period / settings.sample_period).round() as usize;
    let mut controller = Controller::new(&settings).expect("admissible");
    let start = 0.7;
    controller.sample_and_plan(start, 1.0, When::Now);
    let plan = controller.plan().expect("at hand").clone();
    let trajectory = &plan.trajectory;
    let mut command = Command::default();
    for k in 1..=(plan.moves.len() + 2) * per_plan {
        command = controller.sample_and_plan(start, 1.0, When::Never);
        let late = k >= per_plan;
        assert_eq!(command.plan_status == PlanStatus::ShiftedPlan, late, "{k}");
        if k % per_plan == 0 && k / per_plan < plan.moves.len() {
            let node = k / per_plan;
            let reference = command.reference;
            assert!(
                (reference.angle - trajectory.reference_angle[node]).abs() < 1e-9,
                "{node}"
            );
            assert_eq!(reference.acceleration, plan.moves[node]);
        }
    }
    assert_eq!(
        (command.reference.velocity, command.reference.acceleration),
        (0.0, 0.0)
    );
    assert!((command.reference.angle - plan.goal).abs() < 1e-9);
}

/// What a partition of its own plans is what the sample would have planned, and applies as late.
#[test]
fn plans_made_elsewhere_are_those_of_the_sample() {
    for latency in [1.0, 37.0] {
        let mut settings = Settings::pendulum();
        settings.nmpc.latency = latency * settings.sample_period;
        let per_plan = (settings.nmpc.period / settings.sample_period).round() as usize;
        let [mut whole, mut split] =
            [0, 1].map(|_| Controller::new(&settings).expect("admissible"));
        let mut planning = None;
        for k in 0..5 * per_plan {
            let (angle, setpoint) = (0.7 + 1e-4 * (k as f64 * 0.01).sin(), 1.0);
            if k % per_plan == latency as usize {
                split.finish_plan(planning.take().expect("begun"));
            }
            let expected = whole.sample(angle, setpoint);
            let command = split.sample_and_plan(angle, setpoint, When::Never);
            let new_plan = expected.new_plan;
            assert_eq!(
                command,
                Command {
                    new_plan: false,
                    ..expected
                },
                "{k}"
            );
            if new_plan {
                planning = split.begin_plan();
                assert!(split.begin_plan().is_none() && split.plan().is_none());
                planning.as_mut().expect("begun").run();
            }
        }
    }
}

/// While the measurement is held no plan is made; the next one waits for its latency, and until then the move in
/// force goes on, with which its start was predicted.
#[test]
fn a_held_measurement_and_latency_leave_the_reference_at_rest() {
    let mut settings = Settings::tflex();
    settings.nmpc.latency = 100.0 * settings.sample_period;
    let mut controller = Controller::new(&settings).expect("admissible");
    for k in 0..1550 {
        let held = (1000..1450).contains(&k);
        let (angle, setpoint) = if held {
            (f64::NAN, 1.2)
        } else {
            (1.2, if k < 1450 { 1.2 } else { 1.4 })
        };
        let reference = controller.sample(angle, setpoint).reference;
        let moved = reference.velocity.abs().max((reference.angle - 1.2).abs());
        assert!(moved < 1e-6, "{k}: {reference:?}");
    }
    assert!(controller.sample(1.2, 1.4).reference.acceleration > 1.0);
}
