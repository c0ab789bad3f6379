use super::*;
use crate::nmpc::examples::{any_initial, pendulum, tflex};
use arm::Instructions;
use proptest::prelude::*;

proptest! {
    /// No other moves with the same end are cheaper: the gradient is zero along all that keep it.
    #[test]
    fn the_optimum_is_stationary(
        initial in any_initial(), goal in 0.1..1.4, flexure: bool, integral: bool, growth in prop_oneof![Just(1.0), 1.0..1.05],
        heat in prop_oneof![Just(1.0), 1.0..100.0],
    ) {
        let mut problem = if flexure { tflex() } else { pendulum() };
        problem.weights.thermal *= heat;
        problem.weights.integral = if integral { 1.0 } else { 0.0 };
        (problem.growth, problem.longest) = (growth, f64::INFINITY);
        let mut transcription = Transcription::new(problem, Instructions::best());
        transcription.set(initial, goal);
        let mut unconstrained = Unconstrained::new(&transcription).expect("definite");
        let (mut moves, mut rollout) = (vec![0.0; 40], Rollout::new(40));
        prop_assert!(unconstrained.solve(&transcription, &mut moves, &mut rollout));
        prop_assert!((rollout.angle[40] - goal).abs() < 1e-9);
        // What further Newton steps gain, to the end.
        let weight = problem.weights.thermal;
        let (mut best, mut better) = (moves.clone(), rollout.clone());
        for _ in 0..6 {
            let mut sensitivity = Sensitivity::new(40);
            transcription.differentiate(weight, &best, &better, &mut sensitivity);
            unconstrained.sensitivity = sensitivity;
            unconstrained.descend::<Separate>();
            unconstrained.complete_step::<Separate>();
            unconstrained.add_step(1.0, &mut best);
            transcription.roll_out(&best, &mut better);
        }
        let left = (rollout.cost - better.cost).max(0.0);
        prop_assert!(left <= 1.1e-8 * better.cost, "{left} of {}", better.cost);
        // Any change of a move, with the end kept.
        let optimum = rollout.cost;
        for k in [0, 7, 30, 37] {
            let change = |du: f64| {
                let mut moves = moves.clone();
                moves[k] += du;
                transcription.end_at_rest(&mut moves);
                let mut rollout = Rollout::new(40);
                transcription.roll_out(&moves, &mut rollout);
                rollout.cost - optimum
            };
            let (up, down) = (change(1e-2), change(-1e-2));
            prop_assert!(up > 0.0 && down > 0.0);
            // Cauchy–Schwarz: no slope is above that of the Newton step in units of their curvatures.
            let slope = 2.0 * (2.0 * left * (up + down)).sqrt();
            prop_assert!((up - down).abs() <= 1.1 * slope + 1e-3 * (up + down) + 1e-9 * optimum, "{k}: {up} {down}");
        }
    }

    /// Where the policies lead the gradient of q_T is the whole gradient, ∫T² by the trapezoidal rule that of RK4 but for a little.
    #[test]
    fn heat_promises_what_the_whole_cost_does(
        initial in any_initial(), goal in 0.1..1.4, flexure: bool, integral: bool, growth in prop_oneof![Just(1.0), 1.0..1.05],
        heat in 1e-6..1e-3_f64,
    ) {
        let mut problem = if flexure { tflex() } else { pendulum() };
        problem.weights.thermal = heat;
        problem.weights.integral = if integral { 1.0 } else { 0.0 };
        (problem.growth, problem.longest) = (growth, f64::INFINITY);
        let mut transcription = Transcription::new(problem, Instructions::Baseline);
        transcription.set(initial, goal);
        let mut unconstrained = Unconstrained::new(&transcription).expect("definite");
        let (mut moves, mut rollout) = (vec![0.0; 40], Rollout::new(40));
        unconstrained.follow_policies::<Separate>(&transcription, &mut moves);
        transcription.roll_out(&moves, &mut rollout);
        let promised = unconstrained.promised_by_heat::<Separate>(&transcription, &rollout);
        prop_assert!(promised > 0.0);
        transcription.differentiate(heat, &moves, &rollout, &mut unconstrained.sensitivity);
        let whole = unconstrained.descend::<Separate>();
        let most = 0.05 * (whole + SETTLED * rollout.cost);
        prop_assert!((promised - whole).abs() <= most, "{promised} {whole}");
        // What differences of the trapezoidal sum promise, as a cost of the moves alone.
        let mut sum = |moves: &[f64]| {
            transcription.roll_out(moves, &mut rollout);
            let ends = rollout.thermal_load.windows(2).enumerate();
            let of = |(k, t): (usize, &[f64])| {
                0.5 * heat * transcription.interval(k).length * (t[0] * t[0] + t[1] * t[1])
            };
            ends.map(of).sum::<f64>()
        };
        for k in 0..40 {
            let mut at = |du: f64| {
                let mut moves = moves.clone();
                moves[k] += du;
                sum(&moves)
            };
            let slope = (at(1e-4) - at(-1e-4)) / 2e-4;
            unconstrained.sensitivity.gradient[k] = [0.0, 0.0, slope];
        }
        let exact = unconstrained.descend::<Separate>();
        prop_assert!((promised - exact).abs() <= 1e-4 * exact, "{promised} {exact}");
    }

    /// The weight of the paper is too small for a step: the moves are those without it.
    #[test]
    fn the_thermal_weight_of_the_paper_takes_no_step(initial in any_initial(), goal in 0.95..1.5) {
        let plan = |weight: f64| {
            let mut problem = tflex();
            problem.weights.thermal = weight;
            let mut transcription = Transcription::new(problem, Instructions::best());
            transcription.set(initial, goal);
            let mut unconstrained = Unconstrained::new(&transcription).expect("definite");
            let (mut moves, mut rollout) = (vec![0.0; 40], Rollout::new(40));
            unconstrained.solve(&transcription, &mut moves, &mut rollout);
            moves
        };
        prop_assert_eq!(plan(1e-6), plan(0.0));
    }

    /// ½·xᵀPx is the cost, where z = 0 and e = 0.
    #[test]
    fn the_price_is_the_cost_of_the_optimum(distance in -1.0..1.0_f64) {
        let mut transcription = Transcription::new(pendulum(), Instructions::best());
        let initial = crate::nmpc::problem::Initial {
            angle: 0.7 + distance,
            reference_angle: 0.7 + distance,
            ..Default::default()
        };
        transcription.set(initial, 0.7);
        let mut unconstrained = Unconstrained::new(&transcription).expect("definite");
        let (mut moves, mut rollout) = (vec![0.0; 40], Rollout::new(40));
        unconstrained.solve(&transcription, &mut moves, &mut rollout);
        let expected = unconstrained.cost_of_movement(distance);
        prop_assert!((rollout.cost - expected).abs() <= 1e-9 * expected);
    }
}
