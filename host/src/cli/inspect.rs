//! `flexarm inspect`.

use clap::Args;
use comfy_table::presets::UTF8_BORDERS_ONLY;
use comfy_table::{ContentArrangement, Table};
use host::Error;
use host::fmu::{Causality, Description, Fmu, Variable, short};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  flexarm inspect FlexArmController.fmu
  flexarm inspect Vendor.fmu --all";

/// Shows what an FMU is: interfaces, platforms, capabilities, variables.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Arguments {
    /// The FMU.
    fmu: PathBuf,
    /// Shows local and calculated variables too.
    #[arg(long)]
    all: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Error> {
    let fmu = Fmu::open(&arguments.fmu)?;
    let description = fmu.description();
    // Formatting to a String cannot fail.
    let mut text = format!("{}\n{}\n\n", facts(&fmu).trim_fmt(), counts(description));
    let mut groups = vec![
        ("Structural parameters", Causality::StructuralParameter),
        ("Parameters", Causality::Parameter),
        ("Inputs", Causality::Input),
        ("Outputs", Causality::Output),
    ];
    if arguments.all {
        groups.extend([
            ("Calculated parameters", Causality::CalculatedParameter),
            ("Local variables", Causality::Local),
            ("Independent variable", Causality::Independent),
        ]);
    }
    for (title, causality) in groups {
        let mut variables = description
            .variables
            .iter()
            .filter(|v| v.causality == causality)
            .peekable();
        if variables.peek().is_some() {
            let _ = write!(
                text,
                "{title}\n{}\n\n",
                table(description, variables).trim_fmt()
            );
        }
    }
    if !description.problems.is_empty() {
        let _ = writeln!(text, "Problems in modelDescription.xml");
        for problem in &description.problems {
            let _ = writeln!(text, "  {problem}");
        }
    }
    super::print(&text)
}

fn facts(fmu: &Fmu) -> Table {
    let d = fmu.description();
    let mut interfaces = Vec::new();
    let mut capabilities = Vec::new();
    if let Some(c) = &d.co_simulation {
        interfaces.push("Co-Simulation");
        let flags = [
            (c.can_handle_variable_step, "variable communication step"),
            (c.can_get_and_set_state, "get and set state"),
            (c.can_serialize_state, "serialize state"),
            (c.has_event_mode, "event mode"),
            (c.needs_execution_tool, "needs its execution tool"),
            (
                c.can_be_instantiated_only_once_per_process,
                "only one instance per process",
            ),
        ];
        capabilities.extend(flags.iter().filter(|(has, _)| *has).map(|(_, name)| *name));
    }
    if d.model_exchange {
        interfaces.push("Model Exchange");
    }
    if d.scheduled_execution {
        interfaces.push("Scheduled Execution");
    }
    let e = &d.default_experiment;
    let times = [
        ("start", e.start_time),
        ("stop", e.stop_time),
        ("step", e.step_size),
    ];
    let experiment: Vec<_> = times
        .iter()
        .filter_map(|(name, time)| time.map(|t| format!("{name} {t} s")))
        .collect();
    let mut table = plain_table();
    for (name, value) in [
        ("model", d.model_name.clone()),
        ("description", d.description.clone()),
        ("version", d.model_version.clone()),
        ("author", d.author.clone()),
        ("licence", d.license.clone()),
        (
            "made by",
            format!("{} {}", d.generation_tool, d.generation_date)
                .trim()
                .to_owned(),
        ),
        ("FMI version", d.fmi_version.clone()),
        ("token", d.token.clone()),
        ("interfaces", interfaces.join(", ")),
        ("platforms", fmu.platforms().join(", ")),
        ("capabilities", capabilities.join(", ")),
        ("default experiment", experiment.join(", ")),
        ("log categories", d.log_categories.join(", ")),
    ] {
        if !value.is_empty() {
            table.add_row([name.to_owned(), value]);
        }
    }
    table
}

fn counts(description: &Description) -> String {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for variable in &description.variables {
        *counts.entry(variable.causality.to_string()).or_default() += 1;
    }
    let parts: Vec<_> = counts
        .iter()
        .map(|(name, count)| format!("{count} {name}{}", if *count == 1 { "" } else { "s" }))
        .collect();
    format!(
        "{} variables: {}",
        description.variables.len(),
        parts.join(", ")
    )
}

fn table<'a>(d: &Description, variables: impl Iterator<Item = &'a Variable>) -> Table {
    let mut table = plain_table();
    table.set_header(["name", "type", "unit", "start", "range", "description"]);
    for v in variables {
        let sizes = v.dimensions.iter().zip(&v.sized_by);
        let size: String = sizes.map(|(n, by)| dimension(d, *n, *by)).collect();
        let mut start = v.start.join(" ");
        let mut range = match (v.min, v.max) {
            (None, None) => String::new(),
            (min, max) => {
                let bound = |b: Option<f64>| b.map_or(String::new(), short);
                format!("{} .. {}", bound(min), bound(max))
            }
        };
        if !v.items.is_empty() {
            let items: Vec<_> = v.items.iter().map(|i| i.name.as_str()).collect();
            range = items.join(", ");
            let item = v.items.iter().find(|i| start.parse() == Ok(i.value));
            start = item.map_or(start, |i| i.name.clone());
        }
        table.add_row([
            format!("{}{size}", v.name),
            v.kind.to_string(),
            v.unit.clone().unwrap_or_default(),
            start,
            range,
            v.description.clone(),
        ]);
    }
    table
}

/// A dimension: its structural parameter, or else the number of elements.
fn dimension(d: &Description, size: usize, by: Option<u32>) -> String {
    let mut variables = d.variables.iter();
    match by.and_then(|by| variables.find(|v| v.reference == by)) {
        Some(parameter) => format!("[{}]", parameter.name),
        None => format!("[{size}]"),
    }
}

fn plain_table() -> Table {
    let mut table = Table::new();
    table
        .load_style(UTF8_BORDERS_ONLY)
        .set_content_arrangement(ContentArrangement::Dynamic);
    table
}
