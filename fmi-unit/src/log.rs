//! Log messages of a unit on their way to the importer.

use std::fmt::Arguments;

/// Severity of a message; the interface translates it into the status of the FMI version in use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// Something worth knowing.
    Info,
    /// Something was replaced or accepted that should not occur.
    Warning,
    /// A call failed.
    Error,
    /// The instance is lost.
    Fatal,
}

/// Where a unit reports to. Messages of categories that the importer did not ask for are never formatted.
pub struct Log<'a> {
    sink: &'a mut dyn FnMut(Severity, &'static str, Arguments<'_>),
}

impl<'a> Log<'a> {
    /// A log that hands each message to `sink` with its severity and category.
    pub fn new(sink: &'a mut dyn FnMut(Severity, &'static str, Arguments<'_>)) -> Self {
        Self { sink }
    }

    /// Reports under a category of the model description.
    pub fn write(&mut self, severity: Severity, category: &'static str, message: Arguments<'_>) {
        (self.sink)(severity, category, message);
    }
}
