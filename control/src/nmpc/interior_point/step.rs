//! The direction of an iteration: which products it aims at, and how far it may go.

use arm::{Arithmetic, Vector};

use super::super::rollout::Rollout;
use super::super::solver::Task;
use super::inequality::{Aim, length};
use super::newton::Newton;
use super::{GAP, InteriorPoint};

/// Part of the products that is aimed at, at least, for each part of the predictor that cannot be taken.
const UNFINISHED: f64 = 0.3;
/// Sum that a step aims at, at least, in units of [`GAP`].
const LEAST: f64 = 0.1;
/// Sum of the products, and decrease that the step before promised, below which a plan that goes on from the previous one
/// does without predictor.
const NEARLY: f64 = 1e-4;

/// A step towards products of `mu`, with the largest lengths that keep s, t > 0 and 0 < λ < ρ.
#[derive(Clone, Copy)]
pub struct Step {
    /// μ.
    pub mu: f64,
    /// Of the moves, s and t.
    pub primal: f64,
    /// Of λ.
    pub dual: f64,
}

impl<const S: usize> InteriorPoint<S> {
    /// Newton step towards products of `aim` and the steps of the inequalities that go with it; the largest
    /// primal and dual step lengths.
    #[inline(always)]
    fn solve_for<A: Arithmetic>(&mut self, aim: Aim) -> [f64; 2] {
        self.newton
            .solve::<A>([&self.thermal, &self.lower, &self.upper]);
        let mut rates = [A::Vector::splat(0.0); 2];
        let Newton { load, angle, .. } = &self.newton;
        self.thermal.step::<A>(aim, load, &mut rates);
        self.lower.step::<A>(aim, angle, &mut rates);
        self.upper.step::<A>(aim, angle, &mut rates);
        [length(rates[0], aim.mu), length(rates[1], aim.mu)]
    }

    /// The corrector's step; none if there is no minimum.
    #[inline(always)]
    pub(super) fn step<A: Arithmetic>(
        &mut self,
        task: &Task<'_>,
        moves: &[f64],
        rollout: &Rollout,
    ) -> Option<Step> {
        // That of the step before.
        let promised = self.newton.decrease;
        let gap = self.measured.gap;
        self.thermal.predict::<A>();
        self.lower.predict::<A>();
        self.upper.predict::<A>();
        let families = [&self.thermal, &self.lower, &self.upper];
        let newton = &mut self.newton;
        self.convex = !newton.factorise::<A>(task, moves, rollout, families, false);
        if self.convex && !newton.factorise::<A>(task, moves, rollout, families, true) {
            return None;
        }
        let nearly = gap <= NEARLY && promised <= NEARLY;
        let aim = if self.warm && nearly {
            self.aim(LEAST * GAP, 0.0)
        } else {
            self.predict::<A>(gap)
        };
        self.thermal.correct::<A>(aim);
        self.lower.correct::<A>(aim);
        self.upper.correct::<A>(aim);
        let [primal, dual] = self.solve_for::<A>(aim);
        let mu = aim.mu;
        Some(Step { mu, primal, dual })
    }

    /// Products of the corrector, by what the predictor would leave of the sum `gap`.
    #[inline(always)]
    fn predict<A: Arithmetic>(&mut self, gap: f64) -> Aim {
        let [primal, dual] = self.solve_for::<A>(Aim::ZERO);
        let after = self.thermal.gap_after::<A>(primal, dual)
            + self.lower.gap_after::<A>(primal, dual)
            + self.upper.gap_after::<A>(primal, dual);
        let ratio = (after / gap).clamp(0.0, 1.0);
        let share = f64::max(ratio * ratio, UNFINISHED * (1.0 - primal.min(dual)));
        self.aim(f64::max(share * gap, LEAST * GAP), 1.0)
    }

    /// Equal products with the sum `gap`.
    fn aim(&self, gap: f64, correction: f64) -> Aim {
        let products = self.thermal.products() + self.lower.products() + self.upper.products();
        Aim {
            mu: gap / products,
            correction,
        }
    }
}
