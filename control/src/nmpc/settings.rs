//! Settings of the planner: the group `nmpc.*` of the contract, checked at set-up, all at once.

mod torque;

use arm::{Inadmissible, Instructions, Limits, Motor, Parameters, elementary, require};

use super::deviation;
use super::problem::{FeedbackModel, Model, Problem, Terminal, Weights};
use super::rk4::Interval;

/// Length of a shooting interval in units of that of the one before, at most.
pub const GROWTH: f64 = 1.5;
/// Growth of the tracking error over a horizon beyond which a prediction is worthless.
const MAX_DEVIATION_GROWTH: f64 = 1e3;

/// Who solves what the plan without inequalities does not; numbered as in the contract, which the unit checks. Only
/// plans of the nonlinear model that end at rest are solved by [`super::interior_point`]; for all others it is refused
/// by itself, and not tried at all by [`Method::Automatic`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// [`super::interior_point`], and where that does not converge [`super::conic`].
    Automatic = 1,
    /// [`super::interior_point`] alone.
    Riccati = 2,
    /// [`super::conic`] alone.
    Clarabel = 3,
}

/// Settings of the planner; defaults are those of the T-flex (sec 4.1.1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Period of the plans, and length of the first shooting interval \[s\].
    pub period: f64,
    /// N, number of shooting intervals.
    pub horizon: i32,
    /// Duration of a plan; longer than N periods: intervals grow, by [`GROWTH`] at most, to a common length.
    /// 0: N periods \[s\].
    pub duration: f64,
    /// Time after which a plan must be ready; 0: any. Kept where there is a clock \[s\].
    pub deadline: f64,
    /// Time from the measurement that a plan is made from until it is applied, at most a period \[s\].
    pub latency: f64,
    /// Whether a plan starts from the state predicted to the time when it is applied.
    pub models_latency: bool,
    /// What the plan knows of the arm.
    pub model: Model,
    /// What is asked of its end.
    pub terminal: Terminal,
    /// Weights of the cost (eq 28).
    pub weights: Weights,
    /// σ_θ, distance of the reference from the limits (eq 25) \[rad\].
    pub angle_margin: f64,
    /// Share of the continuous current that the plan may use (eq 26) \[1\].
    pub thermal_share: f64,
    /// Whether the plan keeps the thermal limit.
    pub thermal_limit: bool,
    /// Whether the plan knows the feedback (eq 22).
    pub models_feedback: bool,
    /// Whether the plan knows the integral part of the feedback (eqs 37, 38).
    pub models_integrator: bool,
    /// Who solves.
    pub solver: Method,
    /// Instructions of the processor that plans are computed with.
    pub instructions: Instructions,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            period: 0.05,
            horizon: 40,
            duration: 0.0,
            deadline: 0.0,
            latency: 0.0,
            models_latency: true,
            model: Model::Nonlinear,
            terminal: Terminal::RestAtGoal,
            weights: Weights {
                angle: 1.0,
                velocity: 0.0025,
                integral: 0.0,
                thermal: 1e-6,
                acceleration: 1e-6,
            },
            angle_margin: 0.02,
            thermal_share: 0.85,
            thermal_limit: true,
            models_feedback: true,
            models_integrator: false,
            solver: Method::Riccati,
            instructions: Instructions::best(),
        }
    }
}

