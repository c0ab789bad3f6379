//! Parameter files: System Structure Parameter Values (SSP 1.0 and 2.0, `.ssv`).
//!
//! ```
//! use model_description::ssv::{self, Value};
//!
//! let text = r#"<?xml version="1.0" encoding="UTF-8"?>
//! <ssv:ParameterSet version="1.0" name="heavy"
//!     xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"
//!     xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon">
//!   <ssv:Parameters>
//!     <ssv:Parameter name="arm.inertia"><ssv:Real value="0.09" unit="kg.m2"/></ssv:Parameter>
//!     <ssv:Parameter name="arm.cogging_cos[1]"><ssv:Real value="0.12"/></ssv:Parameter>
//!   </ssv:Parameters>
//!   <ssv:Units>
//!     <ssc:Unit name="kg.m2"><ssc:BaseUnit kg="1" m="2" rad="-1"/></ssc:Unit>
//!   </ssv:Units>
//! </ssv:ParameterSet>"#;
//! let set = ssv::read(text, "heavy.ssv").unwrap();
//! assert_eq!(set.parameters[0].name, "arm.inertia");
//! assert_eq!(set.parameters[0].value, Value::Real(0.09));
//! assert_eq!(set.parameters[1].unit, None);
//! ```

use crate::tree::Unit;
use crate::xml::{Reader, escape, f64_text, parse_bool, parse_f64, parse_i32};
use crate::{Diagnostic, read as description};
use roxmltree::{Document, Node};
use std::collections::BTreeSet;
use std::fmt::{self, Write};

const NAMESPACE: &str = "http://ssp-standard.org/SSP1/SystemStructureParameterValues";
const COMMON: &str = "http://ssp-standard.org/SSP1/SystemStructureCommon";

/// A named set of parameter values.
#[derive(Clone, Debug, Default)]
pub struct ParameterSet {
    /// Name.
    pub name: String,
    /// What the values stand for; may be empty.
    pub description: String,
    /// The parameters, in the order of the file.
    pub parameters: Vec<Parameter>,
    /// The units that the parameters name.
    pub units: Vec<Unit>,
}

/// The value of one scalar parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name; elements of arrays as `arm.cogging_cos[1]`.
    pub name: String,
    /// Value.
    pub value: Value,
    /// Unit of the value. None: the unit of the variable.
    pub unit: Option<String>,
    /// Line in the file, from 1.
    pub line: u32,
}

/// A value of a parameter.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs, reason = "the names are the standard's")]
pub enum Value {
    Real(f64),
    Integer(i64),
    Boolean(bool),
    String(String),
    /// Name of the item.
    Enumeration(String),
}

impl Value {
    /// Name of the element that holds the value.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Real(_) => "Real",
            Self::Integer(_) => "Integer",
            Self::Boolean(_) => "Boolean",
            Self::String(_) => "String",
            Self::Enumeration(_) => "Enumeration",
        }
    }
}

/// In the notation of XML Schema; numbers read back exactly.
impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Real(value) => f.write_str(&f64_text(*value)),
            Self::Integer(value) => write!(f, "{value}"),
            Self::Boolean(value) => write!(f, "{value}"),
            Self::String(value) | Self::Enumeration(value) => f.write_str(value),
        }
    }
}

/// Reads a parameter file; `file` names it in the messages.
///
/// Annotations and metadata are skipped. Errors: everything that is wrong with it, by line.
pub fn read(text: &str, file: &str) -> Result<ParameterSet, Vec<Diagnostic>> {
    let document = Document::parse(text).map_err(|error| {
        vec![Diagnostic {
            file: file.to_owned(),
            line: error.pos().row,
            message: format!("not well-formed: {error}"),
        }]
    })?;
    let mut reader = Reader::new(&document, file);
    let set = parameter_set(&mut reader, document.root_element());
    reader.finish(set)
}

