//! What plans owe that end in a safe set instead of at rest (appendix B): from every start that can be
//! stopped at all, no limit is ever violated, however short the horizon.

#[path = "common/mod.rs"]
mod common;
mod nmpc_arms;
#[path = "nmpc_arms/starts.rs"]
#[allow(dead_code, reason = "every test file uses a part")]
mod starts;

use arm::thermal;
use common::Loop;
use common::rates::{PENDULUM, TFLEX, setpoint};
use control::Settings;
use control::nmpc::plan::{Plan, PlanStatus};
use control::nmpc::planner::Planner;
use control::nmpc::problem::{Initial, Model, Problem, Terminal};
use control::nmpc::rest::RestPoints;
use control::nmpc::safe_set::SafeSet;
use control::nmpc::settings::Method;
use control::nmpc::solver::THERMAL_TOLERANCE;
use nmpc_arms::{Arm, pendulum, tflex};
use starts::{Class, Uniform, following, within};

const HORIZONS: [i32; 4] = [5, 10, 20, 40];
const STARTS: u32 = 200;
/// Plans until rest at most.
const PLANS: u32 = 200;

/// A planner of `arm` with another end and horizon.
fn planner(arm: &Arm, terminal: Terminal, horizon: i32) -> Planner {
    let mut arm = arm.clone();
    arm.settings.terminal = terminal;
    arm.settings.horizon = horizon;
    arm.settings.solver = Method::Clarabel;
    arm.planner()
}

/// A start on the reference, from which the arm can be stopped within all limits, and a goal.
fn start(uniform: &mut Uniform, problem: &Problem, class: &Class) -> (Initial, f64) {
    loop {
        let (mut initial, goal) = uniform.start(problem, class);
        (initial.angle, initial.velocity) = (initial.reference_angle, initial.reference_velocity);
        let rest = RestPoints::new(problem);
        let (_, interval) = rest.nearest(goal);
        let [lower, upper] = rest.intervals()[interval];
        let set = SafeSet::new(problem, lower, upper);
        let heat = set.heat(initial.angle, initial.velocity);
        if set.kinetic_excess(initial.angle, initial.velocity) <= 0.0
            && initial.thermal_load + heat <= set.thermal_limit
        {
            return (initial, goal);
        }
    }
}

/// Largest violations of the plans' limits seen at the nodes, the load's by RK4 and by small steps of eq 20.
#[derive(Default, Debug)]
struct Worst {
    angle: f64,
    load: f64,
    simulated: f64,
}

/// Thermal load after a period of `initial` with the acceleration `u`, by 200 steps.
fn simulated(problem: &Problem, initial: &Initial, u: f64) -> f64 {
    let h = problem.period / 200.0;
    (0..200).fold(initial.thermal_load, |load, i| {
        let t = (f64::from(i) + 0.5) * h;
        let velocity = initial.reference_velocity + t * u;
        let angle = initial.reference_angle + t * initial.reference_velocity + 0.5 * t * t * u;
        let arm = &problem.arm;
        let torque = arm.position_torque(angle) + arm.damping * velocity + arm.inertia * u;
        thermal::update(&problem.motor, load, torque, h)
    })
}

/// Closed loops until rest from [`STARTS`] starts.
#[derive(Default)]
struct Runs {
    /// Starts from which no plan ends at rest within the limits.
    infeasible: u32,
    plans: u32,
    /// Plans that are neither solved nor stopped while within all limits.
    missing: u32,
    worst: Worst,
}

fn runs(arm: &Arm, horizon: i32, class: &Class) -> Runs {
    let mut equality = planner(arm, Terminal::RestAtGoal, horizon);
    let mut safe = planner(arm, Terminal::SafeSet, horizon);
    let problem = *safe.problem();
    let limit = problem.thermal_limit.expect("limited");
    let (mut uniform, mut runs) = (Uniform(17), Runs::default());
    for _ in 0..STARTS {
        let (mut initial, goal) = start(&mut uniform, &problem, class);
        equality.set_state(&Default::default());
        let status = equality.plan(&initial, goal).status;
        runs.infeasible += u32::from(status != PlanStatus::Solved);
        safe.set_state(&Default::default());
        let (mut plans, mut is_there) = (0, false);
        while !is_there {
            let plan = safe.plan(&initial, goal);
            let found = matches!(
                plan.status,
                PlanStatus::Solved | PlanStatus::GoalProjected | PlanStatus::IterationLimit
            );
            let rest = plan.goal;
            runs.missing += u32::from(!found);
            let simulated = simulated(&problem, &initial, plan.moves[0]);
            initial = following(plan, &initial);
            let angle = initial.reference_angle;
            let worst = &mut runs.worst;
            let beyond = f64::max(angle - problem.angle_upper, problem.angle_lower - angle);
            worst.angle = worst.angle.max(beyond);
            worst.load = worst.load.max(initial.thermal_load - limit);
            worst.simulated = worst.simulated.max(simulated - limit);
            is_there = (initial.angle - rest).abs() < 1e-3 && initial.velocity.abs() < 1e-3;
            plans += 1;
            assert!(
                plans < PLANS,
                "no rest after {PLANS} plans: {initial:?} to {goal}"
            );
        }
        runs.plans += plans;
    }
    runs
}

