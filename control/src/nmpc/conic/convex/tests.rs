use super::super::super::examples::{any_initial, any_moves, pendulum, tflex};
use super::super::super::safe_set::SafeSet;
use super::super::super::spline::{Spline, hessian};
use super::*;
use proptest::prelude::*;

/// Moves that stay at the goal, but for the ends.
fn at_goal(transcription: &Transcription, goal: f64) -> Spline {
    let mut spline = Spline::new(transcription.problem());
    spline.free().fill(goal);
    spline.fix_ends(transcription);
    spline
}

/// Its moves and their rollout.
fn roll_out(transcription: &Transcription, spline: &Spline) -> (Vec<f64>, Rollout) {
    let horizon = transcription.problem().horizon;
    let (mut moves, mut rollout) = (vec![0.0; horizon], Rollout::new(horizon));
    spline.moves(transcription, &mut moves);
    transcription.roll_out(&moves, &mut rollout);
    (moves, rollout)
}

proptest! {
    /// Where g is affine the convex problem is no approximation: for any step its cost is the true
    /// one, and its rows hold with the true loads exactly, the cones without room.
    #[test]
    fn for_an_affine_torque_cost_and_cones_are_exact(
        initial in any_initial(), goal in 0.1..1.4, steps in any_moves(38), flexure: bool,
    ) {
        let mut problem = if flexure { tflex() } else { pendulum() };
        problem.arm.cogging_cos = [0.0; 9];
        problem.arm.cogging_sin = [0.0; 9];
        problem.arm.damping = 0.1;
        problem.weights.thermal = 0.0;
        let mut transcription = Transcription::new(problem, arm::Instructions::best());
        transcription.set(initial, goal);
        let bounds = vec![[problem.angle_lower, problem.angle_upper]; 39];
        let task = Task {
            transcription: &transcription,
            angle_bounds: &bounds,
            safe_set: None,
            cost_scale: 0.1,
            excess_weight: 1e3,
            time_limit: None,
        };
        let mut convex = Convex::new(&transcription, hessian(&transcription));
        let mut spline = at_goal(&transcription, goal);
        let (moves, from) = roll_out(&transcription, &spline);
        convex.pose(&task, &moves, &from, 0.5);

        let mut solution = DefaultSolution::new(convex.a.n, convex.a.m);
        for (x, step) in solution.x.iter_mut().zip(&steps) {
            *x = 0.01 * step;
        }
        for (c, x) in spline.free().iter_mut().zip(&solution.x) {
            *c += convex.sigma() * x;
        }
        let (_, trial) = roll_out(&transcription, &spline);
        let limit = problem.thermal_limit.expect("limited");
        for k in 0..40 {
            let change = trial.thermal_load[k + 1] - from.thermal_load[k + 1];
            solution.x[38 + k] = change / (convex.heat_weight * limit);
            let excess = (trial.thermal_load[k + 1] - limit).max(0.0);
            solution.x[78 + k] = excess / (convex.heat_weight * limit);
        }
        solution.z.fill(1.0);
        let promise = convex.promise(&task, &solution, &from, &trial);
        let merits = [task.merit(&from), task.merit(&trial)];
        let accuracy = 1e-9 * (merits[0] + merits[1] + 1.0);
        prop_assert!(promise.misjudged <= accuracy, "{}", promise.misjudged);
        prop_assert!((promise.decrease - (merits[0] - merits[1])).abs() <= accuracy);
        prop_assert!((promise.excess - trial.excess).abs() <= 1e-9);

        // s = b − A·x: angle rows give the distance to the bounds, cones lie on their boundary.
        let mut s = convex.b.clone();
        for (column, x) in solution.x.iter().enumerate() {
            for place in convex.a.colptr[column]..convex.a.colptr[column + 1] {
                s[convex.a.rowval[place]] -= convex.a.nzval[place] * x;
            }
        }
        for k in 0..39 {
            let angle = trial.reference_angle[k + 1];
            let sigma = convex.sigma();
            prop_assert!((s[k] * sigma - (problem.angle_upper - angle)).abs() < 1e-9);
            prop_assert!((s[39 + k] * sigma - (angle - problem.angle_lower)).abs() < 1e-9);
        }
        for k in 0..40 {
            let cone = &s[convex.cone_row(k)..][..CONE];
            let norm = cone[1..].iter().map(|x| x * x).sum::<f64>().sqrt();
            prop_assert!((cone[0] - norm).abs() <= 1e-8 * (1.0 + norm), "{k}: {} {norm}", cone[0]);
        }
    }
}

