use super::super::examples::{any_initial, any_moves, pendulum, tflex};
use super::*;
use crate::nmpc::rollout::Sensitivity;
use proptest::prelude::*;

/// Eqs 22, 24, 28 as printed: all states at once. Returns (θ, ω, θr, ωr, e, T, e_L) at every node
/// and the cost.
fn direct(problem: &Problem, initial: &Initial, goal: f64, moves: &[f64]) -> (Vec<[f64; 7]>, f64) {
    let Problem {
        arm,
        motor,
        feedback,
        weights,
        period: h,
        ..
    } = problem;
    let derivative = |x: &[f64; 7], u: f64| -> [f64; 7] {
        let [
            angle,
            velocity,
            reference_angle,
            reference_velocity,
            _,
            load,
            integral,
        ] = *x;
        let error = angle - reference_angle;
        let fb = -feedback.gain_angle * error
            - feedback.gain_velocity * (velocity - reference_velocity)
            - feedback.gain_integral * integral;
        let torque =
            arm.position_torque(angle) + arm.damping * reference_velocity + arm.inertia * u;
        let heat = (torque / motor.torque_constant).powi(2);
        [
            velocity,
            u + fb / feedback.inertia,
            reference_velocity,
            u,
            angle - goal,
            (heat - load) / motor.thermal_time_constant,
            error,
        ]
    };
    let loss = |x: &[f64; 7], u: f64| {
        weights.angle * (x[0] - goal).powi(2)
            + weights.velocity * x[1].powi(2)
            + weights.integral * x[4].powi(2)
            + weights.thermal * x[5].powi(2)
            + weights.acceleration * u * u
    };
    let step = |x: &[f64; 7], k: &[f64; 7], h: f64| -> [f64; 7] {
        std::array::from_fn(|i| x[i] + h * k[i])
    };
    let mut nodes = vec![[
        initial.angle,
        initial.velocity,
        initial.reference_angle,
        initial.reference_velocity,
        initial.integral,
        initial.thermal_load,
        initial.feedback_integral,
    ]];
    let mut cost = 0.0;
    for &u in moves {
        let x1 = nodes[nodes.len() - 1];
        let k1 = derivative(&x1, u);
        let x2 = step(&x1, &k1, h / 2.0);
        let k2 = derivative(&x2, u);
        let x3 = step(&x1, &k2, h / 2.0);
        let k3 = derivative(&x3, u);
        let x4 = step(&x1, &k3, *h);
        let k4 = derivative(&x4, u);
        cost += h / 6.0 * (loss(&x1, u) + 2.0 * loss(&x2, u) + 2.0 * loss(&x3, u) + loss(&x4, u));
        nodes.push(std::array::from_fn(|i| {
            x1[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i])
        }));
    }
    (nodes, cost)
}

/// All weights and gains in play.
fn rich(mut problem: Problem) -> Problem {
    problem.weights.integral = 0.3;
    problem.weights.thermal = 1e-3;
    problem.feedback.gain_integral = 40.0;
    problem.horizon = 12;
    problem
}

fn rolled_out(
    problem: Problem,
    initial: Initial,
    goal: f64,
    moves: &[f64],
) -> (Transcription, Rollout) {
    let mut transcription = Transcription::new(problem, Instructions::best());
    transcription.set(initial, goal);
    let mut rollout = Rollout::new(problem.horizon);
    transcription.roll_out(moves, &mut rollout);
    (transcription, rollout)
}

proptest! {
    #[test]
    fn the_reduced_form_is_rk4_of_all_states(
        initial in any_initial(), goal in 0.0..1.5, moves in any_moves(12), flexure: bool,
    ) {
        let problem = rich(if flexure { tflex() } else { pendulum() });
        let (transcription, rollout) = rolled_out(problem, initial, goal, &moves);
        let (nodes, cost) = direct(&problem, &initial, goal, &moves);
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-10 * (1.0 + b.abs());
        prop_assert!(close(rollout.cost, cost), "{} {cost}", rollout.cost);
        for (k, x) in nodes.iter().enumerate() {
            prop_assert!(close(rollout.angle[k], x[0]));
            prop_assert!(close(rollout.reference_angle[k], x[2]));
            prop_assert!(close(rollout.reference_velocity[k], x[3]));
            prop_assert!(close(rollout.thermal_load[k], x[5]));
        }
        // Terminal rest of the arm asks for the deviation's opposite of the reference.
        let end = nodes[12];
        let [angle, velocity] = transcription.terminal_reference();
        prop_assert!(close(angle - goal, end[2] - end[0]));
        prop_assert!(close(velocity, end[3] - end[1]));
    }

    #[test]
    fn sensitivities_agree_with_differences(
        initial in any_initial(), goal in 0.0..1.5, moves in any_moves(12), flexure: bool,
    ) {
        let problem = rich(if flexure { tflex() } else { pendulum() });
        let (transcription, rollout) = rolled_out(problem, initial, goal, &moves);
        let mut sensitivity = Sensitivity::new(12);
        transcription.differentiate(problem.weights.thermal, &moves, &rollout, &mut sensitivity);
        prop_assert!(sensitivity.heat_price.iter().flatten().all(|&price| price >= 0.0));
        // dcost/du_k in full: own interval, and the states of all later ones.
        let h = problem.period;
        for k in 0..12 {
            let later = (k + 1..12).map(|l| {
                let [angle, velocity, _] = sensitivity.gradient[l];
                angle * h * h * ((l - k) as f64 - 0.5) + velocity * h
            });
            let slope = sensitivity.gradient[k][2] + later.sum::<f64>();
            let cost_at = |change: f64| {
                let mut moves = moves.clone();
                moves[k] += change;
                rolled_out(problem, initial, goal, &moves).1.cost
            };
            let difference = (cost_at(1e-4) - cost_at(-1e-4)) / 2e-4;
            prop_assert!((slope - difference).abs() <= 1e-6 * (1.0 + difference.abs()),
                "{k}: {slope} {difference}");
        }
    }
}
