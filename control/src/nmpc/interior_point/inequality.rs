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
//!
//! Rows are kept in groups of four, the lanes of vectors. Rows that only fill a group up, and those that are
//! lost, stay as they are: their steps are masked.

mod measure;
mod rows;

use arm::{Arithmetic, LANES, Vector};

pub use self::measure::Measure;
pub use self::rows::Aim;
use self::rows::{Lanes, Rows};

/// Part of the way to the boundary that a step leaves, in units of the products that it aims at.
const LEFT: f64 = 30.0;
/// The least of that part and the most.
const LEFT_WITHIN: [f64; 2] = [1e-4, 5e-3];
/// Largest multiplier at the start, in units of the price; at the price itself the excess has no bound.
const BELOW_PRICE: f64 = 0.9;
/// Least multiplier at the start, where guesses are known.
const FLATTEST_START: f64 = 1e-9;
/// Largest multiplier at the start where there is no price.
const STEEPEST_START: f64 = 1e12;

/// The largest lane.
#[inline(always)]
pub fn largest<V: Vector>(of: V) -> f64 {
    let [a, b, c, d] = of.lanes();
    let larger = |a: f64, b: f64| if a > b { a } else { b };
    larger(larger(a, b), larger(c, d))
}

/// Largest step, at most 1, towards products of `mu` that keeps positive what approaches its boundary at `rates`
/// in a whole step; the nearer to the boundary the smaller the products.
#[inline(always)]
pub fn length<V: Vector>(rates: V, mu: f64) -> f64 {
    let [least, most] = LEFT_WITHIN;
    let left = (LEFT * mu).clamp(least, most);
    ((1.0 - left) / largest(rates)).min(1.0)
}

/// A family of inequalities `sign`·(quantity − bound) ≤ 0, one a node.
#[derive(Clone, Debug)]
pub struct Inequalities {
    /// ρ; infinite: no excess.
    pub price: f64,
    /// How many are exceeded whatever the moves: there λ = ρ, and nothing is left to decide.
    pub lost: usize,
    sign: f64,
    count: usize,
    /// Largest of λ and λ + dλ in the latest step.
    steepest: f64,
    groups: Vec<Rows>,
}

impl Inequalities {
    /// `count` inequalities.
    pub fn new(count: usize, price: f64, sign: f64) -> Self {
        Self {
            price,
            lost: 0,
            sign,
            count,
            steepest: 0.0,
            groups: vec![Rows::IDLE; count.div_ceil(LANES)],
        }
    }

    /// `count` inequalities with multipliers and slopes of `price` whatever the moves.
    #[cfg(test)]
    pub fn priced(count: usize, price: f64) -> Self {
        let mut family = Self::new(count, price, 1.0);
        for rows in &mut family.groups {
            (rows.multiplier, rows.slope) = ([price; LANES], [price; LANES]);
        }
        family
    }

    /// Number of inequalities.
    pub fn len(&self) -> usize {
        self.count
    }

    fn elastic(&self) -> bool {
        self.price.is_finite()
    }

    /// Number of complementarity products.
    pub fn products(&self) -> f64 {
        let each = if self.elastic() { 2.0 } else { 1.0 };
        each * (self.count - self.lost) as f64
    }

    /// Sets a bound for each.
    pub fn set_bounds(&mut self, bounds: impl Iterator<Item = f64>) {
        let rows = self.groups.iter_mut().flat_map(|rows| &mut rows.bound);
        for (own, bound) in rows.zip(bounds.take(self.count)) {
            *own = bound;
        }
    }

    /// λ of each.
    pub fn multipliers(&self) -> impl Iterator<Item = f64> {
        let all = self.groups.iter().flat_map(|rows| rows.multiplier);
        all.take(self.count)
    }

    /// λ of each, in groups, the last of them filled up with next to nothing; likewise below.
    #[inline(always)]
    pub fn multiplier_groups(&self) -> impl Iterator<Item = &Lanes> {
        self.groups.iter().map(|rows| &rows.multiplier)
    }

    /// Σ of each.
    #[inline(always)]
    pub fn weights<A: Arithmetic>(&self) -> impl Iterator<Item = A::Vector> {
        self.groups.iter().map(|rows| A::Vector::new(&rows.weight))
    }

    /// Slope of the step's cost in each quantity.
    #[inline(always)]
    pub fn slopes<A: Arithmetic>(&self) -> impl Iterator<Item = A::Vector> {
        let sign = A::Vector::splat(self.sign);
        let groups = self.groups.iter();
        groups.map(move |rows| sign * A::Vector::new(&rows.slope))
    }

    /// Sets c for the `quantities`.
    #[inline(always)]
    pub fn evaluate<A: Arithmetic>(&mut self, quantities: &[f64]) {
        let (quantities, rest) = quantities.as_chunks();
        let sign = A::Vector::splat(self.sign);
        for (rows, quantity) in self.groups.iter_mut().zip(quantities) {
            rows.value = (sign * (A::Vector::new(quantity) - A::Vector::new(&rows.bound))).lanes();
        }
        if let Some(rows) = self.groups.get_mut(quantities.len()) {
            for (l, quantity) in rest.iter().enumerate() {
                rows.value[l] = self.sign * (quantity - rows.bound[l]);
            }
        }
    }

