//! What the planner owes whatever it is given: a finite plan, an honest status, limits kept wherever they
//! can be, and the same answer again after a restore.

mod nmpc_arms;
#[path = "nmpc_arms/starts.rs"]
#[allow(dead_code, reason = "every test file uses a part")]
mod starts;

use control::nmpc::plan::{Plan, PlanStatus};
use control::nmpc::planner::Planner;
use control::nmpc::problem::Initial;
use control::nmpc::settings::Method;
use nmpc_arms::{Arm, assert_finite, pendulum, tflex};
use proptest::prelude::*;
use starts::{RANDOM, Uniform, following, within};

/// Thermal limit of the plan (eq 26) [A²].
fn thermal_limit(arm: &Arm) -> f64 {
    (arm.settings.thermal_share * arm.motor.continuous_current).powi(2)
}

#[test]
fn far_above_the_limit_the_status_is_thermal_slack_and_the_load_falls() {
    let arm = pendulum();
    let initial = Initial {
        angle: 0.6,
        reference_angle: 0.6,
        thermal_load: 1.2 * thermal_limit(&arm),
        ..Initial::default()
    };
    let mut planner = arm.planner();
    let plan = planner.plan(&initial, 0.9);
    assert_eq!(plan.status, PlanStatus::ThermalSlack);
    let loads = &plan.trajectory.thermal_load;
    assert!(loads.windows(2).all(|pair| pair[1] < pair[0]));
}

#[test]
fn setpoints_that_cannot_be_held_are_projected() {
    let arm = pendulum();
    let start = Initial {
        angle: 0.5,
        reference_angle: 0.5,
        ..Initial::default()
    };
    let mut planner = arm.planner();
    let plan = planner.plan(&start, 0.0);
    assert_eq!((plan.status, plan.goal), (PlanStatus::GoalProjected, 0.02));
    assert_eq!(planner.plan(&start, 0.5).status, PlanStatus::Solved);
}

#[test]
fn starts_outside_the_margin_come_back() {
    let mut slack = 0;
    for arm in [pendulum(), tflex()] {
        let mut planner = arm.planner();
        for angle in [
            arm.limits.angle_lower,
            arm.limits.angle_upper,
            arm.limits.angle_upper + 0.05,
            arm.limits.angle_upper + 0.5,
        ] {
            let initial = Initial {
                angle,
                reference_angle: angle,
                ..Initial::default()
            };
            let goal = 0.5 * (arm.limits.angle_lower + arm.limits.angle_upper);
            planner.set_state(&Default::default());
            let plan = planner.plan(&initial, goal);
            // Whether the first period suffices to come back, the status says.
            let inside = arm.settings.angle_margin + arm.limits.angle_lower - 1e-6
                ..=arm.limits.angle_upper - arm.settings.angle_margin + 1e-6;
            let back = plan.trajectory.reference_angle[1..].iter();
            let expected = if back.clone().all(|angle| inside.contains(angle)) {
                PlanStatus::Solved
            } else {
                PlanStatus::AngleSlack
            };
            assert_eq!(plan.status, expected);
            slack += u32::from(expected == PlanStatus::AngleSlack);
            assert_finite(plan);
            // No further out than the start, and inside in the end.
            let reach = (angle - goal).abs() + 1e-6;
            let nodes = &plan.trajectory.reference_angle;
            assert!(nodes.iter().all(|node| (node - goal).abs() <= reach));
            assert!((nodes[40] - goal).abs() < 1e-9);
        }
    }
    assert!(slack > 0);
}

