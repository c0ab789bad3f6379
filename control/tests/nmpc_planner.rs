//! What the planner owes whatever it is given: a finite plan, an honest status, limits kept wherever they
//! can be, and the same answer again after a restore.

mod nmpc_arms;
#[path = "nmpc_arms/starts.rs"]
mod starts;

use control::nmpc::plan::{Plan, PlanStatus};
use control::nmpc::planner::Planner;
use control::nmpc::problem::Initial;
use control::nmpc::settings::Method;
use control::nmpc::solver::ANGLE_TOLERANCE;
use nmpc_arms::{Arm, pendulum, tflex};
use proptest::prelude::*;
use starts::{Class, FAR_OVER, OVER, RANDOM, STARVED, STARVED_FAST, Uniform, following, within};

/// Thermal limit of the plan (eq 26) [A²].
fn thermal_limit(arm: &Arm) -> f64 {
    (arm.settings.thermal_share * arm.motor.continuous_current).powi(2)
}

fn assert_finite(plan: &Plan) {
    let nodes = [
        &plan.trajectory.angle,
        &plan.trajectory.reference_angle,
        &plan.trajectory.reference_velocity,
        &plan.trajectory.thermal_load,
    ];
    let mut all = nodes.into_iter().flatten();
    assert!(all.all(|x| x.is_finite()) && plan.trajectory.cost.is_finite());
    assert!(plan.moves.iter().all(|u| u.is_finite()));
}

/// Plans cold from seeded starts and counts statuses as `[solved, thermal_slack, other]`.
fn count(arm: &Arm, seed: u64, plans: u32, class: &Class) -> [u32; 3] {
    let (mut uniform, mut planner) = (Uniform(seed), arm.planner());
    let mut statuses = [0; 3];
    for _ in 0..plans {
        let (initial, goal) = uniform.start(planner.problem(), class);
        planner.set_state(&Default::default());
        let plan = planner.plan(&initial, goal);
        assert_finite(plan);
        let over = plan.trajectory.excess > 1e-6;
        match plan.status {
            PlanStatus::Solved | PlanStatus::GoalProjected => {
                assert!(!over);
                statuses[0] += 1;
            }
            PlanStatus::ThermalSlack => {
                assert!(over);
                statuses[1] += 1;
            }
            _ => statuses[2] += 1,
        }
        assert!(plan.convex_problems <= 8);
        assert!((plan.trajectory.angle[40] - plan.goal).abs() < 1e-8);
        let (low, high) = (planner.problem().angle_lower, planner.problem().angle_upper);
        let nodes = &planner.latest().trajectory.reference_angle[1..40];
        assert!(
            nodes
                .iter()
                .all(|&angle| low - 1e-6 <= angle && angle <= high + 1e-6)
        );
    }
    statuses
}

#[test]
fn random_starts_are_all_solved() {
    for arm in [pendulum(), tflex()] {
        let [solved, ..] = count(&arm, 1, 1000, &RANDOM);
        assert_eq!(solved, 1000);
    }
}

#[test]
fn starved_starts_are_solved_or_exceed_the_limit_least() {
    for (arm, class) in [(pendulum(), STARVED), (tflex(), STARVED_FAST)] {
        let [solved, slack, other] = count(&arm, 2, 1000, &class);
        assert_eq!(other, 0, "{}: unsolved", class.name);
        // Some of these starts are too fast for the heat they may still make.
        assert!(slack <= 66, "{slack} of {}", solved + slack);
    }
}

#[test]
fn starts_above_the_thermal_limit_are_planned() {
    for (arm, class) in [
        (pendulum(), OVER),
        (pendulum(), FAR_OVER),
        (tflex(), OVER),
        (tflex(), FAR_OVER),
    ] {
        let [_, slack, other] = count(&arm, 3, 1000, &class);
        assert_eq!(other, 0, "{}: unfinished", class.name);
        assert!(slack > 0);
    }
}

