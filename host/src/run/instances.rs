//! Instances of a run: their set-up and what they logged.

use crate::Error;
use crate::fmu::{Experiment, Fmu, Instance, Message, Scalar, Value};

/// An instance in Initialization Mode, with its start values.
pub(crate) fn start(
    fmu: &Fmu,
    name: &str,
    values: &[(Scalar, Value)],
    experiment: &Experiment,
    logging: bool,
) -> Result<Instance, Error> {
    let mut instance = fmu.configured(values)?.instantiate(name, logging)?;
    instance.set_start_values(values)?;
    instance.enter_initialization(experiment)?;
    Ok(instance)
}

/// What instances logged, each with who it is.
pub(crate) fn messages<'a, T: Clone>(
    instances: impl IntoIterator<Item = (T, &'a Instance)>,
) -> Vec<(T, Message)> {
    let of = |(who, instance): (T, &Instance)| {
        let messages = instance.messages().into_iter();
        messages.map(move |message| (who.clone(), message))
    };
    instances.into_iter().flat_map(of).collect()
}
