use super::*;
use crate::read;

/// The tank with a table whose size may change.
fn structural() -> String {
    let points = "<UInt64 name=\"valve.points\" valueReference=\"22\" causality=\"structuralParameter\" \
                  variability=\"fixed\" start=\"3\" min=\"1\" max=\"9\" description=\"d\"/></ModelVariables>";
    VALID
        .replace("</ModelVariables>", points)
        .replace("start=\"1 2 3\"", "start=\"7\"")
        .replace(
            "<Dimension start=\"3\"/>",
            "<Dimension valueReference=\"22\"/>",
        )
}

fn generated(text: &str) -> String {
    generate(&read(text, "t.xml").unwrap())
}

const VALID: &str = include_str!("../../tests/valid.xml");

#[test]
fn groups_become_structs_with_start_values() {
    let code = generated(VALID);
    for line in [
        "    /// d \\[m\\].\n    pub table: [f64; 3],",
        "            table: [1.0, 2.0, 3.0],",
        "    /// Variables `valve.*`.\n    pub valve: Valve,",
        "            valve: Valve::default(),",
        "    pub der_level: f64,",
        "            10 => ::fmi_unit::Values::Float64(&self.valve.table),",
        "            20 => ::fmi_unit::ValuesMut::Int32(::std::slice::from_mut(&mut self.valve.count)),",
        "    states: &[2],\n    derivatives: &[3],",
        "    HalfOpen = 2,",
    ] {
        assert!(code.contains(line), "{line}\n{code}");
    }
    assert!(!code.contains("pub clock"), "time has no storage");
}

#[test]
fn long_arrays_are_vectors() {
    let starts = ["1"; 33].join(" ");
    let text = VALID
        .replace("start=\"1 2 3\"", &format!("start=\"{starts}\""))
        .replace("<Dimension start=\"3\"/>", "<Dimension start=\"33\"/>")
        .replace("valueReference=\"2", "valueReference=\"22")
        .replace("valueReference=\"10\"", "valueReference=\"1000\"")
        .replace("derivative=\"2\"", "derivative=\"22\"")
        .replace("dependencies=\"2\"", "dependencies=\"22\"")
        .replace("dependencies=\"1 2\"", "dependencies=\"1 22\"")
        .replace("dependencies=\"10\"", "dependencies=\"1000\"");
    let code = generated(&text);
    assert!(code.contains("    pub table: Vec<f64>,"), "{code}");
    assert!(
        code.contains("            table: vec![1.0, 1.0, "),
        "{code}"
    );
    assert!(!code.contains("self.valve.table.resize("), "{code}");
}

#[test]
fn arrays_follow_their_structural_parameter() {
    let code = generated(&structural());
    for line in [
        "    pub points: u64,",
        "            points: 3,",
        "    pub table: Vec<f64>,",
        "            table: vec![7.0; 3],",
        "            dimension: Some(::fmi_unit::Dimension { size: 3, parameter: Some(22) }),",
        "            causality: ::fmi_unit::Causality::StructuralParameter,",
        "            22 => ::fmi_unit::Values::UInt64(::std::slice::from_ref(&self.valve.points)),",
        "        self.valve.table.resize(self.valve.points as usize, 7.0);",
        "        self.table.clone_from(&source.table);",
    ] {
        assert!(code.contains(line), "{line}\n{code}");
    }
}

#[test]
fn descriptions_are_no_markup() {
    assert_eq!(markdown("gain_* of [1] <x>"), "gain_\\* of \\[1\\] \\<x\\>");
}
