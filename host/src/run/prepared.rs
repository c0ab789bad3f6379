//! A run of a pair from the check of what the user gave to its outcome.

use super::instances::{messages, start};
use super::master::{Clock, Master};
use super::plan::{self, Plan, SETPOINT};
use super::recording::{Column, Recording};
use super::score::{Scorer, Terms};
use super::summary::{Given, Stopped, Summary, Timing, Unit};
use super::{Outcome, Simulation, checks};
use crate::Error;
use crate::fmu::{Experiment, Fmu, Instance};
use crate::input::connections::{Source, Wiring};
use crate::input::parameters::{ParameterSets, StartValues};
use crate::input::roles::Role;
use crate::input::setpoints::{AngleLimits, Table};
use crate::input::{Pair, Side};
use std::ops::ControlFlow;
use std::time::Instant;

/// A run before its first step: what the user gave makes sense for this pair.
#[derive(Debug)]
pub struct Prepared<'a> {
    simulation: &'a Simulation,
    controller: Fmu,
    plant: Fmu,
    values: StartValues,
    wiring: Wiring,
    limits: Option<AngleLimits>,
    table: Option<Table>,
    steps: usize,
}

impl<'a> Prepared<'a> {
    /// Reads and checks what the user gave, without an instance of either FMU.
    pub fn new(simulation: &'a Simulation, controller: &Fmu, plant: &Fmu) -> Result<Self, Error> {
        let sets = ParameterSets::read(&simulation.parameters)?;
        let [controller, plant] = configured(simulation, &sets, [controller, plant])?;
        let pair = Pair::new(&controller, &plant);
        let values = StartValues::new(pair, &sets, &simulation.assignments)?;
        let wiring = Wiring::read(pair, simulation.connections.as_deref())?;
        let limits = angle_limits(pair, &values);
        let table = match &simulation.setpoints {
            Some(setpoints) => Some(setpoints.table(pair, limits)?),
            None => None,
        };
        let steps = checks::steps(simulation, pair, table.as_ref())?;
        checks::setpoint_and_angle(simulation, pair, &wiring)?;
        let prepared = Self {
            simulation,
            controller,
            plant,
            values,
            wiring,
            limits,
            table,
            steps,
        };
        checks::size(prepared.rows(), prepared.columns()?.len())?;
        Ok(prepared)
    }

