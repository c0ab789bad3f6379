//! Parameter sets made from the contracts of both units.

use model_description::parameters::{change, start_values};
use model_description::ssv::{Parameter, ParameterSet, Value};
use model_description::{ModelDescription, read};

const PLANT: &str = include_str!("../plant.xml");
const CONTROLLER: &str = include_str!("../controller.xml");

fn units(controller: &str) -> Vec<ModelDescription> {
    vec![
        read(PLANT, "plant.xml").unwrap(),
        read(controller, "controller.xml").unwrap(),
    ]
}

fn parameter<'a>(set: &'a ParameterSet, name: &str) -> &'a Parameter {
    set.parameters.iter().find(|p| p.name == name).unwrap()
}

#[test]
fn start_values_are_the_union() {
    let set = start_values(&units(CONTROLLER), "tflex").unwrap();
    assert_eq!(parameter(&set, "initial.angle").value, Value::Real(1.3));
    assert_eq!(
        parameter(&set, "arm.cogging_sin[9]").value,
        Value::Real(0.0031)
    );
    assert_eq!(
        parameter(&set, "feedback.law").value,
        Value::Enumeration("lqr".to_owned())
    );
    assert_eq!(parameter(&set, "nmpc.horizon").value, Value::Integer(40));
    let shared = set.parameters.iter().filter(|p| p.name == "arm.inertia");
    assert_eq!(shared.count(), 1);
}

#[test]
fn shared_parameters_must_agree() {
    for (from, to) in [
        (
            "max=\"1e6\" start=\"0.0818\"\n      description=\"Moment",
            "max=\"1e6\" start=\"0.09\"\n      description=\"Moment",
        ),
        (
            "unit=\"kg.m2\" min=\"1e-9\" max=\"1e6\" start=\"0.0818\"\n      description=\"Moment",
            "unit=\"1\" min=\"1e-9\" max=\"1e6\" start=\"0.0818\"\n      description=\"Moment",
        ),
        (
            "<Unit name=\"kg.m2\"><BaseUnit kg=\"1\"",
            "<Unit name=\"kg.m2\"><BaseUnit kg=\"2\"",
        ),
    ] {
        assert_eq!(CONTROLLER.matches(from).count(), 1);
        let messages = start_values(&units(&CONTROLLER.replace(from, to)), "x").unwrap_err();
        assert_eq!(messages.len(), 1);
        assert!(
            messages[0]
                .message
                .starts_with("variable arm.inertia: declared differently in plant.xml:")
        );
        assert_eq!(messages[0].file, "controller.xml");
    }
}

#[test]
fn changes_are_checked_against_the_contracts() {
    let units = units(CONTROLLER);
    let mut set = start_values(&units, "x").unwrap();
    let mut changed = |name: &str, value: Value, unit: Option<&str>| {
        let changes = ParameterSet {
            parameters: vec![Parameter {
                name: name.to_owned(),
                value,
                unit: unit.map(str::to_owned),
                line: 7,
            }],
            ..ParameterSet::default()
        };
        match change(&mut set, &units, &changes, "c.ssv") {
            Ok(()) => parameter(&set, name).value.to_string(),
            Err(diagnostics) => diagnostics[0].to_string(),
        }
    };
    assert_eq!(changed("arm.inertia", Value::Real(1.0), Some("kg.m2")), "1");
    assert_eq!(
        changed("feedback.law", Value::Enumeration("pid".into()), None),
        "pid"
    );
    assert_eq!(
        changed("arm.mass", Value::Real(1.0), None),
        "c.ssv:7: parameter arm.mass: no unit has such a parameter"
    );
    assert_eq!(
        changed("torque", Value::Real(1.0), None),
        "c.ssv:7: parameter torque: no unit has such a parameter"
    );
    assert_eq!(
        changed("arm.inertia", Value::Real(0.0), None),
        "c.ssv:7: parameter arm.inertia: value 0 is outside its range 1e-9 to 1000000 kg.m2"
    );
    assert_eq!(
        changed("arm.inertia", Value::Real(1.0), Some("rad")),
        "c.ssv:7: parameter arm.inertia: unit is not the variable's, `kg.m2`"
    );
    assert_eq!(
        changed("nmpc.horizon", Value::Real(20.0), None),
        "c.ssv:7: parameter nmpc.horizon: value is Real, the variable is Int32"
    );
    assert_eq!(
        changed("feedback.law", Value::Enumeration("lqg".into()), None),
        "c.ssv:7: parameter feedback.law: `lqg` is none of lqr, lqri, pid"
    );
}

#[test]
fn shipped_changes_fit_the_contracts() {
    let units = units(CONTROLLER);
    let mut set = start_values(&units, "x").unwrap();
    for text in [
        include_str!("../parameters/pendulum.ssv"),
        include_str!("../parameters/pendulum-model-error.ssv"),
    ] {
        let changes = model_description::ssv::read(text, "changes.ssv").unwrap();
        change(&mut set, &units, &changes, "changes.ssv").unwrap();
    }
    // Eq 32: at rest in the middle the mis-modelled spring gives no torque.
    let value = |name: &str| match parameter(&set, name).value {
        Value::Real(value) => value,
        ref other => panic!("{other:?}"),
    };
    let torque = value("arm.stiffness") * value("initial.angle") + value("arm.offset");
    assert!(torque.abs() < 1e-12, "{torque}");
}
