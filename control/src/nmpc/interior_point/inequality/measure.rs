//! Sums over the inequalities: what convergence and merit are judged by.

use arm::{Arithmetic, Vector, elementary};

use super::{Inequalities, largest};

/// Groups whose slacks and excesses are multiplied before the logarithm: 16 numbers of 1e-18 do not underflow.
const FACTORS: usize = 2;

/// η in units of the larger of λ and λ + dλ.
const STEEPER: f64 = 1.1;
/// η, at least, in units of the largest of the family.
const FLATTEST: f64 = 1e-4;

/// Sums and the like over inequalities.
#[derive(Clone, Copy, Debug, Default)]
pub struct Measure {
    /// Σ of the complementarity products.
    pub gap: f64,
    /// Largest |r|.
    pub residual: f64,
    /// Price of all excess.
    excess: f64,
    /// Π s·t.
    product: Product,
}

impl Measure {
    /// Of these inequalities and those of `other`.
    #[inline(always)]
    pub fn and(mut self, other: Self) -> Self {
        self.product.multiply(other.product.mantissa);
        self.product.exponent += other.product.exponent;
        Self {
            gap: self.gap + other.gap,
            residual: f64::max(self.residual, other.residual),
            excess: self.excess + other.excess,
            product: self.product,
        }
    }

    /// Price of excess and barrier, −μ·Σ(ln s + ln t).
    pub fn price_and_barrier(&self, mu: f64) -> f64 {
        self.excess - mu * self.product.ln()
    }
}

/// A product of any number of positive factors, mantissa and exponent apart.
#[derive(Clone, Copy, Debug)]
struct Product {
    mantissa: f64,
    exponent: i64,
}

impl Default for Product {
    /// Of no factors.
    fn default() -> Self {
        Self {
            mantissa: 1.0,
            exponent: 0,
        }
    }
}

impl Product {
    /// What has no number among the factors may come out as one; the residuals tell.
    #[inline(always)]
    fn multiply(&mut self, factor: f64) {
        let bits = (self.mantissa * factor).to_bits();
        self.exponent += ((bits >> 52) & 0x7FF) as i64 - 1023;
        self.mantissa = f64::from_bits(bits & ((1 << 52) - 1) | 1.0_f64.to_bits());
    }

    fn ln(&self) -> f64 {
        elementary::log(self.mantissa) + self.exponent as f64 * std::f64::consts::LN_2
    }
}

impl Inequalities {
    /// Takes the measures.
    #[inline(always)]
    pub fn measure<A: Arithmetic>(&self) -> Measure {
        let (vector, splat) = (A::Vector::new, A::Vector::splat);
        let elastic = self.elastic();
        let mut product = Product::default();
        let (mut gap, mut excess, mut residual) = (splat(0.0), splat(0.0), splat(0.0));
        for groups in self.groups.chunks(FACTORS) {
            let mut factors = splat(1.0);
            for rows in groups {
                let (c, open) = (vector(&rows.value), vector(&rows.open));
                let (s, t) = (vector(&rows.slack), vector(&rows.excess));
                let lambda = vector(&rows.multiplier);
                let mut products = lambda * s;
                factors = factors * s;
                if elastic {
                    factors = factors * t;
                    products = (splat(self.price) - lambda).mul_add(t, products);
                    // Of lost rows the whole of c is in excess.
                    excess = excess + open.mul_add(t - c, c);
                }
                gap = products.mul_add(open, gap);
                let r = open * (c + s - t);
                residual = r.larger(splat(0.0) - r).larger(residual);
            }
            let [a, b, c, d] = factors.lanes();
            product.multiply((a * c) * (b * d));
        }
        Measure {
            gap: gap.sum(),
            residual: largest(residual),
            excess: if elastic {
                self.price * excess.sum()
            } else {
                0.0
            },
            product,
        }
    }

    /// Σ of the products that belong to c itself, s = max(0, −c) and t = max(0, c): what the excess and the price of
    /// it leave to gain where the multipliers are those of a stationary point, whatever the residuals.
    #[inline(always)]
    pub fn true_gap<A: Arithmetic>(&self) -> f64 {
        let (vector, splat) = (A::Vector::new, A::Vector::splat);
        let (zero, price) = (splat(0.0), splat(self.price));
        let mut gap = zero;
        for rows in &self.groups {
            let (c, lambda) = (vector(&rows.value), vector(&rows.multiplier));
            let room = lambda * (zero - c).larger(zero);
            let products = (price - lambda).mul_add(c.larger(zero), room);
            gap = products.mul_add(vector(&rows.open), gap);
        }
        gap.sum()
    }

    /// Σ η·|r|, η of each row a little above its multiplier before and after the latest step: what a row's residual
    /// is worth, so that little is asked of those that matter little.
    #[inline(always)]
    pub fn residual_penalty<A: Arithmetic>(&self) -> f64 {
        let (vector, splat) = (A::Vector::new, A::Vector::splat);
        let flattest = splat(FLATTEST * self.steepest);
        let mut residuals = splat(0.0);
        for rows in &self.groups {
            let (s, t) = (vector(&rows.slack), vector(&rows.excess));
            let r = vector(&rows.open) * (vector(&rows.value) + s - t);
            let lambda = vector(&rows.multiplier);
            let after = lambda + vector(&rows.multiplier_step);
            let size = r.larger(splat(0.0) - r);
            residuals = size.mul_add(lambda.larger(after).larger(flattest), residuals);
        }
        STEEPER * residuals.sum()
    }
}