    /// Slacks, excesses and multipliers with products `mu` near the guesses of the multipliers, each times a scale,
    /// or below where slacks of at least `least` leave less of them; without guesses with such slacks.
    #[inline(always)]
    pub fn start<A: Arithmetic>(&mut self, mu: f64, least: f64, guesses: Option<(&[f64], f64)>) {
        let (vector, splat) = (A::Vector::new, A::Vector::splat);
        let elastic = self.elastic();
        let highest = splat(if elastic {
            BELOW_PRICE * self.price
        } else {
            STEEPEST_START
        });
        let (zero, mu, least) = (splat(0.0), splat(mu), splat(least));
        self.steepest = 0.0;
        let mut known = guesses.map_or(&[][..], |(known, _)| known);
        for rows in &mut self.groups {
            let room = zero - vector(&rows.value);
            let (slack, multiplier) = match guesses {
                Some((_, scale)) => {
                    let mut guess = [0.0; LANES];
                    if let Some((group, rest)) = known.split_first_chunk() {
                        (guess, known) = (*group, rest);
                    } else {
                        guess[..known.len()].copy_from_slice(known);
                    }
                    let guess = splat(scale) * vector(&guess);
                    // What a state from elsewhere has below zero is worth nothing.
                    let guess = guess.smaller(highest).larger(zero);
                    // A row that matters gets the slack of its multiplier, any other what room there is.
                    let slack = room.larger(mu.over(guess).smaller(least));
                    let most = guess.larger(splat(FLATTEST_START)).smaller(highest);
                    (slack, mu.over(slack).smaller(most))
                }
                None => {
                    let slack = room.larger(least);
                    (slack, mu.over(slack).smaller(highest))
                }
            };
            // Nothing of what a failed solve left is kept.
            *rows = Rows {
                open: [1.0; LANES],
                bound: rows.bound,
                value: rows.value,
                slack: slack.lanes(),
                multiplier: multiplier.lanes(),
                ..Rows::IDLE
            };
            if elastic {
                rows.excess = mu.over(splat(self.price) - multiplier).lanes();
            }
        }
        for k in 0..self.lost {
            self.groups[k / LANES].close(k % LANES, self.price);
        }
        for k in self.count..self.groups.len() * LANES {
            self.groups[k / LANES].close(k % LANES, Rows::IDLE.multiplier[k % LANES]);
        }
    }

    /// Whether c > `tolerance` anywhere that the moves decide.
    pub fn exceeded(&self, tolerance: f64) -> bool {
        let exceeded = |rows: &Rows| {
            let mut pairs = rows.value.iter().zip(&rows.open);
            pairs.any(|(&c, &open)| open > 0.0 && c > tolerance)
        };
        self.groups.iter().any(exceeded)
    }

    /// Slacks, excesses and multipliers with products `mu` and, with a price, residuals of zero for any c:
    /// with s = t − c, μ/s + μ/t = ρ is quadratic in t. Without a price, with slacks of at least `least`.
    pub fn restart(&mut self, mu: f64, least: f64) {
        let price = self.price;
        let elastic = self.elastic();
        for rows in &mut self.groups {
            for l in (0..LANES).filter(|&l| rows.open[l] > 0.0) {
                if !elastic {
                    rows.slack[l] = f64::max(-rows.value[l], least);
                    rows.multiplier[l] = mu / rows.slack[l];
                    continue;
                }
                let priced = price * rows.value[l];
                let root = (priced * priced + 4.0 * mu * mu).sqrt();
                // The larger of s and t, to which nothing cancels.
                let larger = (priced.abs() + 2.0 * mu + root) / (2.0 * price);
                let smaller = mu * larger / (price * larger - mu);
                (rows.slack[l], rows.excess[l], rows.multiplier[l]) = if priced < 0.0 {
                    (larger, smaller, mu / larger)
                } else {
                    (smaller, larger, price - mu / larger)
                };
            }
        }
    }

    /// Weights and slopes of a step towards products of zero.
    #[inline(always)]
    pub fn predict<A: Arithmetic>(&mut self) {
        let elastic = self.elastic();
        let (vector, one) = (A::Vector::new, A::Vector::splat(1.0));
        for rows in &mut self.groups {
            let (s, lambda) = (vector(&rows.slack), vector(&rows.multiplier));
            let open = vector(&rows.open);
            // Two inverses with one division.
            let inverse = one.over(s * lambda);
            let (per_slack, per_multiplier) = (inverse * lambda, inverse * s);
            let mut weight = lambda * per_slack;
            if elastic {
                let t = vector(&rows.excess);
                // Nothing is left of the price where a row is lost; any number will do.
                let nu = A::Vector::splat(self.price) - lambda + (one - open);
                let inverse = one.over(t * nu);
                let per_rest = inverse * t;
                weight = one.over(s.mul_add(per_multiplier, t * per_rest));
                rows.per_excess = (inverse * nu).lanes();
                rows.per_rest = per_rest.lanes();
            }
            weight = weight * open;
            rows.per_slack = per_slack.lanes();
            rows.per_multiplier = per_multiplier.lanes();
            rows.weight = weight.lanes();
            rows.slope = weight.mul_add(vector(&rows.value), lambda).lanes();
        }
    }

