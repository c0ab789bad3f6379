//! The three ways to instantiate in FMI 3.0.

use fmi_abi::fmi3::*;

use super::IntermediateUpdate;
use crate::guard::{Preemption, create};
use crate::instance::{Instance, Interface};
use crate::logger::Logger;
use crate::pointer::string;
use crate::unit::{Failure, Unit};

/// What all three have in common.
unsafe fn instance<U: Unit>(
    logger: &mut Logger,
    (name, token): (fmi3String, fmi3String),
    logging: fmi3Boolean,
    interface: Interface,
) -> Result<Instance<U>, Failure> {
    let (name, token) = unsafe { (string(name), string(token)) };
    let logging = logging != fmi3False;
    Instance::new(
        logger,
        name.as_deref(),
        token.as_deref(),
        interface,
        logging,
    )
}

pub unsafe fn fmi3InstantiateModelExchange<U: Unit>(
    name: fmi3String,
    token: fmi3String,
    _resources: fmi3String,
    _visible: fmi3Boolean,
    logging: fmi3Boolean,
    environment: fmi3InstanceEnvironment,
    log: fmi3LogMessageCallback,
) -> fmi3Instance {
    let logger = Logger::fmi3(log, environment);
    create("fmi3InstantiateModelExchange", logger, |logger| unsafe {
        instance::<U>(logger, (name, token), logging, Interface::ModelExchange)
    })
}

pub unsafe fn fmi3InstantiateCoSimulation<U: Unit>(
    name: fmi3String,
    token: fmi3String,
    _resources: fmi3String,
    _visible: fmi3Boolean,
    logging: fmi3Boolean,
    event_mode_used: fmi3Boolean,
    early_return_allowed: fmi3Boolean,
    _required_intermediate_variables: *const fmi3ValueReference,
    _n_required_intermediate_variables: usize,
    environment: fmi3InstanceEnvironment,
    log: fmi3LogMessageCallback,
    intermediate_update: fmi3IntermediateUpdateCallback,
) -> fmi3Instance {
    let logger = Logger::fmi3(log, environment);
    create("fmi3InstantiateCoSimulation", logger, |logger| {
        let interface = if event_mode_used == fmi3False {
            Interface::CoSimulation
        } else {
            Interface::EventfulCoSimulation
        };
        let mut instance = unsafe { instance::<U>(logger, (name, token), logging, interface)? };
        instance.early_return_allowed = early_return_allowed != fmi3False;
        instance.intermediate_update = intermediate_update.map(|callback| IntermediateUpdate {
            callback,
            environment,
        });
        Ok(instance)
    })
}

pub unsafe fn fmi3InstantiateScheduledExecution<U: Unit>(
    name: fmi3String,
    token: fmi3String,
    _resources: fmi3String,
    _visible: fmi3Boolean,
    logging: fmi3Boolean,
    environment: fmi3InstanceEnvironment,
    log: fmi3LogMessageCallback,
    _clock_update: fmi3ClockUpdateCallback,
    lock: fmi3LockPreemptionCallback,
    unlock: fmi3UnlockPreemptionCallback,
) -> fmi3Instance {
    let logger = Logger::fmi3(log, environment);
    create("fmi3InstantiateScheduledExecution", logger, |logger| {
        let interface = Interface::ScheduledExecution;
        let mut instance = unsafe { instance::<U>(logger, (name, token), logging, interface)? };
        instance.preemption = Preemption { lock, unlock };
        Ok(instance)
    })
}