/// Reads a parameter set that stands in another document, like the `ParameterValues` of a system structure.
pub fn parameter_set<'a>(r: &mut Reader<'a>, node: Node<'a, 'a>) -> ParameterSet {
    if !node.has_tag_name((NAMESPACE, "ParameterSet")) {
        r.problem(
            node,
            format_args!("a `ParameterSet` of {NAMESPACE} must stand here"),
        );
    }
    let version = node.attribute("version").unwrap_or_default();
    if !version.starts_with("1.") && !version.starts_with("2.") {
        r.problem(node, format_args!("version `{version}` is not 1.x or 2.x"));
    }
    let mut set = ParameterSet {
        name: r.required(node, "name"),
        description: node.attribute("description").unwrap_or_default().to_owned(),
        ..ParameterSet::default()
    };
    for section in r.children(
        node,
        &[
            "Parameters",
            "Enumerations",
            "Units",
            "MetaData",
            "Annotations",
        ],
    ) {
        match section.tag_name().name() {
            "Parameters" => {
                let nodes = r.children(section, &["Parameter"]);
                set.parameters = nodes.iter().filter_map(|n| parameter(r, *n)).collect();
            }
            "Units" => {
                let nodes = r.children(section, &["Unit"]);
                set.units = nodes.iter().map(|n| description::unit(r, *n)).collect();
            }
            _ => {}
        }
    }
    let mut names = BTreeSet::new();
    for p in &set.parameters {
        if !names.insert(&p.name) {
            r.report(p.line, format_args!("parameter {}: given twice", p.name));
        }
        if let Some(unit) = &p.unit
            && !set.units.iter().any(|u| u.name == *unit)
        {
            let message = format!("parameter {}: unit `{unit}` is not in `Units`", p.name);
            r.report(p.line, message);
        }
    }
    set
}

/// Elements that hold a value: those of SSP 1.0, then what SSP 2.0 adds (sec 6.1.1).
const VALUES: [&str; 15] = [
    "Real",
    "Integer",
    "Boolean",
    "String",
    "Enumeration",
    "Float64",
    "Float32",
    "Int8",
    "UInt8",
    "Int16",
    "UInt16",
    "Int32",
    "UInt32",
    "Int64",
    "UInt64",
];

fn parameter<'a>(r: &mut Reader<'a>, node: Node<'a, 'a>) -> Option<Parameter> {
    r.know_attributes(node, &["name", "id", "description"]);
    let name = r.required(node, "name");
    let children = r.children(node, &[&VALUES[..], &["Annotations"]].concat());
    let values: Vec<_> = children
        .into_iter()
        .filter(|c| !c.has_tag_name((NAMESPACE, "Annotations")))
        .collect();
    let [value] = values[..] else {
        let of = VALUES[..5].join(", ");
        r.problem(node, format_args!("must have exactly one value, of {of}"));
        return None;
    };
    let kind = value.tag_name().name();
    r.know_attributes(
        value,
        match kind {
            "Real" | "Float64" | "Float32" => &["value", "unit"],
            "Enumeration" => &["value", "name"],
            _ => &["value"],
        },
    );
    let Some(text) = value.attribute("value") else {
        r.problem(node, "missing attribute `value`");
        return None;
    };
    let parsed = match kind {
        "Real" | "Float64" | "Float32" => parse_f64(text).map(Value::Real),
        "Boolean" => parse_bool(text).map(Value::Boolean),
        "String" => Some(Value::String(text.to_owned())),
        "Enumeration" => Some(Value::Enumeration(text.trim().to_owned())),
        "Integer" => parse_i32(text).map(|number| Value::Integer(number.into())),
        _ => text.trim().parse().ok().map(Value::Integer),
    };
    if parsed.is_none() {
        r.problem(node, format_args!("value `{text}` is not of type {kind}"));
    }
    Some(Parameter {
        name,
        value: parsed?,
        unit: value.attribute("unit").map(str::to_owned),
        line: r.line(node),
    })
}

/// Writes a parameter file.
pub fn write(set: &ParameterSet) -> String {
    let mut out = String::new();
    write_to(&mut out, set).unwrap_or_default(); // writing to a String does not fail
    out
}

