//! Importing FMUs that behave and FMUs that do not.
#![cfg(target_os = "linux")]

mod common;

use common::*;
use host::fmu::{Error, Experiment, Fmu, Instance, Signals, Status, Value};
use std::fs;

fn set(instance: &mut Instance, values: &[(&str, Value)]) -> Result<(), Error> {
    let values: Vec<_> = values
        .iter()
        .map(|(name, value)| (instance.description().scalar(name).unwrap(), value.clone()))
        .collect();
    instance.set_start_values(&values)
}

fn value(instance: &mut Instance, name: &str) -> f64 {
    let scalar = instance.description().scalar(name).unwrap();
    instance.value(scalar).unwrap()
}

/// An instance ready to step that has the fault at 1 s.
fn faulty(fmu: &Fmu, fault: i32) -> Instance {
    let mut instance = fmu.instantiate("m", false).unwrap();
    let fault = Value::Integer(fault.into());
    set(
        &mut instance,
        &[
            ("fault", fault),
            ("fault_time", Value::Float(1.0)),
            ("label", Value::Text("arm".into())),
        ],
    )
    .unwrap();
    start(&mut instance);
    instance
}

fn start(instance: &mut Instance) {
    instance
        .enter_initialization(&Experiment::default())
        .unwrap();
    instance.exit_initialization().unwrap();
}

#[test]
fn both_versions_run_alike() {
    let folder = tempfile::tempdir().unwrap();
    for version in [2, 3] {
        let fmu = Fmu::open(&mock(folder.path(), version)).unwrap();
        assert!(
            fmu.description().problems.is_empty(),
            "{:?}",
            fmu.description().problems
        );
        let mut instance = fmu.instantiate("m", false).unwrap();
        let unpacked = fmu.folder().to_owned();
        drop(fmu);
        assert!(
            unpacked.exists(),
            "the folder outlives the FMU while an instance lives"
        );
        for gain in [3.0, -2.0] {
            set(&mut instance, &[("gain", Value::Float(gain))]).unwrap();
            start(&mut instance);
            let u = instance.description().scalar("u").unwrap();
            let mut input = Signals::new(instance.description(), &[u]);
            for k in 0..10 {
                input.write(&mut instance, &[f64::from(k)]).unwrap();
                instance.do_step(f64::from(k), 1.0).unwrap();
                assert_eq!(value(&mut instance, "y"), gain * f64::from(k));
            }
            assert_eq!(
                value(&mut instance, "flag"),
                1.0,
                "odd truth values are true"
            );
            instance.terminate().unwrap();
            instance.reset().unwrap();
            assert_eq!(value(&mut instance, "y"), 0.0);
        }
        drop(instance);
        assert!(!unpacked.exists());
    }
}

#[test]
fn one_element_of_an_array_is_set_alone() {
    let folder = tempfile::tempdir().unwrap();
    let fmu = Fmu::open(&mock(folder.path(), 3)).unwrap();
    let mut instance = fmu.instantiate("m", false).unwrap();
    set(
        &mut instance,
        &[
            ("vector[2]", Value::Float(20.0)),
            ("gain", Value::Float(5.0)),
        ],
    )
    .unwrap();
    let names = ["vector[1]", "vector[2]", "vector[3]", "gain"];
    assert_eq!(
        names.map(|name| value(&mut instance, name)),
        [1.0, 20.0, 1.0, 5.0]
    );
}

/// The mock refuses its structural parameter outside Configuration Mode, and all but the right number of values.
#[test]
fn structural_parameters_come_first_and_again_after_a_reset() {
    let folder = tempfile::tempdir().unwrap();
    let fmu = Fmu::open(&mock(folder.path(), 3)).unwrap();
    let size = fmu.description().scalar("size").unwrap();
    let mut plain = fmu.instantiate("m", false).unwrap();
    let late = set(&mut plain, &[("size", Value::Integer(5))]).unwrap_err();
    assert!(late.to_string().contains("fmi3SetUInt64"), "{late}");

    let given = [(size, Value::Integer(5))];
    let larger = fmu.configured(&given).unwrap();
    assert!(fmu.description().scalar("vector[5]").is_err());
    let mut instance = larger.instantiate("m", false).unwrap();
    for _ in 0..2 {
        instance.set_start_values(&given).unwrap();
        set(&mut instance, &[("vector[5]", Value::Float(50.0))]).unwrap();
        let names = ["size", "vector[1]", "vector[5]"];
        assert_eq!(
            names.map(|name| value(&mut instance, name)),
            [5.0, 1.0, 50.0]
        );
        start(&mut instance);
        instance.do_step(0.0, 1.0).unwrap();
        instance.terminate().unwrap();
        instance.reset().unwrap();
        assert_eq!(value(&mut instance, "vector[5]"), 1.0);
    }
    // The FMU itself is as it was.
    let absurd = [(size, Value::Integer(1 << 40))];
    let refused = fmu.configured(&absurd).unwrap_err().to_string();
    assert!(refused.contains("vector"), "{refused}");
    assert_eq!(value(&mut plain, "vector[3]"), 1.0);
}

