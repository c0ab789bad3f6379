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
/// Largest multiplier at the start, in units of the price; at the price itself the excess has no bound.
const BELOW_PRICE: f64 = 0.9;
/// Largest multiplier at the start where there is no price.
const STEEPEST_START: f64 = 1e12;
/// Running sums and maxima that are kept side by side, for the sake of vector instructions.
const LANES: usize = 4;
/// Factors of a product whose logarithm is taken at once; 16 numbers of 1e-18 do not underflow.
const FACTORS: usize = 16;

/// The larger number, by one instruction. Unlike `f64::max` it may lose a NaN; the merit of the step, which
/// is one then, tells.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

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
    /// m_s.
    slack_product: Vec<f64>,
    /// m_t.
    excess_product: Vec<f64>,
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
            slack_product: zeros(),
            excess_product: zeros(),
            slack_step: zeros(),
            excess_step: zeros(),
            multiplier_step: zeros(),
        }
    }

    /// λ at the end of interval `k`; zero where there are no inequalities.
    #[inline(always)]
    pub fn multiplier_after(&self, k: usize) -> f64 {
        self.multiplier.get(k).copied().unwrap_or(0.0)
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
        for steps in [
            &mut self.multiplier_step,
            &mut self.slack_step,
            &mut self.excess_step,
        ] {
            // All of them: what a failed solve left may be anything.
            steps.fill(0.0);
        }
        let highest = if self.elastic() {
            BELOW_PRICE * self.price
        } else {
            STEEPEST_START
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
        self.gap_after(0.0, 0.0)
    }

    /// Σ|r| and the largest |r|.
    #[inline(always)]
    pub fn residuals(&self) -> [f64; 2] {
        let rows = self.value[self.lost..].iter();
        let rows = rows
            .zip(&self.slack[self.lost..])
            .zip(&self.excess[self.lost..]);
        rows.fold([0.0, 0.0], |[sum, most], ((c, s), t)| {
            let residual = (c + s - t).abs();
            [sum + residual, f64::max(most, residual)]
        })
    }

    /// Weights and slopes of a step towards products of zero.
    #[inline(always)]
    pub fn predict(&mut self) {
        let elastic = self.elastic();
        let rows = self.lost..self.len();
        let (c, s) = (&self.value[rows.clone()], &self.slack[rows.clone()]);
        let (t, lambda) = (&self.excess[rows.clone()], &self.multiplier[rows.clone()]);
        let weight = &mut self.weight[rows.clone()];
        if elastic {
            for i in 0..c.len() {
                // 1/(s/λ + t/ν) with one division.
                let nu = self.price - lambda[i];
                weight[i] = lambda[i] * nu / (s[i] * nu + t[i] * lambda[i]);
            }
        } else {
            for i in 0..c.len() {
                weight[i] = lambda[i] / s[i];
            }
        }
        let (shift, slope) = (&mut self.shift[rows.clone()], &mut self.slope[rows]);
        for i in 0..c.len() {
            shift[i] = c[i];
            slope[i] = lambda[i] + weight[i] * c[i];
        }
    }

    /// Slopes of a step towards products of `mu`, corrected by the products of the latest changes.
    #[inline(always)]
    pub fn correct(&mut self, mu: f64) {
        let elastic = self.elastic();
        let rows = self.lost..self.len();
        let (c, lambda) = (&self.value[rows.clone()], &self.multiplier[rows.clone()]);
        let weight = &self.weight[rows.clone()];
        let of_slack = &mut self.slack_product[rows.clone()];
        let of_excess = &mut self.excess_product[rows.clone()];
        let (slack_step, excess_step) = (
            &self.slack_step[rows.clone()],
            &self.excess_step[rows.clone()],
        );
        let multiplier_step = &self.multiplier_step[rows.clone()];
        let (shift, slope) = (&mut self.shift[rows.clone()], &mut self.slope[rows]);
        for i in 0..c.len() {
            of_slack[i] = mu - multiplier_step[i] * slack_step[i];
            shift[i] = c[i] + of_slack[i] / lambda[i];
        }
        if elastic {
            for i in 0..c.len() {
                of_excess[i] = mu + multiplier_step[i] * excess_step[i];
                shift[i] -= of_excess[i] / (self.price - lambda[i]);
            }
        }
        for i in 0..c.len() {
            slope[i] = lambda[i] + weight[i] * shift[i];
        }
    }

    /// Forgets what [`Self::correct`] aimed at: products of zero.
    #[inline(always)]
    pub fn aim_at_zero(&mut self) {
        self.slack_product.fill(0.0);
        self.excess_product.fill(0.0);
    }

    /// Changes of s, t and λ that go with the changes `sign`·`change` of c. Returns the largest steps that
    /// keep s, t > 0, and 0 < λ < ρ.
    #[inline(always)]
    pub fn step<A: Arithmetic>(&mut self, sign: f64, change: &[f64]) -> [f64; 2] {
        let elastic = self.elastic();
        let rows = self.lost..self.len();
        let change = &change[rows.clone()];
        let (s, t) = (&self.slack[rows.clone()], &self.excess[rows.clone()]);
        let (lambda, weight) = (&self.multiplier[rows.clone()], &self.weight[rows.clone()]);
        let shift = &self.shift[rows.clone()];
        let of_slack = &self.slack_product[rows.clone()];
        let of_excess = &self.excess_product[rows.clone()];
        let slack_step = &mut self.slack_step[rows.clone()];
        let excess_step = &mut self.excess_step[rows.clone()];
        let multiplier_step = &mut self.multiplier_step[rows];
        // Inverse step lengths: the largest rates of approach to the boundary.
        let (mut primal, mut dual) = ([0.0_f64; LANES], [0.0_f64; LANES]);
        for i in 0..change.len() {
            let step = weight[i] * A::mul_add(sign, change[i], shift[i]);
            let inverse = 1.0 / lambda[i];
            slack_step[i] = A::mul_add(-s[i] * inverse, step, of_slack[i] * inverse - s[i]);
            multiplier_step[i] = step;
        }
        if elastic {
            for i in 0..change.len() {
                let inverse = 1.0 / (self.price - lambda[i]);
                let step = multiplier_step[i];
                excess_step[i] = A::mul_add(t[i] * inverse, step, of_excess[i] * inverse - t[i]);
            }
            for i in 0..change.len() {
                let lane = i % LANES;
                primal[lane] = larger(primal[lane], -excess_step[i] / t[i]);
                dual[lane] = larger(dual[lane], multiplier_step[i] / (self.price - lambda[i]));
            }
        }
        for i in 0..change.len() {
            let lane = i % LANES;
            primal[lane] = larger(primal[lane], -slack_step[i] / s[i]);
            dual[lane] = larger(dual[lane], -multiplier_step[i] / lambda[i]);
        }
        [primal, dual].map(|rates| (TO_BOUNDARY / rates.into_iter().fold(0.0, larger)).min(1.0))
    }

    /// Σ of the products after a step of the given lengths.
    #[inline(always)]
    pub fn gap_after(&self, primal: f64, dual: f64) -> f64 {
        let rows = self.lost..self.len();
        let (s, slack_step) = (&self.slack[rows.clone()], &self.slack_step[rows.clone()]);
        let (t, excess_step) = (&self.excess[rows.clone()], &self.excess_step[rows.clone()]);
        let multiplier_step = &self.multiplier_step[rows.clone()];
        let lambda = &self.multiplier[rows];
        let mut gap = [0.0; LANES];
        for i in 0..s.len() {
            let after = lambda[i] + dual * multiplier_step[i];
            gap[i % LANES] += after * (s[i] + primal * slack_step[i]);
        }
        if self.elastic() {
            for i in 0..s.len() {
                let after = self.price - (lambda[i] + dual * multiplier_step[i]);
                gap[i % LANES] += after * (t[i] + primal * excess_step[i]);
            }
        }
        gap.iter().sum()
    }

    /// Largest multiplier before or after the whole step.
    #[inline(always)]
    pub fn steepest(&self) -> f64 {
        let rows = self.multiplier.iter().zip(&self.multiplier_step);
        rows.fold(0.0, |most, (lambda, step)| {
            larger(most, larger(*lambda, lambda + step))
        })
    }

    /// Takes the step in s and t.
    #[inline(always)]
    pub fn advance(&mut self, primal: f64) {
        for (s, step) in self.slack.iter_mut().zip(&self.slack_step) {
            *s += primal * step;
        }
        for (t, step) in self.excess.iter_mut().zip(&self.excess_step) {
            *t += primal * step;
        }
    }

    /// Takes the step in λ.
    #[inline(always)]
    pub fn advance_multipliers(&mut self, dual: f64) {
        for (lambda, step) in self.multiplier.iter_mut().zip(&self.multiplier_step) {
            *lambda += dual * step;
        }
    }

    /// Lets the slack take in what c is smaller than expected.
    #[inline(always)]
    pub fn reset_slack(&mut self) {
        let rows = self.value.iter().zip(&self.excess);
        for (s, (c, t)) in self.slack.iter_mut().zip(rows).skip(self.lost) {
            *s = larger(*s, t - c);
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

#[cfg(test)]
mod tests {
    use super::*;
    use arm::Separate;
    use proptest::prelude::*;

    /// The equations of the module's head, linearised.
    fn assert_solved(family: &Inequalities, sign: f64, change: &[f64], mu: [&[f64]; 2]) {
        for i in 0..change.len() {
            let (c, s, t) = (family.value[i], family.slack[i], family.excess[i]);
            let (ds, dt) = (family.slack_step[i], family.excess_step[i]);
            let (lambda, step) = (family.multiplier[i], family.multiplier_step[i]);
            let row = c + sign * change[i] + (s + ds) - (t + dt);
            assert!(row.abs() < 1e-9, "{row}");
            let product = lambda * ds + s * step + lambda * s - mu[0][i];
            assert!(product.abs() < 1e-9, "{product}");
            if family.elastic() {
                let nu = family.price - lambda;
                let product = nu * dt - t * step + nu * t - mu[1][i];
                assert!(product.abs() < 1e-9, "{product}");
            }
        }
    }

    proptest! {
        #[test]
        fn steps_solve_the_linearised_equations(
            values in prop::collection::vec(-2.0..2.0_f64, 7), change in prop::collection::vec(-1.0..1.0_f64, 7),
            mu in 1e-3..0.5_f64, elastic: bool, sign in prop_oneof![Just(1.0), Just(-1.0)],
        ) {
            let mut family = Inequalities::new(7, if elastic { 10.0 } else { f64::INFINITY });
            family.value.copy_from_slice(&values);
            family.start(mu, 0.1);
            prop_assert!((family.gap() - mu * family.products()).abs() < 1e-9);
            family.predict();
            family.aim_at_zero();
            let [primal, dual] = family.step::<Separate>(sign, &change);
            assert_solved(&family, sign, &change, [&[0.0; 7], &[0.0; 7]]);

            // Whatever the step, what must be positive stays so.
            for i in 0..7 {
                let lambda = family.multiplier[i] + dual * family.multiplier_step[i];
                prop_assert!(family.slack[i] + primal * family.slack_step[i] > 0.0);
                prop_assert!(lambda > 0.0 && lambda < family.price);
                prop_assert!(!elastic || family.excess[i] + primal * family.excess_step[i] > 0.0);
            }

            let target = 0.1 * mu;
            let products = |steps: &[f64], sign: f64| -> Vec<f64> {
                let pairs = steps.iter().zip(&family.multiplier_step);
                pairs.map(|(a, b)| target + sign * a * b).collect()
            };
            let expected = [
                products(&family.slack_step, -1.0),
                products(&family.excess_step, 1.0),
            ];
            family.correct(target);
            family.step::<Separate>(sign, &change);
            assert_solved(&family, sign, &change, [&expected[0], &expected[1]]);
        }
    }
}
