//! A run of a system structure: its samples, and all signals that take part in a connection as a page and as SVG,
//! one panel for each unit.

use super::chart::{Chart, PANELS, Panel, Trace};
use super::figures::COLOURS;
use super::html::{END, RESULT, circumstances, head};
use super::report::{PANEL, TIME};
use super::{OF_A_RUN, OutputFolder, PLOT, names};
use crate::Error;
use crate::experiment::Style;
use crate::ssp::SystemOutcome;
use std::fs;
use std::io;
use std::path::PathBuf;

impl OutputFolder {
    /// Writes all files of a run of a system and returns the path of the report. On an error none of them appears.
    pub fn write_system(mut self, outcome: &SystemOutcome) -> Result<PathBuf, Error> {
        let [_, _, report] = names(outcome.summary.stopped.is_some());
        let written = self.try_write_system(outcome);
        written.map_err(|source| Error::Output {
            path: self.path.clone(),
            source,
        })?;
        Ok(self.path.join(report))
    }

    fn try_write_system(&mut self, outcome: &SystemOutcome) -> io::Result<()> {
        let partial = outcome.summary.stopped.is_some();
        self.run_files(
            &outcome.recording,
            &outcome.summary,
            partial,
            Some(&html(outcome)),
        )?;
        // The plot of an earlier run stays with its samples.
        let stale: Vec<_> = OF_A_RUN
            .into_iter()
            .filter(|name| !partial || *name != PLOT)
            .collect();
        if !partial {
            let svg = Chart::new(TIME, panels(outcome)).svg();
            let svg = svg.map_err(io::Error::other)?;
            fs::write(self.partial.path().join(PLOT), svg)?;
        }
        self.write_log(&outcome.messages)?;
        self.publish(&stale)
    }
}

fn html(outcome: &SystemOutcome) -> String {
    let summary = &outcome.summary;
    let mut page = head(&summary.name, RESULT);
    circumstances(
        &mut page,
        &summary.headline(),
        &summary.rows(),
        summary.stopped.as_ref(),
        &summary.warnings,
    );
    let mut panels = panels(outcome).into_iter().peekable();
    for count in 1.. {
        if panels.peek().is_none() {
            break;
        }
        let chart = Chart::new(TIME, panels.by_ref().take(PANELS).collect());
        page.push_str(&chart.interactive(&format!("plots{count}"), PANEL));
        page.push('\n');
    }
    page.push_str(END);
    page
}

/// Signals with a unit share a panel, those without one have one for each component.
fn panels(outcome: &SystemOutcome) -> Vec<Panel> {
    let recording = &outcome.recording;
    let time = recording.column(0);
    let mut panels: Vec<Panel> = Vec::new();
    for (count, &index) in outcome.connected.iter().enumerate() {
        let column = &recording.columns()[index];
        let title = match &column.unit {
            Some(unit) => format!("[{unit}]"),
            None => {
                let component = column.name.rsplit_once('.').map_or("", |(path, _)| path);
                component.to_owned()
            }
        };
        let values = recording.column(index);
        let colour = COLOURS[count % COLOURS.len()];
        // What steps where the step ends is held.
        let whole = values.iter().all(|value| value.fract() == 0.0);
        let style = if whole { Style::Steps } else { Style::Line };
        let trace = Trace::new(&column.name, colour, style, &time, &values);
        match panels.iter_mut().find(|panel| panel.title == title) {
            Some(panel) => panel.traces.push(trace),
            None => panels.push(Panel::new(title, vec![trace])),
        }
    }
    panels
}