    /// Descriptions of both FMUs.
    pub fn pair(&self) -> Pair<'_> {
        Pair::new(&self.controller, &self.plant)
    }

    /// Values that parameters will have.
    pub(crate) fn values(&self) -> &StartValues {
        &self.values
    }

    /// Who is connected to whom.
    pub(crate) fn wiring(&self) -> &Wiring {
        &self.wiring
    }

    /// Setpoints and other inputs over time, if they are given.
    pub(crate) fn table(&self) -> Option<&Table> {
        self.table.as_ref()
    }

    /// Simulated time of the run \[s\].
    pub fn duration(&self) -> f64 {
        self.steps as f64 * self.simulation.step
    }

    /// Number of communication points that are recorded.
    fn rows(&self) -> usize {
        self.steps.div_ceil(self.simulation.record_every)
    }

    /// Names of the statuses that plans can have; empty if nothing tells.
    pub fn statuses(&self) -> Vec<String> {
        let tap = self.wiring.roles.get(&Role::PlanStatus);
        let Some(Source::Output(side, scalar)) = tap.map(|tap| tap.source) else {
            return Vec::new();
        };
        let items = &self.pair().of(side).variable(scalar).items;
        items.iter().map(|item| item.name.clone()).collect()
    }

    /// The columns that its recording will have.
    pub fn columns(&self) -> Result<Vec<Column>, Error> {
        let constant = Table::constant(0.0);
        let table = self.table.as_ref().unwrap_or(&constant);
        let plan = Plan::new(self.pair(), &self.wiring, table, self.simulation)?;
        Ok(plan.columns)
    }

    /// Makes the run.
    ///
    /// # Errors
    /// [`Error::Stopped`], with the samples until then, where it ends before its time, be it that `progress` stops it.
    pub fn run(self, progress: &mut dyn FnMut(f64) -> ControlFlow<()>) -> Result<Outcome, Error> {
        let rows = self.rows();
        let Self {
            simulation,
            controller,
            plant,
            values,
            wiring,
            limits,
            table,
            steps,
        } = self;
        let pair = Pair::new(&controller, &plant);
        let end = steps as f64 * simulation.step;
        let experiment = Experiment {
            stop: Some(end),
            ..Experiment::default()
        };
        let start = |fmu, side: Side| {
            let name = side.to_string();
            start(
                fmu,
                &name,
                &values.of(side),
                &experiment,
                simulation.logging,
            )
        };
        let mut instances = [
            start(&controller, Side::Controller)?,
            start(&plant, Side::Plant)?,
        ];
        let table = match table {
            Some(table) => table,
            None => Table::constant(start_angle(&mut instances, &wiring)?),
        };
        let plan = Plan::new(pair, &wiring, &table, simulation)?;
        let thermal_limit = both(|side| values.number(pair, side, "motor.continuous_current"))
            .map(|current| current * current);
        let terms = Terms {
            step: simulation.step,
            first: table
                .first_change()
                .map_or(0, |time| plan::step_of(time, simulation.step)),
            limits,
            thermal_limit,
            plan_period: values.number(pair, Side::Controller, "nmpc.period"),
        };
        let mut warnings = wiring.warnings.clone();
        warnings.extend(checks::wiring(pair, &wiring));
        warnings.extend(checks::replaced(pair, &values, &wiring));
        warnings.extend(checks::descriptions(pair, simulation.step));
        warnings.extend(checks::periods(pair, &values, simulation.step));
        warnings.extend(plan.warnings.iter().cloned());
        let until = simulation.until;
        warnings
            .extend(until.and_then(|until| checks::cut("--until", until, end, simulation.step)));
        if terms.first >= steps {
            warnings.push(format!(
                "nothing is scored: errors count from the first change of the setpoint, and the run ends before, at {end} s"
            ));
        }
        let recording = Recording::new(plan.columns, plan.roles, rows);
        let mut scorer = Scorer::new(&recording, terms);
        // The angle and where it must stay.
        let guard = recording.slot(Role::Angle).zip(simulation.stop_outside);
        let step = simulation.step;
        let mut observe = |k: usize, row: &[f64]| {
            scorer.sample(k, row[SETPOINT], row);
            match guard.map(|(slot, limits)| (slot.value(row), limits)) {
                Some((angle, limits)) if !limits.contains(angle) => Err(Error::LeftRange {
                    angle,
                    time: row[0],
                    limits,
                }),
                _ => Ok(()),
            }
        };
        let schedule = table.rows.iter();
        let schedule = schedule.map(|row| (plan::step_of(row.time, step), row.values.clone()));
        let clock = Clock {
            start: 0.0,
            step,
            order: simulation.order,
            record_every: simulation.record_every,
        };
        let begin = Instant::now();
        let mut master = Master::new(
            plan.members,
            recording,
            schedule.collect(),
            clock,
            &mut instances,
        )?;
        let failure = match master.run(&mut instances, steps, &mut observe, progress) {
            Ok(()) => None,
            // Before the first step is over there is no result.
            Err(error) if master.steps_done() == 0 => return Err(error),
            Err(error) => Some(error),
        };
        let wall = begin.elapsed().as_secs_f64();
        if failure.is_none() {
            scorer.last(master.row());
            for instance in &mut instances {
                instance.terminate()?;
            }
        }

        let done = master.steps_done();
        let until = done as f64 * simulation.step;
        let (recording, times) = master.finish();
        let score = scorer.finish();
        if let (Some(value), None) = (score.not_finite(), &failure) {
            return Err(Error::NotFinite {
                name: "the squared error".to_owned(),
                value,
                time: end,
            });
        }
        let summary = Summary {
            controller: Unit::new(&controller),
            plant: Unit::new(&plant),
            given: Given::new(simulation),
            order: simulation.order,
            step_s: simulation.step,
            steps: done as u64,
            until_s: until,
            stopped: failure.as_ref().map(|error| Stopped {
                reason: error.to_string(),
                planned_s: end,
            }),
            score,
            timing: Timing {
                wall_s: wall,
                real_time_factor: until / wall,
                controller_mean_us: times[0].as_secs_f64() * 1e6 / done as f64,
            },
            warnings,
        };
        let outcome = Outcome {
            summary,
            recording,
            angle_limits: limits,
            thermal_limit,
            messages: messages(Side::BOTH.into_iter().zip(&instances)),
        };
        match failure {
            None => Ok(outcome),
            Some(source) => Err(Error::Stopped {
                source: Box::new(source),
                partial: Box::new(outcome),
            }),
        }
    }
}

/// Both FMUs with the structural parameters that the user gave.
fn configured(
    simulation: &Simulation,
    sets: &ParameterSets,
    [controller, plant]: [&Fmu; 2],
) -> Result<[Fmu; 2], Error> {
    let pair = Pair::new(controller, plant);
    let structure = StartValues::structure(pair, sets, &simulation.assignments)?;
    Ok([
        controller.configured(&structure.of(Side::Controller))?,
        plant.configured(&structure.of(Side::Plant))?,
    ])
}

/// What the plant knows, or else the controller.
fn both<T>(known: impl Fn(Side) -> Option<T>) -> Option<T> {
    known(Side::Plant).or_else(|| known(Side::Controller))
}

pub(crate) fn angle_limits(pair: Pair<'_>, values: &StartValues) -> Option<AngleLimits> {
    both(|side| {
        Some(AngleLimits {
            lower: values.number(pair, side, "limits.angle_lower")?,
            upper: values.number(pair, side, "limits.angle_upper")?,
        })
    })
}

/// Where the arm starts, or 0 if nothing tells.
fn start_angle(instances: &mut [Instance; 2], wiring: &Wiring) -> Result<f64, Error> {
    let Some(tap) = wiring.roles.get(&Role::Angle) else {
        return Ok(0.0);
    };
    let Source::Output(side, scalar) = tap.source else {
        return Ok(0.0);
    };
    Ok(tap.factor * instances[side as usize].value(scalar)? + tap.offset)
}