#[test]
fn angle_bounds_bind_where_the_optimum_would_overshoot() {
    let arm = pendulum();
    let mut planner = arm.planner();
    // Fast towards the upper limit, goal close to it.
    let initial = Initial {
        angle: 1.4,
        velocity: 3.0,
        reference_angle: 1.4,
        reference_velocity: 3.0,
        ..Initial::default()
    };
    let plan = planner.plan(&initial, 1.54);
    assert_eq!(plan.status, PlanStatus::Solved);
    let bound = arm.limits.angle_upper - 0.02;
    let nodes = plan.trajectory.reference_angle[1..].iter();
    let highest = nodes.fold(0.0, |most, &angle| f64::max(most, angle));
    assert!((highest - bound).abs() < 1e-4, "{highest} {bound}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Any horizon and period, all features: always a finite plan that ends at rest at its goal.
    #[test]
    fn any_settings_give_plans(
        horizon in 2..60, period in 1e-3..0.1_f64, share in 0.3..1.0, integral in prop_oneof![Just(0.0), 0.0..10.0],
        thermal in prop_oneof![Just(0.0), 0.0..1e-4], limited: bool, feedback: bool, integrator: bool,
        flexure: bool, longer in prop_oneof![Just(0.0), 1.0..5.0], seed: u64,
    ) {
        let mut arm = if flexure { tflex() } else { pendulum() };
        arm.settings.horizon = horizon;
        arm.settings.period = period;
        // Intervals grow where the horizon has room for them.
        if longer > 0.0 && horizon >= 10 {
            arm.settings.duration = f64::min(longer * period * f64::from(horizon), 0.05 * f64::from(horizon))
                .max(period * f64::from(horizon));
        }
        arm.settings.thermal_share = share;
        arm.settings.thermal_limit = limited;
        arm.settings.models_feedback = feedback;
        arm.settings.models_integrator = integrator;
        arm.settings.weights.integral = integral;
        arm.settings.weights.thermal = thermal;
        arm.feedback.gain_integral = 30.0;
        let mut planner = arm.planner();
        let mut uniform = Uniform(seed);
        for _ in 0..4 {
            let (initial, goal) = uniform.start(planner.problem(), &within("any", [0.0, 1.1]));
            let plan = planner.plan(&initial, goal);
            assert_finite(plan);
            prop_assert!(!matches!(plan.status, PlanStatus::Idle | PlanStatus::MeasurementHeld));
            if !matches!(plan.status, PlanStatus::ShiftedPlan | PlanStatus::Rest) {
                let end = plan.trajectory.angle[horizon as usize];
                prop_assert!((end - plan.goal).abs() < 1e-6, "{:?} {end} {}", plan.status, plan.goal);
            }
        }
    }

    #[test]
    fn nothing_that_is_not_a_number_gets_in(component in 0..8_usize, infinite: bool) {
        let bad = if infinite { f64::INFINITY } else { f64::NAN };
        let mut planner = tflex().planner();
        let mut initial = Initial { angle: 1.2, reference_angle: 1.2, reference_velocity: 0.1, ..Initial::default() };
        let before = planner.plan(&initial, 1.0).moves.clone();
        let mut goal = 1.0;
        match component {
            0 => initial.angle = bad,
            1 => initial.velocity = bad,
            2 => initial.reference_angle = bad,
            3 => initial.reference_velocity = bad,
            4 => initial.integral = bad,
            5 => initial.feedback_integral = bad,
            6 => initial.thermal_load = bad,
            _ => goal = bad,
        }
        let plan = planner.plan(&initial, goal);
        assert_finite(plan);
        prop_assert_eq!(plan.status, PlanStatus::ShiftedPlan);
        for (u, expected) in plan.moves.iter().zip(&before[1..]) {
            prop_assert!((u - expected).abs() <= 1e-12 * (1.0 + expected.abs()), "{u} {expected}");
        }
    }
}

/// Work for the cold plans of a move to and fro with a hot motor, and for each warm one that was iterated.
fn work(solver: Method, of: fn(&Plan) -> u32) -> (u32, Vec<u32>) {
    let mut arm = pendulum();
    arm.settings.solver = solver;
    let mut planner = arm.planner();
    let mut initial = Initial {
        angle: 0.3,
        reference_angle: 0.3,
        thermal_load: 0.97 * thermal_limit(&arm),
        ..Initial::default()
    };
    let (mut cold, mut warm) = (0, Vec::new());
    for k in 0..120 {
        let goal = if k < 60 { 1.2 } else { 0.4 };
        let plan = planner.plan(&initial, goal);
        assert_eq!(plan.status, PlanStatus::Solved, "plan {k}");
        assert!(plan.trajectory.excess <= 1e-6);
        if k % 60 == 0 {
            cold += of(plan);
        } else if plan.iterations > 0 {
            warm.push(of(plan));
        }
        initial = following(plan, &initial);
    }
    assert!((initial.angle - 0.4).abs() < 1e-3, "arrives");
    (cold, warm)
}

#[test]
fn in_closed_loop_the_limit_is_kept_and_a_warm_start_saves_work() {
    let (cold, warm) = work(Method::Clarabel, |plan| plan.convex_problems);
    assert!(
        cold >= 2 && warm.iter().max() == Some(&1),
        "{cold} {warm:?}"
    );
    let (cold, warm) = work(Method::Riccati, |plan| plan.iterations);
    let mean = f64::from(warm.iter().sum::<u32>()) / warm.len() as f64;
    assert!(warm.len() > 10);
    assert!(
        cold >= 10 && mean <= 3.0,
        "{cold} for two cold plans, {mean} a warm one"
    );
}

fn bits(plan: &Plan) -> (PlanStatus, u32, u32, Vec<u64>) {
    let numbers = plan.moves.iter().chain(&plan.trajectory.thermal_load);
    let bits = numbers
        .map(|x| x.to_bits())
        .chain([plan.trajectory.cost.to_bits()]);
    (
        plan.status,
        plan.iterations,
        plan.convex_problems,
        bits.collect(),
    )
}

/// A planner rebuilt from its parameters and given the state goes on bit by bit as if never stopped.
#[test]
fn a_restored_planner_goes_on_to_the_bit() {
    let class = within("near the limit", [0.9, 1.01]);
    for arm in [pendulum(), tflex()] {
        let mut uniform = Uniform(5);
        let mut planner = arm.planner();
        let mut solver_was_used = false;
        for _ in 0..25 {
            let (mut initial, goal) = uniform.start(planner.problem(), &class);
            let state = planner.state().clone();
            let mut restored: Planner = arm.planner();
            restored.set_state(&state);
            for _ in 0..2 {
                let plan = planner.plan(&initial, goal);
                assert_eq!(bits(plan), bits(restored.plan(&initial, goal)));
                solver_was_used |= plan.iterations > 0;
                initial = following(plan, &initial);
            }
            assert_eq!(planner.state(), restored.state());
        }
        assert!(solver_was_used);
    }
}

#[test]
fn inadmissible_settings_are_all_named() {
    let mut arm = tflex();
    arm.settings.period = 0.0;
    arm.settings.horizon = 1;
    arm.settings.weights.acceleration = 0.0;
    arm.settings.weights.thermal = f64::NAN;
    arm.settings.angle_margin = 0.5;
    arm.settings.thermal_share = 1.1;
    arm.settings.deadline = -1.0;
    arm.settings.latency = 0.01;
    let Err(errors) = Planner::new(
        &arm.settings,
        &arm.arm,
        &arm.motor,
        &arm.limits,
        &arm.feedback,
    ) else {
        panic!("admitted");
    };
    let names: Vec<_> = errors.iter().map(|error| error.name).collect();
    assert_eq!(
        names,
        [
            "nmpc.period",
            "nmpc.horizon",
            "nmpc.deadline",
            "nmpc.latency",
            "nmpc.weight_thermal",
            "nmpc.weight_acceleration",
            "nmpc.angle_margin",
            "nmpc.thermal_share",
        ]
    );
}

#[test]
fn a_period_too_long_for_the_feedback_is_refused() {
    let mut arm = tflex();
    arm.settings.period = 1.0;
    let planner = |arm: &Arm| {
        Planner::new(
            &arm.settings,
            &arm.arm,
            &arm.motor,
            &arm.limits,
            &arm.feedback,
        )
    };
    let errors = planner(&arm).err().expect("refused");
    assert_eq!(errors[0].name, "nmpc.period");
    let text = errors[0].to_string();
    let longest = text.rsplit(' ').nth(1).expect("a number before the unit");
    // The number given is admissible, and hardly more is.
    arm.settings.period = longest.parse::<f64>().expect("number") - 1e-4;
    assert!(planner(&arm).is_ok(), "{text}");
    arm.settings.period += 2e-2;
    assert!(planner(&arm).is_err(), "{text}");
    arm.settings.period = 1.0;
    arm.settings.models_feedback = false;
    assert!(planner(&arm).is_ok());
}

/// Weights from one end of their range to the other.
#[test]
fn extreme_weights_give_plans_or_are_refused() {
    // Where the interior point finds no way within the angle bounds the status says that they were widened;
    // the general-purpose solver finds one.
    for (solver, most) in [(Method::Riccati, 10), (Method::Automatic, 2)] {
        let [refused, unsolved] = extreme_weights(solver);
        assert_eq!(refused, 0);
        assert!(unsolved <= most, "{solver:?}: {unsolved}");
    }
}

/// How many of 60 draws of weights are refused, and how many of three plans by each of the others unsolved.
fn extreme_weights(solver: Method) -> [u32; 2] {
    let (mut refused, mut unsolved) = (0, 0);
    let mut uniform = Uniform(11);
    for _ in 0..60 {
        let mut arm = if uniform.within(0.0, 1.0) < 0.5 {
            tflex()
        } else {
            pendulum()
        };
        arm.settings.solver = solver;
        let mut weight = |low: f64, high: f64| 10_f64.powf(uniform.within(low, high));
        arm.settings.weights.angle = weight(-6.0, 6.0);
        arm.settings.weights.velocity = weight(-9.0, 3.0);
        arm.settings.weights.thermal = weight(-9.0, 3.0);
        arm.settings.weights.acceleration = weight(-9.0, 3.0);
        let planner = Planner::new(
            &arm.settings,
            &arm.arm,
            &arm.motor,
            &arm.limits,
            &arm.feedback,
        );
        let Ok(mut planner) = planner else {
            refused += 1;
            continue;
        };
        for _ in 0..3 {
            let (initial, goal) = uniform.start(planner.problem(), &RANDOM);
            planner.set_state(&Default::default());
            let plan = planner.plan(&initial, goal);
            assert_finite(plan);
            unsolved += u32::from(!matches!(
                plan.status,
                PlanStatus::Solved | PlanStatus::IterationLimit
            ));
        }
    }
    [refused, unsolved]
}
