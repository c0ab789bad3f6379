//! The optimal control problem: what is optimised, as data (sec 3.2.3). How it becomes numbers is the
//! matter of [`super::transcription`], who solves it that of [`super::solver`].
//!
//! ```text
//! minimise    ∫ q_θ·(θ−θ_goal)² + q_ω·ω² + q_int·e² + q_T·T² + q_u·u² dt                      (eq 28)
//! subject to  dθ/dt  = ω      dω/dt  = u + fb/I
//!             dθr/dt = ωr     dωr/dt = u                                                       (eq 22)
//!             fb     = −Kθ·(θ−θr) − Kω·(ω−ωr) − Kint·e_L ,   de_L/dt = θ−θr           (eqs 37, 38)
//!             de/dt  = θ − θ_goal
//!             dT/dt  = ((τ/Ki)² − T)/T_tc ,   τ = g_φ(θ) + d·ωr + J·u                     (eqs 20, 21)
//!             θ_lower + σ_θ ≤ θr ≤ θ_upper − σ_θ                                               (eq 25)
//!             T ≤ (share·I_lim)²                                                               (eq 26)
//!             θ(N) = θ_goal ,   ω(N) = 0                                                       (eq 27)
//! ```
//!
//! with u constant over each of the N intervals.
//!
//! Two parts can be exchanged. The terminal equality (eq 27) gives way to a safe set (appendix B,
//! [`super::safe_set`]) or to nothing, by [`Terminal`]; the bounds of θr then hold at the node N too. And
//! [`Model::Qp`] leaves the thermal load out, which makes a quadratic programme of the problem (appendix C.2):
//! q_T = 0, no eq 26, and instead, at both ends of every interval (appendix C.3, [`super::torque_bounds`]),
//!
//! ```text
//! −τ_max ≤ g_lower(θ) + d·ωr + J·u      g_upper(θ) + d·ωr + J·u ≤ τ_max
//! ```

use arm::{Motor, Parameters, elementary};
use serde::{Deserialize, Serialize};

use super::solver::ANGLE_TOLERANCE;
use super::torque_bounds::TorqueLimit;

/// What the plan knows of the arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Model {
    /// Motion, torque and thermal load (eqs 20 to 22).
    Nonlinear,
    /// Motion alone, with pessimistic affine bounds of the torque (appendix C).
    Qp,
}

/// What is asked of the plan's end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Terminal {
    /// Rest at the goal (eq 27).
    RestAtGoal,
    /// A state from which the arm can be stopped within all limits (appendix B).
    SafeSet,
    /// Nothing, for comparison (sec 2.4.2): what comes after the plan may violate any limit.
    Free,
}

/// Weights of the cost (eq 28).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// q_θ, on the squared distance to the goal \[1\].
    pub angle: f64,
    /// q_ω, on the squared velocity \[s²\].
    pub velocity: f64,
    /// q_int, on the squared integral of the distance to the goal \[1/s²\].
    pub integral: f64,
    /// q_T, on the squared thermal load \[rad²/A⁴\].
    pub thermal: f64,
    /// q_u, on the squared reference acceleration \[s⁴\].
    pub acceleration: f64,
}

/// The feedback as the plan knows it (eqs 22, 38). Gains of zero: a part the plan does not know.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeedbackModel {
    /// I, inertia of the model that the feedback is designed for (eq 16) \[kg·m²\].
    pub inertia: f64,
    /// Kθ \[N·m/rad\].
    pub gain_angle: f64,
    /// Kω \[N·m·s/rad\].
    pub gain_velocity: f64,
    /// Kint \[N·m/(rad·s)\].
    pub gain_integral: f64,
    /// How long it holds the torque \[s\]; 0: not at all. Only [`Problem::thermal_limit_after`] knows: eq 22 is continuous.
    pub sample_period: f64,
}

