//! Four inequalities side by side.

use arm::{Arithmetic, LANES, Vector};

/// Multiplier of rows that only fill a group up.
const NEXT_TO_NOTHING: f64 = 1e-200;

/// A number for each of four inequalities.
pub type Lanes = [f64; LANES];

/// Four inequalities.
#[derive(Clone, Copy, Debug)]
pub struct Rows {
    /// 1 for those that leave something to decide, otherwise 0.
    pub open: Lanes,
    /// Bound of the quantity.
    pub bound: Lanes,
    /// c.
    pub value: Lanes,
    /// s.
    pub slack: Lanes,
    /// t; zero without a price.
    pub excess: Lanes,
    /// λ.
    pub multiplier: Lanes,
    /// 1/s.
    pub per_slack: Lanes,
    /// 1/t.
    pub per_excess: Lanes,
    /// 1/λ.
    pub per_multiplier: Lanes,
    /// 1/ν.
    pub per_rest: Lanes,
    /// Σ.
    pub weight: Lanes,
    /// γ = λ + Σ·shift: slope of the step's cost in c.
    pub slope: Lanes,
    /// ds.
    pub slack_step: Lanes,
    /// dt.
    pub excess_step: Lanes,
    /// dλ.
    pub multiplier_step: Lanes,
}

impl Rows {
    /// Rows that only fill a group up.
    pub const IDLE: Self = Self {
        open: [0.0; LANES],
        bound: [0.0; LANES],
        value: [0.0; LANES],
        slack: [1.0; LANES],
        excess: [0.0; LANES],
        multiplier: [NEXT_TO_NOTHING; LANES],
        per_slack: [0.0; LANES],
        per_excess: [0.0; LANES],
        per_multiplier: [0.0; LANES],
        per_rest: [0.0; LANES],
        weight: [0.0; LANES],
        slope: [0.0; LANES],
        slack_step: [0.0; LANES],
        excess_step: [0.0; LANES],
        multiplier_step: [0.0; LANES],
    };

    /// Takes row `l` out, with `multiplier` for good.
    pub fn close(&mut self, l: usize, multiplier: f64) {
        self.open[l] = 0.0;
        self.slack[l] = 1.0;
        self.excess[l] = 1.0;
        self.multiplier[l] = multiplier;
    }

    /// m_s/λ and m_t/ν.
    #[inline(always)]
    pub fn targets<A: Arithmetic>(&self, aim: Aim) -> [A::Vector; 2] {
        let vector = A::Vector::new;
        let (mu, correction) = (A::Vector::splat(aim.mu), A::Vector::splat(aim.correction));
        let step = correction * vector(&self.multiplier_step);
        let of_slack = step.neg_mul_add(vector(&self.slack_step), mu);
        let of_excess = step.mul_add(vector(&self.excess_step), mu);
        [
            of_slack * vector(&self.per_multiplier),
            of_excess * vector(&self.per_rest),
        ]
    }
}

/// Complementarity products that a step aims at: μ, less `correction` times those of the latest changes.
#[derive(Clone, Copy, Debug)]
pub struct Aim {
    /// μ.
    pub mu: f64,
    /// 1 with Mehrotra's correction, otherwise 0.
    pub correction: f64,
}

impl Aim {
    /// The predictor's.
    pub const ZERO: Self = Self {
        mu: 0.0,
        correction: 0.0,
    };
}
