//! RK4 (eq 24) of the two parts of the model that are linear whatever the moves are: the deviation from the
//! reference, and the thermal load for given heat.

use arm::{Arithmetic, Vector};

use super::problem::{Model, Problem};
use super::rollout::Stages;

/// RK4 stages per interval.
pub const STAGES: usize = 4;
/// c_j: part of the interval after which a stage looks at the state (eq 24).
pub const ELAPSED: [f64; STAGES] = [0.0, 0.5, 0.5, 1.0];
/// d_j: share of h²·u in the angle that a stage sees (eq 24).
pub const CURVED: [f64; STAGES] = [0.0, 0.0, 0.25, 0.5];
/// Weights of the stages in a step (eq 24).
pub const QUADRATURE: [f64; STAGES] = [1.0 / 6.0, 2.0 / 6.0, 2.0 / 6.0, 1.0 / 6.0];

/// One number for every stage.
pub type Lanes = [f64; STAGES];

/// A 3 × 3 matrix by rows.
pub type Matrix3 = [[f64; 3]; 3];

/// A shooting interval: what RK4 makes of its length.
#[derive(Clone, Copy, Debug)]
pub struct Interval {
    /// h \[s\].
    pub length: f64,
    /// Limit of T at its end \[A²\]; infinite: not limited.
    pub thermal_limit: f64,
    /// c_j·h \[s\].
    pub elapsed: Lanes,
    /// d_j·h² \[s²\].
    pub curved: Lanes,
    /// Weights of the stages in an integral \[s\].
    pub quadrature: Lanes,
    /// Step of the thermal load.
    pub thermal: ThermalStep,
    /// Stage values M_1..M_4 and step M_5 of the deviation.
    pub deviation: [Matrix3; STAGES + 1],
}

impl Interval {
    /// One for every shooting interval of `problem`, or a single one if all are equally long.
    pub fn all(problem: &Problem) -> Vec<Self> {
        let kinds = if problem.is_even() {
            1
        } else {
            problem.horizon
        };
        let lengths = (0..kinds).map(|k| problem.interval_length(k));
        lengths.map(|length| Self::new(problem, length)).collect()
    }

    /// An interval of `length` \[s\].
    pub fn new(problem: &Problem, length: f64) -> Self {
        let deviation = match problem.model {
            Model::Nonlinear => deviation_step(problem, length),
            Model::Qp => exact_deviation_step(problem, length),
        };
        Self {
            length,
            thermal_limit: problem.thermal_limit_after(length),
            elapsed: ELAPSED.map(|part| part * length),
            curved: CURVED.map(|part| part * length * length),
            quadrature: QUADRATURE.map(|weight| weight * length),
            thermal: ThermalStep::new(length / problem.motor.thermal_time_constant),
            deviation,
        }
    }

    /// Price of heat at the stages, ∂/∂q_j \[4\] of ∫q_T·T² over the interval with q_T = `weight_thermal`, T at the stages
    /// being those of `stage`, and of T after it at the price `load_price`, which becomes that of T before it
    /// (eqs 20, 24, 28); in units of the cost \[1/A²\].
    #[inline(always)]
    pub fn heat_price<A: Arithmetic>(
        &self,
        stage: &Stages,
        weight_thermal: f64,
        load_price: &mut f64,
    ) -> A::Vector {
        let (vector, splat) = (A::Vector::new, A::Vector::splat);
        let thermal = &self.thermal;
        let price = splat(*load_price) * vector(thermal.weights());
        *load_price *= thermal.decay();
        if weight_thermal == 0.0 {
            return price;
        }
        let quadrature = vector(&self.quadrature);
        let direct =
            (quadrature + quadrature) * splat(weight_thermal) * vector(&stage.thermal_load);
        let [first, second, third] = &thermal.warming;
        let sums = A::Vector::sums([
            direct * vector(first),
            direct * vector(second),
            direct * vector(third),
            direct * vector(thermal.stage_load()),
        ]);
        let [.., load] = sums.lanes();
        *load_price += load;
        // The last stage warms none.
        sums.mul_add(vector(&[1.0, 1.0, 1.0, 0.0]), price)
    }
}

/// RK4 step of the thermal load (eqs 20, 24); row 5 is the step itself.
#[derive(Clone, Copy, Debug)]
pub struct ThermalStep {
    /// α_j, and last a \[5\].
    pub load: [f64; STAGES + 1],
    /// γ_ji, and last w_i \[5 × 4\].
    pub heat: [Lanes; STAGES + 1],
    /// Columns 1..3 of γ, what each stage's heat does to all stages; the last stage warms none \[3 × 4\].
    pub warming: [Lanes; STAGES - 1],
}