fn write_to(out: &mut String, set: &ParameterSet) -> fmt::Result {
    writeln!(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>")?;
    writeln!(
        out,
        "<ssv:ParameterSet version=\"1.0\" name=\"{}\" description=\"{}\"\n    \
         xmlns:ssv=\"{NAMESPACE}\"\n    xmlns:ssc=\"{COMMON}\">",
        escape(&set.name),
        escape(&set.description),
    )?;
    writeln!(out, "  <ssv:Parameters>")?;
    for p in &set.parameters {
        let unit = p.unit.as_ref().map(|u| format!(" unit=\"{}\"", escape(u)));
        writeln!(
            out,
            "    <ssv:Parameter name=\"{}\"><ssv:{} value=\"{}\"{}/></ssv:Parameter>",
            escape(&p.name),
            p.value.kind(),
            escape(&p.value.to_string()),
            unit.unwrap_or_default(),
        )?;
    }
    writeln!(out, "  </ssv:Parameters>")?;
    if !set.units.is_empty() {
        writeln!(out, "  <ssv:Units>")?;
        for unit in &set.units {
            write!(
                out,
                "    <ssc:Unit name=\"{}\"><ssc:BaseUnit",
                escape(&unit.name)
            )?;
            for (attribute, value) in unit.base.iter().flatten() {
                write!(out, " {attribute}=\"{}\"", escape(value))?;
            }
            writeln!(out, "/></ssc:Unit>")?;
        }
        writeln!(out, "  </ssv:Units>")?;
    }
    writeln!(out, "</ssv:ParameterSet>")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(parameters: &str) -> String {
        format!(
            "<ssv:ParameterSet version=\"1.0\" name=\"n\" xmlns:ssv=\"{NAMESPACE}\" xmlns:ssc=\"{COMMON}\">\n\
             <ssv:Parameters>\n{parameters}\n</ssv:Parameters>\n\
             <ssv:Units><ssc:Unit name=\"A\"><ssc:BaseUnit A=\"1\"/></ssc:Unit></ssv:Units>\n\
             </ssv:ParameterSet>"
        )
    }

    fn errors(parameters: &str) -> Vec<String> {
        let diagnostics = read(&file(parameters), "p.ssv").unwrap_err();
        diagnostics.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn what_is_written_reads_back() {
        let set = read(
            &file(
                "<ssv:Parameter name=\"r\"><ssv:Real value=\"1e-9\" unit=\"A\"/></ssv:Parameter>\n\
                 <ssv:Parameter name=\"v[2]\"><ssv:Real value=\"0.30000000000000004\"/></ssv:Parameter>\n\
                 <ssv:Parameter name=\"i\"><ssv:Integer value=\"-3\"/></ssv:Parameter>\n\
                 <ssv:Parameter name=\"b\"><ssv:Boolean value=\"1\"/></ssv:Parameter>\n\
                 <ssv:Parameter name=\"s\"><ssv:String value=\"a&lt;&quot;\"/></ssv:Parameter>\n\
                 <ssv:Parameter name=\"e\"><ssv:Enumeration value=\"lqr\"/></ssv:Parameter>",
            ),
            "p.ssv",
        )
        .unwrap();
        let lines: Vec<_> = set.parameters.iter().map(|p| p.line).collect();
        assert_eq!(lines, [3, 4, 5, 6, 7, 8]);
        let again = read(&write(&set), "again.ssv").unwrap();
        let strip = |set: &ParameterSet| -> Vec<_> {
            let of = |p: &Parameter| (p.name.clone(), p.value.clone(), p.unit.clone());
            set.parameters.iter().map(of).collect()
        };
        assert_eq!(strip(&set), strip(&again));
        assert_eq!(again.units[0].base, set.units[0].base);
    }

    #[test]
    fn errors_name_file_line_and_parameter() {
        assert_eq!(
            errors("<ssv:Parameter name=\"x\"><ssv:Real value=\"fast\"/></ssv:Parameter>"),
            ["p.ssv:3: parameter x: value `fast` is not of type Real"]
        );
        assert_eq!(
            errors(
                "\n<ssv:Parameter name=\"x\"><ssv:Real value=\"1\" unit=\"V\"/></ssv:Parameter>"
            ),
            ["p.ssv:4: parameter x: unit `V` is not in `Units`"]
        );
        let one = "<ssv:Parameter name=\"x\"><ssv:Integer value=\"1\"/></ssv:Parameter>\n";
        assert_eq!(
            errors(&one.repeat(2)),
            ["p.ssv:4: parameter x: given twice"]
        );
        assert_eq!(
            errors("<ssv:Parameter name=\"x\"/>"),
            [
                "p.ssv:3: parameter x: must have exactly one value, of Real, Integer, Boolean, String, Enumeration"
            ]
        );
        assert_eq!(
            errors("<ssv:Parameter name=\"x\"><ssv:Integer value=\"1.5\"/></ssv:Parameter>\n<ssv:Parameter/>")
                .len(),
            3,
            "all errors at once"
        );
        assert_eq!(
            read("<ssv:x", "p.ssv").unwrap_err()[0].line,
            1,
            "broken XML has a line too"
        );
    }
}
