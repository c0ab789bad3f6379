//! What all pages share.

use super::chart::script;
use crate::run::summary::Stopped;
use std::fmt::Write;

/// Style of the pages of one result.
pub(super) const RESULT: &str = "\
body { font: 15px/1.5 system-ui, sans-serif; color: #1f2933; background: #fff; max-width: 1200px; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.4rem; font-weight: 600; }
table { border-collapse: collapse; columns: 2; margin-bottom: 1rem; }
th { text-align: left; font-weight: 400; color: #52606d; padding: .1rem 1.5rem .1rem 0; }
td { text-align: right; font-variant-numeric: tabular-nums; padding: .1rem .4rem; }
td.unit { text-align: left; color: #52606d; }
p.warning { color: #b45309; margin: .2rem 0; }
";

/// Beginning of a page that needs no network, up to its heading.
pub(super) fn head(title: &str, style: &str) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<style>\n{style}</style>\n\
         <title>{0}</title>\n{1}</head>\n<body>\n<h1>{0}</h1>\n",
        escape(title),
        script()
    )
}

/// End of a page.
pub(super) const END: &str = "</body>\n</html>\n";

/// A row of a table: a quantity, its value and its unit.
pub(super) fn row(page: &mut String, [name, value, unit]: [&str; 3]) {
    // Formatting to a String cannot fail.
    let _ = writeln!(
        page,
        "<tr><th>{}</th><td>{}</td><td class=\"unit\">{}</td></tr>",
        escape(name),
        escape(value),
        escape(unit)
    );
}

/// What a run comes to, above its plots.
pub(super) fn circumstances(
    page: &mut String,
    headline: &str,
    rows: &[[String; 3]],
    stopped: Option<&Stopped>,
    warnings: &[String],
) {
    let _ = writeln!(page, "<p>{}</p>\n<table>", escape(headline));
    for [name, value, unit] in rows {
        row(page, [name, value, unit]);
    }
    page.push_str("</table>\n");
    if let Some(stopped) = stopped {
        let reason = escape(&stopped.reason);
        let _ = writeln!(
            page,
            "<p class=\"warning\"><strong>Partial: {reason}</strong></p>"
        );
    }
    self::warnings(page, warnings);
}

/// What may be meant but looks wrong.
pub(super) fn warnings(page: &mut String, warnings: &[String]) {
    for warning in warnings {
        let _ = writeln!(page, "<p class=\"warning\">{}</p>", escape(warning));
    }
}

/// Text in HTML.
pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
