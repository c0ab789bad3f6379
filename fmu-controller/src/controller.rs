//! [`Controller`]: a sampled unit without continuous states; every sample is an event.

use std::time::Instant;

use arm::Instructions;
use control::LARGEST_ANGLE;
use control::nmpc::plan::PlanStatus;
use control::nmpc::solver::Clock;
use control::{Command, State};
use fmi_unit::{Failure, Log, Severity, Unit};

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
    type Job = ();

    /// Before the first sample there is no torque, and the reference rests at the measured angle.
    fn initial_outputs(variables: &mut Variables) {
        variables.reference.angle = variables.angle;
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
        let before = variables.nmpc.status;
        let begin = self.reports_time.then(Instant::now);
        let command = self.control.sample(variables.angle, variables.setpoint);
        if command.new_plan {
            if let Some(begin) = begin {
                variables.nmpc.solve_time = begin.elapsed().as_secs_f64();
            }
            let plan = self.control.plan();
            variables.nmpc.iterations = saturated(plan.iterations);
            variables.nmpc.convex_problems = saturated(plan.convex_problems);
            variables.nmpc.cost = plan.trajectory.cost;
            variables.nmpc.goal = plan.goal;
            plan::publish(plan, self.control.latency(), &mut variables.nmpc.plan);
        }
        write(&command, variables);
        if variables.nmpc.status != before {
            report(command.plan_status, variables, time, log);
        }
        Ok(())
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
