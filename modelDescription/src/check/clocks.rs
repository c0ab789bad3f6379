//! Rules for clocks.

use super::variables::unique;
use crate::tree::ModelDescription;
use crate::xml::Reader;

/// Clocks come after all variables, so that neither owns a value reference of the other.
pub(super) fn check(d: &ModelDescription, r: &mut Reader) {
    let variables = d.variables.iter().map(|v| (&*v.name, v.line));
    let names = variables.chain(d.clocks.iter().map(|c| (&*c.name, c.line)));
    unique(
        r,
        "clock or variable",
        names.filter(|_| !d.clocks.is_empty()),
    );
    let mut last = d
        .variables
        .iter()
        .map(|v| v.value_reference + (v.length() - 1))
        .max();
    for clock in &d.clocks {
        let (name, reference) = (&clock.name, clock.value_reference);
        if last.is_some_and(|last| reference <= last) {
            let message = format!(
                "clock {name}: value reference {reference} must be greater than those of all variables and \
                 of the clocks before"
            );
            r.report(clock.line, message);
        }
        last = Some(reference);
    }
    if let Some(interface) = &d.scheduled_execution
        && d.clocks.is_empty()
    {
        r.report(interface.line, "`ScheduledExecution` needs a clock");
    }
}