    /// Slopes of a step towards products of `aim`.
    #[inline(always)]
    pub fn correct<A: Arithmetic>(&mut self, aim: Aim) {
        let vector = A::Vector::new;
        for rows in &mut self.groups {
            let [of_slack, of_excess] = rows.targets::<A>(aim);
            let shift = vector(&rows.value) + of_slack - of_excess;
            let slope = vector(&rows.weight).mul_add(shift, vector(&rows.multiplier));
            rows.slope = slope.lanes();
        }
    }

    /// Changes of s, t and λ towards products of `aim` that go with the `changes` of the quantities. Raises
    /// `rates` to the largest at which s, t and λ, ρ − λ approach zero.
    #[inline(always)]
    pub fn step<A: Arithmetic>(
        &mut self,
        aim: Aim,
        changes: &[Lanes],
        [primal, dual]: &mut [A::Vector; 2],
    ) {
        let elastic = self.elastic();
        let (vector, zero) = (A::Vector::new, A::Vector::splat(0.0));
        let sign = A::Vector::splat(self.sign);
        let mut steepest = zero;
        for (rows, change) in self.groups.iter_mut().zip(changes) {
            let open = vector(&rows.open);
            let (s, t) = (vector(&rows.slack), vector(&rows.excess));
            let per_multiplier = vector(&rows.per_multiplier);
            let [of_slack, of_excess] = rows.targets::<A>(aim);
            let shift = vector(&rows.value) + of_slack - of_excess;
            let step = vector(&rows.weight) * sign.mul_add(vector(change), shift);
            let slack_step = open * (s * per_multiplier).neg_mul_add(step, of_slack - s);
            let lambda = vector(&rows.multiplier);
            steepest = lambda.larger(lambda + step).larger(steepest);
            rows.multiplier_step = step.lanes();
            rows.slack_step = slack_step.lanes();
            *primal = slack_step
                .neg_mul_add(vector(&rows.per_slack), zero)
                .larger(*primal);
            *dual = step.neg_mul_add(per_multiplier, zero).larger(*dual);
            if elastic {
                let per_rest = vector(&rows.per_rest);
                let excess_step = open * (t * per_rest).mul_add(step, of_excess - t);
                rows.excess_step = excess_step.lanes();
                *primal = excess_step
                    .neg_mul_add(vector(&rows.per_excess), zero)
                    .larger(*primal);
                *dual = (step * per_rest).larger(*dual);
            }
        }
        self.steepest = largest(steepest);
    }

    /// Σ of the products after a step of the given lengths.
    #[inline(always)]
    pub fn gap_after<A: Arithmetic>(&self, primal: f64, dual: f64) -> f64 {
        let (vector, splat) = (A::Vector::new, A::Vector::splat);
        let (primal, dual) = (splat(primal), splat(dual));
        let elastic = self.elastic();
        let mut gap = splat(0.0);
        for rows in &self.groups {
            let lambda = dual.mul_add(vector(&rows.multiplier_step), vector(&rows.multiplier));
            let s = primal.mul_add(vector(&rows.slack_step), vector(&rows.slack));
            let mut products = lambda * s;
            if elastic {
                let t = primal.mul_add(vector(&rows.excess_step), vector(&rows.excess));
                products = (splat(self.price) - lambda).mul_add(t, products);
            }
            gap = products.mul_add(vector(&rows.open), gap);
        }
        gap.sum()
    }

    /// Takes the step in s and t.
    #[inline(always)]
    pub fn advance<A: Arithmetic>(&mut self, primal: f64) {
        let (vector, primal) = (A::Vector::new, A::Vector::splat(primal));
        for rows in &mut self.groups {
            let slack = primal.mul_add(vector(&rows.slack_step), vector(&rows.slack));
            let excess = primal.mul_add(vector(&rows.excess_step), vector(&rows.excess));
            (rows.slack, rows.excess) = (slack.lanes(), excess.lanes());
        }
    }

    /// Takes the step in λ, and lets the slacks take in what c is smaller than expected.
    #[inline(always)]
    pub fn settle<A: Arithmetic>(&mut self, dual: f64) {
        let (vector, dual) = (A::Vector::new, A::Vector::splat(dual));
        for rows in &mut self.groups {
            let lambda = dual.mul_add(vector(&rows.multiplier_step), vector(&rows.multiplier));
            let least = vector(&rows.excess) - vector(&rows.value);
            rows.multiplier = lambda.lanes();
            rows.slack = vector(&rows.slack).larger(least).lanes();
        }
    }
}

#[cfg(test)]
mod tests;
