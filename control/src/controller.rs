//! One sample of the controller: a measured angle and a setpoint in, a motor torque out.

use arm::{Inadmissible, Limits, Motor, Parameters, hysteresis, thermal};

use crate::feedback::Feedback;
use crate::latency::Prediction;
use crate::nmpc::grid::Grid;
use crate::nmpc::plan::{Plan, PlanStatus};
use crate::nmpc::planner::Planner;
use crate::nmpc::problem::{FeedbackModel, Initial};
use crate::nmpc::solver::Clock;
use crate::planning::{Origin, Planning, When};
use crate::profile::{self, Profile};
use crate::settings::{ReferenceSource, Settings};
use crate::state::{Command, Pending, State};
use crate::{Reference, feedforward};

/// Angles beyond this \[rad\] are as good as not a number: no arm turns 10⁵ times.
pub const LARGEST_ANGLE: f64 = 1e6;

/// Whether an angle or setpoint \[rad\] can be worked with: a number of at most [`LARGEST_ANGLE`].
pub fn usable(input: f64) -> bool {
    input.abs() <= LARGEST_ANGLE
}

/// The controller of sec 3.2.
pub struct Controller {
    arm: Parameters,
    motor: Motor,
    limits: Limits,
    sample_period: f64,
    /// Samples in a plan period; need not be a whole number.
    samples_per_plan: f64,
    source: ReferenceSource,
    feedback: Feedback,
    profile: Profile,
    /// Of the plans.
    grid: Grid,
    /// None while a plan is made elsewhere.
    planning: Option<Box<Planning>>,
    /// Samples from the measurement of a plan until it is applied.
    latency: u64,
    state: State,
}

impl Controller {
    /// Sets a controller up and allocates all that it needs.
    ///
    /// # Errors
    /// Every setting that is not admissible.
    pub fn new(settings: &Settings) -> Result<Self, Vec<Inadmissible>> {
        let Settings {
            arm,
            motor,
            limits,
            sample_period,
            initial_thermal_load,
            reference,
            profile_max_acceleration,
            nmpc,
            feedback,
        } = settings;
        let mut errors = Vec::new();
        arm.validate(&mut errors);
        motor.validate(&mut errors);
        limits.validate(&mut errors);
        settings.validate_own(&mut errors);
        let feedback = Feedback::new(feedback, *sample_period)
            .map_err(|reasons| errors.extend(reasons))
            .ok();
        let (Some(feedback), true) = (feedback, errors.is_empty()) else {
            return Err(errors);
        };
        let model = FeedbackModel {
            inertia: settings.feedback.inertia,
            gain_angle: feedback.gains.angle,
            gain_velocity: feedback.gains.velocity,
            gain_integral: feedback.gains.integral,
            sample_period: *sample_period,
        };
        let planner = Planner::new(nmpc, arm, motor, limits, &model)?;
        let samples_per_plan = whole_if_close(nmpc.period / sample_period);
        // Whole samples, and never beyond the next plan.
        let latency = whole_if_close(nmpc.latency / sample_period).ceil();
        let latency = latency.min(samples_per_plan.floor());
        let prediction = (latency > 0.0 && nmpc.models_latency)
            .then(|| Prediction::new(arm, motor, &model, latency as usize, *sample_period));
        let state = State::new(*initial_thermal_load, planner.state());
        let grid = planner.grid().clone();
        let planning = Planning {
            planner,
            prediction,
            from: state.origin,
        };
        Ok(Self {
            arm: *arm,
            motor: *motor,
            limits: *limits,
            sample_period: *sample_period,
            samples_per_plan,
            source: *reference,
            feedback,
            profile: Profile {
                max_acceleration: *profile_max_acceleration,
                sample_period: *sample_period,
            },
            grid,
            planning: Some(Box::new(planning)),
            latency: latency as u64,
            state,
        })
    }

    /// Tells the time from now on, without which `nmpc.deadline` is not kept.
    pub fn set_clock(&mut self, clock: Box<dyn Clock>) {
        if let Some(planning) = &mut self.planning {
            planning.planner.set_clock(clock);
        }
    }

