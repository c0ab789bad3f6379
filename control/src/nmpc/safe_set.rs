//! States from which the reference can be stopped within all limits: the safe sets of appendix B.
//!
//! # Stopping
//! At the angle θ, with the velocity v > 0 towards the upper bound θ_u (towards the lower one all is
//! mirrored), the reference brakes by one constant deceleration a for as many whole intervals of length h as
//! v > a·h, and by less in the last one. That takes a distance of v²/(2·a) + v·h/2 and a time of v/a + h at
//! most. With
//!
//! ```text
//! Δx = θ_u − θ − v·h/2        y = min(Δx, v·D/2)        a = v²/(2·y)
//! ```
//!
//! it stops before the bound, and in D + h at most; this is the paper's "minimum deceleration, the entire
//! remaining distance" (eq 44) for moves that last an interval. It asks for the torque
//! `τ = g(θ) + d·ω − J·a` (eq 21).
//!
//! # Kinetic set (eq 41)
//! The motor can do that if `J·a ≤ τ_max + g(x)` wherever the arm passes. With g_min, the least g on the
//! range,
//!
//! ```text
//! ½·J·v² ≤ (τ_max + g_min)·y
//! ```
//!
//! which is eq 41 with the least potential energy that an arm can gain on its way, `g_min·y`, in place of
//! what it does gain: only so does one constant deceleration suffice. (Gained potential energy helps to
//! brake; eq 41 prints its sign the other way round.) On the other side `g_max + d·v ≤ τ_max`.
//!
//! # Thermal set (eq 46)
//! Let L be the limit of T, and let every angle on the range be one where the arm may rest for ever:
//! `g² ≤ Ki²·L`. While braking `τ² ≤ g² + E` with `b = J·a − d·ω` and
//!
//! ```text
//! E = b² − 2·g·b ≤ (J·a)² + (d·ω)² + 2·g⁻·J·a + 2·g⁺·d·ω       g⁻ = max(0, −g_min) ,  g⁺ = max(0, g_max)
//! d(T − L)/dt = ((τ/Ki)² − L − (T − L))/T_tc ≤ (E/Ki² − (T − L))/T_tc                        (eq 20)
//! ```
//!
//! Integrated over a time of at most D + h, with ∫ω dt ≤ X, the length of the range, and ∫ω dt ≤ v·(D + h),
//! T stays below L, at the end of the braking and for ever after, if
//!
//! ```text
//! T + κ·(J²·v³/(2·y) + (2·g⁻·J + 2·g⁺·d·(D + h) + d²·X)·v)/(Ki²·T_tc) ≤ L      κ = e^((D + h)/T_tc)
//! ```
//!
//! The first term is eq 46; the others are the arm's own torque, which eq 46 leaves out. Of the cooling,
//! neglected there, only as much is used as holding the arm at the limit takes.
//!
//! # For a solver
//! All functions are convex in (θ, v, T), and safe for a larger v too: with w ≥ v, w ≥ 0, y ≤ Δx and
//! y ≤ w·D/2 as variables the sets are second-order cones, `w² ≤ 2·(τ_max + g_min)/J·y`, and for r ≥ w³/y
//! `p² ≤ r·y`, `q² ≤ w`, `w² ≤ p·q`.
//!
//! From a state in the kinetic set the first interval of braking leads to another one (Δx falls by
//! (v − a·h)·h, which leaves a ≤ v²/(2·Δx) for the new v): plans exist as long as the arm follows its
//! reference. The error by which it does not is bounded by the margin of eq 25 and the feedback's share of
//! eq 26, as for all plans.

use arm::elementary;

use super::problem::Problem;
use super::torque_bounds::Scan;

/// Intervals at least in which the reference may be stopped.
const INTERVALS: usize = 40;
/// Deceleration that is left at least, relative to that of the motor without load.
const LEAST_DECELERATION: f64 = 1e-6;

/// What stopping before one of the two bounds takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Side {
    /// Largest deceleration (τ_max + g_min)/J \[rad/s²\].
    pub deceleration: f64,
    /// Largest velocity \[rad/s\].
    pub speed: f64,
    /// Heat of stopping per v³/y \[A²·s³/rad²\].
    pub cubic: f64,
    /// Heat of stopping per v \[A²·s/rad\].
    pub linear: f64,
}

impl Side {
    /// Within the torques `least` and `most` of g \[N·m\].
    fn new(problem: &Problem, [least, most]: [f64; 2], torque: f64, set: &SafeSet) -> Self {
        let arm = &problem.arm;
        let deceleration =
            ((torque + least) / arm.inertia).max(LEAST_DECELERATION * torque / arm.inertia);
        let overdriven = (torque - most).max(0.0) / arm.damping;
        let time = set.time + set.interval;
        let motor = &problem.motor;
        let cooling = elementary::exp(time / motor.thermal_time_constant);
        let per_torque = cooling / (motor.torque_constant.powi(2) * motor.thermal_time_constant);
        let (inertia, damping) = (arm.inertia, arm.damping);
        let [against, along] = [(-least).max(0.0), most.max(0.0)];
        let range = set.upper - set.lower;
        Self {
            deceleration,
            speed: f64::min(deceleration * set.time, overdriven),
            cubic: 0.5 * per_torque * inertia * inertia,
            linear: per_torque
                * (2.0 * against * inertia
                    + 2.0 * along * damping * time
                    + damping * damping * range),
        }
    }

