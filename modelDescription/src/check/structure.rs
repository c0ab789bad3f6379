//! Rules for the model structure (FMI 3.0 sec 2.4.8).

use crate::tree::{Causality, Initial, Kind, ModelDescription, Unknown, Variability, Variable};
use crate::xml::Reader;
use std::collections::BTreeMap;

pub(super) fn check(d: &ModelDescription, r: &mut Reader) {
    derivatives(d, r);
    let states: Vec<u32> = d.variables.iter().filter_map(|v| v.derivative).collect();
    let is_state = |v: &Variable| states.contains(&v.value_reference);
    let known = |v: &Variable| {
        is_state(v) || matches!(v.causality, Causality::Input | Causality::Independent)
    };
    let indicates = |v: &Variable| {
        let mut entries = d.event_indicators.iter();
        entries.any(|e| e.value_reference == v.value_reference)
    };
    let known_initially = |v: &Variable| {
        matches!(v.causality, Causality::Input | Causality::Independent)
            || v.initial == Some(Initial::Exact)
    };
    let sections: [Section; 4] = [
        Section {
            name: "Output",
            what: "an output",
            entries: &d.outputs,
            belongs: &|v| v.causality == Causality::Output,
            knowns: "an input, a continuous state or the independent variable",
            known: &known,
        },
        Section {
            name: "ContinuousStateDerivative",
            what: "the derivative of a state",
            entries: &d.derivatives,
            belongs: &|v| v.derivative.is_some(),
            knowns: "an input, a continuous state or the independent variable",
            known: &known,
        },
        Section {
            name: "InitialUnknown",
            what: "calculated at initialization",
            entries: &d.initial_unknowns,
            belongs: &|v| {
                matches!(v.initial, Some(Initial::Calculated | Initial::Approx))
                    && (matches!(
                        v.causality,
                        Causality::Output | Causality::CalculatedParameter
                    ) || is_state(v)
                        || v.derivative.is_some())
            },
            knowns: "an input, the independent variable or a variable with initial exact",
            known: &known_initially,
        },
        Section {
            name: "EventIndicator",
            what: "continuous",
            entries: &d.event_indicators,
            // Any continuous variable may be one, none has to.
            belongs: &|v| {
                v.variability == Variability::Continuous && v.dimension.is_none() && indicates(v)
            },
            knowns: "an input, a continuous state or the independent variable",
            known: &known,
        },
    ];
    for section in &sections {
        section.check(d, r);
    }
}

/// A kind of entry and which variables may and must stand there.
struct Section<'a> {
    name: &'a str,
    what: &'a str,
    entries: &'a [Unknown],
    belongs: &'a dyn Fn(&Variable) -> bool,
    knowns: &'a str,
    known: &'a dyn Fn(&Variable) -> bool,
}

impl Section<'_> {
    fn check(&self, d: &ModelDescription, r: &mut Reader) {
        let section = self.name;
        let mut lines = BTreeMap::new();
        for entry in self.entries {
            let reference = entry.value_reference;
            let mut report = |message: String| {
                r.report(entry.line, format_args!("{section} {reference}: {message}"));
            };
            if let Some(first) = lines.insert(reference, entry.line) {
                report(format!("already declared in line {first}"));
            }
            match d.variable(reference) {
                None => report("no variable has this value reference".to_owned()),
                Some(v) if !(self.belongs)(v) => {
                    report(format!("variable {} is not {}", v.name, self.what));
                }
                Some(_) => {}
            }
            let dependencies = entry.dependencies.as_deref().unwrap_or_default();
            for (n, dependency) in dependencies.iter().enumerate() {
                if dependencies[..n].contains(dependency) {
                    report(format!("dependency {dependency} stands twice"));
                }
                match d.variable(*dependency) {
                    None => report(format!("dependency {dependency} is no variable")),
                    Some(v) if !(self.known)(v) => report(format!(
                        "dependency {dependency} ({}) is not {}",
                        v.name, self.knowns
                    )),
                    Some(_) => {}
                }
            }
        }
        for v in d.variables.iter().filter(|v| (self.belongs)(v)) {
            if !lines.contains_key(&v.value_reference) {
                let (name, reference) = (&v.name, v.value_reference);
                r.report(
                    v.line,
                    format_args!(
                        "variable {name}: missing `{section}` {reference} in the model structure"
                    ),
                );
            }
        }
    }
}

/// Attributes `derivative`.
fn derivatives(d: &ModelDescription, r: &mut Reader) {
    let mut of = BTreeMap::new();
    for v in &d.variables {
        let Some(reference) = v.derivative else {
            continue;
        };
        let name = &v.name;
        let Some(state) = d.variable(reference) else {
            r.report(
                v.line,
                format_args!("variable {name}: derivative of unknown variable {reference}"),
            );
            continue;
        };
        let continuous =
            |v: &Variable| v.kind == Kind::Float64 && v.variability == Variability::Continuous;
        if !continuous(v) || !continuous(state) {
            let state = &state.name;
            r.report(
                v.line,
                format_args!(
                    "variable {name}: it and its state {state} must be continuous Float64"
                ),
            );
        }
        if v.dimension.is_some() || state.dimension.is_some() {
            r.report(
                v.line,
                format_args!("variable {name}: states must be scalars"),
            );
        }
        if let Some(other) = of.insert(reference, name) {
            let state = &state.name;
            r.report(
                v.line,
                format_args!("variable {name}: {other} is already the derivative of {state}"),
            );
        }
    }
}
