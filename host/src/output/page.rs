//! The page of experiments: tables as paper, reference, ours; figures interactive, and as SVG in print.

use super::chart::Chart;
use super::experiments::{Finished, svg_path};
use super::html::{END, escape, head};
use crate::experiment::verdict::{self, Row};
use crate::run::summary::number;
use std::fmt::Write;

/// Height of a panel \[px\].
const PANEL: usize = 240;

const STYLE: &str = "\
body { font: 15px/1.55 system-ui, sans-serif; color: #1f2933; background: #fff; max-width: 1000px; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.6rem; } h2 { font-size: 1.25rem; margin-top: 3rem; border-top: 1px solid #e5e7eb; padding-top: 1.2rem; }
h3 { font-size: 1rem; margin: 1.6rem 0 .4rem; }
.source, figcaption, .note { color: #52606d; }
table { border-collapse: collapse; margin: .4rem 0 1rem; }
th, td { padding: .2rem .8rem; border-bottom: 1px solid #e5e7eb; text-align: right; font-variant-numeric: tabular-nums; vertical-align: top; }
th { font-weight: 600; color: #52606d; }
th:first-child, td:first-child, td.text, th.text { text-align: left; }
td.met { color: #2f855a; } td.missed, .missed { color: #c0392b; font-weight: 600; }
figure { margin: 1.5rem 0; break-inside: avoid; } figcaption { font-size: .95em; }
figure img { display: none; max-width: 100%; }
nav li { margin: .1rem 0; }
@media print { .interactive { display: none; } figure img { display: block; } nav { display: none; } body { max-width: none; } }
";

/// The page. `charts` are those of each experiment's figures.
pub(super) fn html(title: &str, experiments: &[Finished<'_>], charts: &[Vec<Chart>]) -> String {
    let mut page = head(title, STYLE);
    let rows = || experiments.iter().flat_map(|finished| finished.rows);
    let judged = rows().filter(|row| row.met.is_some()).count();
    let missed = rows().filter(|row| row.met == Some(false)).count();
    let outcomes = experiments.iter().flat_map(|finished| finished.outcomes);
    let failed = outcomes.filter(|outcome| outcome.is_err()).count();
    let mut headline = match judged {
        0 => "No figure is judged".to_owned(),
        judged => format!("{judged} expected figures"),
    };
    if missed > 0 {
        let _ = write!(headline, ", <span class=\"missed\">{missed} missed</span>");
    } else if judged > 0 {
        headline.push_str(", all met");
    }
    if failed > 0 {
        let _ = write!(
            headline,
            ", <span class=\"missed\">{failed} runs failed</span>"
        );
    }
    let _ = writeln!(page, "<p>{headline}.</p>\n<nav><ul>");
    for Finished { experiment, .. } in experiments {
        let (id, title) = (escape(&experiment.name), escape(&experiment.title));
        let source = escape(&experiment.source);
        let _ = writeln!(
            page,
            "<li><a href=\"#{id}\">{title}</a> <span class=\"source\">{source}</span></li>"
        );
    }
    page.push_str("</ul></nav>\n");
    for (finished, charts) in experiments.iter().zip(charts) {
        section(&mut page, finished, charts);
    }
    page.push_str(END);
    page
}

fn section(page: &mut String, finished: &Finished<'_>, charts: &[Chart]) {
    let experiment = finished.experiment;
    let _ = writeln!(
        page,
        "<h2 id=\"{}\">{}</h2>\n<p class=\"source\">{}</p>",
        escape(&experiment.name),
        escape(&experiment.title),
        escape(&experiment.source)
    );
    for paragraph in experiment.description.split("\n\n") {
        if !paragraph.trim().is_empty() {
            let _ = writeln!(page, "<p>{}</p>", escape(paragraph.trim()));
        }
    }
    for (title, path) in &experiment.see {
        let _ = writeln!(
            page,
            "<p>See also <a href=\"{}\">{}</a>.</p>",
            escape(path),
            escape(title)
        );
    }
    for (run, outcome) in experiment.runs.iter().zip(finished.outcomes) {
        if let Err(error) = outcome {
            let _ = writeln!(
                page,
                "<p class=\"missed\">{} failed: {}</p>",
                escape(&run.name),
                escape(&error.to_string())
            );
        }
    }
    for (run, outcome) in experiment.runs.iter().zip(finished.outcomes) {
        let warnings = outcome.as_ref().map_or(&[][..], |o| &o.summary.warnings);
        for warning in warnings {
            let _ = writeln!(
                page,
                "<p class=\"note\">{}: {}</p>",
                escape(&run.name),
                escape(warning)
            );
        }
    }
    for table in finished.rows.chunk_by(|a, b| a.table == b.table) {
        rows(page, table);
    }
    for (figure, chart) in experiment.figures.iter().zip(charts) {
        // Neither name has a slash.
        let id = format!("{}/{}", experiment.name, figure.name);
        let _ = writeln!(
            page,
            "<figure>\n<div class=\"interactive\">{}</div>\n<img src=\"{svg}\" alt=\"{title}\">\n\
             <figcaption>{title} (<a href=\"{svg}\">SVG</a>)</figcaption>\n</figure>",
            chart.interactive(&id, PANEL),
            svg = escape(&svg_path(experiment, &figure.name)),
            title = escape(&figure.title)
        );
    }
}

/// One table.
fn rows(page: &mut String, rows: &[Row]) {
    let columns = verdict::columns(rows);
    let any = |filled: &dyn Fn(&Row) -> bool| rows.iter().any(filled);
    let judged = any(&|r| r.met.is_some());
    let noted = any(&|r| !r.note.is_empty());
    if let Some(name) = rows.first().map(|row| &row.table).filter(|n| !n.is_empty()) {
        let _ = writeln!(page, "<h3>{}</h3>", escape(name));
    }
    page.push_str("<table>\n<tr><th></th><th class=\"text\">quantity</th>");
    for (title, _) in &columns {
        let _ = write!(page, "<th>{title}</th>");
    }
    if judged {
        page.push_str("<th class=\"text\">expected</th>");
    }
    if noted {
        page.push_str("<th class=\"text\">note</th>");
    }
    page.push_str("</tr>\n");
    for (i, row) in rows.iter().enumerate() {
        let quantity = escape(&row.quantity_with_unit());
        let _ = write!(
            page,
            "<tr><td>{}</td><td class=\"text\">{quantity}</td>",
            escape(&row.name)
        );
        for (_, figures) in &columns {
            let text = figures[i].map_or("–".to_owned(), number);
            let _ = write!(page, "<td>{text}</td>");
        }
        if judged {
            let class = match row.met {
                Some(true) => "met",
                Some(false) => "missed",
                None => "",
            };
            let mark = match row.met {
                Some(true) => "✓ ",
                Some(false) => "missed: ",
                None => "",
            };
            let _ = write!(
                page,
                "<td class=\"text {class}\">{mark}{}</td>",
                escape(&row.admissible)
            );
        }
        if noted {
            let _ = write!(page, "<td class=\"text note\">{}</td>", escape(&row.note));
        }
        page.push_str("</tr>\n");
    }
    page.push_str("</table>\n");
}
