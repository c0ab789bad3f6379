//! The solver's interface: set up once from the problem's parameters, then asked for plans.
//!
//! Every solver minimises the same merit,
//!
//! ```text
//! cost/cost_scale + excess_weight·Σ_k max(0, T_k − T_limit)     over u, subject to eqs 22, 25, 27
//! ```
//!
//! an exact penalty: below the weight's price the thermal limit is kept wherever it can be kept, and where
//! it cannot, the excess is least. A solver sees the true model through [`Transcription`] only. With a safe
//! set for the plan's end, T_N includes the heat of stopping, and the end must lie in the kinetic set. With the
//! linear model the largest excess of the torque has a price in place of that of heat.

use serde::{Deserialize, Serialize};

use super::rollout::Rollout;
use super::safe_set::SafeSet;
use super::transcription::Transcription;

/// Excess of the thermal load that counts as none \[A²\].
pub const THERMAL_TOLERANCE: f64 = 1e-6;
/// Excess of the reference over the angle bounds that counts as none \[rad\].
pub const ANGLE_TOLERANCE: f64 = 1e-7;
/// Excess of the torque over its limit that counts as none, in units of that.
pub const TORQUE_TOLERANCE: f64 = 1e-6;
/// Price of the largest excess of the torque over its limit, in units of that.
pub const TORQUE_PRICE: f64 = 1e5;

/// Tells the time, for deadlines. The maths has no clock of its own: without one it never stops early, and
/// equal inputs give equal plans.
pub trait Clock: Send {
    /// Time since any fixed moment, never falling \[s\].
    fn now(&self) -> f64;
}

/// When a plan must be ready.
#[derive(Clone, Copy)]
pub struct TimeLimit<'a> {
    /// What tells the time.
    pub clock: &'a dyn Clock,
    /// The time when the plan must be ready, on that clock \[s\].
    pub end: f64,
}

/// How long the iterations of a solver take.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pace {
    /// What the first iteration of a plan is expected to take: the shortest so far \[s\].
    shortest: Option<f64>,
    /// Longest iteration of the plan at hand \[s\].
    longest: Option<f64>,
    /// When the iteration under way began \[s\].
    begin: Option<f64>,
}

impl Pace {
    /// A plan begins.
    pub fn restart(&mut self) {
        (self.longest, self.begin) = (None, None);
    }

    /// Whether the limit allows another iteration, to be asked before each. Without a limit it does.
    pub fn allows(&mut self, limit: Option<TimeLimit<'_>>) -> bool {
        let Some(TimeLimit { clock, end }) = limit else {
            return true;
        };
        let now = clock.now();
        if let Some(begin) = self.begin {
            let taken = now - begin;
            self.longest = Some(self.longest.map_or(taken, |longest| longest.max(taken)));
            self.shortest = Some(self.shortest.map_or(taken, |shortest| shortest.min(taken)));
        }
        self.begin = Some(now);
        let expected = self.longest.or(self.shortest).unwrap_or(0.0);
        let allowed = now + expected < end;
        if !allowed && self.longest.is_none() {
            // Or a first iteration that was interrupted for longer than the deadline would forbid all others.
            self.shortest = self.shortest.map(|shortest| 0.5 * shortest);
        }
        allowed
    }
}

/// One plan to make.
#[derive(Clone, Copy)]
pub struct Task<'a> {
    /// Problem with start and goal.
    pub transcription: &'a Transcription,
    /// Bounds of θr at the nodes 1..N−1 \[N − 1\], or 1..N where the end need not be at rest \[N\] \[rad\];
    /// wider than eq 25 where the start demands it.
    pub angle_bounds: &'a [[f64; 2]],
    /// Where the plan must end, if not at rest.
    pub safe_set: Option<&'a SafeSet>,
    /// Cost that counts as 1 \[rad²·s\].
    pub cost_scale: f64,
    /// Price of thermal excess, in units of `cost_scale` \[1/A²\].
    pub excess_weight: f64,
    /// When the plan must be ready, if ever.
    pub time_limit: Option<TimeLimit<'a>>,
}