/// The curvature of the cost of heat is that of λ·q with τ affine.
#[test]
fn the_cost_of_heat_bends_the_problem() {
    let mut problem = tflex();
    problem.weights.thermal = 1.0;
    let mut transcription = Transcription::new(problem, arm::Instructions::best());
    let initial = super::super::super::problem::Initial {
        angle: 1.1,
        reference_angle: 1.1,
        thermal_load: 5.0,
        ..Default::default()
    };
    transcription.set(initial, 1.3);
    let task = Task {
        transcription: &transcription,
        angle_bounds: &[[0.9, 1.6]; 39],
        safe_set: None,
        cost_scale: 1.0,
        excess_weight: 1e3,
        time_limit: None,
    };
    let hessian = hessian(&transcription);
    let mut convex = Convex::new(&transcription, hessian.clone());
    let mut rollout = Rollout::new(40);
    transcription.roll_out(&[0.0; 40], &mut rollout);
    convex.pose(&task, &[0.0; 40], &rollout, 0.0);
    let m = 20;
    let scale = convex.sigma().powi(2);
    let places = convex.p.colptr[m]..convex.p.colptr[m + 1];
    for (place, row) in places.zip(m - 2..=m) {
        let mut expected = hessian[(row, m)];
        for k in 0..40 {
            for j in 0..STAGES {
                let slope = convex.torque_slope(&task, &rollout, k, j);
                let of = |index: usize| {
                    let column = (index + 2).checked_sub(k).filter(|&column| column < 3);
                    column.map_or(0.0, |column| slope[column])
                };
                expected += 2.0 * convex.sensitivity.heat_price[k][j] * of(row) * of(m)
                    / problem.motor.torque_constant.powi(2);
            }
        }
        assert!((convex.p.nzval[place] / scale - expected).abs() < 1e-9 * expected.abs());
    }
}

/// s = b − A·x.
fn slack_of(convex: &Convex, x: &[f64]) -> Vec<f64> {
    let mut s = convex.b.clone();
    for (column, x) in x.iter().enumerate() {
        for place in convex.a.colptr[column]..convex.a.colptr[column + 1] {
            s[convex.a.rowval[place]] -= convex.a.nzval[place] * x;
        }
    }
    s
}

