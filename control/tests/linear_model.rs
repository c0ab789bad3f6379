//! The linear model (appendix C): its plans are those of a quadratic programme, and what it does not know, the
//! heat, stays within its limit all the same.

#[path = "common/mod.rs"]
mod common;
mod nmpc_arms;
#[path = "nmpc_arms/starts.rs"]
#[allow(dead_code, reason = "every test file uses a part")]
mod starts;

use arm::Inadmissible;
use common::Loop;
use common::rates::{PENDULUM, TFLEX, setpoint};
use control::Settings;
use control::nmpc::plan::PlanStatus;
use control::nmpc::planner::Planner;
use control::nmpc::problem::{Initial, Model, Terminal};
use control::nmpc::settings::Method;
use nmpc_arms::{Arm, pendulum, tflex};
use serde_json::Value;
use starts::{RANDOM, Uniform, following};

fn linear(mut arm: Arm) -> Arm {
    arm.settings.model = Model::Qp;
    arm.settings.solver = Method::Clarabel;
    arm
}

/// Against qpOASES on the sparse form of eqs 47 to 55, with affine bounds from a linear programme
/// (`golden/qp_*.json`). In every case the torque limit is active.
#[test]
fn plans_are_the_optima_of_the_quadratic_programme() {
    for (name, arm) in [("pendulum", pendulum()), ("tflex", tflex())] {
        let folder = env!("CARGO_MANIFEST_DIR");
        let text = std::fs::read_to_string(format!("{folder}/tests/golden/qp_{name}.json"));
        let golden: Value = serde_json::from_str(&text.expect("golden file")).expect("JSON");
        let number = |value: &Value| value.as_f64().expect("number");
        let numbers = |value: &Value| -> Vec<f64> {
            value
                .as_array()
                .expect("array")
                .iter()
                .map(number)
                .collect()
        };
        let cases = golden["cases"].as_array().expect("cases");
        assert_eq!(cases.len(), 12);
        for case in cases {
            let mut arm = linear(arm.clone());
            arm.settings.thermal_share = number(&golden["thermal_share"]);
            arm.settings.horizon = case["horizon"].as_i64().expect("whole") as i32;
            if case["rest"] == false {
                arm.settings.terminal = Terminal::Free;
            }
            let mut planner = arm.planner();
            let limit = planner.problem().torque_limit.expect("limited");
            assert!((limit.most - number(&golden["tau_max"])).abs() < 1e-12);
            for (bound, golden) in [
                (limit.lower, &golden["lower"]),
                (limit.upper, &golden["upper"]),
            ] {
                let [slope, offset] = numbers(golden)[..] else {
                    panic!("two numbers");
                };
                assert!(
                    (bound.slope - slope).abs() < 1e-3,
                    "{name}: {bound:?} {slope} {offset}"
                );
                assert!(
                    (bound.offset - offset).abs() < 1e-3,
                    "{name}: {bound:?} {slope} {offset}"
                );
            }
            let x = numbers(&case["x0"]);
            let initial = Initial {
                angle: x[0],
                velocity: x[1],
                reference_angle: x[2],
                reference_velocity: x[3],
                thermal_load: x[5],
                ..Initial::default()
            };
            let plan = planner.plan(&initial, number(&case["goal"]));
            assert_eq!(plan.status, PlanStatus::Solved);
            assert_eq!(plan.convex_problems, 1, "one quadratic programme");
            let moves = numbers(&case["U"]);
            let largest = moves.iter().fold(0.0, |most, u| f64::max(most, u.abs()));
            let pairs = plan.moves.iter().zip(&moves);
            let difference = pairs.fold(0.0, |most, (u, v)| f64::max(most, (u - v).abs()));
            let cost = plan.trajectory.cost / number(&case["cost"]) - 1.0;
            // What the two ways to the affine bounds leave, along which the pendulum's plans go.
            assert!(cost.abs() < 2e-5, "{name}: cost differs by {cost:e}");
            assert!(
                difference <= 1e-3 * largest,
                "{name}: moves differ by {difference}"
            );
        }
    }
}