impl Task<'_> {
    /// Cost of a rollout and the price of its excesses, of heat and torque, in one number, in units of `cost_scale`.
    pub fn merit(&self, rollout: &Rollout) -> f64 {
        rollout.cost / self.cost_scale + self.penalty(rollout)
    }

    /// Price of what exceeds the limits that have slack.
    pub fn penalty(&self, rollout: &Rollout) -> f64 {
        self.excess_weight * self.total_excess(rollout)
            + TORQUE_PRICE * self.torque_excess(rollout).max(0.0)
    }

    /// Thermal excess of the last node: of T_N alone, and with the heat of stopping \[A²\].
    fn terminal_excess(&self, rollout: &Rollout) -> [f64; 2] {
        let Some(set) = self.safe_set else {
            return [0.0; 2];
        };
        let (Some(angle), Some(velocity), Some(load)) = (
            rollout.reference_angle.last(),
            rollout.reference_velocity.last(),
            rollout.thermal_load.last(),
        ) else {
            return [0.0; 2];
        };
        let beyond = load - set.thermal_limit;
        [beyond, beyond + set.heat(*angle, *velocity)].map(|excess| excess.max(0.0))
    }

    /// Largest thermal excess at the nodes after the first \[A²\]; at the last one with the heat of stopping, if that
    /// is to be kept free.
    pub fn excess(&self, rollout: &Rollout) -> f64 {
        rollout.excess.max(self.terminal_excess(rollout)[1])
    }

    /// Sum of the thermal excesses at the nodes after the first \[A²\], the last one as in [`Self::excess`].
    pub fn total_excess(&self, rollout: &Rollout) -> f64 {
        let [counted, all] = self.terminal_excess(rollout);
        rollout.total_excess + (all - counted)
    }

    /// Whether θr keeps its bounds.
    pub fn keeps_angle_bounds(&self, rollout: &Rollout) -> bool {
        let inner = rollout.reference_angle[1..].iter().zip(self.angle_bounds);
        // Without a branch at each.
        let beyond = inner.fold(false, |beyond, (angle, [lower, upper])| {
            beyond | (lower - angle > ANGLE_TOLERANCE) | (angle - upper > ANGLE_TOLERANCE)
        });
        !beyond
    }

    /// Whether a rollout keeps the angle bounds and ends in the kinetic set: all that has no slack.
    pub fn keeps_bounds(&self, rollout: &Rollout) -> bool {
        let ends = rollout
            .reference_angle
            .last()
            .zip(rollout.reference_velocity.last());
        let short = self
            .safe_set
            .zip(ends)
            .map_or(0.0, |(set, (angle, velocity))| {
                set.kinetic_excess(*angle, *velocity)
            });
        short <= ANGLE_TOLERANCE && self.keeps_angle_bounds(rollout)
    }

    /// Largest excess of the torque over its limit (appendix C.3), in units of that; negative: within.
    pub fn torque_excess(&self, rollout: &Rollout) -> f64 {
        let problem = self.transcription.problem();
        let Some(limit) = &problem.torque_limit else {
            return f64::NEG_INFINITY;
        };
        let arm = &problem.arm;
        let velocities = rollout.reference_velocity.windows(2);
        let intervals = rollout.angle.windows(2).zip(velocities).enumerate();
        let most = intervals.fold(f64::NEG_INFINITY, |most, (k, (angle, velocity))| {
            let length = self.transcription.interval(k).length;
            let inertia = arm.inertia * (velocity[1] - velocity[0]) / length;
            let excess =
                |end: usize| limit.excess(angle[end], arm.damping * velocity[end] + inertia);
            most.max(excess(0)).max(excess(1))
        });
        most / limit.most
    }

    /// Whether a rollout keeps every limit.
    pub fn admits(&self, rollout: &Rollout) -> bool {
        rollout.is_finite()
            && self.excess(rollout) <= THERMAL_TOLERANCE
            && self.torque_excess(rollout) <= TORQUE_TOLERANCE
            && self.keeps_bounds(rollout)
    }

    /// How good a rollout is as a plan, the least the best: first whether it keeps every limit, then whether
    /// it keeps those without slack, then its merit.
    pub fn rank(&self, rollout: &Rollout) -> (u8, f64) {
        let merit = self.merit(rollout);
        if !rollout.is_finite() || merit.is_nan() {
            (3, f64::INFINITY)
        } else if !self.keeps_bounds(rollout) {
            (2, merit)
        } else {
            let kept = self.excess(rollout) <= THERMAL_TOLERANCE
                && self.torque_excess(rollout) <= TORQUE_TOLERANCE;
            (u8::from(!kept), merit)
        }
    }
}

