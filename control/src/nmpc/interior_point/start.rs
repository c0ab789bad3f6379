//! Where the iterations begin.

use arm::Arithmetic;

use super::super::problem::Problem;
use super::super::rollout::Rollout;
use super::super::solver::{Multipliers, Task};
use super::super::transcription::Transcription;
use super::{InteriorPoint, RESIDUAL, evaluate};

/// Least slack at the start, in units of the bound's size.
const LEAST_SLACK: f64 = 1e-2;
/// The same where iterations go on with large products: at a bound that the angle is at little room stays little.
const LEAST_SLACK_AGAIN: f64 = 1e-3;
/// Product of a start from scratch.
pub(super) const COLD: f64 = 1e-2;
/// Product of a start from the previous plan.
const WARM: f64 = 3e-4;

impl<const S: usize> InteriorPoint<S> {
    /// Number of nodes after the first where T exceeds its limit even without any heat.
    fn lost(&self, transcription: &Transcription) -> usize {
        let mut load = transcription.initial().thermal_load;
        let cooled = (0..self.thermal.len()).take_while(|&k| {
            let interval = transcription.interval(k);
            load *= interval.thermal.decay();
            load > interval.thermal_limit
        });
        cooled.count()
    }

    /// Places slacks and multipliers for the `rollout` of the guess.
    #[inline(always)]
    pub(super) fn start<A: Arithmetic>(
        &mut self,
        task: &Task<'_>,
        rollout: &Rollout,
        multipliers: &Multipliers,
    ) {
        let transcription = task.transcription;
        let problem = transcription.problem();
        let bounds = task.angle_bounds.iter();
        self.lower
            .set_bounds(bounds.clone().map(|bounds| bounds[0]));
        self.upper.set_bounds(bounds.map(|bounds| bounds[1]));
        evaluate::<A>(self.families(), rollout);
        self.thermal.price = task.excess_weight;
        self.thermal.lost = self.lost(transcription);
        self.newton.decrease = f64::INFINITY;
        let mu = if multipliers.known { WARM } else { COLD };
        let scale = 1.0 / task.cost_scale;
        let guesses = [&multipliers.thermal, &multipliers.lower, &multipliers.upper];
        let families = self
            .families()
            .into_iter()
            .zip(leasts(problem, LEAST_SLACK));
        for ((family, least), guesses) in families.zip(guesses) {
            let guesses = multipliers.known.then_some((&guesses[..], scale));
            family.start::<A>(mu, least, guesses);
        }
        self.measured = self.measure::<A>();
    }

    /// Goes on from the latest iterate with products `mu`.
    #[inline(always)]
    pub(super) fn restart<A: Arithmetic>(&mut self, problem: &Problem, mu: f64) {
        self.warm = false;
        for (family, least) in self
            .families()
            .into_iter()
            .zip(leasts(problem, LEAST_SLACK_AGAIN))
        {
            family.restart(mu, least);
        }
        self.measured = self.measure::<A>();
    }
}

/// Least slacks of the three families where nothing else tells, `share` of the bounds' sizes.
fn leasts(problem: &Problem, share: f64) -> [f64; 3] {
    let least = |size: f64| f64::max(share * size, RESIDUAL);
    let range = least(problem.angle_upper - problem.angle_lower);
    [least(problem.thermal_limit.unwrap_or(0.0)), range, range]
}
