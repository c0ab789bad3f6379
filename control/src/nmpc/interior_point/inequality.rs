//! The inequalities of a plan in the interior point's terms.
//!
//! Each is c ≤ 0, written c + s − t = r with slack s > 0, excess t > 0 at the price ρ, and a residual r that
//! the iterations bring to zero. With the multiplier λ of c, 0 < λ < ρ, and ν = ρ − λ that of t, the
//! optimum has λ·s = ν·t = 0, which is approached as λ·s = ν·t = μ. Inequalities without a price have no t.
//!
//! Eliminating ds, dt and dλ from a Newton step leaves, for the change dc of c,
//!
//! ```text
//! λ + dλ = λ + Σ·(shift + dc)     Σ = 1/(s/λ + t/ν)     shift = c + m_s/λ − m_t/ν
//! ds = m_s/λ − s − (s/λ)·dλ       dt = m_t/ν − t + (t/ν)·dλ
//! ```
//!
//! with m_s = m_t = μ, less the product of the predictor's changes (Mehrotra's correction).

use arm::Arithmetic;

/// Part of the way to the boundary that a step may go.
const TO_BOUNDARY: f64 = 0.995;
/// Factors of a product whose logarithm is taken at once; 16 numbers of 1e-18 do not underflow.
const FACTORS: usize = 16;

/// A family of inequalities, one a node.
#[derive(Clone, Debug)]
pub struct Inequalities {
    /// ρ; infinite: no excess.
    pub price: f64,
    /// How many are exceeded whatever the moves: there λ = ρ, and nothing is left to decide.
    pub lost: usize,
    /// c.
    pub value: Vec<f64>,
    /// s.
    pub slack: Vec<f64>,
    /// t.
    pub excess: Vec<f64>,
    /// λ.
    pub multiplier: Vec<f64>,
    /// Σ.
    pub weight: Vec<f64>,
    /// What dc is added to in the change of λ.
    shift: Vec<f64>,
    /// γ = λ + Σ·shift: slope of the step's cost in c.
    pub slope: Vec<f64>,
    slack_step: Vec<f64>,
    excess_step: Vec<f64>,
    multiplier_step: Vec<f64>,
}

impl Inequalities {
    /// `count` inequalities.
    pub fn new(count: usize, price: f64) -> Self {
        let zeros = || vec![0.0; count];
        Self {
            price,
            lost: 0,
            value: zeros(),
            slack: zeros(),
            excess: zeros(),
            multiplier: zeros(),
            weight: zeros(),
            shift: zeros(),
            slope: zeros(),
            slack_step: zeros(),
            excess_step: zeros(),
            multiplier_step: zeros(),
        }
    }

    fn len(&self) -> usize {
        self.value.len()
    }

    fn elastic(&self) -> bool {
        self.price.is_finite()
    }

    /// Number of complementarity products.
    pub fn products(&self) -> f64 {
        let each = if self.elastic() { 2.0 } else { 1.0 };
        each * (self.len() - self.lost) as f64
    }

    /// Slacks, excesses and multipliers with products `mu`, near the multipliers there are and with slacks
    /// of at least `least` where there are none.
    pub fn start(&mut self, mu: f64, least: f64) {
        self.multiplier[..self.lost].fill(self.price);
        self.slope[..self.lost].fill(self.price);
        self.weight[..self.lost].fill(0.0);
        self.multiplier_step[..self.lost].fill(0.0);
        let highest = if self.elastic() {
            0.9 * self.price
        } else {
            1e12
        };
        for i in self.lost..self.len() {
            let guess = self.multiplier[i].min(highest);
            let floor = if guess > 0.0 { mu / guess } else { least };
            let slack = f64::max(-self.value[i], floor);
            self.slack[i] = slack;
            self.multiplier[i] = (mu / slack).min(highest);
            self.excess[i] = if self.elastic() {
                mu / (self.price - self.multiplier[i])
            } else {
                0.0
            };
        }
    }

    /// Σ of the complementarity products.
    #[inline(always)]
    pub fn gap(&self) -> f64 {
        let mut gap = 0.0;
        for i in self.lost..self.len() {
            gap += self.multiplier[i] * self.slack[i];
        }
        if self.elastic() {
            for i in self.lost..self.len() {
                gap += (self.price - self.multiplier[i]) * self.excess[i];
            }
        }
        gap
    }

    /// Σ|r| and the largest r.
    #[inline(always)]
    pub fn residuals(&self) -> [f64; 2] {
        let (mut sum, mut most) = (0.0, 0.0_f64);
        for i in self.lost..self.len() {
            let residual = (self.value[i] + self.slack[i] - self.excess[i]).abs();
            sum += residual;
            most = most.max(residual);
        }
        [sum, most]
    }

    /// Weights and slopes of a step towards products of zero.
    #[inline(always)]
    pub fn predict(&mut self) {
        for i in self.lost..self.len() {
            let (s, lambda) = (self.slack[i], self.multiplier[i]);
            self.weight[i] = lambda / s;
        }
        if self.elastic() {
            for i in self.lost..self.len() {
                let flexibility = self.excess[i] / (self.price - self.multiplier[i]);
                self.weight[i] = 1.0 / (1.0 / self.weight[i] + flexibility);
            }
        }
        for i in self.lost..self.len() {
            self.shift[i] = self.value[i];
            self.slope[i] = self.multiplier[i] + self.weight[i] * self.value[i];
        }
    }

