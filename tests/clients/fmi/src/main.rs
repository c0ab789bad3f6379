//! The closed loop through the crate `fmi`, FMI 2.0 and 3.0.

use closed_loop::{Outcome, Parameter, Unit, Values};
use fmi::fmi2::import::Fmi2Import;
use fmi::fmi2::instance::{self as fmi2, CoSimulation as _, Common as _};
use fmi::fmi3::import::Fmi3Import;
use fmi::fmi3::instance as fmi3;
use fmi::fmi3::{CoSimulation as _, Fmi3Model as _, GetSet as _};
use fmi::import;
use fmi::schema::MajorVersion;
use fmi::schema::traits::FmiModelDescription as _;
use fmi::traits::{FmiImport as _, FmiInstance as _};
use std::path::Path;

/// One instance; freed before the folder that its library lies in, which the import keeps.
enum Client {
    Fmi2(Box<fmi2::InstanceCS>, Box<Fmi2Import>),
    Fmi3(Box<fmi3::InstanceCS>, Box<Fmi3Import>),
}

fn main() -> Outcome {
    closed_loop::main(Client::open)
}

impl Client {
    fn open(path: &Path) -> Outcome<Self> {
        if import::peek_descr_path(path)?.major_version()? == MajorVersion::FMI2 {
            let import: Fmi2Import = import::from_path(path)?;
            let instance = import.instantiate_cs("unit", false, false)?;
            return Ok(Self::Fmi2(Box::new(instance), Box::new(import)));
        }
        let import: Fmi3Import = import::from_path(path)?;
        // Without Event Mode and early return samples are taken inside the steps.
        let instance = import.instantiate_cs("unit", false, false, false, false, &[])?;
        Ok(Self::Fmi3(Box::new(instance), Box::new(import)))
    }
}

impl Unit for Client {
    fn reference(&self, name: &str) -> Outcome<u32> {
        let found = match self {
            Self::Fmi2(_, import) => {
                let mut variables = import.model_description().get_model_variables();
                variables
                    .find(|v| v.name == name)
                    .map(|v| v.value_reference)
            }
            Self::Fmi3(_, import) => {
                let variables = &import.model_description().model_variables;
                variables.find_by_name(name).map(|v| v.value_reference())
            }
        };
        found.ok_or_else(|| format!("no variable {name}").into())
    }

    fn configure(&mut self, parameter: &Parameter) -> Outcome {
        let at = [parameter.reference];
        match self {
            Self::Fmi2(unit, _) => {
                match &parameter.values {
                    Values::Real(values) => unit.set_real(&at, values)?,
                    Values::Integer(values) | Values::Enumeration(values) => {
                        unit.set_integer(&at, values)?
                    }
                    Values::Boolean(values) => {
                        let values: Vec<_> = values.iter().map(|v| i32::from(*v)).collect();
                        unit.set_boolean(&at, &values)?
                    }
                };
            }
            Self::Fmi3(unit, _) => {
                match &parameter.values {
                    Values::Real(values) => unit.set_float64(&at, values)?,
                    Values::Integer(values) => unit.set_int32(&at, values)?,
                    Values::Boolean(values) => unit.set_boolean(&at, values)?,
                    Values::Enumeration(values) => {
                        let values: Vec<_> = values.iter().map(|v| i64::from(*v)).collect();
                        unit.set_int64(&at, &values)?
                    }
                };
            }
        }
        Ok(())
    }

    fn enter_initialization(&mut self) -> Outcome {
        match self {
            Self::Fmi2(unit, _) => {
                unit.setup_experiment(None, 0.0, None)?;
                fmi2::Common::enter_initialization_mode(unit.as_mut())?;
            }
            Self::Fmi3(unit, _) => {
                unit.enter_initialization_mode(None, 0.0, None)?;
            }
        }
        Ok(())
    }

    fn exit_initialization(&mut self) -> Outcome {
        match self {
            Self::Fmi2(unit, _) => {
                fmi2::Common::exit_initialization_mode(unit.as_mut())?;
            }
            Self::Fmi3(unit, _) => {
                unit.exit_initialization_mode()?;
            }
        }
        Ok(())
    }

    fn get(&mut self, reference: u32) -> Outcome<f64> {
        let mut value = [0.0];
        match self {
            Self::Fmi2(unit, _) => {
                unit.get_real(&[reference], &mut value)?;
            }
            Self::Fmi3(unit, _) => {
                unit.get_float64(&[reference], &mut value)?;
            }
        }
        Ok(value[0])
    }

    fn set(&mut self, reference: u32, value: f64) -> Outcome {
        match self {
            Self::Fmi2(unit, _) => {
                unit.set_real(&[reference], &[value])?;
            }
            Self::Fmi3(unit, _) => {
                unit.set_float64(&[reference], &[value])?;
            }
        }
        Ok(())
    }

    fn step(&mut self, time: f64, size: f64) -> Outcome {
        match self {
            Self::Fmi2(unit, _) => {
                unit.do_step(time, size, true)?;
            }
            Self::Fmi3(unit, _) => {
                let (mut event, mut end, mut early, mut reached) = (false, false, false, 0.0);
                unit.do_step(
                    time,
                    size,
                    true,
                    &mut event,
                    &mut end,
                    &mut early,
                    &mut reached,
                )?;
            }
        }
        Ok(())
    }
}