    /// Takes one sample: `angle` measured and `setpoint` wanted \[rad\]. Makes a plan when it is due.
    ///
    /// The first sample sets the reference to rest at the measured angle. Without a usable angle the
    /// last good command is held: time and thermal load go on, all else waits. Without a usable setpoint
    /// the last good one stays in force; before the first, the command is held.
    pub fn sample(&mut self, angle: f64, setpoint: f64) -> Command {
        self.sample_and_plan(angle, setpoint, When::Due)
    }

    /// [`Controller::sample`] with a plan when somebody else's clock asks for it.
    pub fn sample_and_plan(&mut self, angle: f64, setpoint: f64, plan: When) -> Command {
        if usable(setpoint) {
            self.state.setpoint = Some(setpoint);
        }
        match self.state.setpoint {
            Some(setpoint) if usable(angle) => self.control(angle, setpoint, plan),
            _ => {
                self.state.command.thermal_load = self.state.thermal_load;
                self.state.command.new_plan = false;
            }
        }
        if !(usable(angle) && usable(setpoint)) {
            self.state.command.plan_status = PlanStatus::MeasurementHeld;
            self.state.command.measurement_held = true;
        }
        let state = &mut self.state;
        state.samples += 1;
        state.thermal_load = thermal::update(
            &self.motor,
            state.thermal_load,
            state.command.torque,
            self.sample_period,
        );
        state.command
    }

    /// Takes out what makes plans, to plan from the last sample with a usable angle; none if there was no
    /// such sample, if the reference is a profile, or if it is out already.
    pub fn begin_plan(&mut self) -> Option<Box<Planning>> {
        if self.state.measured == 0 || self.source != ReferenceSource::Nmpc {
            return None;
        }
        let mut planning = self.planning.take()?;
        planning.from = self.state.origin;
        Some(planning)
    }

    /// Takes a plan that was made elsewhere back in. It applies once its latency has gone by, at the next
    /// sample at the earliest, and its first move is in force until the next plan (sec 3.2.3).
    pub fn finish_plan(&mut self, planning: Box<Planning>) {
        let state = &mut self.state;
        let plan = planning.planner.latest();
        state.pending = Some(Pending {
            sample: planning.from.sample + self.latency,
            acceleration: plan.moves[0],
            goal: plan.goal,
            status: plan.status,
        });
        // Not by a derived clone_from, which allocates.
        state.planner.clone_from(planning.planner.state());
        // Not before the next period, whichever way the quotient rounds.
        let period = (planning.from.sample as f64 / self.samples_per_plan) as u64;
        state.next_plan = period.max(state.next_plan) + 1;
        self.planning = Some(planning);
    }

    /// Everything that changes while the controller runs.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Goes back to a state of a controller with the same settings; what follows is equal to the bit.
    /// [`Controller::plan`] is not brought back.
    pub fn set_state(&mut self, state: &State) {
        self.state = state.clone();
        if let Some(planning) = &mut self.planning {
            planning.planner.set_state(&state.planner);
        }
    }

    /// Samples taken so far, held ones included.
    pub fn samples(&self) -> u64 {
        self.state.samples
    }

    /// Time from the sample that makes a plan until it is applied \[s\]: whole samples.
    pub fn latency(&self) -> f64 {
        self.latency as f64 * self.sample_period
    }

    /// The latest plan; none while the next one is made elsewhere.
    pub fn plan(&self) -> Option<&Plan> {
        self.planning.as_ref().map(|p| p.planner.latest())
    }

