//! Rules for structural parameters and the arrays whose size follows them (FMI 3.0 sec 2.4.7.4, 2.4.7.5).

use crate::tree::{Causality, Kind, ModelDescription, Variability, Variable};
use crate::xml::Reader;

pub(super) fn check(d: &ModelDescription, r: &mut Reader) {
    for v in &d.variables {
        let name = &v.name;
        for message in problems(d, v) {
            r.report(v.line, format_args!("variable {name}: {message}"));
        }
    }
}

fn problems(d: &ModelDescription, v: &Variable) -> Vec<String> {
    let mut found = Vec::new();
    let structural = v.causality == Causality::StructuralParameter;
    if structural != (v.kind == Kind::UInt64) {
        found.push("structural parameters, and they alone, are of type UInt64".to_owned());
    }
    if structural {
        if v.variability == Variability::Tunable {
            found.push(
                "a tunable structural parameter needs Reconfiguration Mode, which no unit has"
                    .to_owned(),
            );
        }
        if v.dimension.is_some() {
            found.push("a structural parameter must be a scalar".to_owned());
        }
        // An array is never empty, and never takes memory without bound.
        if v.min.is_none_or(|min| min < 1.0) {
            found.push("a structural parameter needs a `min` of at least 1".to_owned());
        }
        if v.max.is_none_or(|max| max > f64::from(u32::MAX)) {
            found.push(format!(
                "a structural parameter needs a `max` of at most {}",
                u32::MAX
            ));
        }
        let mut sizes = d.variables.iter().filter_map(Variable::sized_by);
        if !sizes.any(|parameter| parameter == v.value_reference) {
            found.push("no `Dimension` names this structural parameter".to_owned());
        }
    }
    if let Some(parameter) = v.sized_by() {
        let known = d.variable(parameter);
        if known.is_none_or(|p| p.causality != Causality::StructuralParameter) {
            found.push(format!("dimension {parameter} is no structural parameter"));
        }
    }
    found
}
