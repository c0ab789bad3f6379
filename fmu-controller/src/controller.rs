//! [`Controller`]: a sampled unit without continuous states; every sample is an event.

use std::time::Instant;

use arm::Instructions;
use control::LARGEST_ANGLE;
use control::nmpc::plan::PlanStatus;
use control::nmpc::solver::Clock;
use control::{Command, Planning, State, When};
use fmi_unit::{Failure, Log, Severity, Ticks, Unit};

use crate::plan;
use crate::settings::{instructions, settings};
use crate::variables::{self, Variables};

const WARNING: &str = "logStatusWarning";
const EVENTS: &str = "logEvents";

/// The controller, sampled at `start + k·sample_period`.
pub struct Controller {
    control: control::Controller,
    /// \[s\]
    start: f64,
    sample_period: f64,
    reports_time: bool,
}

/// Positions of the clocks in the contract, which a test compares.
const FEEDBACK: usize = 0;
const PLAN: usize = 1;

/// A plan under way in a partition of its own.
pub struct Job {
    planning: Box<Planning>,
    /// When it began, if times are reported.
    begin: Option<Instant>,
}

/// The machine's monotonic clock.
struct WallClock(Instant);

impl Clock for WallClock {
    fn now(&self) -> f64 {
        self.0.elapsed().as_secs_f64()
    }
}

impl Unit for Controller {
    type Variables = Variables;
    type State = State;
    type Job = Job;

    /// Before the first sample there is no torque, and the reference rests at the measured angle, if that is
    /// a usable number.
    fn initial_outputs(variables: &mut Variables) {
        let angle = variables.angle;
        variables.reference.angle = if control::usable(angle) { angle } else { 0.0 };
        variables.thermal_load = variables.initial.thermal_load;
        // A set that is none of its items is refused later, by name.
        let set = instructions(variables).unwrap_or(Instructions::Baseline);
        variables.nmpc.instructions = match set.available() {
            Instructions::Baseline => variables::Instructions::Separate,
            Instructions::Fused => variables::Instructions::Fused,
        } as i64;
    }

    fn new(variables: &mut Variables, start: f64) -> Result<Self, Vec<Failure>> {
        let settings = settings(variables).map_err(|failure| vec![failure])?;
        let mut control = control::Controller::new(&settings).map_err(|errors| {
            errors
                .iter()
                .map(|e| Failure(e.to_string()))
                .collect::<Vec<_>>()
        })?;
        if settings.nmpc.deadline > 0.0 {
            control.set_clock(Box::new(WallClock(Instant::now())));
        }
        Ok(Self {
            control,
            start,
            sample_period: settings.sample_period,
            reports_time: variables.nmpc.reports_time,
        })
    }

    fn state(&self) -> &State {
        self.control.state()
    }

    fn is_admissible(state: &State) -> bool {
        state.is_admissible()
    }

    fn set_state(&mut self, state: &State) -> Result<(), Failure> {
        self.control.set_state(state);
        Ok(())
    }

    fn next_event(&self) -> f64 {
        self.start + self.control.samples() as f64 * self.sample_period
    }

    fn event(
        &mut self,
        variables: &mut Variables,
        time: f64,
        log: &mut Log<'_>,
    ) -> Result<(), Failure> {
        self.sample(variables, When::Due, time, log)
    }

    fn clock_interval(variables: &Variables, clock: usize) -> f64 {
        match clock {
            FEEDBACK => variables.sample_period,
            _ => variables.nmpc.period,
        }
    }

    fn set_clock_interval(variables: &mut Variables, clock: usize, interval: f64) {
        match clock {
            FEEDBACK => variables.sample_period = interval,
            _ => variables.nmpc.period = interval,
        }
    }

    /// Where both clocks tick the plan comes first, as without clocks.
    fn tick(
        &mut self,
        variables: &mut Variables,
        ticks: Ticks,
        time: f64,
        log: &mut Log<'_>,
    ) -> Result<(), Failure> {
        match (ticks.contains(FEEDBACK), ticks.contains(PLAN)) {
            (true, true) => self.sample(variables, When::Now, time, log)?,
            (true, false) => self.sample(variables, When::Never, time, log)?,
            (false, true) => {
                if let Some(mut job) = self.activate(variables, PLAN, time, log)? {
                    Self::work(&mut job);
                    self.complete(variables, job, log)?;
                }
            }
            (false, false) => {}
        }
        Ok(())
    }

    /// The feedback samples at once; the planner starts from the latest sample.
    fn activate(
        &mut self,
        variables: &mut Variables,
        clock: usize,
        time: f64,
        log: &mut Log<'_>,
    ) -> Result<Option<Job>, Failure> {
        if clock == PLAN {
            let begin = self.reports_time.then(Instant::now);
            let planning = self.control.begin_plan();
            return Ok(planning.map(|planning| Job { planning, begin }));
        }
        self.sample(variables, When::Never, time, log)?;
        Ok(None)
    }

    fn work(job: &mut Job) {
        job.planning.run();
    }

    fn complete(
        &mut self,
        variables: &mut Variables,
        job: Job,
        _: &mut Log<'_>,
    ) -> Result<(), Failure> {
        self.control.finish_plan(job.planning);
        self.publish_plan(variables, job.begin);
        Ok(())
    }
}

impl Controller {
    fn sample(
        &mut self,
        variables: &mut Variables,
        plan: When,
        time: f64,
        log: &mut Log<'_>,
    ) -> Result<(), Failure> {
        let before = variables.nmpc.status;
        let begin = self.reports_time.then(Instant::now);
        let (angle, setpoint) = (variables.angle, variables.setpoint);
        let command = self.control.sample_and_plan(angle, setpoint, plan);
        if !command.torque.is_finite() {
            return Err(Failure(format!(
                "at {time} s torque = {} N.m is not admissible: must be finite; the last good one stays",
                command.torque
            )));
        }
        if command.new_plan {
            self.publish_plan(variables, begin);
        }
        write(&command, variables);
        if variables.nmpc.status != before {
            report(command.plan_status, variables, time, log);
        }
        Ok(())
    }

