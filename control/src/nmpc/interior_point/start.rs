//! Where the iterations begin.

use arm::Arithmetic;

use super::super::problem::Problem;
use super::super::rollout::Rollout;
use super::super::solver::{Multipliers, Task};
use super::super::transcription::Transcription;
use super::{InteriorPoint, RESIDUAL};

/// Least slack at the start, in units of the bound's size.
const LEAST_SLACK: f64 = 1e-2;
/// Product of a start from scratch.
const COLD: f64 = 1e-2;
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

    /// Rolls the guess out, led to rest, and places slacks and multipliers.
    #[inline(always)]
    pub(super) fn start<A: Arithmetic>(
        &mut self,
        task: &Task<'_>,
        moves: &mut [f64],
        rollout: &mut Rollout,
        multipliers: &Multipliers,
    ) {
        let transcription = task.transcription;
        let problem = transcription.problem();
        let limits = (0..problem.horizon).map(|k| transcription.interval(k).thermal_limit);
        self.thermal.set_bounds(limits);
        let bounds = task.angle_bounds.iter();
        self.lower
            .set_bounds(bounds.clone().map(|bounds| bounds[0]));
        self.upper.set_bounds(bounds.map(|bounds| bounds[1]));
        transcription.end_at_rest(moves);
        transcription.roll_out_with::<A, 3>(moves, &mut self.trial_rollout);
        self.evaluate_trial::<A>();
        std::mem::swap(rollout, &mut self.trial_rollout);
        self.thermal.price = task.excess_weight;
        self.thermal.lost = self.lost(transcription);
        let known = multipliers.known;
        let mu = if known { WARM } else { COLD };
        let scaled = |guess: &f64| {
            if known { guess / task.cost_scale } else { 0.0 }
        };
        let guesses = [&multipliers.thermal, &multipliers.lower, &multipliers.upper];
        let families = self.families().into_iter().zip(leasts(problem));
        for ((family, least), guesses) in families.zip(guesses) {
            family.start(mu, least, guesses.iter().map(scaled));
        }
        self.measures = self.measure::<A>();
    }

    /// Goes on from the latest iterate with products `mu`.
    #[inline(always)]
    pub(super) fn restart<A: Arithmetic>(&mut self, problem: &Problem, mu: f64) {
        for (family, least) in self.families().into_iter().zip(leasts(problem)) {
            family.restart(mu, least);
        }
        self.measures = self.measure::<A>();
    }
}

/// Least slacks of the three families where nothing else tells.
fn leasts(problem: &Problem) -> [f64; 3] {
    let least = |size: f64| f64::max(LEAST_SLACK * size, RESIDUAL);
    let range = least(problem.angle_upper - problem.angle_lower);
    [least(problem.thermal_limit.unwrap_or(0.0)), range, range]
}