    /// Slopes of a step towards products of `mu`, corrected by the products of the latest changes.
    #[inline(always)]
    pub fn correct(&mut self, mu: f64) {
        for i in self.lost..self.len() {
            let product = self.multiplier_step[i] * self.slack_step[i];
            let mut shift = (mu - product) / self.multiplier[i];
            if self.elastic() {
                let product = self.multiplier_step[i] * self.excess_step[i];
                shift -= (mu + product) / (self.price - self.multiplier[i]);
            }
            self.shift[i] = self.value[i] + shift;
            self.slope[i] = self.multiplier[i] + self.weight[i] * self.shift[i];
        }
    }

    /// Changes of s, t and λ that go with the changes `sign`·`change` of c, towards products of `mu`;
    /// `corrected` if [`Self::correct`] made the slopes. Returns the largest steps that keep s, t > 0, and
    /// 0 < λ < ρ.
    #[inline(always)]
    pub fn step<A: Arithmetic>(
        &mut self,
        mu: f64,
        corrected: bool,
        sign: f64,
        change: &[f64],
    ) -> [f64; 2] {
        // Inverse step lengths: the largest rate of approach.
        let (mut primal, mut dual) = (0.0_f64, 0.0_f64);
        let change = &change[..self.len()];
        for i in self.lost..self.len() {
            let (s, t, lambda) = (self.slack[i], self.excess[i], self.multiplier[i]);
            let inverse = 1.0 / lambda;
            let step = self.weight[i] * A::mul_add(sign, change[i], self.shift[i]);
            let mut of_slack = mu;
            let mut of_excess = mu;
            if corrected {
                of_slack -= self.multiplier_step[i] * self.slack_step[i];
                of_excess += self.multiplier_step[i] * self.excess_step[i];
            }
            let slack_step = A::mul_add(-s * inverse, step, of_slack * inverse - s);
            primal = primal.max(-slack_step / s);
            dual = dual.max(-step * inverse);
            if self.elastic() {
                let inverse = 1.0 / (self.price - lambda);
                let excess_step = A::mul_add(t * inverse, step, of_excess * inverse - t);
                primal = primal.max(-excess_step / t);
                dual = dual.max(step * inverse);
                self.excess_step[i] = excess_step;
            }
            self.slack_step[i] = slack_step;
            self.multiplier_step[i] = step;
        }
        [primal, dual].map(|rate| (TO_BOUNDARY / rate).min(1.0))
    }

    /// Σ of the products after a step of the given lengths.
    #[inline(always)]
    pub fn gap_after(&self, primal: f64, dual: f64) -> f64 {
        let mut gap = 0.0;
        for i in self.lost..self.len() {
            let lambda = self.multiplier[i] + dual * self.multiplier_step[i];
            gap += lambda * (self.slack[i] + primal * self.slack_step[i]);
            if self.elastic() {
                gap += (self.price - lambda) * (self.excess[i] + primal * self.excess_step[i]);
            }
        }
        gap
    }

    /// Largest multiplier before or after the whole step.
    #[inline(always)]
    pub fn steepest(&self) -> f64 {
        let mut most = 0.0_f64;
        for i in self.lost..self.len() {
            let lambda = self.multiplier[i];
            most = most.max(lambda).max(lambda + self.multiplier_step[i]);
        }
        most
    }

    /// Takes the step in s and t.
    #[inline(always)]
    pub fn advance(&mut self, primal: f64) {
        for i in self.lost..self.len() {
            self.slack[i] += primal * self.slack_step[i];
            self.excess[i] += primal * self.excess_step[i];
        }
    }

    /// Takes the step in λ.
    #[inline(always)]
    pub fn advance_multipliers(&mut self, dual: f64) {
        for i in self.lost..self.len() {
            self.multiplier[i] += dual * self.multiplier_step[i];
        }
    }

    /// Lets the slack take in what c is smaller than expected.
    #[inline(always)]
    pub fn reset_slack(&mut self) {
        for i in self.lost..self.len() {
            self.slack[i] = self.slack[i].max(self.excess[i] - self.value[i]);
        }
    }

    /// Barrier, price of excess and `weight` times Σ|r|.
    #[inline(always)]
    pub fn merit(&self, mu: f64, weight: f64) -> f64 {
        let mut logarithms = 0.0;
        for slacks in self.slack[self.lost..].chunks(FACTORS) {
            logarithms += slacks.iter().product::<f64>().ln();
        }
        let mut excess = 0.0;
        if self.elastic() {
            for excesses in self.excess[self.lost..].chunks(FACTORS) {
                logarithms += excesses.iter().product::<f64>().ln();
            }
            excess = self.price
                * (self.excess[self.lost..].iter().sum::<f64>()
                    + self.value[..self.lost].iter().sum::<f64>());
        }
        excess - mu * logarithms + weight * self.residuals()[0]
    }
}