#[test]
fn a_refusal_is_reported_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    for version in [2, 3] {
        let file = folder.path().join("wrong.fmu");
        let text = description(version).replace("mock-token", "other");
        pack_mock(&file, version, &text, binary());
        let error = Fmu::open(&file)
            .unwrap()
            .instantiate("m", false)
            .unwrap_err();
        let Error::Refused { log, .. } = &error else {
            panic!("{error}")
        };
        assert_eq!(log[0].status, Status::Error);
        let message = error.to_string();
        let reason = if version == 2 {
            "token \"other\" is not mine, type 1"
        } else {
            "are not mine"
        };
        assert!(
            message.contains("refuses to be instantiated as m") && message.contains(reason),
            "{message}"
        );
    }
}

#[test]
fn failures_name_time_and_reason_and_the_host_lives() {
    let folder = tempfile::tempdir().unwrap();
    for version in [2, 3] {
        let fmu = Fmu::open(&mock(folder.path(), version)).unwrap();
        for (fault, expected) in [
            (
                FAIL,
                format!("m: fmi{version}DoStep returned Error at t = 1 s\n"),
            ),
            (
                REFUSE_STEP,
                format!("m: fmi{version}DoStep returned Discard at t = 1 s"),
            ),
            (
                ODD_STATUS,
                format!("m: fmi{version}DoStep returned the unknown status 99 at t = 1 s"),
            ),
            (END, "m ended the simulation at t = ".to_owned()),
        ] {
            let mut instance = faulty(&fmu, fault);
            instance.do_step(0.0, 1.0).unwrap();
            let message = instance.do_step(1.0, 1.0).unwrap_err().to_string();
            assert!(message.starts_with(&expected), "{message}");
            assert_eq!(
                message.contains("arm failed at 1 [logStatusError]"),
                fault == FAIL,
                "{message}"
            );
            // The mock ends the process if it is called in vain.
            let _ = instance.terminate();
        }
    }
    let fmu = Fmu::open(&mock(folder.path(), 3)).unwrap();
    let mut instance = faulty(&fmu, RETURN_EARLY);
    let error = instance.do_step(1.0, 1.0).unwrap_err();
    assert!(
        matches!(error, Error::ReturnedEarly { time: 1.5, .. }),
        "{error}"
    );
    let fmu = Fmu::open(&mock(folder.path(), 2)).unwrap();
    let mut instance = faulty(&fmu, ASYNCHRONOUS);
    instance.do_step(1.0, 1.0).unwrap();
}

#[test]
fn after_fatal_no_instance_is_called_any_more() {
    let folder = tempfile::tempdir().unwrap();
    for version in [2, 3] {
        let fmu = Fmu::open(&mock(folder.path(), version)).unwrap();
        let mut bystander = faulty(&fmu, 0);
        let mut instance = faulty(&fmu, DIE);
        let error = instance.do_step(1.0, 1.0).unwrap_err();
        assert!(
            matches!(
                error,
                Error::Call {
                    status: Status::Fatal,
                    ..
                }
            ),
            "{error}"
        );
        for error in [
            instance.do_step(2.0, 1.0).unwrap_err(),
            instance.reset().unwrap_err(),
            bystander.do_step(0.0, 1.0).unwrap_err(),
            fmu.instantiate("n", false).unwrap_err(),
        ] {
            assert!(matches!(error, Error::AfterFatal { .. }), "{error}");
        }
        // The mock ends the process if either is freed.
    }
}