impl Settings {
    /// The optimal control problem of these settings.
    ///
    /// # Errors
    /// Every setting that is not admissible by itself, or else those not admissible for this arm,
    /// motor, limits and feedback. The latter are taken to be admissible themselves.
    pub fn problem(
        &self,
        arm: &Parameters,
        motor: &Motor,
        limits: &Limits,
        feedback: &FeedbackModel,
    ) -> Result<Problem, Vec<Inadmissible>> {
        let mut errors = Vec::new();
        self.validate(motor, limits, &mut errors);
        if !errors.is_empty() {
            return Err(errors);
        }
        let used = |used: bool, gain: f64| if used { gain } else { 0.0 };
        let linear = self.model == Model::Qp;
        let torque_limit = linear.then(|| self.torque_limit(arm, motor, limits));
        let problem = Problem {
            horizon: usize::try_from(self.horizon).unwrap_or_default(),
            period: self.period,
            growth: if self.duration > 0.0 { GROWTH } else { 1.0 },
            longest: self.longest_interval(),
            weights: Weights {
                thermal: used(!linear, self.weights.thermal),
                ..self.weights
            },
            angle_lower: limits.angle_lower + self.angle_margin,
            angle_upper: limits.angle_upper - self.angle_margin,
            thermal_limit: (self.thermal_limit && !linear)
                .then(|| self.thermal_share * self.thermal_share * motor.thermal_limit()),
            arm: *arm,
            motor: *motor,
            feedback: FeedbackModel {
                inertia: feedback.inertia,
                gain_angle: used(self.models_feedback, feedback.gain_angle),
                gain_velocity: used(self.models_feedback, feedback.gain_velocity),
                gain_integral: used(
                    self.models_feedback && self.models_integrator,
                    feedback.gain_integral,
                ),
                ..*feedback
            },
            model: self.model,
            terminal: self.terminal,
            torque_limit,
        };
        self.validate_torque(&problem, &mut errors);
        if !errors.is_empty() {
            return Err(errors);
        }
        if predictable(&problem) {
            return Ok(problem);
        }
        // The period itself, or the duration that decides on the intervals after the first.
        let (name, value, shortest) = if problem.is_even() {
            ("nmpc.period", self.period, 1e-6)
        } else {
            ("nmpc.duration", self.duration, self.durations()[0])
        };
        let with = |value: f64| {
            let settings = match name {
                "nmpc.period" => Self {
                    period: value,
                    duration: 0.0,
                    ..*self
                },
                _ => Self {
                    duration: value,
                    ..*self
                },
            };
            Problem {
                period: settings.period,
                longest: settings.longest_interval(),
                ..problem
            }
        };
        let mut longest = [shortest, value];
        for _ in 0..40 {
            let middle = 0.5 * (longest[0] + longest[1]);
            longest[usize::from(!predictable(&with(middle)))] = middle;
        }
        Err(vec![Inadmissible {
            name,
            value,
            admissible: format!(
                "short enough for RK4 to follow the feedback that the plan models: at most {:.4}",
                longest[0]
            ),
            unit: "s",
        }])
    }

    /// Shortest and longest duration that the horizon can have \[s\].
    fn durations(&self) -> [f64; 2] {
        let horizon = f64::from(self.horizon);
        let growing = (elementary::pow(GROWTH, horizon) - 1.0) / (GROWTH - 1.0);
        [horizon, growing].map(|intervals| intervals * self.period)
    }

    /// Duration of intervals that grow to a length of `longest` \[s\].
    fn filled(&self, longest: f64) -> f64 {
        let lengths = std::iter::successors(Some(self.period), |h| Some(h * GROWTH));
        let lengths = lengths.take(usize::try_from(self.horizon).unwrap_or_default());
        lengths.map(|h| h.min(longest)).sum()
    }

    /// Length of the longest shooting interval \[s\]: the one with which the intervals fill the duration.
    fn longest_interval(&self) -> f64 {
        let [shortest, _] = self.durations();
        if self.duration <= shortest {
            return self.period;
        }
        let mut within = [self.period, self.duration];
        for _ in 0..60 {
            let middle = 0.5 * (within[0] + within[1]);
            within[usize::from(self.filled(middle) > self.duration)] = middle;
        }
        within[0]
    }

    /// Notes what is not admissible about the duration, whose intervals are `longest` \[s\] at most.
    fn validate_duration(&self, longest: f64, errors: &mut Vec<Inadmissible>) {
        let [least, most] = self.durations();
        let rounding = 1e-9 * least;
        let fits = (least - rounding..=most).contains(&self.duration);
        if self.duration != 0.0 && !(fits && self.longest_interval() <= longest) {
            errors.push(Inadmissible {
                name: "nmpc.duration",
                value: self.duration,
                admissible: format!(
                    "0, or nmpc.horizon*nmpc.period = {least} to {:.4}",
                    most.min(self.filled(longest))
                ),
                unit: "s",
            });
        }
    }

