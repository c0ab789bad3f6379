//! The closed loop through the crate `fmi-rs`, FMI 2.0 and 3.0.

use closed_loop::{Outcome, Parameter, Unit, Values};
use fmi_rs::fmi2::builder::FMU2Builder;
use fmi_rs::fmi2::types::fmi2Status;
use fmi_rs::fmi2::{CS, FMU2};
use fmi_rs::fmi3::FMU3;
use fmi_rs::fmi3::builder::FMU3Builder;
use fmi_rs::fmi3::types::fmi3Status;
use std::path::Path;
use std::sync::Arc;

/// One instance; freed before the folder that its library lies in, which the builder keeps.
enum Client {
    Fmi2(Arc<FMU2<CS>>, FMU2Builder),
    Fmi3(Arc<FMU3>, FMU3Builder),
}

fn main() -> Outcome {
    closed_loop::main(Client::open)
}

impl Client {
    fn open(path: &Path) -> Outcome<Self> {
        if let Ok(builder) = FMU3Builder::new(&path) {
            let mut builder = builder;
            // Without them samples are taken inside the steps.
            builder.eventModeUsed = false;
            builder.earlyReturnAllowed = false;
            return Ok(Self::Fmi3(builder.instantiate_cs("unit")?, builder));
        }
        let builder = FMU2Builder::new(&path)?;
        Ok(Self::Fmi2(builder.instantiate_cs("unit")?, builder))
    }
}

fn fmi2(status: fmi2Status) -> Outcome {
    match status {
        fmi2Status::Ok | fmi2Status::Warning => Ok(()),
        bad => Err(format!("{bad:?}").into()),
    }
}

fn fmi3(status: fmi3Status) -> Outcome {
    match status {
        fmi3Status::Ok | fmi3Status::Warning => Ok(()),
        bad => Err(format!("{bad:?}").into()),
    }
}

impl Unit for Client {
    fn reference(&self, name: &str) -> Outcome<u32> {
        Ok(match self {
            Self::Fmi2(_, builder) => {
                builder
                    .model_description
                    .variable_by_name(name)?
                    .valueReference
            }
            Self::Fmi3(_, builder) => {
                builder
                    .model_description
                    .variable_by_name(name)?
                    .valueReference
            }
        })
    }

    fn configure(&mut self, parameter: &Parameter) -> Outcome {
        let at = [parameter.reference];
        match self {
            Self::Fmi2(fmu, _) => fmi2(match &parameter.values {
                Values::Real(values) => fmu.setReal(&at, values),
                Values::Integer(values) | Values::Enumeration(values) => {
                    fmu.setInteger(&at, values)
                }
                Values::Boolean(values) => {
                    let values: Vec<_> = values.iter().map(|v| i32::from(*v)).collect();
                    fmu.setBoolean(&at, &values)
                }
            }),
            Self::Fmi3(fmu, _) => fmi3(match &parameter.values {
                Values::Real(values) => fmu.setFloat64(&at, values),
                Values::Integer(values) => fmu.setInt32(&at, values),
                Values::Boolean(values) => fmu.setBoolean(&at, values),
                Values::Enumeration(values) => {
                    let values: Vec<_> = values.iter().map(|v| i64::from(*v)).collect();
                    fmu.setInt64(&at, &values)
                }
            }),
        }
    }

    fn enter_initialization(&mut self) -> Outcome {
        match self {
            Self::Fmi2(fmu, _) => {
                fmi2(fmu.setupExperiment(None, 0.0, None))?;
                fmi2(fmu.enterInitializationMode())
            }
            Self::Fmi3(fmu, _) => fmi3(fmu.enterInitializationMode(None, 0.0, None)),
        }
    }

    fn exit_initialization(&mut self) -> Outcome {
        match self {
            Self::Fmi2(fmu, _) => fmi2(fmu.exitInitializationMode()),
            Self::Fmi3(fmu, _) => fmi3(fmu.exitInitializationMode()),
        }
    }

    fn get(&mut self, reference: u32) -> Outcome<f64> {
        let mut value = [0.0];
        match self {
            Self::Fmi2(fmu, _) => fmi2(fmu.getReal(&[reference], &mut value))?,
            Self::Fmi3(fmu, _) => fmi3(fmu.getFloat64(&[reference], &mut value))?,
        }
        Ok(value[0])
    }

    fn set(&mut self, reference: u32, value: f64) -> Outcome {
        match self {
            Self::Fmi2(fmu, _) => fmi2(fmu.setReal(&[reference], &[value])),
            Self::Fmi3(fmu, _) => fmi3(fmu.setFloat64(&[reference], &[value])),
        }
    }

    fn step(&mut self, time: f64, size: f64) -> Outcome {
        match self {
            Self::Fmi2(fmu, _) => fmi2(fmu.doStep(time, size, 1)),
            Self::Fmi3(fmu, _) => {
                let (mut event, mut end, mut early, mut reached) = (false, false, false, 0.0);
                let flags = (&mut event, &mut end, &mut early);
                fmi3(fmu.doStep(time, size, true, flags.0, flags.1, flags.2, &mut reached))
            }
        }
    }
}