#[test]
fn states_are_saved_restored_moved_and_freed() {
    let folder = tempfile::tempdir().unwrap();
    let fmu = Fmu::open(&mock(folder.path(), 3)).unwrap();
    let mut instance = faulty(&fmu, 0);
    let u = instance.description().scalar("u").unwrap();
    let mut input = Signals::new(instance.description(), &[u]);
    instance.do_step(0.0, 1.0).unwrap();
    let before = instance.save().unwrap();
    input.write(&mut instance, &[7.0]).unwrap();
    instance.do_step(1.0, 1.0).unwrap();
    let after = instance.save().unwrap();
    instance.restore(&before).unwrap();
    assert_eq!(value(&mut instance, "y"), 0.0);
    let bytes = instance.serialize(&after).unwrap();
    let copy = instance.deserialize(&bytes).unwrap();
    instance.restore(&copy).unwrap();
    assert_eq!(value(&mut instance, "y"), 7.0);
    instance.discard(before).unwrap();
    let mut other = faulty(&fmu, 0);
    assert!(matches!(
        other.restore(&after).unwrap_err(),
        Error::ForeignState { .. }
    ));
    // `after` and `copy` are freed with their instance: the mock ends the process otherwise.
}

#[test]
fn states_are_missed_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let fmu = Fmu::open(&mock(folder.path(), 2)).unwrap();
    let error = faulty(&fmu, 0).save().unwrap_err();
    assert!(
        error
            .to_string()
            .ends_with("lacks the function fmi2GetFMUstate"),
        "{error}"
    );
}

#[test]
fn binaries_that_cannot_be_used_are_explained() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("m.fmu");
    let instantiate = || {
        Fmu::open(&file)
            .unwrap()
            .instantiate("m", false)
            .unwrap_err()
            .to_string()
    };

    let xml = description(2);
    pack(
        &file,
        &[
            ("modelDescription.xml", xml.as_bytes()),
            ("binaries/win64/mock.dll", b""),
            ("binaries/riscv64-linux/mock.so", b""),
        ],
    );
    let message = instantiate();
    assert!(
        message.ends_with("platforms in it: riscv64-linux, win64"),
        "{message}"
    );

    pack_mock(&file, 2, &xml, b"no library");
    assert!(
        instantiate().contains("its binary cannot be loaded"),
        "{}",
        instantiate()
    );

    let needed = folder.path().join("libneeded_by_mock.so");
    let source = folder.path().join("needed.c");
    fs::write(&source, "int needed(void) { return 1; }").unwrap();
    compile(&source, &needed, &[]);
    fs::write(
        &source,
        "int needed(void); int other(void) { return needed(); }",
    )
    .unwrap();
    let library = folder.path().join("mock.so");
    let search = format!("-L{}", folder.path().display());
    compile(&source, &library, &[&search, "-lneeded_by_mock"]);
    fs::remove_file(needed).unwrap();
    pack_mock(&file, 2, &xml, &fs::read(&library).unwrap());
    let message = instantiate();
    assert!(
        message.contains("needs the library libneeded_by_mock.so, which is not installed"),
        "{message}"
    );

    fs::write(&source, "int other(void) { return 1; }").unwrap();
    compile(&source, &library, &[]);
    pack_mock(&file, 2, &xml, &fs::read(&library).unwrap());
    assert!(
        instantiate().ends_with("its binary lacks the function fmi2Instantiate"),
        "{}",
        instantiate()
    );
}

#[test]
fn descriptions_that_cannot_be_used_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("m.fmu");
    let open = |xml: &str| {
        pack_mock(&file, 2, xml, b"");
        Fmu::open(&file).unwrap_err().to_string()
    };
    let good = description(2);
    for (xml, reason) in [
        ("<a".to_owned(), "modelDescription.xml: "),
        (
            good.replace("fmiVersion=\"2.0\"", "fmiVersion=\"1.0\""),
            "is of FMI 1.0",
        ),
        (
            good.replace("fmiVersion=\"2.0\"", ""),
            "fmiVersion is missing",
        ),
        (
            good.replace("name=\"y\"", "name=\"u\""),
            "two variables are called u",
        ),
        (
            good.replace("causality=\"output\"", "causality=\"outputs\""),
            "causality is outputs",
        ),
        (
            good.replace("variability=\"fixed\"", "variability=\"continuous\""),
            "variability continuous does not go with causality parameter",
        ),
    ] {
        let message = open(&xml);
        assert!(message.contains(reason), "{message}");
    }
    pack(&file, &[("readme.txt", b"")]);
    assert!(
        Fmu::open(&file)
            .unwrap_err()
            .to_string()
            .contains("no readable modelDescription.xml")
    );
    pack_mock(
        &file,
        2,
        &good
            .replace("CoSimulation", "ModelExchange")
            .replace(" canHandleVariableCommunicationStepSize=\"true\"", ""),
        b"",
    );
    let error = Fmu::open(&file)
        .unwrap()
        .instantiate("m", false)
        .unwrap_err();
    assert!(matches!(error, Error::NoCoSimulation { .. }), "{error}");
}