    /// y for the speed `w` ≥ 0 with the `room` Δx left \[rad\].
    fn stopping_distance(&self, w: f64, room: f64, time: f64) -> f64 {
        // Beyond the kinetic set the distance that the motor needs.
        room.min(0.5 * w * time)
            .max(0.5 * w * w / self.deceleration)
    }
}

/// The safe sets for rest within one range of angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SafeSet {
    /// Least angle \[rad\].
    pub lower: f64,
    /// Largest angle \[rad\].
    pub upper: f64,
    /// h, longest interval of a plan \[s\].
    pub interval: f64,
    /// D, longest time of braking but for the last interval \[s\].
    pub time: f64,
    /// Towards the upper bound, and towards the lower one.
    pub sides: [Side; 2],
    /// L \[A²\]; infinite: not limited.
    pub thermal_limit: f64,
}

impl SafeSet {
    /// Intervals in which a reference in the sets stops at most.
    pub fn stopping_intervals(horizon: usize) -> usize {
        horizon.max(INTERVALS)
    }

    /// The sets for rest in `[lower, upper]` \[rad\], where the arm may rest for ever.
    pub fn new(problem: &Problem, lower: f64, upper: f64) -> Self {
        let interval = problem.interval_length(problem.horizon - 1);
        let intervals = Self::stopping_intervals(problem.horizon);
        let idle = Side {
            deceleration: 0.0,
            speed: 0.0,
            cubic: 0.0,
            linear: 0.0,
        };
        let mut set = Self {
            lower,
            // A single rest point still has a range.
            upper: upper.max(lower + 1e-9),
            interval,
            time: (intervals - 1) as f64 * interval,
            sides: [idle; 2],
            thermal_limit: problem.thermal_limit_after(interval),
        };
        let ([least, most], torque) = match &problem.torque_limit {
            Some(limit) => {
                let at = |angle| [limit.lower.at(angle), limit.upper.at(angle)];
                let ([l0, u0], [l1, u1]) = (at(set.lower), at(set.upper));
                ([l0.min(l1), u0.max(u1)], limit.most)
            }
            None => {
                let scan = Scan::new(&problem.arm, set.lower, set.upper);
                (scan.extremes(), problem.motor.peak_torque)
            }
        };
        set.sides = [
            Side::new(problem, [least, most], torque, &set),
            Side::new(problem, [-most, -least], torque, &set),
        ];
        set
    }

    /// Speed towards the bound of each side and the room Δx left there, at `angle` and `velocity`.
    fn approach(&self, angle: f64, velocity: f64) -> [(Side, f64, f64); 2] {
        let [up, down] = self.sides;
        let [w, v] = [velocity.max(0.0), (-velocity).max(0.0)];
        let rounded = 0.5 * self.interval;
        [
            (up, w, self.upper - angle - rounded * w),
            (down, v, angle - self.lower - rounded * v),
        ]
    }

    /// What is missing to stop at `angle` and `velocity` before the bounds; 0 in the kinetic set \[rad\].
    pub fn kinetic_excess(&self, angle: f64, velocity: f64) -> f64 {
        let sides = self.approach(angle, velocity);
        sides.iter().fold(0.0, |most: f64, (side, w, room)| {
            let short = 0.5 * w * w / side.deceleration - room;
            most.max(short).max((w - side.speed) * self.interval)
        })
    }

    /// Thermal load that stopping adds at most, at `angle` and `velocity` in the kinetic set \[A²\].
    pub fn heat(&self, angle: f64, velocity: f64) -> f64 {
        let sides = self.approach(angle, velocity);
        let heats = sides.iter().map(|(side, w, room)| {
            if *w == 0.0 {
                return 0.0;
            }
            let y = side.stopping_distance(*w, *room, self.time);
            side.cubic * w * w * w / y + side.linear * w
        });
        heats.sum()
    }

    /// Fills `moves`, each for one of the `lengths` \[s\], with the braking from `angle` and `velocity`. From
    /// outside the kinetic set the deceleration is larger than the motor's.
    pub fn brake(
        &self,
        angle: f64,
        velocity: f64,
        lengths: impl Iterator<Item = f64>,
        moves: &mut [f64],
    ) {
        moves.fill(0.0);
        if !(angle.is_finite() && velocity.is_finite()) || velocity == 0.0 {
            return;
        }
        let sides = self.approach(angle, velocity);
        let (_, w, room) = sides[usize::from(velocity < 0.0)];
        let y = room.min(0.5 * w * self.time).max(0.5 * w * self.interval);
        let deceleration = 0.5 * w * w / y;
        let mut left = w;
        for (u, length) in moves.iter_mut().zip(lengths) {
            let now = deceleration.min(left / length);
            *u = -now.copysign(velocity);
            left = (left - now * length).max(0.0);
        }
    }
}

#[cfg(test)]
mod tests;
