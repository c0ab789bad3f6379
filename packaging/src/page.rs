//! `documentation/index.html`: one page for people, made from the contract and the texts in `assets/`.

mod table;

use crate::workspace::Workspace;
use model_description::ModelDescription;

/// The page of a unit. `plot` is the SVG of a run, or empty. The page needs no other file and no network.
pub fn write(
    workspace: &Workspace,
    description: &ModelDescription,
    art: &str,
    plot: &str,
) -> Result<String, String> {
    let asset = |name: &str| workspace.read(&format!("packaging/assets/{name}"));
    let interfaces: Vec<_> = [
        (&description.co_simulation, "Co-Simulation"),
        (&description.model_exchange, "Model Exchange"),
        (
            &description.scheduled_execution,
            "Scheduled Execution (FMI 3.0)",
        ),
    ]
    .into_iter()
    .filter_map(|(interface, name)| interface.as_ref().map(|_| name))
    .collect();
    let figure = if plot.is_empty() {
        String::new()
    } else {
        asset("run.html")?.replace("{{svg}}", plot)
    };
    let values = [
        ("style", asset("page.css")?),
        ("icon", asset(&format!("{art}.svg"))?),
        ("body", asset(&format!("{art}.html"))?),
        ("connect", asset("connect.html")?),
        ("plot", figure),
        ("variables", table::variables(description)),
        ("log", table::log_categories(description)),
        ("name", escape(&description.name)),
        ("description", escape(&description.description)),
        ("version", escape(&description.version)),
        ("license", escape(&description.license)),
        ("token", escape(&description.token)),
        ("interfaces", interfaces.join(", ")),
    ];
    let mut page = asset("page.html")?;
    for (key, value) in values {
        page = page.replace(&format!("{{{{{key}}}}}"), value.trim_end());
    }
    Ok(page)
}

/// Text for HTML.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
