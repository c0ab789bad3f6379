//! The example's binary, loaded as an importer loads it.

use fmi_abi::{fmi2, fmi3};
use libloading::{Library, Symbol};
use std::path::PathBuf;
use std::ptr::{null, null_mut};

use crate::session::{ERROR, FATAL, Messages, OK, log3};

/// Beside the test's own executable: target/release/deps/.. has examples/.
fn path() -> PathBuf {
    let mut path = std::env::current_exe().unwrap();
    path.pop();
    path.pop();
    let (prefix, suffix) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    path.join(format!("examples/{prefix}fault{suffix}"))
}

fn load() -> Library {
    // SAFETY: the library has no initialisers.
    unsafe { Library::new(path()) }.unwrap()
}

/// The functions of a version, by the names of their types in its header's translation.
fn functions(source: &str, version: &str) -> Vec<String> {
    let generic = [
        format!("{version}Get"),
        format!("{version}Set"),
        "GetXxxStatus".into(),
    ];
    source
        .lines()
        .filter_map(|line| line.strip_prefix("pub type ")?.split_once("TYPE"))
        .map(|(name, _)| name.to_owned())
        .filter(|name| {
            !generic
                .iter()
                .any(|g| name == g || name.ends_with(g.as_str()))
        })
        .filter(|name| name.starts_with(version))
        .collect()
}

#[test]
fn every_function_of_both_standards_is_exported() {
    let library = load();
    let fmi2 = functions(include_str!("../../../fmi-abi/src/fmi2.rs"), "fmi2");
    let fmi3 = functions(
        include_str!("../../../fmi-abi/src/fmi3/functions.rs"),
        "fmi3",
    );
    assert_eq!((fmi2.len(), fmi3.len()), (44, 75));
    for name in fmi2.iter().chain(&fmi3) {
        // SAFETY: the symbol is not called.
        let symbol = unsafe { library.get::<*const ()>(name.as_bytes()) };
        assert!(symbol.is_ok(), "{name} is missing");
    }
}

#[test]
fn versions_and_platform() {
    let library = load();
    let text = |name: &str| unsafe {
        let f: Symbol<unsafe extern "C" fn() -> *const std::ffi::c_char> =
            library.get(name.as_bytes()).unwrap();
        std::ffi::CStr::from_ptr(f()).to_str().unwrap().to_owned()
    };
    assert_eq!(text("fmi2GetVersion"), "2.0");
    assert_eq!(text("fmi2GetTypesPlatform"), "default");
    assert_eq!(text("fmi3GetVersion"), "3.0");
}

#[test]
fn the_library_can_be_loaded_many_times_and_a_panic_stays_inside() {
    for _ in 0..3 {
        let library = load();
        let messages: Box<Messages> = Box::default();
        let environment = (&raw const *messages).cast_mut().cast();
        unsafe {
            let instantiate: Symbol<fmi3::fmi3InstantiateCoSimulationTYPE> =
                library.get(b"fmi3InstantiateCoSimulation").unwrap();
            let exchange: Symbol<fmi3::fmi3InstantiateModelExchangeTYPE> =
                library.get(b"fmi3InstantiateModelExchange").unwrap();
            let scheduled: Symbol<fmi3::fmi3InstantiateScheduledExecutionTYPE> =
                library.get(b"fmi3InstantiateScheduledExecution").unwrap();
            let enter: Symbol<fmi3::fmi3EnterInitializationModeTYPE> =
                library.get(b"fmi3EnterInitializationMode").unwrap();
            let exit: Symbol<fmi3::fmi3ExitInitializationModeTYPE> =
                library.get(b"fmi3ExitInitializationMode").unwrap();
            let set: Symbol<fmi3::fmi3SetInt32TYPE> = library.get(b"fmi3SetInt32").unwrap();
            let step: Symbol<fmi3::fmi3DoStepTYPE> = library.get(b"fmi3DoStep").unwrap();
            let free: Symbol<fmi3::fmi3FreeInstanceTYPE> =
                library.get(b"fmi3FreeInstance").unwrap();
            let (name, token) = (c"fault".as_ptr(), c"{fault}".as_ptr());
            let refused = exchange.unwrap()(name, token, null(), 0, 1, environment, Some(log3));
            assert!(refused.is_null());
            let message = messages.borrow().last().cloned().unwrap();
            assert_eq!(message.status, ERROR);
            assert!(message.text.contains("no Model Exchange"));
            let refused = scheduled.unwrap()(
                name,
                token,
                null(),
                0,
                1,
                environment,
                Some(log3),
                None,
                None,
                None,
            );
            assert!(refused.is_null());

            let instance = instantiate.unwrap()(
                name,
                token,
                null(),
                0,
                1,
                0,
                0,
                null(),
                0,
                environment,
                Some(log3),
                None,
            );
            assert!(!instance.is_null());
            assert_eq!(enter.unwrap()(instance, 0, 0.0, 0.0, 0, 0.0), OK);
            assert_eq!(exit.unwrap()(instance), OK);
            let (mut a, mut b, mut c, mut d) = (0, 0, 0, 0.0);
            let mut step = |t: f64| {
                step.unwrap()(
                    instance, t, 0.1, 1, &raw mut a, &raw mut b, &raw mut c, &raw mut d,
                )
            };
            assert_eq!(step(0.0), OK);
            assert_eq!(set.unwrap()(instance, &1, 1, &2, 1), OK);
            assert_eq!(step(0.1), FATAL);
            assert_eq!(step(0.1), FATAL);
            assert!(
                messages
                    .borrow()
                    .last()
                    .unwrap()
                    .text
                    .contains("told to panic at 0.1 s")
            );
            free.unwrap()(instance);
        }
        drop(library);
    }
}

