//! Plans from thousands of seeded starts: all are solved, by the interior point alone, and by both solvers alike.

mod nmpc_arms;
#[path = "nmpc_arms/starts.rs"]
mod starts;

use control::nmpc::plan::PlanStatus;
use control::nmpc::problem::Initial;
use control::nmpc::settings::Method;
use nmpc_arms::{Arm, assert_finite, pendulum, tflex};
use starts::{Class, FAR_OVER, OVER, RANDOM, STARVED, STARVED_FAST, Uniform, following, within};

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
                let inside = planner.problem().admits_angle(next.reference_angle);
                assert!(!inside || !planner.widened_bounds());
            }
        }
    }
}

/// Pendulum starts that were once left unsolved \[θ, ω, θr, ωr, T, goal\]: moving towards a bound
/// 0.3 to 25 mrad ahead with too little heat left to stop, and, last, one whose steps went round in circles.
#[rustfmt::skip]
const HARD: [[f64; 6]; 6] = [
    [0.021528840365676222, -0.9075882880996754, 0.022369467199678948, -0.9083489283570712, 10.773814551535084, 1.4107637933147967],
    [1.52575134752665, 1.097432424539665, 1.5256391377161738, 1.1112322272605053, 11.02251016975963, 0.3254841281314808],
    [0.021668937915909625, -0.7386086965427338, 0.020687225041503388, -0.7355097992280175, 11.11164806234312, 1.3290434594578073],
    [0.019159226630848267, -0.6089480136016256, 0.020313837527062045, -0.6167102029052957, 11.420591365897893, 1.536401309134215],
    [1.5373046886234694, 1.0160584482354742, 1.5372214547547154, 1.0086079819128577, 11.116890852416683, 0.2746391334556976],
    [0.5152748169764726, -0.45719887418566646, 0.5136253902270882, -0.46432458635653284, 11.061879613315009, 0.9975918608967812],
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