/// The T-flex plans every 10 ms here and is flung away from its goal: over 0.25 s its motor can end at rest from
/// anywhere.
#[test]
fn safe_sets_violate_no_limit_where_terminal_rest_is_infeasible() {
    let mut fast = tflex();
    fast.settings.period = 0.01;
    let cases = [
        ("pendulum", pendulum(), within("hot", [0.6, 0.999])),
        (
            "T-flex",
            fast,
            Class {
                away: Some([2.0, 12.0]),
                ..within("hot and fast", [0.99, 0.9999])
            },
        ),
    ];
    for (name, arm, class) in cases {
        let mut infeasible = [0; 4];
        for (horizon, infeasible) in HORIZONS.into_iter().zip(&mut infeasible) {
            let runs = runs(&arm, horizon, &class);
            let Worst {
                angle,
                load,
                simulated,
            } = runs.worst;
            eprintln!(
                "{name}, N = {horizon}: from {} of {STARTS} starts no plan ends at rest; {} plans into safe sets, {} \
                 missing, beyond the limits by {angle:.1e} rad, {load:.1e} A² (simulated {simulated:.1e} A²)",
                runs.infeasible, runs.plans, runs.missing
            );
            assert!(angle <= 1e-7 && load <= THERMAL_TOLERANCE && simulated <= 1e-5);
            assert_eq!(runs.missing, 0);
            *infeasible = runs.infeasible;
        }
        assert!(infeasible[0] >= STARTS / 4, "{name}: {infeasible:?}");
        assert!(
            infeasible.is_sorted_by(|a, b| a >= b),
            "{name}: {infeasible:?}"
        );
    }
}

/// A motor that cannot hold the arm everywhere: it rests, and stops, where the motor can hold it for ever.
#[test]
fn a_weak_motor_keeps_to_where_it_can_rest() {
    let mut weak = pendulum();
    weak.motor.continuous_current = 1.4;
    let problem = *planner(&weak, Terminal::SafeSet, 5).problem();
    let rest = RestPoints::new(&problem).intervals().to_vec();
    assert!(
        rest.iter()
            .all(|[l, u]| u - l < 0.9 * (problem.angle_upper - problem.angle_lower)),
        "narrower than the limits: {rest:?}"
    );
    let runs = runs(&weak, 5, &within("warm", [0.3, 0.95]));
    assert!(runs.worst.angle <= 1e-7 && runs.worst.load <= THERMAL_TOLERANCE);
    assert_eq!(runs.missing, 0);
}

/// The plan before, which stays where it is, is far from the new one: found from the plan without inequalities.
#[test]
fn a_goal_that_moves_after_a_rest_is_planned_for() {
    for horizon in HORIZONS {
        let mut planner = planner(&pendulum(), Terminal::SafeSet, horizon);
        let at_rest = Initial {
            angle: 0.1,
            reference_angle: 0.1,
            thermal_load: 10.7,
            ..Initial::default()
        };
        for _ in 0..8 {
            assert_eq!(planner.plan(&at_rest, 0.1).status, PlanStatus::Solved);
        }
        for goal in [0.5, 1.0, 1.4] {
            let plan = planner.plan(&at_rest, goal);
            assert_eq!(plan.status, PlanStatus::Solved, "N = {horizon}, to {goal}");
            assert!(plan.trajectory.angle[horizon as usize] > 0.12);
        }
    }
}

/// The whole controller on its arm, with horizons of 0.25 s and hot motors: setpoint after setpoint, and every
/// limit of the arm kept, which without terminal set it is not.
#[test]
fn controllers_with_short_horizons_violate_no_limit() {
    for (name, settings, sequence, start) in [
        ("T-flex", Settings::tflex(), TFLEX, 1.3),
        ("pendulum", Settings::pendulum(), PENDULUM, 0.785),
    ] {
        let mut settings = settings;
        settings.nmpc.horizon = 5;
        settings.nmpc.terminal = Terminal::SafeSet;
        settings.nmpc.solver = Method::Automatic;
        settings.initial_thermal_load = 11.0;
        let mut closed_loop = Loop::new(&settings, settings.arm, start);
        let (mut score, mut slack) = (0.0, 0);
        for sample in 0..40_000 {
            let [goal, _] = setpoint(&sequence, f64::from(sample) * settings.sample_period);
            let command = closed_loop.step(goal, 0.0);
            score += (goal - closed_loop.motion.angle).powi(2);
            assert!(!closed_loop.violates(), "{name}, sample {sample}");
            slack += u32::from(command.new_plan && command.plan_status != PlanStatus::Solved);
        }
        eprintln!("{name}: {score:.1}, {slack} of 200 plans not solved within their own limits");
        assert!(slack <= 20, "{name}: {slack}");
    }
}

