//! Experiments as data: which pairs run, with what, what is expected of them and which figures show them.
//!
//! [`Experiment::read`] takes a TOML file, [`execute`](execute::execute) makes the runs of many experiments in
//! parallel, [`verdict`] compares them with what was expected; [`crate::output`] writes tables, figures and the
//! page. The format is documented in `experiments/README.md` of the project.
//!
//! An experiment knows no FMU: names of variables are checked against the FMUs before the first run begins.

mod blame;
pub mod execute;
mod expect;
mod figure;
mod file;
mod lines;
mod quantity;
mod response;
pub mod verdict;

pub use expect::{Combine, Expectation};
pub use figure::{Curve, Figure, FigureKind, Panel, Style};
pub use quantity::{Quantity, Signal, Statistic};
pub use response::frequency_response;

use crate::Simulation;
use crate::input::Place;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// An experiment.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// The file that describes it.
    pub file: PathBuf,
    /// Name: that of the file without its extension.
    pub name: String,
    /// Title.
    pub title: String,
    /// What it repeats: equation, section, table or figure. May be empty.
    pub source: String,
    /// What it is for, in paragraphs of plain text.
    pub description: String,
    /// What else there is to read: title and path from the page.
    pub see: Vec<(String, String)>,
    /// Whether its runs are made one at a time, after all others: where it measures wall-clock times.
    pub alone: bool,
    /// The runs, each with every variant.
    pub runs: Vec<Run>,
    /// What is expected of them.
    pub expectations: Vec<Expectation>,
    /// What is drawn of them.
    pub figures: Vec<Figure>,
}

/// One run.
#[derive(Clone, Debug)]
pub struct Run {
    /// Name, unique in the experiment.
    pub name: String,
    /// Folder of its results within the experiment's.
    pub folder: String,
    /// Where it is described.
    pub place: Place,
    /// Where each of its settings and files is given, by key and by path.
    pub keys: BTreeMap<String, Place>,
    /// What runs.
    pub simulation: Simulation,
}

/// A name as part of a path: letters, digits, points, minus and underscores.
fn folder_name(name: &str) -> String {
    let mut folder = String::new();
    for c in name.chars() {
        let plain = c.is_alphanumeric() || matches!(c, '.' | '_' | '-');
        if plain {
            folder.push(c);
        } else if !folder.ends_with('-') {
            folder.push('-');
        }
    }
    folder.trim_matches(['-', '.']).to_owned()
}

#[cfg(test)]
mod tests {
    use super::folder_name;

    #[test]
    fn names_become_folders() {
        for (name, folder) in [
            ("LQR/MPC", "LQR-MPC"),
            ("0.5 s, profile", "0.5-s-profile"),
            ("../x", "x"),
            ("α", "α"),
        ] {
            assert_eq!(folder_name(name), folder);
        }
    }
}
