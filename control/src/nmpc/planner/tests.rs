use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use super::super::examples::feedback;
use super::super::solver::{Multipliers, Outcome};
use super::*;

/// A solver that finds nothing, or stops too early.
struct Unable(SolverStatus);

impl Solver for Unable {
    fn solve(
        &mut self,
        _: &Task<'_>,
        _: &mut [f64],
        _: &mut Rollout,
        _: &mut Multipliers,
    ) -> Outcome {
        Outcome {
            status: self.0,
            iterations: 7,
            convex_problems: 1,
        }
    }
}

/// A clock on which 1 s goes by with every look at it.
#[derive(Default)]
struct Ticking(Cell<f64>);

impl Clock for Ticking {
    fn now(&self) -> f64 {
        self.0.set(self.0.get() + 1.0);
        self.0.get()
    }
}

fn planner() -> Planner {
    planner_of(Settings {
        solver: Method::Automatic,
        ..crate::Settings::pendulum().nmpc
    })
}

fn planner_of(nmpc: Settings) -> Planner {
    planner_for(&crate::Settings {
        nmpc,
        ..crate::Settings::pendulum()
    })
}

fn planner_for(settings: &crate::Settings) -> Planner {
    let crate::Settings {
        arm,
        motor,
        limits,
        nmpc,
        ..
    } = settings;
    Planner::new(nmpc, arm, motor, limits, &feedback(settings)).expect("admissible")
}

/// Starved, so that a solver is needed.
fn starved() -> Initial {
    Initial {
        angle: 0.3,
        reference_angle: 0.3,
        thermal_load: 10.9,
        ..Initial::default()
    }
}

fn next(plan: &Plan, initial: &Initial) -> Initial {
    Initial {
        angle: plan.trajectory.angle[1],
        velocity: plan.trajectory.reference_velocity[1],
        reference_angle: plan.trajectory.reference_angle[1],
        reference_velocity: plan.trajectory.reference_velocity[1],
        thermal_load: plan.trajectory.thermal_load[1],
        ..*initial
    }
}

#[test]
fn without_a_new_plan_the_previous_one_goes_on_to_its_end() {
    let mut planner = planner();
    let plan = planner.plan(&starved(), 1.2);
    assert_eq!(plan.status, PlanStatus::Solved);
    let (first, mut initial) = (plan.clone(), next(plan, &starved()));
    planner.solvers = vec![Box::new(Unable(SolverStatus::Infeasible))];
    for k in 1..40 {
        // Too hot for the plan without inequalities.
        initial.thermal_load = 12.0;
        let plan = planner.plan(&initial, 0.3);
        assert_eq!(plan.status, PlanStatus::ShiftedPlan, "{k}");
        for (u, expected) in plan.moves.iter().zip(&first.moves[k..]) {
            assert!((u - expected).abs() < 1e-12, "{u} {expected}");
        }
        initial = next(plan, &initial);
    }
    assert!((initial.angle - 1.2).abs() < 1e-9);
    assert!(initial.reference_velocity.abs() < 1e-9);
}

#[test]
fn an_unfinished_plan_that_exceeds_the_limit_gives_way_to_one_that_does_not() {
    let mut planner = planner();
    let plan = planner.plan(&starved(), 1.2);
    let initial = next(plan, &starved());
    planner.solvers = vec![Box::new(Unable(SolverStatus::IterationLimit))];
    let plan = planner.plan(&initial, 1.4);
    assert_eq!(plan.status, PlanStatus::ShiftedPlan);
    assert!(plan.trajectory.excess <= THERMAL_TOLERANCE);
}

#[test]
fn without_any_plan_the_reference_is_braked_within_the_bounds() {
    let mut planner = planner();
    planner.solvers = vec![Box::new(Unable(SolverStatus::Infeasible))];
    let initial = Initial {
        reference_velocity: 2.0,
        velocity: 2.0,
        ..starved()
    };
    let plan = planner.plan(&initial, 1.2);
    assert_eq!(plan.status, PlanStatus::Rest);
    let (angles, velocities) = (
        &plan.trajectory.reference_angle,
        &plan.trajectory.reference_velocity,
    );
    assert!(velocities[40].abs() < 1e-12);
    let upper = Limits::pendulum().angle_upper - 0.02;
    assert!(angles.iter().all(|&angle| angle <= upper + 1e-12));
    // The braking is a plan like others: it goes on.
    let second = next(plan, &initial);
    assert_eq!(planner.plan(&second, 1.2).status, PlanStatus::ShiftedPlan);
}