impl ThermalStep {
    /// The step of length κ·T_tc.
    pub fn new(kappa: f64) -> Self {
        // A stage is T + c·κ·(q − T) of the stage before; carry the coefficients of T and q_1..q_4.
        let mut load = [1.0; STAGES + 1];
        let mut heat = [[0.0; STAGES]; STAGES + 1];
        for j in 1..STAGES {
            let step = kappa * ELAPSED[j];
            load[j] = 1.0 - step * load[j - 1];
            heat[j] = heat[j - 1].map(|coefficient| -step * coefficient);
            heat[j][j - 1] += step;
        }
        for (j, weight) in QUADRATURE.into_iter().enumerate() {
            let step = kappa * weight;
            load[STAGES] -= step * load[j];
            let of_stage = heat[j];
            for (total, coefficient) in heat[STAGES].iter_mut().zip(of_stage) {
                *total -= step * coefficient;
            }
            heat[STAGES][j] += step;
        }
        Self {
            load,
            heat,
            warming: std::array::from_fn(|i| std::array::from_fn(|j| heat[j][i])),
        }
    }

    /// α_j: share of T that is left at the stages.
    #[inline(always)]
    pub fn stage_load(&self) -> &Lanes {
        let [load @ .., _] = &self.load;
        load
    }

    /// a: share of T that is left after a step.
    pub fn decay(&self) -> f64 {
        self.load[STAGES]
    }

    /// w_i: weight of (τ_i/Ki)² in the load after a step.
    #[inline(always)]
    pub fn weights(&self) -> &Lanes {
        &self.heat[STAGES]
    }
}

/// F of dz/dt = F·z (eqs 22, 37).
fn deviation_rate(problem: &Problem) -> Matrix3 {
    let feedback = &problem.feedback;
    let gains = [
        feedback.gain_angle,
        feedback.gain_velocity,
        feedback.gain_integral,
    ];
    [
        [0.0, 1.0, 0.0],
        gains.map(|gain| -gain / feedback.inertia),
        [1.0, 0.0, 0.0],
    ]
}

/// The same for the linear model: exact, as its discretisation is (appendix C.2).
fn exact_deviation_step(problem: &Problem, h: f64) -> [Matrix3; STAGES + 1] {
    let f = deviation_rate(problem);
    let f = nalgebra::Matrix3::from_fn(|r, c| f[r][c]);
    std::array::from_fn(|j| {
        let step = (f * (h * ELAPSED.get(j).unwrap_or(&1.0))).exp();
        std::array::from_fn(|r| std::array::from_fn(|c| step[(r, c)]))
    })
}

/// Stage values M_1..M_4 and step M_5 of dz/dt = F·z by RK4 (eq 24).
fn deviation_step(problem: &Problem, h: f64) -> [Matrix3; STAGES + 1] {
    let f = deviation_rate(problem);
    let identity: Matrix3 = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut steps = [identity; STAGES + 1];
    for j in 0..STAGES {
        let slope: Matrix3 = std::array::from_fn(|r| {
            std::array::from_fn(|c| (0..3).map(|i| f[r][i] * steps[j][i][c]).sum())
        });
        for r in 0..3 {
            for c in 0..3 {
                if j + 1 < STAGES {
                    steps[j + 1][r][c] = identity[r][c] + h * ELAPSED[j + 1] * slope[r][c];
                }
                steps[STAGES][r][c] += h * QUADRATURE[j] * slope[r][c];
            }
        }
    }
    steps
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Ever shorter RK4 steps approach the exact one.
    #[test]
    fn the_exact_step_is_the_limit_of_many() {
        let problem = Problem {
            model: Model::Qp,
            ..super::super::examples::tflex()
        };
        let exact = exact_deviation_step(&problem, 0.05);
        let short = deviation_step(&problem, 0.05 / 512.0)[STAGES];
        let matrix = |m: &Matrix3| nalgebra::Matrix3::from_fn(|r, c| m[r][c]);
        for (exponent, exact) in
            [(0, 0), (256, 1), (256, 2), (512, 3), (512, 4)].map(|(n, j)| (n, exact[j]))
        {
            let many = (0..exponent).fold(nalgebra::Matrix3::identity(), |m, _| m * matrix(&short));
            assert!((many - matrix(&exact)).norm() < 1e-8 * matrix(&exact).norm());
        }
    }

    proptest! {
        #[test]
        fn heat_only_warms(kappa in 1e-6..1.0_f64) {
            let step = ThermalStep::new(kappa);
            prop_assert!(step.weights().iter().all(|&w| w > 0.0));
            // A load equal to the heat stays, whatever the step.
            let rest = step.decay() + step.weights().iter().sum::<f64>();
            prop_assert!((rest - 1.0).abs() < 1e-14);
            // A decay is that of eq 20 to fourth order.
            prop_assert!((step.decay() - (-kappa).exp()).abs() <= kappa.powi(5) / 100.0 + 1e-15);
        }
    }
}
