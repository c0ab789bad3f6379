//! `flexarm simulate x.ssp`.

use super::progress::Progress;
use super::simulate::report_messages;
use host::Error;
use host::output::OutputFolder;
use host::ssp::{SystemSimulation, simulate_system};
use std::io::{self, Write};
use std::path::Path;

pub(super) fn run(simulation: &SystemSimulation, output: Option<&Path>) -> Result<(), Error> {
    let output = output.map(OutputFolder::prepare).transpose()?;
    let mut progress = Progress::new();
    let outcome = simulate_system(simulation, &mut |done| progress.tell(done));
    progress.finish();
    let outcome = outcome?;
    report_messages(&outcome.summary.warnings, &outcome.messages);
    if let Some(output) = output {
        let report = output.write_system(&outcome)?;
        let partial = if outcome.failure.is_some() {
            "partial "
        } else {
            ""
        };
        let _ = writeln!(io::stderr(), "{partial}report: {}", report.display());
    }
    match outcome.failure {
        Some(failure) => Err(failure),
        None => super::print(&format!("{}\n", outcome.summary.table())),
    }
}
