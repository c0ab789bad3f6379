//! Small helpers for reading XML with positions and for writing it.

use crate::Diagnostic;
use roxmltree::{Document, Node};
use std::fmt::Display;

/// Reads elements and collects everything that is wrong with them.
pub struct Reader<'a> {
    document: &'a Document<'a>,
    file: &'a str,
    /// What was found to be wrong until now.
    pub diagnostics: Vec<Diagnostic>,
}

impl<'a> Reader<'a> {
    /// A reader for a document; `file` names it in the messages.
    pub fn new(document: &'a Document<'a>, file: &'a str) -> Self {
        Self {
            document,
            file,
            diagnostics: Vec::new(),
        }
    }

    /// What was read, or everything that is wrong, by line.
    pub fn finish<T>(self, read: T) -> Result<T, Vec<Diagnostic>> {
        let mut diagnostics = self.diagnostics;
        if diagnostics.is_empty() {
            return Ok(read);
        }
        diagnostics.sort();
        Err(diagnostics)
    }

    /// Line of the element's start tag, from 1.
    pub fn line(&self, node: Node) -> u32 {
        self.document.text_pos_at(node.range().start).row
    }

    /// Reports a problem at a line.
    pub fn report(&mut self, line: u32, message: impl Display) {
        self.diagnostics.push(Diagnostic {
            file: self.file.to_owned(),
            line,
            message: message.to_string(),
        });
    }

    /// Reports a problem of an element, which the message then names.
    pub fn problem(&mut self, node: Node, message: impl Display) {
        let tag = node.tag_name().name();
        let name = node
            .attribute("name")
            .or_else(|| node.attribute("valueReference"));
        let line = self.line(node);
        self.report(
            line,
            match name {
                Some(name) => format!("{} {name}: {message}", subject(tag)),
                None => format!("element `{tag}`: {message}"),
            },
        );
    }

    /// Reports attributes other than `known`.
    pub fn know_attributes(&mut self, node: Node, known: &[&str]) {
        for attribute in node.attributes() {
            if attribute.namespace().is_some() || !known.contains(&attribute.name()) {
                self.problem(
                    node,
                    format_args!("unknown attribute `{}`", attribute.name()),
                );
            }
        }
    }

    /// The child elements; reports names other than `known` and text.
    pub fn children(&mut self, node: Node<'a, 'a>, known: &[&str]) -> Vec<Node<'a, 'a>> {
        for text in node.children().filter(|c| c.is_text()) {
            if !text.text().unwrap_or_default().trim().is_empty() {
                self.problem(node, "text where only elements may stand");
            }
        }
        let (known_ones, others): (Vec<_>, Vec<_>) = node
            .children()
            .filter(Node::is_element)
            .partition(|c| known.contains(&c.tag_name().name()));
        for other in others {
            let line = self.line(other);
            let parent = node.tag_name().name();
            let tag = other.tag_name().name();
            self.report(line, format_args!("unknown element `{tag}` in `{parent}`"));
        }
        known_ones
    }

    /// An attribute that must be there and not be empty.
    pub fn required(&mut self, node: Node<'a, 'a>, attribute: &str) -> String {
        match node.attribute(attribute) {
            Some(text) if !text.trim().is_empty() => text.to_owned(),
            Some(_) => {
                self.problem(node, format_args!("attribute `{attribute}` is empty"));
                String::new()
            }
            None => {
                self.problem(node, format_args!("missing attribute `{attribute}`"));
                String::new()
            }
        }
    }

    /// An attribute that `parse` can read; `what` says what it should be.
    pub fn parsed<T>(
        &mut self,
        node: Node<'a, 'a>,
        attribute: &str,
        what: impl Display,
        parse: impl Fn(&str) -> Option<T>,
    ) -> Option<T> {
        let text = node.attribute(attribute)?;
        let value = parse(text);
        if value.is_none() {
            self.problem(node, format_args!("{attribute} `{text}` is not {what}"));
        }
        value
    }

    /// A whitespace-separated list; elements that `parse` cannot read are reported.
    pub fn list<T>(
        &mut self,
        node: Node<'a, 'a>,
        attribute: &str,
        what: impl Display,
        parse: impl Fn(&str) -> Option<T>,
    ) -> Option<Vec<T>> {
        let mut values = Vec::new();
        for text in node.attribute(attribute)?.split_ascii_whitespace() {
            match parse(text) {
                Some(value) => values.push(value),
                None => self.problem(node, format_args!("{attribute} `{text}` is not {what}")),
            }
        }
        Some(values)
    }

    /// A finite number.
    pub fn number(&mut self, node: Node<'a, 'a>, attribute: &str) -> Option<f64> {
        self.parsed(node, attribute, "a finite number", parse_f64)
    }

    /// A truth value; false if absent.
    pub fn flag(&mut self, node: Node<'a, 'a>, attribute: &str) -> bool {
        self.parsed(node, attribute, "true or false", parse_bool)
            .unwrap_or(false)
    }

    /// A value reference.
    pub fn reference(&mut self, node: Node<'a, 'a>, attribute: &str) -> Option<u32> {
        self.parsed(node, attribute, "a value reference", |t| t.parse().ok())
    }
}

/// How a message names an element.
fn subject(tag: &str) -> &str {
    match tag {
        "Float64" | "Int32" | "Boolean" | "Enumeration" => "variable",
        "Unit" => "unit",
        "DisplayUnit" => "display unit",
        "EnumerationType" => "type",
        "Item" => "item",
        "Category" => "log category",
        "Parameter" => "parameter",
        other => other,
    }
}

/// A finite `xs:double`.
pub fn parse_f64(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|v: &f64| v.is_finite())
}

/// An `xs:int`.
pub fn parse_i32(text: &str) -> Option<i32> {
    text.trim().parse().ok()
}

/// An `xs:boolean`.
pub fn parse_bool(text: &str) -> Option<bool> {
    match text.trim() {
        "true" | "1" => Some(true),
        "false" | "0" => Some(false),
        _ => None,
    }
}

/// A number that reads back exactly, as short as can be.
pub fn f64_text(value: f64) -> String {
    let text = format!("{value:?}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

/// Text for an attribute in double quotes.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            c => escaped.push(c),
        }
    }
    escaped
}