/// Intervals that grow: the same promise as with equal ones, at the nodes of the plans.
#[test]
fn growing_intervals_end_in_safe_sets_too() {
    for mut arm in [pendulum(), tflex()] {
        (arm.settings.period, arm.settings.duration) = (2e-3, 0.3);
        let mut planner = planner(&arm, Terminal::SafeSet, 16);
        let problem = *planner.problem();
        let limit = problem.thermal_limit.expect("limited");
        let class = within("hot", [0.6, 0.99]);
        let (mut uniform, mut plans, mut missing) = (Uniform(23), 0, 0);
        for _ in 0..10 {
            let (mut initial, goal) = start(&mut uniform, &problem, &class);
            planner.set_state(&Default::default());
            for _ in 0..150 {
                let plan = planner.plan(&initial, goal);
                plans += 1;
                missing += u32::from(plan.status != PlanStatus::Solved);
                initial = following(plan, &initial);
                assert!(initial.thermal_load <= limit + THERMAL_TOLERANCE);
                let angle = initial.reference_angle;
                assert!(problem.angle_lower - 1e-6 <= angle && angle <= problem.angle_upper + 1e-6);
            }
        }
        eprintln!("{missing} of {plans} plans missing");
        assert!(missing <= plans / 100);
    }
}

/// A planner rebuilt from its parameters and given the state goes on bit by bit, whatever the model and end.
#[test]
fn a_restored_planner_goes_on_to_the_bit() {
    for (model, terminal) in [
        (Model::Nonlinear, Terminal::SafeSet),
        (Model::Nonlinear, Terminal::Free),
        (Model::Qp, Terminal::RestAtGoal),
        (Model::Qp, Terminal::SafeSet),
    ] {
        let mut arm = pendulum();
        arm.settings.model = model;
        let class = within("hot", [0.9, 0.999]);
        let mut original = planner(&arm, terminal, 10);
        let (mut uniform, mut iterated) = (Uniform(29), 0);
        for _ in 0..20 {
            let (mut initial, goal) = uniform.start(original.problem(), &class);
            let mut restored = planner(&arm, terminal, 10);
            restored.set_state(original.state());
            for k in 0..3 {
                if k == 2 {
                    // No number: the previous plan goes on.
                    initial.angle = f64::NAN;
                }
                let (a, b) = (original.plan(&initial, goal), restored.plan(&initial, goal));
                let bits =
                    |plan: &Plan| -> Vec<u64> { plan.moves.iter().map(|u| u.to_bits()).collect() };
                assert_eq!(
                    (a.status, bits(a)),
                    (b.status, bits(b)),
                    "{model:?}, {terminal:?}"
                );
                iterated += a.iterations;
                initial = following(a, &initial);
            }
            assert_eq!(original.state(), restored.state());
        }
        assert!(iterated > 100, "{model:?}, {terminal:?}: {iterated}");
    }
}

/// Weights from one end of their range to the other, any start: finite plans, and nearly all of them solved.
#[test]
fn extreme_weights_give_plans() {
    let mut uniform = Uniform(31);
    let (mut plans, mut unsolved) = (0, 0);
    for k in 0..80 {
        let mut arm = if k % 2 == 0 { tflex() } else { pendulum() };
        let mut weight = |low: f64, high: f64| 10_f64.powf(uniform.within(low, high));
        arm.settings.weights.angle = weight(-6.0, 6.0);
        arm.settings.weights.velocity = weight(-9.0, 3.0);
        arm.settings.weights.thermal = weight(-9.0, 3.0);
        arm.settings.weights.acceleration = weight(-9.0, 3.0);
        if k % 4 < 2 {
            arm.settings.model = Model::Qp;
        }
        let horizon = [2, 5, 12, 40][k / 4 % 4];
        let mut planner = planner(&arm, Terminal::SafeSet, horizon);
        for _ in 0..3 {
            let (initial, goal) = start(&mut uniform, planner.problem(), &starts::RANDOM);
            planner.set_state(&Default::default());
            let plan = planner.plan(&initial, goal);
            assert!(plan.trajectory.is_finite() && plan.moves.iter().all(|u| u.is_finite()));
            let solved = matches!(plan.status, PlanStatus::Solved | PlanStatus::GoalProjected);
            unsolved += u32::from(!solved);
            plans += 1;
        }
    }
    eprintln!("{unsolved} of {plans} plans unsolved");
    assert!(unsolved <= plans / 20);
}
