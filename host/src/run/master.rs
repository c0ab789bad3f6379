//! The co-simulation master: moves values between the FMUs and steps them.
//!
//! Time is an integer count of communication steps. Nothing in a step looks up a name or allocates.

use super::plan::{Inputs, Plan, SETPOINT, step_of};
use super::recording::{Recording, Slot};
use super::score::{Score, Scorer, Terms};
use super::{Instances, Order, Simulation};
use crate::Error;
use crate::fmu::Instance;
use crate::input::roles::Role;
use crate::input::setpoints::{AngleLimits, Table};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

pub(super) struct Master {
    plan: Plan,
    row: Vec<f64>,
    /// First step and values of each row of the setpoints.
    schedule: Vec<(usize, Vec<f64>)>,
    next: usize,
    done: usize,
    step: f64,
    order: Order,
    record_every: usize,
    recording: Recording,
    scorer: Scorer,
    /// The angle and where it must stay.
    guard: Option<(Slot, AngleLimits)>,
    controller_time: Duration,
}

impl Master {
    /// Takes over two instances in Initialization Mode, exchanges their first values and leaves that mode.
    pub(super) fn new(
        mut plan: Plan,
        table: &Table,
        simulation: &Simulation,
        rows: usize,
        terms: Terms,
        instances: &mut Instances,
    ) -> Result<Self, Error> {
        let columns = std::mem::take(&mut plan.columns);
        let row = vec![0.0; columns.len()];
        let recording = Recording::new(columns, std::mem::take(&mut plan.roles), rows);
        let schedule = table
            .rows
            .iter()
            .map(|row| (step_of(row.time, simulation.step), row.values.clone()))
            .collect();
        let mut master = Self {
            plan,
            row,
            schedule,
            next: 0,
            done: 0,
            step: simulation.step,
            order: simulation.order,
            record_every: simulation.record_every,
            scorer: Scorer::new(&recording, terms),
            guard: recording.slot(Role::Angle).zip(simulation.stop_outside),
            recording,
            controller_time: Duration::ZERO,
        };
        master.apply_schedule(0);
        master.initialise(instances)?;
        Ok(master)
    }

    /// Outputs that depend on inputs in Initialization Mode settle after one exchange each way.
    fn initialise(&mut self, instances: &mut Instances) -> Result<(), Error> {
        let Instances { controller, plant } = instances;
        self.read_plant(plant)?;
        self.write_controller(controller, 0.0)?;
        self.read_controller(controller)?;
        self.write_plant(plant, 0.0)?;
        controller.exit_initialization()?;
        plant.exit_initialization()?;
        self.read_controller(controller)
    }

    /// Makes all steps.
    pub(super) fn run(
        &mut self,
        instances: &mut Instances,
        steps: usize,
        progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<(), Error> {
        let Instances { controller, plant } = instances;
        for k in 0..steps {
            let time = k as f64 * self.step;
            if progress(k as f64 / steps as f64).is_break() {
                return Err(Error::Interrupted { time });
            }
            self.apply_schedule(k);
            self.row[0] = time;
            self.read_plant(plant)?;
            if self.order == Order::SideBySide {
                self.write_plant(plant, time)?;
                self.record(k);
            }
            self.write_controller(controller, time)?;
            let begin = Instant::now();
            controller.do_step(time, self.step)?;
            self.controller_time += begin.elapsed();
            self.read_controller(controller)?;
            if self.order == Order::Sequential {
                self.write_plant(plant, time)?;
            }
            plant.do_step(time, self.step)?;
            self.scorer.sample(k, self.row[SETPOINT], &self.row);
            if self.order == Order::Sequential {
                self.record(k);
            }
            self.done = k + 1;
            if let Some((slot, limits)) = self.guard {
                let angle = slot.value(&self.row);
                if !limits.contains(angle) {
                    return Err(Error::LeftRange {
                        angle,
                        time,
                        limits,
                    });
                }
            }
        }
        self.read_plant(plant)?;
        self.scorer.last(&self.row);
        // Who stops a run during its last step means to stop what follows, too.
        match progress(1.0) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(Error::Interrupted {
                time: steps as f64 * self.step,
            }),
        }
    }

    /// Number of steps that both FMUs have made.
    pub(super) fn steps_done(&self) -> usize {
        self.done
    }

    pub(super) fn finish(self) -> (Score, Recording, Duration) {
        (self.scorer.finish(), self.recording, self.controller_time)
    }

    fn record(&mut self, k: usize) {
        if k.is_multiple_of(self.record_every) {
            self.recording.push(&self.row);
        }
    }

    fn apply_schedule(&mut self, k: usize) {
        while let Some((first, values)) = self.schedule.get(self.next)
            && *first <= k
        {
            self.row[SETPOINT..SETPOINT + values.len()].copy_from_slice(values);
            self.next += 1;
        }
    }

    fn read_plant(&mut self, plant: &mut Instance) -> Result<(), Error> {
        let outputs = &mut self.plan.plant_outputs;
        Ok(outputs
            .signals
            .read(plant, &mut self.row[outputs.range.clone()])?)
    }

    fn read_controller(&mut self, controller: &mut Instance) -> Result<(), Error> {
        let outputs = &mut self.plan.controller_outputs;
        Ok(outputs
            .signals
            .read(controller, &mut self.row[outputs.range.clone()])?)
    }

    fn write_plant(&mut self, plant: &mut Instance, time: f64) -> Result<(), Error> {
        write(&mut self.plan.plant_inputs, &self.row, plant).map_err(|e| self.name(e, time))
    }

    fn write_controller(&mut self, controller: &mut Instance, time: f64) -> Result<(), Error> {
        write(&mut self.plan.controller_inputs, &self.row, controller)
            .map_err(|e| self.name(e, time))
    }

    #[cold]
    fn name(&self, failure: WriteFailure, time: f64) -> Error {
        match failure {
            WriteFailure::Fmu(error) => error.into(),
            WriteFailure::NotFinite(column) => Error::NotFinite {
                name: self.recording.columns()[column].name.clone(),
                value: self.row[column],
                time,
            },
        }
    }
}

enum WriteFailure {
    Fmu(crate::fmu::Error),
    /// The column of the row.
    NotFinite(usize),
}

fn write(inputs: &mut Inputs, row: &[f64], instance: &mut Instance) -> Result<(), WriteFailure> {
    for (value, slot) in inputs.values.iter_mut().zip(&inputs.slots) {
        *value = slot.value(row);
        if !value.is_finite() {
            return Err(WriteFailure::NotFinite(slot.column));
        }
    }
    inputs
        .signals
        .write(instance, &inputs.values)
        .map_err(WriteFailure::Fmu)
}
