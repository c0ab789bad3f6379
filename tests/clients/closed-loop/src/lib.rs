//! Steps controller and plant through an importer and scores them.
//!
//! The loop comes as JSON from `tests/cases.py`, which resolves parameters to value references; the names of inputs and
//! outputs are for the importer. Knows importers only as [`Unit`].

use serde::Deserialize;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// What fails ends the run.
pub type Outcome<T = ()> = Result<T, Box<dyn Error>>;

/// One instance for Co-Simulation, before Initialization Mode to begin with.
pub trait Unit {
    /// The value reference of a real variable.
    fn reference(&self, name: &str) -> Outcome<u32>;
    /// Sets a parameter.
    fn configure(&mut self, parameter: &Parameter) -> Outcome;
    /// Into Initialization Mode.
    fn enter_initialization(&mut self) -> Outcome;
    /// Into Step Mode.
    fn exit_initialization(&mut self) -> Outcome;
    /// Value of a real scalar.
    fn get(&mut self, reference: u32) -> Outcome<f64>;
    /// Sets a real scalar.
    fn set(&mut self, reference: u32, value: f64) -> Outcome;
    /// One communication step.
    fn step(&mut self, time: f64, size: f64) -> Outcome;
}

/// A parameter with all its values.
#[derive(Deserialize)]
pub struct Parameter {
    /// Where it is.
    pub reference: u32,
    /// What it is.
    #[serde(flatten)]
    pub values: Values,
}

/// Values of a type.
#[derive(Deserialize)]
#[serde(tag = "type", content = "values")]
pub enum Values {
    /// Real or Float64.
    Real(Vec<f64>),
    /// Integer or Int32.
    Integer(Vec<i32>),
    /// Boolean.
    Boolean(Vec<bool>),
    /// Underlying numbers of items.
    Enumeration(Vec<i32>),
}

#[derive(Deserialize)]
struct Described {
    fmu: PathBuf,
    parameters: Vec<Parameter>,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Order {
    /// The plant gets the fresh torque.
    Sequential,
    /// Both get what was known at the communication point.
    SideBySide,
}

#[derive(Deserialize)]
struct Loop {
    controller: Described,
    plant: Described,
    /// Communication step, s.
    step: f64,
    samples: usize,
    /// The first that is scored.
    first: usize,
    order: Order,
    /// Sample from which on they hold, setpoint (rad), disturbance torque (N·m).
    inputs: Vec<(usize, f64, f64)>,
}

/// Runs the loop of the file that the command line names and prints its score: the squared error summed over the
/// samples, rad².
pub fn main<U: Unit>(open: impl Fn(&Path) -> Outcome<U>) -> Outcome {
    let file = env::args_os().nth(1).ok_or("name the file of the loop")?;
    let described: Loop = serde_json::from_str(&fs::read_to_string(file)?)?;
    println!("{}", described.run(open)?);
    Ok(())
}

impl Described {
    fn open<U: Unit>(&self, open: impl Fn(&Path) -> Outcome<U>) -> Outcome<U> {
        let mut unit = open(&self.fmu)?;
        for parameter in &self.parameters {
            unit.configure(parameter)?;
        }
        Ok(unit)
    }
}

impl Loop {
    fn run<U: Unit>(&self, open: impl Fn(&Path) -> Outcome<U>) -> Outcome<f64> {
        let mut plant = self.plant.open(&open)?;
        let mut controller = self.controller.open(&open)?;
        let [angle, torque_in, push] =
            ["angle", "torque", "disturbance_torque"].map(|n| plant.reference(n));
        let [angle_in, torque, goal] =
            ["angle", "torque", "setpoint"].map(|n| controller.reference(n));
        let (angle, torque_in, push) = (angle?, torque_in?, push?);
        let (angle_in, torque, goal) = (angle_in?, torque?, goal?);

        let mut inputs = self.inputs.iter().peekable();
        let mut setpoint = inputs.peek().ok_or("there are no inputs")?.1;
        plant.enter_initialization()?;
        plant.exit_initialization()?;
        controller.enter_initialization()?;
        controller.set(angle_in, plant.get(angle)?)?;
        controller.set(goal, setpoint)?;
        controller.exit_initialization()?;

        let mut score = 0.0;
        for k in 0..self.samples {
            if let Some((_, wanted, torque)) = inputs.next_if(|(sample, ..)| *sample == k) {
                setpoint = *wanted;
                controller.set(goal, setpoint)?;
                plant.set(push, *torque)?;
            }
            let measured = plant.get(angle)?;
            if k >= self.first {
                score += (setpoint - measured) * (setpoint - measured);
            }
            let time = k as f64 * self.step;
            let before = controller.get(torque)?;
            controller.set(angle_in, measured)?;
            controller.step(time, self.step)?;
            let drive = match self.order {
                Order::Sequential => controller.get(torque)?,
                Order::SideBySide => before,
            };
            plant.set(torque_in, drive)?;
            plant.step(time, self.step)?;
        }
        Ok(score)
    }
}