/// Multipliers of the inequalities, ∂cost/∂bound: what a solver may start from and leaves.
#[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Multipliers {
    /// Whether a solver left them.
    pub known: bool,
    /// Of the thermal limit at the nodes 1..N \[N\] \[rad²·s/A²\].
    pub thermal: Vec<f64>,
    /// Of the lower bound of θr at the nodes 1..N−1 \[N − 1\] \[rad·s\].
    pub lower: Vec<f64>,
    /// Of the upper bound of θr at the nodes 1..N−1 \[N − 1\] \[rad·s\].
    pub upper: Vec<f64>,
}

impl Multipliers {
    /// Unknown multipliers of a plan of `horizon` intervals.
    pub fn new(horizon: usize) -> Self {
        Self {
            known: false,
            thermal: vec![0.0; horizon],
            lower: vec![0.0; horizon - 1],
            upper: vec![0.0; horizon - 1],
        }
    }

    /// Whether these are of a plan of `horizon` intervals.
    pub fn fit(&self, horizon: usize) -> bool {
        let bounds = horizon.saturating_sub(1);
        (self.thermal.len(), self.lower.len(), self.upper.len()) == (horizon, bounds, bounds)
    }
}

impl Clone for Multipliers {
    fn clone(&self) -> Self {
        Self {
            known: self.known,
            thermal: self.thermal.clone(),
            lower: self.lower.clone(),
            upper: self.upper.clone(),
        }
    }

    /// Without allocation where the horizons agree.
    fn clone_from(&mut self, source: &Self) {
        self.known = source.known;
        self.thermal.clone_from(&source.thermal);
        self.lower.clone_from(&source.lower);
        self.upper.clone_from(&source.upper);
    }
}

/// How a solver ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolverStatus {
    /// Converged to tolerance.
    Solved,
    /// Stopped before it converged; the moves are the best found.
    IterationLimit,
    /// Stopped before the time was up; the moves are the best found.
    OutOfTime,
    /// No moves within the angle bounds were found.
    Infeasible,
}

/// What a solver did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// How it ended.
    pub status: SolverStatus,
    /// Interior-point iterations.
    pub iterations: u32,
    /// Convex problems.
    pub convex_problems: u32,
}

/// Something that solves tasks of one problem.
///
/// Without a time limit the answer depends on the problem's parameters, the task and the guess alone, never
/// on earlier tasks: a solver rebuilt from the parameters answers bit by bit the same.
pub trait Solver {
    /// Improves `moves` \[N\], given `rollout` of them by [`Transcription::roll_out`], and leaves the best moves
    /// with their rollout. The guess may violate any limit, but must itself end at rest where plans do. Multipliers
    /// may be those of another plan; a solver that has none leaves them unknown.
    fn solve(
        &mut self,
        task: &Task<'_>,
        moves: &mut [f64],
        rollout: &mut Rollout,
        multipliers: &mut Multipliers,
    ) -> Outcome;
}
