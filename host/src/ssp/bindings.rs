//! Reads parameter bindings, parameter mappings and transformations (SSP 1.0 sec 4.4.2, 5.2.4 and 7).

use super::document::{Binding, Mapping, MappingEntry, Source, Written};
use super::read::{errors, parse};
use crate::input::Error;
use model_description::ssv;
use model_description::xml::{Reader, parse_bool};
use roxmltree::Node;
use std::collections::BTreeSet;

const SSM: &str = "http://ssp-standard.org/SSP1/SystemStructureParameterMapping";

/// Reads a file with a parameter mapping.
pub(super) fn mapping_file(text: &str, file: &str) -> Result<Mapping, Error> {
    let document = parse(text, file)?;
    let mut reader = Reader::new(&document, file);
    let mapping = mapping(&mut reader, document.root_element());
    reader.finish(mapping).map_err(errors)
}

/// The transformation among the children of `node`, of which `others` are admissible too.
pub(super) fn transformation<'a>(
    r: &mut Reader<'a>,
    node: Node<'a, 'a>,
    others: &[&str],
) -> Option<Written> {
    let known = [
        "LinearTransformation",
        "BooleanMappingTransformation",
        "IntegerMappingTransformation",
        "EnumerationMappingTransformation",
    ];
    let mut found = None;
    for child in r.children(node, &[&known[..], others].concat()) {
        let tag = child.tag_name().name();
        if !known.contains(&tag) {
            continue;
        }
        if found.is_some() {
            r.problem(child, "only one transformation can be given");
        }
        found = Some(match tag {
            "LinearTransformation" => {
                let factor = r.number(child, "factor").unwrap_or(1.0);
                if factor == 0.0 {
                    r.problem(child, "factor 0: must be a finite number that is not 0");
                }
                let offset = r.number(child, "offset").unwrap_or(0.0);
                Written::Linear { factor, offset }
            }
            "BooleanMappingTransformation" => {
                Written::Boolean(entries(r, child, "true or false", parse_bool))
            }
            "IntegerMappingTransformation" => {
                let integer = |text: &str| text.trim().parse().ok();
                Written::Integer(entries(r, child, "an integer", integer))
            }
            _ => {
                let text = |text: &str| Some(text.to_owned());
                Written::Enumeration(entries(r, child, "an item", text))
            }
        });
    }
    found
}

fn entries<'a, T>(
    r: &mut Reader<'a>,
    node: Node<'a, 'a>,
    what: &str,
    parse: impl Fn(&str) -> Option<T>,
) -> Vec<(T, T)> {
    let mut entries = Vec::new();
    for entry in r.children(node, &["MapEntry"]) {
        for attribute in ["source", "target"] {
            r.required(entry, attribute);
        }
        let source = r.parsed(entry, "source", what, &parse);
        let target = r.parsed(entry, "target", what, &parse);
        entries.extend(source.zip(target));
    }
    entries
}

pub(super) fn binding<'a>(r: &mut Reader<'a>, node: Node<'a, 'a>) -> Option<Binding> {
    let kind = node.attribute("type");
    if let Some(kind) = kind.filter(|kind| *kind != "application/x-ssp-parameter-set") {
        r.problem(
            node,
            format_args!("type `{kind}` cannot be read, only application/x-ssp-parameter-set"),
        );
        return None;
    }
    let (mut inline, mut mapping) = (None, None);
    for child in r.children(
        node,
        &["ParameterValues", "ParameterMapping", "Annotations"],
    ) {
        match child.tag_name().name() {
            "ParameterValues" => inline = child.children().find(Node::is_element),
            "ParameterMapping" => {
                let content = child.children().find(Node::is_element);
                mapping = source(r, child, content.map(mapping_in));
                mapping.as_ref()?;
            }
            _ => {}
        }
    }
    let values = source(r, node, inline.map(values_in))?;
    Some(Binding {
        prefix: node.attribute("prefix").unwrap_or_default().to_owned(),
        values,
        mapping,
        line: r.line(node),
    })
}

type Content<'a, T> = Box<dyn FnOnce(&mut Reader<'a>) -> T + 'a>;

fn mapping_in<'a>(node: Node<'a, 'a>) -> Content<'a, Mapping> {
    Box::new(move |r| mapping(r, node))
}

fn values_in<'a>(node: Node<'a, 'a>) -> Content<'a, ssv::ParameterSet> {
    Box::new(move |r| ssv::parameter_set(r, node))
}

/// What `source` names, or what stands in the element: exactly one of them.
fn source<'a, T>(
    r: &mut Reader<'a>,
    node: Node<'a, 'a>,
    inline: Option<Content<'a, T>>,
) -> Option<Source<T>> {
    match (node.attribute("source"), inline) {
        (Some(path), None) => Some(Source::File {
            path: path.to_owned(),
            in_component: node.attribute("sourceBase") == Some("component"),
        }),
        (None, Some(content)) => Some(Source::Inline(content(r))),
        (Some(_), Some(_)) => {
            r.problem(node, "has both a source and content");
            None
        }
        (None, None) => {
            r.problem(node, "has neither a source nor content");
            None
        }
    }
}

fn mapping<'a>(r: &mut Reader<'a>, node: Node<'a, 'a>) -> Mapping {
    if !node.has_tag_name((SSM, "ParameterMapping")) {
        r.problem(
            node,
            format_args!("a `ParameterMapping` of {SSM} must stand here"),
        );
    }
    let mut entries = Vec::new();
    let mut targets = BTreeSet::new();
    for child in r.children(node, &["MappingEntry", "MetaData", "Annotations"]) {
        if child.tag_name().name() != "MappingEntry" {
            continue;
        }
        let entry = MappingEntry {
            source: r.required(child, "source"),
            target: r.required(child, "target"),
            transformation: transformation(r, child, &["Annotations"]),
            suppress_unit_conversion: r.flag(child, "suppressUnitConversion"),
            line: r.line(child),
        };
        // SSP 1.0 sec 7.1: not several parameters to one name.
        if !targets.insert(entry.target.clone()) {
            r.problem(child, format_args!("target `{}` given twice", entry.target));
        }
        entries.push(entry);
    }
    Mapping { entries }
}