/// Everything that the description does not declare fails with a message.
#[test]
fn undeclared_capabilities_are_errors() {
    let library = load();
    let messages: Box<Messages> = Box::default();
    let environment = (&raw const *messages).cast_mut().cast();
    unsafe {
        let instantiate: Symbol<fmi3::fmi3InstantiateCoSimulationTYPE> =
            library.get(b"fmi3InstantiateCoSimulation").unwrap();
        let free: Symbol<fmi3::fmi3FreeInstanceTYPE> = library.get(b"fmi3FreeInstance").unwrap();
        let instance = instantiate.unwrap()(
            c"f".as_ptr(),
            c"{fault}".as_ptr(),
            null(),
            0,
            1,
            0,
            0,
            null(),
            0,
            environment,
            Some(log3),
            None,
        );
        for (name, why) in [
            (
                "fmi3EnterConfigurationMode",
                "fault has no structural parameter",
            ),
            ("fmi3ExitConfigurationMode", "not allowed in Instantiated"),
            ("fmi3EvaluateDiscreteStates", "not provided"),
        ] {
            let f: Symbol<fmi3::fmi3ResetTYPE> = library.get(name.as_bytes()).unwrap();
            assert_eq!(f.unwrap()(instance), ERROR);
            let message = messages.borrow().last().cloned().unwrap();
            assert!(message.text.starts_with(name) && message.text.contains(why));
        }
        let partition: Symbol<fmi3::fmi3ActivateModelPartitionTYPE> =
            library.get(b"fmi3ActivateModelPartition").unwrap();
        assert_eq!(partition.unwrap()(instance, 0, 0.0), ERROR);
        let derivative: Symbol<fmi3::fmi3GetDirectionalDerivativeTYPE> =
            library.get(b"fmi3GetDirectionalDerivative").unwrap();
        let none = null_mut();
        let status = derivative.unwrap()(instance, null(), 0, null(), 0, null(), 0, none, 0);
        assert_eq!(status, ERROR);
        free.unwrap()(instance);

        let instantiate: Symbol<fmi2::fmi2InstantiateTYPE> =
            library.get(b"fmi2Instantiate").unwrap();
        let component = instantiate.unwrap()(null(), 1, c"{fault}".as_ptr(), null(), null(), 0, 0);
        let derivatives: Symbol<fmi2::fmi2SetRealInputDerivativesTYPE> =
            library.get(b"fmi2SetRealInputDerivatives").unwrap();
        let derivatives = derivatives.unwrap();
        assert_eq!(derivatives(component, null(), 0, null(), null()), OK);
        assert_eq!(derivatives(component, &1, 1, &1, &0.0), ERROR);
        let free: Symbol<fmi2::fmi2FreeInstanceTYPE> = library.get(b"fmi2FreeInstance").unwrap();
        free.unwrap()(component);
    }
}