/// The interior point solves the next plan too, within the angle bounds, and that to another goal; once it took
/// plans for solved that were a little beyond.
#[test]
fn plans_that_go_on_above_the_limit_need_no_other_solver() {
    for (arm, class) in [
        (pendulum(), OVER),
        (pendulum(), FAR_OVER),
        (pendulum(), STARVED_FAST),
        (tflex(), FAR_OVER),
    ] {
        let mut arm = arm;
        arm.settings.solver = Method::Automatic;
        let (mut uniform, mut planner) = (Uniform(5), arm.planner());
        for _ in 0..1000 {
            let (initial, goal) = uniform.start(planner.problem(), &class);
            let (_, other) = uniform.start(planner.problem(), &class);
            planner.set_state(&Default::default());
            planner.plan(&initial, goal);
            let known = planner.state().clone();
            let next = following(planner.latest(), &initial);
            for goal in [goal, other] {
                planner.set_state(&known);
                let plan = planner.plan(&next, goal);
                assert_finite(plan);
                assert_eq!(plan.convex_problems, 0, "{}: {next:?} {goal}", class.name);
                let (low, high) = (planner.problem().angle_lower, planner.problem().angle_upper);
                let bounds = low - ANGLE_TOLERANCE..=high + ANGLE_TOLERANCE;
                assert!(!bounds.contains(&next.reference_angle) || !planner.widened_bounds());
            }
        }
    }
}

/// Pendulum starts that were once left unsolved \[θ, ω, θr, ωr, T, goal\]: moving towards a bound
/// 0.3 to 25 mrad ahead with too little heat left to stop, and, last, one whose steps went round in circles.
const HARD: [[f64; 6]; 6] = [
    [
        0.021528840365676222,
        -0.9075882880996754,
        0.022369467199678948,
        -0.9083489283570712,
        10.773814551535084,
        1.4107637933147967,
    ],
    [
        1.52575134752665,
        1.097432424539665,
        1.5256391377161738,
        1.1112322272605053,
        11.02251016975963,
        0.3254841281314808,
    ],
    [
        0.021668937915909625,
        -0.7386086965427338,
        0.020687225041503388,
        -0.7355097992280175,
        11.11164806234312,
        1.3290434594578073,
    ],
    [
        0.019159226630848267,
        -0.6089480136016256,
        0.020313837527062045,
        -0.6167102029052957,
        11.420591365897893,
        1.536401309134215,
    ],
    [
        1.5373046886234694,
        1.0160584482354742,
        1.5372214547547154,
        1.0086079819128577,
        11.116890852416683,
        0.2746391334556976,
    ],
    [
        0.5152748169764726,
        -0.45719887418566646,
        0.5136253902270882,
        -0.46432458635653284,
        11.061879613315009,
        0.9975918608967812,
    ],
];

#[test]
fn hard_starts_are_solved() {
    let mut planner = pendulum().planner();
    for [
        angle,
        velocity,
        reference_angle,
        reference_velocity,
        thermal_load,
        goal,
    ] in HARD
    {
        let initial = Initial {
            angle,
            velocity,
            reference_angle,
            reference_velocity,
            thermal_load,
            ..Initial::default()
        };
        planner.set_state(&Default::default());
        let plan = planner.plan(&initial, goal);
        assert_finite(plan);
        let solved = [PlanStatus::Solved, PlanStatus::ThermalSlack];
        assert!(
            solved.contains(&plan.status),
            "{:?}: {initial:?}",
            plan.status
        );
        assert_eq!(plan.convex_problems, 0);
        assert!(!planner.widened_bounds());
    }
}

/// Two solvers of different kinds, one answer.
#[test]
fn the_interior_point_and_clarabel_agree() {
    let (mut iterated, mut arm) = (0, pendulum());
    arm.settings.solver = Method::Riccati;
    let mut riccati = arm.planner();
    arm.settings.solver = Method::Clarabel;
    let mut clarabel = arm.planner();
    let mut uniform = Uniform(4);
    for _ in 0..100 {
        let (initial, goal) = uniform.start(riccati.problem(), &within("hot", [0.8, 0.99]));
        riccati.set_state(&Default::default());
        clarabel.set_state(&Default::default());
        let (a, b) = (riccati.plan(&initial, goal), clarabel.plan(&initial, goal));
        iterated += u32::from(a.iterations > 0);
        if (a.status, b.status) == (PlanStatus::Solved, PlanStatus::Solved) {
            let [a, b] = [a, b].map(|plan| plan.trajectory.cost);
            assert!((a - b).abs() <= 1e-6 * b, "{a} {b}");
        } else {
            let [a, b] = [a, b].map(|plan| plan.trajectory.total_excess);
            assert!((a - b).abs() <= 1e-3 * b + 1e-6, "{a} {b}");
        }
    }
    assert!(iterated >= 30, "{iterated}");
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
