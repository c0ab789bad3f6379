//! Files and assignments on the contracts of both units.

use super::super::tests::contract;
use super::*;
use std::io::Write;

fn read(files: &[ParameterFile], sets: &[&str]) -> Result<(StartValues, Vec<f64>), String> {
    let (controller, plant) = (contract("controller"), contract("plant"));
    let pair = Pair {
        controller: &controller,
        plant: &plant,
    };
    let sets: Vec<_> = sets.iter().map(|s| s.parse().unwrap()).collect();
    let values = ParameterSets::read(files)
        .and_then(|read| StartValues::new(pair, &read, &sets))
        .map_err(|e| e.to_string())?;
    let numbers = [
        (Side::Controller, "arm.inertia"),
        (Side::Plant, "arm.inertia"),
        (Side::Controller, "feedback.law"),
        (Side::Plant, "arm.cogging_cos[2]"),
    ];
    let numbers = numbers.map(|(side, name)| values.number(pair, side, name).unwrap());
    Ok((values, numbers.to_vec()))
}

fn ssv(parameters: &str) -> tempfile::NamedTempFile {
    let mut file = tempfile::NamedTempFile::with_suffix(".ssv").unwrap();
    write!(
        file,
        r#"<?xml version="1.0" encoding="UTF-8"?>
<ssv:ParameterSet version="1.0" name="p"
  xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"
  xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon">
<ssv:Parameters>
{parameters}
</ssv:Parameters>
<ssv:Units><ssc:Unit name="kg.m2"><ssc:BaseUnit kg="1" m="2" rad="-1"/></ssc:Unit>
<ssc:Unit name="rad"><ssc:BaseUnit rad="1"/></ssc:Unit></ssv:Units>
</ssv:ParameterSet>"#
    )
    .unwrap();
    file
}

fn file(ssv: &tempfile::NamedTempFile, side: &str) -> ParameterFile {
    format!("{side}{}", ssv.path().display()).parse().unwrap()
}

const INERTIA: &str =
    r#"<ssv:Parameter name="arm.inertia"><ssv:Real value="0.09" unit="kg.m2"/></ssv:Parameter>"#;

#[test]
fn later_values_win_and_sides_are_kept_apart() {
    assert_eq!(read(&[], &[]).unwrap().1, [0.0818, 0.0818, 1.0, -0.2366]);
    let heavy = ssv(INERTIA);
    let both = file(&heavy, "");
    assert_eq!(
        read(std::slice::from_ref(&both), &[]).unwrap().1[..2],
        [0.09, 0.09]
    );
    assert_eq!(
        read(&[file(&heavy, "plant=")], &[]).unwrap().1[..2],
        [0.0818, 0.09]
    );
    let sets = [
        "controller:arm.inertia=0.1",
        "feedback.law=lqri",
        "arm.cogging_cos[2]=1",
    ];
    let (values, numbers) = read(&[both], &sets).unwrap();
    assert_eq!(numbers, [0.1, 0.09, 2.0, 1.0]);
    assert_eq!(values.of(Side::Controller).len(), 3);
    let (_, numbers) = read(
        &[],
        &["plant.arm.inertia=0.2", "controller.feedback.law=pid"],
    )
    .unwrap();
    assert_eq!(numbers[..3], [0.0818, 0.2, 3.0]);
}

#[test]
fn all_wrong_assignments_are_named_at_once() {
    let sets = [
        "nmpc.horizon=1",
        "arm.damping=1",
        "plant.nmpc.horizon=4",
        "feedback.law=lqg",
    ];
    assert_eq!(
        read(&[], &sets)
            .unwrap_err()
            .lines()
            .map(|line| line.trim().split([',', ';']).next().unwrap_or_default())
            .collect::<Vec<_>>(),
        [
            "--set: nmpc.horizon = 1: must be in [2",
            "--set: plant has no variable nmpc.horizon",
            "--set: feedback.law = \"lqg\": expected one of lqr",
        ]
    );
}

#[test]
fn mistakes_are_named() {
    let error = |files: &[ParameterFile], sets: &[&str]| read(files, sets).unwrap_err();
    let ends = |message: String, end: &str| assert!(message.ends_with(end), "{message}");
    let begins = |message: String, begin: &str| assert!(message.starts_with(begin), "{message}");
    begins(
        error(&[], &["nmpc.horizn=40"]),
        "--set: neither FMU has a variable nmpc.horizn, did you mean nmpc.horizon?",
    );
    ends(
        error(&[], &["nmpc.horizon=1"]),
        "nmpc.horizon = 1: must be in [2, 400]",
    );
    ends(
        error(&[], &["arm.inertia=-1"]),
        "arm.inertia = -1: must be in [1e-9, 1e6] kg.m2",
    );
    ends(
        error(&[], &["feedback.law=lqg"]),
        "expected one of lqr, lqri, pid",
    );
    ends(
        error(&[], &["nmpc.horizon=4.5"]),
        "expected an integer from -2147483648 to 2147483647",
    );
    ends(
        error(&[], &["arm.inertia=heavy"]),
        "arm.inertia = \"heavy\": expected a finite number",
    );
    ends(
        error(&[], &["velocity=1"]),
        "plant.velocity is an output that cannot be set",
    );
    assert!(read(&[], &["torque=1"]).is_ok(), "an input of the plant");
    ends(
        error(&[], &["arm.cogging_cos=1"]),
        "arm.cogging_cos[1] to arm.cogging_cos[9]",
    );
    let wrong = ssv(&INERTIA.replace("kg.m2", "rad"));
    ends(
        error(&[file(&wrong, "")], &[]),
        ":6: arm.inertia is given in rad, but its unit is kg.m2",
    );
    let typo = ssv(&INERTIA.replace("inertia", "inertya"));
    assert!(
        error(&[file(&typo, "plant=")], &[])
            .contains(":6: plant has no variable arm.inertya, did you mean arm.inertia?")
    );
    assert!("x".parse::<Assignment>().is_err());
    for text in ["plant:a=1", "a=b"] {
        assert_eq!(text.parse::<Assignment>().unwrap().to_string(), text);
    }
}
