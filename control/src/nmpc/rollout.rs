//! Trajectories in the true model, and the first derivatives of their cost.

use super::rk4::{Lanes, STAGES};

/// The RK4 stages of an interval in a rollout.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stages {
    /// θ − θ_goal \[rad\].
    pub distance: Lanes,
    /// ω \[rad/s\].
    pub velocity: Lanes,
    /// e \[rad·s\]; only where the cost weighs it.
    pub integral: Lanes,
    /// τ (eq 21) \[N·m\].
    pub torque: Lanes,
    /// dg/dθ \[N·m/rad\].
    pub slope: Lanes,
    /// d²g/dθ² \[N·m/rad²\]; not in closed form.
    pub curvature: Lanes,
    /// T \[A²\]; only where the cost weighs it.
    pub thermal_load: Lanes,
}

/// A trajectory in the true model: N intervals, N + 1 nodes.
#[derive(Clone, Debug)]
pub struct Rollout {
    /// θ at the nodes \[N + 1\] \[rad\].
    pub angle: Vec<f64>,
    /// θr at the nodes \[N + 1\] \[rad\].
    pub reference_angle: Vec<f64>,
    /// ωr at the nodes \[N + 1\] \[rad/s\].
    pub reference_velocity: Vec<f64>,
    /// T at the nodes \[N + 1\] \[A²\].
    pub thermal_load: Vec<f64>,
    /// RK4 stages of the intervals \[N\].
    pub stages: Vec<Stages>,
    /// Cost (eqs 24, 28) \[rad²·s\].
    pub cost: f64,
    /// Largest excess of T over its limit at the nodes after the first \[A²\].
    pub excess: f64,
    /// Sum of the excesses of T over its limit at the nodes after the first \[A²\].
    pub total_excess: f64,
}

impl Rollout {
    /// Space for a trajectory of `horizon` intervals.
    pub fn new(horizon: usize) -> Self {
        let nodes = || vec![0.0; horizon + 1];
        Self {
            angle: nodes(),
            reference_angle: nodes(),
            reference_velocity: nodes(),
            thermal_load: nodes(),
            stages: vec![Stages::default(); horizon],
            cost: 0.0,
            excess: 0.0,
            total_excess: 0.0,
        }
    }

    /// Whether cost and trajectory are finite numbers.
    pub fn is_finite(&self) -> bool {
        // Each node follows from the one before: what is no finite number once never is again.
        let ends = [
            &self.angle,
            &self.reference_angle,
            &self.reference_velocity,
            &self.thermal_load,
        ];
        let mut ends = ends.iter().map(|nodes| nodes.last());
        self.cost.is_finite() && ends.all(|end| end.is_some_and(|end| end.is_finite()))
    }
}

/// Whether all are finite numbers.
pub fn are_finite(numbers: &[f64]) -> bool {
    // x·0 is 0 for a finite number only; sums side by side take several numbers in one instruction.
    let (chunks, rest) = numbers.as_chunks::<8>();
    let mut sums = [0.0; 8];
    for chunk in chunks {
        for (sum, x) in sums.iter_mut().zip(chunk) {
            *sum += 0.0 * x;
        }
    }
    let rest: f64 = rest.iter().map(|x| 0.0 * x).sum();
    sums.iter().sum::<f64>() + rest == 0.0
}

/// First derivatives of the cost along a rollout, e and T eliminated.
#[derive(Clone, Debug)]
pub struct Sensitivity {
    /// ∂cost/∂(θr, ωr, u) of every interval \[N × 3\].
    pub gradient: Vec<[f64; 3]>,
    /// λ_j = ∂cost/∂(τ_j/Ki)² of every interval and stage \[N × 4\].
    pub heat_price: Vec<Lanes>,
}

impl Sensitivity {
    /// Space for `horizon` intervals.
    pub fn new(horizon: usize) -> Self {
        Self {
            gradient: vec![[0.0; 3]; horizon],
            heat_price: vec![[0.0; STAGES]; horizon],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::examples::{pendulum, tflex};
    use super::super::problem::Initial;
    use super::super::transcription::Transcription;
    use super::*;
    use arm::Instructions;

    #[test]
    fn what_is_no_finite_number_is_found_wherever_it_is() {
        for length in 0..20 {
            assert!(are_finite(&vec![-f64::MAX; length]));
            for at in 0..length {
                for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                    let mut numbers = vec![1.0; length];
                    numbers[at] = bad;
                    assert!(!are_finite(&numbers));
                }
            }
        }
    }

    #[test]
    fn a_rollout_is_finite_if_all_of_it_is() {
        for problem in [pendulum(), tflex()] {
            let mut transcription = Transcription::new(problem, Instructions::Baseline);
            let mut rollout = Rollout::new(40);
            for bad in [f64::NAN, f64::INFINITY, f64::MAX] {
                for at in 0..40 {
                    transcription.set(Initial::default(), 1.0);
                    let mut moves = [0.1; 40];
                    transcription.roll_out(&moves, &mut rollout);
                    assert!(rollout.is_finite());
                    moves[at] = bad;
                    transcription.roll_out(&moves, &mut rollout);
                    assert!(!rollout.is_finite(), "{bad} at {at}");
                }
            }
            let start = |start: fn(&mut Initial)| {
                let mut initial = Initial::default();
                start(&mut initial);
                initial
            };
            for initial in [
                start(|initial| initial.angle = f64::NAN),
                start(|initial| initial.velocity = f64::INFINITY),
                start(|initial| initial.thermal_load = f64::INFINITY),
            ] {
                transcription.set(initial, 1.0);
                transcription.roll_out(&[0.1; 40], &mut rollout);
                assert!(!rollout.is_finite(), "{initial:?}");
            }
        }
    }
}