/// What the linear model asks of the motor is within the limit in truth, at every node and for ever: the load
/// rises above the plans' limit never, and above its start no further than that.
#[test]
fn the_true_torque_and_load_stay_within_the_limit() {
    for (name, arm) in [("pendulum", linear(pendulum())), ("tflex", linear(tflex()))] {
        let mut planner = arm.planner();
        let problem = *planner.problem();
        let most = problem.torque_limit.expect("limited").most;
        let limit = (arm.settings.thermal_share * arm.motor.continuous_current).powi(2);
        assert!((most - limit.sqrt() * arm.motor.torque_constant).abs() < 1e-12);
        let mut uniform = Uniform(3);
        let (mut active, mut solved) = (0, 0);
        for _ in 0..100 {
            let (mut initial, goal) = uniform.start(&problem, &RANDOM);
            planner.set_state(&Default::default());
            for _ in 0..20 {
                let plan = planner.plan(&initial, goal);
                if plan.status != PlanStatus::Solved {
                    break;
                }
                solved += 1;
                let nodes = &plan.trajectory;
                let mut reached = 0.0_f64;
                for k in 0..plan.moves.len() {
                    for end in [k, k + 1] {
                        let torque = arm.arm.position_torque(nodes.angle[end])
                            + arm.arm.damping * nodes.reference_velocity[end]
                            + arm.arm.inertia * plan.moves[k];
                        reached = reached.max(torque.abs());
                    }
                }
                assert!(
                    reached <= most * (1.0 + 1e-6),
                    "{name}: {reached} above {most}"
                );
                active += u32::from(reached > 0.9 * most);
                let hottest = nodes
                    .thermal_load
                    .iter()
                    .fold(0.0, |most, t| f64::max(most, *t));
                assert!(
                    hottest <= initial.thermal_load.max(limit) + 1e-6,
                    "{name}: {hottest}"
                );
                initial = following(plan, &initial);
            }
        }
        eprintln!("{name}: {solved} plans, {active} near the torque limit");
        assert!(solved > 1500 && (name == "tflex" || active > 100));
    }
}

/// In closed loop, with noise-free arms: no limit violated, no plan missing.
#[test]
fn in_closed_loop_no_limit_is_violated() {
    for (name, mut settings, sequence, start, most) in [
        ("T-flex", Settings::tflex(), TFLEX, 1.3, 240.0),
        ("pendulum", Settings::pendulum(), PENDULUM, 0.785, 19e3),
    ] {
        settings.nmpc.model = Model::Qp;
        settings.nmpc.solver = Method::Automatic;
        settings.initial_thermal_load = 11.0;
        let mut closed_loop = Loop::new(&settings, settings.arm, start);
        let mut score = 0.0;
        for sample in 0..40_000 {
            let [goal, _] = setpoint(&sequence, f64::from(sample) * settings.sample_period);
            let command = closed_loop.step(goal, 0.0);
            score += (goal - closed_loop.motion.angle).powi(2);
            assert!(!closed_loop.violates(), "{name}, sample {sample}");
            let status = command.plan_status;
            assert!(
                matches!(status, PlanStatus::Solved | PlanStatus::GoalProjected),
                "{name}, sample {sample}: {status:?}"
            );
        }
        assert!(score < most, "{name} follows: {score}");
    }
}

/// A setpoint that only a plan of the nonlinear model can hold: the bounds of the torque are pessimistic.
#[test]
fn goals_are_those_that_the_pessimistic_bounds_can_hold() {
    let mut arm = linear(pendulum());
    arm.settings.thermal_share = 0.4;
    let mut planner = arm.planner();
    let limit = planner.problem().torque_limit.expect("limited");
    let at_rest = Initial {
        angle: 0.8,
        reference_angle: 0.8,
        ..Initial::default()
    };
    let plan = planner.plan(&at_rest, 1.5);
    assert_eq!(plan.status, PlanStatus::GoalProjected);
    assert!(limit.excess(plan.goal, 0.0).abs() < 1e-9, "at the limit");
    assert!(arm.arm.position_torque(plan.goal) < limit.most);
    assert!((plan.trajectory.angle[40] - plan.goal).abs() < 1e-7);
}

fn refused(change: impl Fn(&mut Arm)) -> Inadmissible {
    let mut arm = linear(pendulum());
    change(&mut arm);
    let planner = Planner::new(
        &arm.settings,
        &arm.arm,
        &arm.motor,
        &arm.limits,
        &arm.feedback,
    );
    let mut errors = planner.err().expect("refused");
    assert_eq!(errors.len(), 1);
    errors.remove(0)
}

#[test]
fn what_the_linear_model_cannot_do_is_refused() {
    let error = refused(|arm| arm.settings.solver = Method::Riccati);
    assert_eq!((error.name, error.value), ("nmpc.solver", 2.0));
    assert!(error.to_string().contains("3 (clarabel)"), "{error}");

    // Too little torque for ever; the number in the message is enough.
    let error = refused(|arm| arm.settings.thermal_share = 0.01);
    assert_eq!(error.name, "nmpc.thermal_share");
    let least = error.to_string();
    let least = least
        .split(&[' ', ','][..])
        .find_map(|word| word.parse::<f64>().ok().filter(|&x| x > 0.01));
    let mut arm = linear(pendulum());
    arm.settings.thermal_share = least.expect("number") + 1e-4;
    arm.planner();

    let error = refused(|arm| {
        arm.settings.thermal_limit = false;
        arm.motor.peak_torque = 0.01;
    });
    assert_eq!((error.name, error.unit), ("motor.peak_torque", "N.m"));

    let error = refused(|arm| {
        arm.settings.model = Model::Nonlinear;
        arm.settings.terminal = Terminal::SafeSet;
        arm.motor.peak_torque = 1.0;
    });
    assert_eq!(error.name, "motor.peak_torque");
    let error = refused(|arm| {
        arm.settings.model = Model::Nonlinear;
        arm.settings.terminal = Terminal::Free;
        arm.settings.solver = Method::Riccati;
    });
    assert_eq!(error.name, "nmpc.solver");
}