#[test]
fn a_shifted_plan_from_another_reference_is_not_followed() {
    let mut planner = planner();
    planner.plan(&starved(), 1.2);
    planner.solvers = vec![Box::new(Unable(SolverStatus::Infeasible))];
    let elsewhere = Initial {
        reference_velocity: -1.0,
        ..starved()
    };
    assert_eq!(planner.plan(&elsewhere, 1.2).status, PlanStatus::Rest);
}

#[test]
fn a_state_that_is_not_made_of_numbers_does_no_harm() {
    let mut planner = planner();
    let state = PlannerState {
        moves: vec![f64::NAN; 40],
        age: Some(0),
        multipliers: Multipliers {
            known: true,
            thermal: vec![f64::NAN; 40],
            lower: vec![f64::INFINITY; 39],
            upper: vec![-1.0; 39],
        },
    };
    planner.set_state(&state);
    assert_eq!(planner.plan(&starved(), 1.2).status, PlanStatus::Solved);
    planner.set_state(&state);
    planner.solvers = vec![Box::new(Unable(SolverStatus::Infeasible))];
    let plan = planner.plan(&starved(), 1.2);
    assert_eq!(plan.status, PlanStatus::Rest);
    assert!(plan.moves.iter().all(|u| u.is_finite()));
}

/// The optimum of least heat is to wait; a guess that goes to the goal at once is many iterations away from it.
#[test]
fn far_above_its_limit_the_arm_waits_where_it_takes_little_torque() {
    let mut planner = planner_for(&crate::Settings::tflex());
    for start in [0.96, 1.0, 1.05, 1.1] {
        planner.set_state(&PlannerState::default());
        let hot = Initial {
            angle: start,
            reference_angle: start,
            thermal_load: 14.0,
            ..Initial::default()
        };
        let plan = planner.plan(&hot, 1.24);
        assert_eq!(plan.status, PlanStatus::ThermalSlack);
        assert!(plan.iterations <= 3, "{} iterations", plan.iterations);
        let angles = &plan.trajectory.reference_angle[12..28];
        let waits = angles.iter().all(|angle| (angle - 0.97).abs() < 0.03);
        assert!(waits, "from {start}: {angles:?}");
    }
}

#[test]
fn the_solvers_work_is_reported() {
    let mut planner = planner();
    planner.solvers = vec![Box::new(Unable(SolverStatus::Solved))];
    let plan = planner.plan(&starved(), 1.2);
    assert_eq!((plan.iterations, plan.convex_problems), (7, 1));
}

#[test]
fn multipliers_of_another_length_count_as_no_state() {
    let mut planner = planner();
    planner.plan(&starved(), 1.2);
    for thermal in [vec![], vec![0.0; 41]] {
        let mut state = planner.state().clone();
        state.multipliers.thermal = thermal;
        planner.set_state(&state);
        assert_eq!(planner.state().age, None);
        assert_eq!(planner.plan(&starved(), 1.2).status, PlanStatus::Solved);
    }
}

/// Numbers of any kind for multipliers cost iterations at most.
#[test]
fn wrong_multipliers_still_lead_to_the_plan() {
    let mut planner = planner();
    let first = planner.plan(&starved(), 1.2).clone();
    let initial = next(&first, &starved());
    let state = planner.state().clone();
    let expected = planner.plan(&initial, 1.2).trajectory.cost;
    for wrong in [f64::NAN, f64::INFINITY, -1.0, 1e300] {
        let mut state = state.clone();
        state.multipliers.thermal.fill(wrong);
        state.multipliers.upper.fill(wrong);
        planner.set_state(&state);
        let plan = planner.plan(&initial, 1.2);
        assert_eq!(plan.status, PlanStatus::Solved, "{wrong}");
        let cost = plan.trajectory.cost;
        assert!(
            (cost - expected).abs() <= 1e-6 * expected,
            "{wrong}: {cost} {expected}"
        );
    }
}

#[test]
fn a_growing_grid_falls_back_to_rest_too() {
    let mut planner = planner_of(Settings {
        period: 0.01,
        duration: 2.0,
        ..crate::Settings::pendulum().nmpc
    });
    let plan = planner.plan(&starved(), 1.2);
    assert_eq!(plan.status, PlanStatus::Solved);
    assert!((plan.time[40] - 2.0).abs() < 1e-9);
    let mut initial = next(plan, &starved());
    planner.solvers = vec![Box::new(Unable(SolverStatus::Infeasible))];
    for k in 1..200 {
        initial.thermal_load = 12.0;
        let plan = planner.plan(&initial, 0.3);
        assert_eq!(plan.status, PlanStatus::ShiftedPlan, "{k}");
        initial = next(plan, &initial);
    }
    // Velocities are those of the plan, angles to what averaging within intervals of 57 ms leaves.
    assert!(initial.reference_velocity.abs() < 1e-9);
    assert!((initial.angle - 1.2).abs() < 1e-3, "{}", initial.angle);
    assert_eq!(planner.plan(&initial, 0.3).status, PlanStatus::Rest);
}