/// What stays fixed from plan to plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Problem {
    /// N, number of shooting intervals; at least 2.
    pub horizon: usize,
    /// h_0, length of the first shooting interval \[s\].
    pub period: f64,
    /// Length of a shooting interval in units of that of the one before, up to `longest`; at least 1.
    pub growth: f64,
    /// Length that no shooting interval exceeds; equal to `period`: all are equal \[s\].
    pub longest: f64,
    /// Weights of the cost (eq 28).
    pub weights: Weights,
    /// Lower bound of the reference angle, margin included (eq 25) \[rad\].
    pub angle_lower: f64,
    /// Upper bound of the reference angle, margin included (eq 25) \[rad\].
    pub angle_upper: f64,
    /// Limit of the thermal load, the feedback's share taken off (eq 26) \[A²\]; none: not limited.
    pub thermal_limit: Option<f64>,
    /// φ, the arm as the controller knows it (eq 12).
    pub arm: Parameters,
    /// Motor (eqs 10, 20).
    pub motor: Motor,
    /// Feedback inside the model (eqs 22, 38).
    pub feedback: FeedbackModel,
    /// What the plan knows of the arm.
    pub model: Model,
    /// What is asked of its end.
    pub terminal: Terminal,
    /// Limit of the torque (appendix C.3); none: not limited.
    pub torque_limit: Option<TorqueLimit>,
}

impl Problem {
    /// Number of nodes with bounds of θr: all after the first, but for a last one that is fixed.
    pub fn bounded_nodes(&self) -> usize {
        self.horizon - usize::from(self.terminal == Terminal::RestAtGoal)
    }

    /// Whether the reference angle `angle` \[rad\] keeps its bounds (eq 25), but for [`ANGLE_TOLERANCE`].
    pub fn admits_angle(&self, angle: f64) -> bool {
        self.angle_lower - ANGLE_TOLERANCE <= angle && angle <= self.angle_upper + ANGLE_TOLERANCE
    }

    /// Whether all shooting intervals are equally long.
    pub fn is_even(&self) -> bool {
        self.growth == 1.0 || self.longest <= self.period
    }

    /// Limit of T at the end of a shooting interval of `length` \[s\] \[A²\]; infinite: not limited.
    ///
    /// A plan on a growing grid is made anew before its long intervals are over, on nodes elsewhere, and the
    /// moves it had in mind are not among the new ones. What the load can change in that much time, of the
    /// order of T_limit·(h_k − h_0)/T_tc, is kept back so that the new plan keeps the limit too. So is what it can
    /// change in a sample of the feedback: a held torque lags behind the plan's, and the feedback makes up for it.
    pub fn thermal_limit_after(&self, length: f64) -> f64 {
        let unplanned = length - self.period + self.feedback.sample_period;
        let kept_back = unplanned / self.motor.thermal_time_constant;
        let limit = self.thermal_limit.unwrap_or(f64::INFINITY);
        limit * (1.0 - kept_back).max(0.5)
    }

    /// h_k, length of shooting interval `k` \[s\].
    pub fn interval_length(&self, k: usize) -> f64 {
        (self.period * elementary::pow(self.growth, k as f64)).min(self.longest)
    }
}

/// State at the start of a plan (eq 23).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Initial {
    /// θ, measured \[rad\].
    pub angle: f64,
    /// ω \[rad/s\].
    pub velocity: f64,
    /// θr \[rad\].
    pub reference_angle: f64,
    /// ωr \[rad/s\].
    pub reference_velocity: f64,
    /// e, integral of the distance to the goal \[rad·s\].
    pub integral: f64,
    /// e_L, integral of the tracking error (eq 37) \[rad·s\].
    pub feedback_integral: f64,
    /// T \[A²\].
    pub thermal_load: f64,
}

impl Initial {
    /// Every component, in the order and units of the fields.
    pub(crate) fn numbers(&self) -> [f64; 7] {
        [
            self.angle,
            self.velocity,
            self.reference_angle,
            self.reference_velocity,
            self.integral,
            self.feedback_integral,
            self.thermal_load,
        ]
    }

    /// Whether every component is a finite number.
    pub fn is_finite(&self) -> bool {
        self.numbers().iter().all(|x| x.is_finite())
    }
}