    fn publish_plan(&self, variables: &mut Variables, begin: Option<Instant>) {
        if let Some(begin) = begin {
            variables.nmpc.solve_time = begin.elapsed().as_secs_f64();
        }
        let Some(plan) = self.control.plan() else {
            return;
        };
        variables.nmpc.iterations = saturated(plan.iterations);
        variables.nmpc.convex_problems = saturated(plan.convex_problems);
        variables.nmpc.cost = plan.trajectory.cost;
        variables.nmpc.goal = plan.goal;
        plan::publish(plan, self.control.latency(), &mut variables.nmpc.plan);
    }
}

fn write(command: &Command, variables: &mut Variables) {
    variables.torque = command.torque;
    variables.current = command.current;
    variables.reference.angle = command.reference.angle;
    variables.reference.velocity = command.reference.velocity;
    variables.reference.acceleration = command.reference.acceleration;
    variables.feedforward_torque = command.feedforward_torque;
    variables.feedback_torque = command.feedback_torque;
    variables.thermal_load = command.thermal_load;
    variables.nmpc.status = declared(command.plan_status) as i64;
}

/// The item of the contract that a status is.
fn declared(status: PlanStatus) -> variables::PlanStatus {
    match status {
        PlanStatus::Idle => variables::PlanStatus::Idle,
        PlanStatus::Solved => variables::PlanStatus::Solved,
        PlanStatus::GoalProjected => variables::PlanStatus::GoalProjected,
        PlanStatus::ThermalSlack => variables::PlanStatus::ThermalSlack,
        PlanStatus::IterationLimit => variables::PlanStatus::IterationLimit,
        PlanStatus::ShiftedPlan => variables::PlanStatus::ShiftedPlan,
        PlanStatus::Rest => variables::PlanStatus::Rest,
        PlanStatus::MeasurementHeld => variables::PlanStatus::MeasurementHeld,
        PlanStatus::AngleSlack => variables::PlanStatus::AngleSlack,
        PlanStatus::Deadline => variables::PlanStatus::Deadline,
    }
}

/// Says once when the way plans come to be changes.
fn report(status: PlanStatus, variables: &Variables, time: f64, log: &mut Log<'_>) {
    let Variables {
        angle, setpoint, ..
    } = *variables;
    let goal = variables.nmpc.goal;
    match status {
        PlanStatus::Idle | PlanStatus::Solved => {}
        PlanStatus::GoalProjected => log.write(
            Severity::Info,
            EVENTS,
            format_args!("at {time} s the setpoint {setpoint} rad cannot be held within the margins: planning to {goal} rad"),
        ),
        PlanStatus::ThermalSlack => log.write(
            Severity::Warning,
            WARNING,
            format_args!("at {time} s no plan keeps the thermal limit, or the torque limit of nmpc.model = qp: planning the least excess"),
        ),
        PlanStatus::AngleSlack => log.write(
            Severity::Warning,
            WARNING,
            format_args!("at {time} s no plan keeps the reference within its angle bounds: they are widened until it is back"),
        ),
        PlanStatus::IterationLimit => log.write(
            Severity::Info,
            EVENTS,
            format_args!("at {time} s the planner stopped before it converged; its best plan is taken"),
        ),
        PlanStatus::Deadline => log.write(
            Severity::Info,
            EVENTS,
            format_args!("at {time} s the deadline came before the planner converged; its best plan is taken"),
        ),
        PlanStatus::ShiftedPlan => log.write(
            Severity::Warning,
            WARNING,
            format_args!("at {time} s no plan was found: the previous one goes on"),
        ),
        PlanStatus::Rest => log.write(
            Severity::Warning,
            WARNING,
            format_args!("at {time} s no plan was found and none is left: braking to rest"),
        ),
        PlanStatus::MeasurementHeld => {
            for (name, value, held) in [
                ("angle", angle, "torque"),
                ("setpoint", setpoint, "setpoint"),
            ] {
                if !control::usable(value) {
                    log.write(
                        Severity::Warning,
                        WARNING,
                        format_args!(
                            "at {time} s {name} = {value} rad is outside [-{LARGEST_ANGLE:e}, {LARGEST_ANGLE:e}] rad: \
                             the last good {held} is held"
                        ),
                    );
                }
            }
        }
    }
}

fn saturated(count: u32) -> i32 {
    i32::try_from(count).unwrap_or(i32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmi_unit::Variables as _;

    /// Found by random calls: a start from no measurement put it out.
    #[test]
    fn an_angle_that_is_no_number_is_not_put_out() {
        for angle in [f64::NAN, f64::INFINITY, -1e7] {
            let mut variables = Variables {
                angle,
                ..Variables::default()
            };
            Controller::initial_outputs(&mut variables);
            assert_eq!(variables.reference.angle, 0.0);
        }
    }

    #[test]
    fn clocks_are_those_of_the_contract() {
        let clocks = Variables::MODEL.clocks;
        assert_eq!(clocks.len(), 2);
        for (index, name, interval) in [
            (FEEDBACK, "clock.feedback", 0.00025),
            (PLAN, "clock.plan", 0.05),
        ] {
            assert_eq!(clocks[index].name, name);
            let found = Controller::clock_interval(&Variables::default(), index);
            assert_eq!(found, interval, "{name}");
        }
    }
}
