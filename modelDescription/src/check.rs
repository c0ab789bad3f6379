//! Rules that a model description must keep beyond the schema, each reported with its line.

mod clocks;
mod dimensions;
mod structure;
mod variables;

use crate::tree::{Causality, Initial, ModelDescription, Variability};
use crate::xml::Reader;

/// Reports everything that is inconsistent.
pub(crate) fn check(description: &ModelDescription, reader: &mut Reader) {
    variables::check(description, reader);
    dimensions::check(description, reader);
    clocks::check(description, reader);
    structure::check(description, reader);
}

/// The `initial` of a variable that does not say (FMI 3.0 sec 2.4.7.5).
pub(crate) fn default_initial(causality: Causality, variability: Variability) -> Option<Initial> {
    Some(match (causality, variability) {
        (Causality::Input | Causality::Independent, _) => return None,
        (Causality::Parameter | Causality::StructuralParameter, _) | (_, Variability::Constant) => {
            Initial::Exact
        }
        _ => Initial::Calculated,
    })
}