/// A clock that stands still until it is told otherwise.
#[derive(Clone, Default)]
struct Hanging(Arc<AtomicU64>);

impl Clock for Hanging {
    /// 5 µs an iteration, but the first ever takes 20 ms.
    fn now(&self) -> f64 {
        let looks = self.0.fetch_add(1, Ordering::Relaxed);
        5e-6 * looks as f64 + if looks > 1 { 0.02 } else { 0.0 }
    }
}

#[test]
fn one_slow_iteration_does_not_forbid_all_others() {
    let mut planner = planner_of(crate::Settings::pendulum().nmpc);
    planner.set_clock(Box::new(Hanging::default()));
    planner.deadline = 0.01;
    let mut solved = 0;
    for _ in 0..50 {
        planner.set_state(&PlannerState::default());
        solved += u32::from(planner.plan(&starved(), 1.2).status == PlanStatus::Solved);
    }
    assert!(solved >= 45, "{solved}");
}

/// Where there was no time to find a way within the angle bounds, none beyond them is taken.
#[test]
fn no_plan_leaves_the_bounds_for_lack_of_time() {
    let mut planner = planner_of(crate::Settings::pendulum().nmpc);
    let problem = *planner.problem();
    let inside = problem.angle_lower - 1e-6..=problem.angle_upper + 1e-6;
    let mut stopped = 0;
    // Cool starts towards the upper bound: low-discrepancy numbers instead of random ones.
    let part = |i: u32, root: f64| (f64::from(i) * root.sqrt()).fract();
    for i in 1..400 {
        let angle = 1.3 + 0.25 * part(i, 2.0);
        let velocity = 3.0 * part(i, 3.0);
        let goal = 0.05 + 1.45 * part(i, 5.0);
        let initial = Initial {
            angle,
            reference_angle: angle,
            velocity,
            reference_velocity: velocity,
            thermal_load: part(i, 7.0),
            ..Initial::default()
        };
        for deadline in 1..12 {
            planner.set_state(&PlannerState::default());
            planner.set_clock(Box::new(Ticking::default()));
            planner.deadline = f64::from(deadline);
            let plan = planner.plan(&initial, goal);
            let angles = &plan.trajectory.reference_angle;
            let keeps = angles.iter().all(|angle| inside.contains(angle));
            let status = plan.status;
            assert!(
                keeps || status == PlanStatus::Rest,
                "{initial:?} {deadline}: {status:?}"
            );
            stopped += u32::from(matches!(status, PlanStatus::Rest | PlanStatus::Deadline));
        }
    }
    assert!(stopped > 20, "{stopped}");
}

#[test]
fn a_deadline_is_kept_and_leaves_a_plan_and_no_trace() {
    let rest = Terminal::RestAtGoal;
    for (solver, terminal) in [
        (Method::Automatic, rest),
        (Method::Riccati, rest),
        (Method::Clarabel, rest),
        (Method::Clarabel, Terminal::SafeSet),
    ] {
        let settings = Settings {
            solver,
            terminal,
            ..crate::Settings::pendulum().nmpc
        };
        let (mut stopped, mut reference) = (planner_of(settings), planner_of(settings));
        let first = stopped.plan(&starved(), 1.2).clone();
        let initial = next(&first, &starved());
        let before = stopped.state().clone();
        reference.set_state(&before);
        let expected = reference.plan(&initial, 1.4).trajectory.cost;
        let mut seen = [false; 3];
        for deadline in 1..60 {
            stopped.set_state(&before);
            stopped.set_clock(Box::new(Ticking::default()));
            stopped.deadline = f64::from(deadline);
            let plan = stopped.plan(&initial, 1.4);
            assert!(plan.trajectory.excess <= THERMAL_TOLERANCE, "{deadline}");
            let cost = plan.trajectory.cost;
            match plan.status {
                PlanStatus::Solved => {
                    seen[0] = true;
                    assert!((cost - expected).abs() <= 1e-6 * expected);
                }
                PlanStatus::Deadline => {
                    seen[1] = true;
                    assert!(cost >= expected * (1.0 - 1e-6));
                }
                PlanStatus::ShiftedPlan => seen[2] = true,
                other => panic!("{solver:?}, {deadline}: {other:?}"),
            }
            // Every solver looks once to find that there is no time for another iteration.
            let late = stopped
                .clock
                .as_ref()
                .map(|clock| clock.now() - 1.0 - stopped.end);
            assert!(late <= Some(1.0), "{solver:?}, {deadline}: {late:?}");

            // The next plan knows nothing of it.
            stopped.deadline = 0.0;
            let plan = stopped.plan(&initial, 1.4);
            assert_eq!(plan.status, PlanStatus::Solved);
            assert!((plan.trajectory.cost - expected).abs() <= 1e-6 * expected);
        }
        assert!(seen[0] && seen[1], "{solver:?}: {seen:?}");
    }
}

