use super::super::super::examples::{any_initial, any_moves, pendulum, tflex};
use super::linear::Curvature;
use super::*;
use arm::{Instructions, Separate};
use proptest::prelude::*;

fn any<const S: usize>() -> impl Strategy<Value = [f64; S]> {
    prop::array::uniform(-1.0..1.0_f64)
}

proptest! {
    /// The recursion with the step's structure is that for any step.
    #[test]
    fn structure_changes_nothing(
        load in any::<3>(), integral in any::<2>(), by_move in any::<4>(), root in any::<4>(), h in 0.01..1.0_f64,
        imposed in prop::option::of(any::<4>()),
    ) {
        let square = |v: [f64; 4]| -> [[f64; 4]; 4] {
            std::array::from_fn(|r| std::array::from_fn(|c| v[r] * v[c] + f64::from(r == c)))
        };
        let mut linear = Linear {
            h, load, integral, by_move,
            gradient: [0.0; 4],
            gradient_by_move: 0.0,
            policy: Policy { gain: [0.0; 4], inverse: 0.0 },
            closed: [[0.0; 4]; 4],
            closed_gradient: [0.0; 4],
        };
        let form = Form {
            a: [
                [1.0, h, 0.0, 0.0],
                [0.0, 1.0, 0.0, 0.0],
                [load[0], load[1], load[2], 0.0],
                [integral[0], integral[1], 0.0, 1.0],
            ],
            b: by_move,
            xx: square(by_move),
            xu: root,
            uu: 2.0,
        };
        let own = Curvature { xx: form.xx, xu: form.xu, uu: form.uu };
        let (mut price, mut expected) = (square(root), square(root));
        let policy = form.policy::<Separate>(&mut expected, imposed).expect("convex");
        prop_assert!(linear.recur::<Separate>(&own, &mut price, imposed.as_ref()));
        for r in 0..4 {
            prop_assert!((linear.policy.gain[r] - policy.gain[r]).abs() < 1e-12);
            for c in 0..4 {
                prop_assert!((price[r][c] - expected[r][c]).abs() < 1e-11);
            }
        }
        prop_assert!((linear.policy.inverse - policy.inverse).abs() < 1e-14);
    }

    /// Along the step d, cost and priced loads fall with slope −dᵀHd and bend by dᵀHd, as differences of
    /// true rollouts tell: gradient and curvature are exact.
    #[test]
    fn the_step_solves_the_true_problem(
        initial in any_initial(), goal in 0.2..1.3, moves in any_moves(40), price in 0.0..5e-2_f64, flexure: bool,
        integral: bool, growth in prop_oneof![Just(1.0), 1.0..1.05],
    ) {
        let mut problem = if flexure { tflex() } else { pendulum() };
        problem.growth = growth;
        problem.weights.integral = if integral { 0.3 } else { 0.0 };
        problem.weights.thermal = 1e-5;
        let mut transcription = Transcription::new(problem, Instructions::Baseline);
        transcription.set(initial, goal);
        let mut moves: Vec<f64> = moves.iter().map(|u| 0.1 * u).collect();
        transcription.end_at_rest(&mut moves);
        let slope = if integral {
            along::<4>(&transcription, &moves, price)
        } else {
            along::<3>(&transcription, &moves, price)
        };
        prop_assert!(slope.is_some() || flexure, "the pendulum's curvature has a minimum");
        if let Some([slope, bend, expected]) = slope {
            prop_assert!((slope + expected).abs() <= 1e-4 * expected, "{slope} {expected}");
            prop_assert!((bend - expected).abs() <= 1e-3 * expected, "{bend} {expected}");
        }
    }
}

proptest! {
    /// At any price of heat; all of the curvature of the T-flex's cogging often has none.
    #[test]
    fn the_convex_parts_have_a_minimum(
        initial in any_initial(), goal in 0.2..1.3, moves in any_moves(40), price in 0.0..1e3_f64, flexure: bool,
    ) {
        let problem = if flexure { tflex() } else { pendulum() };
        let mut transcription = Transcription::new(problem, Instructions::Baseline);
        transcription.set(initial, goal);
        let mut rollout = Rollout::new(40);
        transcription.roll_out(&moves, &mut rollout);
        let task = Task {
            transcription: &transcription,
            angle_bounds: &[[-10.0, 10.0]; 39],
            cost_scale: 0.5,
            excess_weight: 1e3,
            time_limit: None,
            safe_set: None,
        };
        let thermal = Inequalities::priced(40, price);
        let bounds = Inequalities::priced(39, 0.0);
        let mut newton = Newton::<3>::new(&transcription);
        let families = [&thermal, &bounds, &bounds];
        prop_assert!(newton.factorise::<Separate>(&task, &moves, &rollout, families, true));
    }
}

/// First and second difference along the Newton step, and dᵀHd; none where the true curvature has no
/// minimum.
fn along<const S: usize>(
    transcription: &Transcription,
    moves: &[f64],
    price: f64,
) -> Option<[f64; 3]> {
    let horizon = moves.len();
    let task = Task {
        safe_set: None,
        transcription,
        angle_bounds: &[[-10.0, 10.0]; 39],
        cost_scale: 0.5,
        excess_weight: 1e3,
        time_limit: None,
    };
    let thermal = Inequalities::priced(horizon, price);
    let bounds = Inequalities::priced(horizon - 1, 0.0);
    let mut rollout = Rollout::new(horizon);
    let mut lagrangian = |moves: &[f64]| {
        transcription.roll_out(moves, &mut rollout);
        rollout.cost / task.cost_scale + price * rollout.thermal_load[1..].iter().sum::<f64>()
    };
    let before = lagrangian(moves);
    let mut start = Rollout::new(horizon);
    transcription.roll_out(moves, &mut start);
    let mut newton = Newton::<S>::new(transcription);
    let families = [&thermal, &bounds, &bounds];
    if !newton.factorise::<Separate>(&task, moves, &start, families, false) {
        return None;
    }
    newton.solve::<Separate>(families);
    let size = 2e-4;
    let mut at = |part: f64| {
        let moved = moves.iter().zip(&newton.moves).map(|(u, d)| u + part * d);
        lagrangian(&moved.collect::<Vec<_>>())
    };
    let (above, below) = (at(size), at(-size));
    Some([
        (above - below) / (2.0 * size),
        (above - 2.0 * before + below) / (size * size),
        2.0 * newton.decrease,
    ])
}