    fn validate(&self, motor: &Motor, limits: &Limits, errors: &mut Vec<Inadmissible>) {
        const WEIGHT: [f64; 2] = [0.0, 1e12];
        let riccati = self.model == Model::Nonlinear && self.terminal == Terminal::RestAtGoal;
        if self.solver == Method::Riccati && !riccati {
            errors.push(Inadmissible {
                name: "nmpc.solver",
                value: f64::from(Method::Riccati as i32),
                admissible: "1 (automatic) or 3 (clarabel): 2 (riccati) solves nmpc.model = 1 (nonlinear) with \
                             nmpc.terminal = 1 (rest_at_goal) only"
                    .to_owned(),
                unit: "1",
            });
        }
        let weights = &self.weights;
        // Above the thermal time constant an RK4 step of eq 20 loses its positive weights.
        let longest = f64::min(10.0, motor.thermal_time_constant);
        let before = errors.len();
        require(errors, "nmpc.period", self.period, [1e-6, longest], "s");
        let horizon = f64::from(self.horizon);
        require(errors, "nmpc.horizon", horizon, [2.0, 400.0], "1");
        if errors.len() == before {
            self.validate_duration(longest, errors);
        }
        require(errors, "nmpc.deadline", self.deadline, [0.0, 10.0], "s");
        let latest = self.period.max(0.0);
        require(errors, "nmpc.latency", self.latency, [0.0, latest], "s");
        require(errors, "nmpc.weight_angle", weights.angle, WEIGHT, "1");
        require(
            errors,
            "nmpc.weight_velocity",
            weights.velocity,
            WEIGHT,
            "s2",
        );
        require(
            errors,
            "nmpc.weight_integral",
            weights.integral,
            WEIGHT,
            "1/s2",
        );
        require(
            errors,
            "nmpc.weight_thermal",
            weights.thermal,
            WEIGHT,
            "rad2/A4",
        );
        require(
            errors,
            "nmpc.weight_acceleration",
            weights.acceleration,
            [1e-12, 1e12],
            "s4",
        );
        let half_range = 0.5 * (limits.angle_upper - limits.angle_lower);
        let margin = [0.0, half_range.min(1e3)];
        require(
            errors,
            "nmpc.angle_margin",
            self.angle_margin,
            margin,
            "rad",
        );
        let share = [1e-3, 1.0];
        require(errors, "nmpc.thermal_share", self.thermal_share, share, "1");
    }
}

/// Whether the tracking error stays bounded over the horizon when predicted with these intervals.
fn predictable(problem: &Problem) -> bool {
    deviation::growth(&Interval::all(problem), problem.horizon) <= MAX_DEVIATION_GROWTH
}

#[cfg(test)]
mod tests {
    use super::super::examples::feedback;
    use super::super::grid::Grid;
    use super::*;
    use proptest::prelude::*;

    fn problem(nmpc: Settings) -> Result<Problem, Vec<Inadmissible>> {
        let settings = crate::Settings::tflex();
        let crate::Settings {
            arm, motor, limits, ..
        } = &settings;
        nmpc.problem(arm, motor, limits, &feedback(&settings))
    }

    proptest! {
        /// From one period to a common length, by half each at most, over the whole duration.
        #[test]
        fn intervals_fill_the_duration(horizon in 12..80, period in 1e-4..0.05_f64, longer in 1.0..20.0_f64) {
            let duration = f64::min(longer, 0.07 / period) * period * f64::from(horizon);
            let settings = Settings { horizon, period, duration, ..Settings::default() };
            let [shortest, longest] = settings.durations();
            prop_assume!((shortest..longest).contains(&duration));
            let problem = problem(settings).map_err(|errors| TestCaseError::fail(errors[0].to_string()))?;
            let grid = Grid::new(&problem);
            prop_assert!((grid.nodes()[grid.nodes().len() - 1] - duration).abs() <= 1e-9 * duration);
            prop_assert!((grid.nodes()[1] - period).abs() <= 1e-12);
            let lengths: Vec<_> = grid.nodes().windows(2).map(|node| node[1] - node[0]).collect();
            for pair in lengths.windows(2) {
                prop_assert!(pair[1] >= pair[0] * (1.0 - 1e-9) && pair[1] <= GROWTH * pair[0] * (1.0 + 1e-9));
            }
        }
    }

    #[test]
    fn durations_that_intervals_cannot_fill_are_refused_with_the_range() {
        for (horizon, duration) in [(40, 1.9), (40, -1.0), (40, f64::NAN), (2, 0.2), (40, 500.0)] {
            let settings = Settings {
                horizon,
                duration,
                ..Settings::default()
            };
            let error = problem(settings).expect_err("refused")[0].to_string();
            assert!(
                error.contains("nmpc.duration") && error.contains(" to "),
                "{error}"
            );
        }
        // N periods are a duration like any other.
        let settings = Settings {
            duration: 2.0,
            ..Settings::default()
        };
        assert!(problem(settings).expect("admissible").is_even());
        // Intervals that the feedback outruns are refused by the duration that makes them.
        let settings = Settings {
            duration: 40.0,
            ..Settings::default()
        };
        let error = problem(settings).expect_err("refused")[0].to_string();
        assert!(
            error.contains("nmpc.duration") && error.contains("follow the feedback"),
            "{error}"
        );
    }
}