/// Plans that end in a safe set, without a solver from some moment on: what is left of the plan and then the
/// braking lead to rest, and no limit is exceeded on the way.
#[test]
fn a_plan_into_a_safe_set_is_followed_by_braking_within_all_limits() {
    let mut planner = planner_of(Settings {
        horizon: 5,
        terminal: Terminal::SafeSet,
        ..planner_settings()
    });
    let problem = *planner.problem();
    let limit = problem.thermal_limit.expect("limited");
    let mut longest = 0;
    for (k, load) in [0.9, 0.99, 0.999].into_iter().cycle().enumerate().take(60) {
        planner.set_state(&PlannerState::default());
        planner.solvers = conic(&planner);
        let part = |root: f64| (k as f64 * root.sqrt()).fract();
        let mut initial = Initial {
            angle: 0.1 + 1.3 * part(2.0),
            thermal_load: load * limit,
            ..Initial::default()
        };
        initial.reference_angle = initial.angle;
        let goal = 0.1 + 1.3 * part(3.0);
        for _ in 0..k % 7 {
            initial = next(planner.plan(&initial, goal), &initial);
        }
        let plan = planner.plan(&initial, goal);
        assert_eq!(plan.status, PlanStatus::Solved);
        let end = plan.end()[1];
        initial = next(plan, &initial);
        planner.solvers = vec![Box::new(Unable(SolverStatus::Infeasible))];
        // The optimum without inequalities must not come to help.
        let hopeless = |initial: &Initial| Initial {
            thermal_load: 2.0 * limit,
            ..*initial
        };
        let mut periods = 0;
        while initial.reference_velocity.abs() > 1e-9 {
            let plan = planner.plan(&hopeless(&initial), goal);
            assert_eq!(plan.status, PlanStatus::ShiftedPlan, "{k}, {periods}");
            let moves = plan.moves.clone();
            // Again from the load that it has.
            planner.transcription.set(initial, goal);
            planner
                .transcription
                .roll_out(&moves, &mut planner.plan.trajectory);
            initial = next(&planner.plan, &initial);
            assert!(initial.thermal_load <= limit + 1e-6);
            let angle = initial.reference_angle;
            assert!(problem.angle_lower - 1e-7 <= angle && angle <= problem.angle_upper + 1e-7);
            periods += 1;
        }
        assert!(end == 0.0 || periods > 4, "{k}: {periods} periods");
        longest = longest.max(periods);
    }
    assert!(longest > 5, "some braking is beyond the horizon: {longest}");
}

/// Without any plan the reference is braked as the safe set says, from outside of it too.
#[test]
fn without_any_plan_the_safe_sets_braking_is_followed() {
    let mut planner = planner_of(Settings {
        horizon: 5,
        terminal: Terminal::SafeSet,
        ..planner_settings()
    });
    planner.solvers = vec![Box::new(Unable(SolverStatus::Infeasible))];
    for (velocity, periods) in [(0.4, 40), (-3.0, 20), (20.0, 1)] {
        planner.set_state(&PlannerState::default());
        let mut initial = Initial {
            angle: 1.3,
            reference_angle: 1.3,
            velocity,
            reference_velocity: velocity,
            thermal_load: 20.0,
            ..Initial::default()
        };
        for k in 0..periods {
            let plan = planner.plan(&initial, 0.5);
            let expected = if k == 0 {
                PlanStatus::Rest
            } else {
                PlanStatus::ShiftedPlan
            };
            assert_eq!(plan.status, expected, "{velocity}, {k}");
            initial = next(plan, &initial);
        }
        assert!(initial.reference_velocity.abs() < 1e-9, "{velocity}");
    }
}

fn conic(planner: &Planner) -> Vec<Box<dyn Solver + Send>> {
    let hessian = spline::hessian(&planner.transcription);
    vec![Box::new(Conic::new(&planner.transcription, hessian))]
}

/// Settings of plans by Clarabel.
fn planner_settings() -> Settings {
    Settings {
        solver: Method::Clarabel,
        ..crate::Settings::pendulum().nmpc
    }
}