    /// The sample, once its inputs are known to be usable.
    fn control(&mut self, angle: f64, setpoint: f64, plan: When) {
        let velocity = self.measure(angle, setpoint);
        let mut new_plan = false;
        match self.source {
            ReferenceSource::Nmpc => {
                self.apply_pending();
                self.state.origin = self.origin(angle, velocity, setpoint);
                let now = match plan {
                    When::Due => self.plan_is_due(),
                    When::Now => true,
                    When::Never => false,
                };
                if now && let Some(mut planning) = self.begin_plan() {
                    planning.run();
                    self.finish_plan(planning);
                    self.apply_pending();
                    new_plan = true;
                }
                if plan == When::Never {
                    self.go_on_if_late();
                }
            }
            ReferenceSource::Profile => {
                let state = &mut self.state;
                // Eq 35 knows no limits; the arm does.
                let goal = setpoint.clamp(self.limits.angle_lower, self.limits.angle_upper);
                state.reference = self.profile.sample(&mut state.profile, goal);
                state.goal = goal;
            }
        }
        let state = &mut self.state;
        let reference = state.reference;
        let feedback_torque = self.feedback.sample(
            &mut state.feedback,
            angle - reference.angle,
            velocity - reference.velocity,
        );
        let feedforward_torque =
            feedforward::torque(&self.arm, angle, state.hysteresis, &reference);
        let torque = self.motor.saturate(feedforward_torque + feedback_torque);
        state.command = Command {
            torque,
            current: torque / self.motor.torque_constant,
            reference,
            feedforward_torque,
            feedback_torque,
            thermal_load: state.thermal_load,
            plan_status: state.plan_status,
            new_plan,
            measurement_held: false,
        };
        state.reference = reference.advanced(self.sample_period);
        state.integral += (angle - state.goal) * self.sample_period;
    }

    /// Takes a usable measurement in; returns the velocity \[rad/s\], the unfiltered difference (sec 3.2.2).
    fn measure(&mut self, angle: f64, setpoint: f64) -> f64 {
        let state = &mut self.state;
        let now = state.samples + 1;
        let velocity = if state.measured == 0 {
            state.reference = Reference::at_rest(angle);
            state.profile = profile::State::at(angle);
            state.goal = setpoint;
            0.0
        } else {
            let move_ = angle - state.angle;
            state.hysteresis = hysteresis::update(state.hysteresis, move_);
            move_ / ((now - state.measured) as f64 * self.sample_period)
        };
        state.measured = now;
        state.angle = angle;
        velocity
    }

    /// Puts the pending plan in force if its time has come.
    fn apply_pending(&mut self) {
        let state = &mut self.state;
        if let Some(pending) = state.pending.take_if(|p| p.sample <= state.samples) {
            state.reference.acceleration = pending.acceleration;
            state.goal = pending.goal;
            state.plan_status = pending.status;
            state.in_force = state.samples;
        }
    }

    /// Where the next plan is not there in time the one in force goes on, to rest at its end.
    fn go_on_if_late(&mut self) {
        let state = &mut self.state;
        if state.pending.is_some() {
            // The memory is that of the new plan; until it applies its prediction counts on the move in force.
            return;
        }
        let since = (state.samples - state.in_force) as f64;
        let Some(age) = state.planner.age.filter(|_| since >= self.samples_per_plan) else {
            return;
        };
        let period = self.samples_per_plan * self.sample_period;
        let ago = f64::from(age) * period + since * self.sample_period;
        match self.grid.move_at(&state.planner.moves, ago) {
            Some(acceleration) => state.reference.acceleration = acceleration,
            None => state.reference = Reference::at_rest(state.reference.angle),
        }
        state.plan_status = PlanStatus::ShiftedPlan;
    }

    /// Whether this is the first usable sample at or after the beginning of the next plan period.
    fn plan_is_due(&self) -> bool {
        self.state.samples as f64 >= self.state.next_plan as f64 * self.samples_per_plan
    }

    /// What a plan from this sample begins with.
    fn origin(&self, angle: f64, velocity: f64, setpoint: f64) -> Origin {
        let state = &self.state;
        Origin {
            sample: state.samples,
            measured: Initial {
                angle,
                velocity,
                reference_angle: state.reference.angle,
                reference_velocity: state.reference.velocity,
                integral: state.integral,
                feedback_integral: state.feedback.integral,
                thermal_load: state.thermal_load,
            },
            acceleration: state.reference.acceleration,
            goal: state.goal,
            setpoint,
        }
    }
}

/// The nearest whole number, if `ratio` misses it by no more than the rounding of its two parts.
fn whole_if_close(ratio: f64) -> f64 {
    let whole = ratio.round();
    if (ratio - whole).abs() <= 1e-9 * ratio {
        whole
    } else {
        ratio
    }
}