proptest! {
    /// For the true end of any step the rows and cones of the safe sets hold exactly when the sets do, and
    /// the last row of the thermal limit has the heat of stopping in it.
    #[test]
    fn rows_and_cones_describe_the_safe_sets(
        initial in any_initial(), goal in 0.1..1.4, steps in any_moves(12), flexure: bool, damping in 0.0..0.5,
    ) {
        let mut problem = if flexure { tflex() } else { pendulum() };
        (problem.terminal, problem.horizon) = (Terminal::SafeSet, 12);
        problem.arm.damping = damping;
        let mut transcription = Transcription::new(problem, arm::Instructions::best());
        transcription.set(initial, goal);
        let set = SafeSet::new(&problem, problem.angle_lower, problem.angle_upper);
        let bounds = [[problem.angle_lower, problem.angle_upper]; 12];
        let task = Task {
            transcription: &transcription,
            angle_bounds: &bounds,
            safe_set: Some(&set),
            cost_scale: 0.1,
            excess_weight: 1e3,
            time_limit: None,
        };
        let mut convex = Convex::new(&transcription, hessian(&transcription));
        let mut spline = at_goal(&transcription, goal);
        let (moves, from) = roll_out(&transcription, &spline);
        convex.pose(&task, &moves, &from, 0.0);
        let mut x = vec![0.0; convex.a.n];
        for ((c, x), step) in spline.free().iter_mut().zip(&mut x).zip(&steps) {
            *x = 1e-3 * step / convex.sigma();
            *c += 1e-3 * step;
        }
        let (_, trial) = roll_out(&transcription, &spline);
        let (angle, velocity) = (trial.reference_angle[12], trial.reference_velocity[12]);
        let unit = convex.heat_weight * problem.thermal_limit.expect("limited");
        for k in 0..12 {
            x[12 + k] = (trial.thermal_load[k + 1] - from.thermal_load[k + 1]) / unit;
        }
        // The best choice of the variables of either side.
        let range = set.upper - set.lower;
        let rooms = [set.upper - angle, angle - set.lower];
        for (index, side) in set.sides.iter().enumerate() {
            let w = if index == 0 { velocity } else { -velocity }.max(0.0);
            let y = (rooms[index] - 0.5 * set.interval * w).min(0.5 * set.time * w).max(0.0);
            let unit_velocity = (2.0 * side.deceleration * range).sqrt();
            let (w, y) = (w / unit_velocity, y / range);
            let r = if w > 0.0 { w * w * w / y } else { 0.0 };
            let [q, p] = [w.sqrt(), (r * y).sqrt()];
            x[36 + 5 * index..][..5].copy_from_slice(&[w, y, p, q, r]);
        }
        prop_assume!(x.iter().all(|x| x.is_finite()));
        let s = slack_of(&convex, &x);
        let inside = |s: &[f64]| {
            let linear = s[convex.safe_row()..convex.cone_row(0)].iter().all(|&s| s >= -1e-9);
            let cones = s[convex.cone_row(12)..].chunks(3).all(|cone| {
                cone[0] - cone[1].hypot(cone[2]) >= -1e-9
            });
            linear && cones
        };
        let short = set.kinetic_excess(angle, velocity);
        prop_assume!(short == 0.0 || short > 1e-6);
        prop_assert_eq!(inside(&s), short == 0.0, "{} {}", angle, velocity);
        if short == 0.0 {
            let left = problem.thermal_limit.expect("limited") - trial.thermal_load[12] - set.heat(angle, velocity);
            prop_assert!((s[convex.last_room_row()] * unit - left).abs() <= 1e-7 * (1.0 + left.abs()));
        }
    }

    /// For any step the rows of the torque limit are what the linear model says of its end.
    #[test]
    fn rows_describe_the_torque_limit(
        initial in any_initial(), goal in 0.1..1.4, steps in any_moves(12), rest: bool, growth in 1.0..1.3,
    ) {
        let settings = crate::nmpc::settings::Settings {
            model: crate::nmpc::problem::Model::Qp,
            solver: crate::nmpc::settings::Method::Clarabel,
            ..crate::Settings::tflex().nmpc
        };
        let tflex = crate::Settings::tflex();
        let feedback = super::super::super::examples::feedback(&tflex);
        let problem = settings.problem(&tflex.arm, &tflex.motor, &tflex.limits, &feedback);
        let mut problem = problem.expect("admissible");
        problem.horizon = 12;
        (problem.growth, problem.longest) = (growth, 0.2);
        problem.terminal = if rest { Terminal::RestAtGoal } else { Terminal::Free };
        let mut transcription = Transcription::new(problem, arm::Instructions::best());
        transcription.set(initial, goal);
        let bounds = [[problem.angle_lower, problem.angle_upper]; 12];
        let task = Task {
            transcription: &transcription,
            angle_bounds: &bounds[..problem.bounded_nodes()],
            safe_set: None,
            cost_scale: 0.1,
            excess_weight: 1e3,
            time_limit: None,
        };
        let mut convex = Convex::new(&transcription, hessian(&transcription));
        let mut spline = at_goal(&transcription, goal);
        let (moves, from) = roll_out(&transcription, &spline);
        convex.pose(&task, &moves, &from, 0.0);
        let mut solution = DefaultSolution::new(convex.a.n, convex.a.m);
        for ((c, x), step) in spline.free().iter_mut().zip(&mut solution.x).zip(&steps) {
            *x = 1e-2 * step / convex.sigma();
            *c += 1e-2 * step;
        }
        let (moves, trial) = roll_out(&transcription, &spline);
        let excess = task.torque_excess(&trial).max(0.0);
        let slack = convex.torque_slack();
        solution.x[slack] = excess / torque_rows::UNIT;
        let s = slack_of(&convex, &solution.x);
        // By the slack the worst row is kept just so.
        let rows = &s[convex.torque_row()..convex.safe_row()];
        prop_assert!(rows.iter().all(|&row| row >= -1e-7 * (1.0 + excess)));
        let worst = rows[..48].iter().fold(f64::INFINITY, |least, row| least.min(*row));
        prop_assert!(excess == 0.0 || worst.abs() <= 1e-7 * (1.0 + excess), "{worst} {excess}");
        // And so is g itself.
        let limit = problem.torque_limit.expect("limited");
        for k in 0..12 {
            for end in [k, k + 1] {
                let torque = problem.arm.position_torque(trial.angle[end])
                    + problem.arm.damping * trial.reference_velocity[end]
                    + problem.arm.inertia * moves[k];
                let within = (tflex.limits.angle_lower..=tflex.limits.angle_upper).contains(&trial.angle[end]);
                prop_assert!(!within || torque.abs() <= limit.most * (1.0 + excess) + 1e-9);
            }
        }
        let merits = [task.merit(&from), task.merit(&trial)];
        let promise = convex.promise(&task, &solution, &from, &trial);
        let accuracy = 1e-9 * (merits[0] + merits[1] + 1.0);
        prop_assert!(promise.misjudged <= accuracy && (promise.decrease - (merits[0] - merits[1])).abs() <= accuracy);
    }
}
