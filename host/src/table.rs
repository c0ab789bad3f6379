//! Tables for the terminal.

use comfy_table::presets::UTF8_BORDERS_ONLY;
use comfy_table::{CellAlignment, Table};

/// Name, value and unit of quantities.
pub fn quantities(rows: Vec<[String; 3]>) -> Table {
    let mut table = aligned(["quantity", "value", "unit"], [1]);
    table.add_rows(rows);
    table
}

/// An empty table; the columns at `numbers` are aligned to the right.
pub fn aligned(
    header: impl IntoIterator<Item = impl Into<String>>,
    numbers: impl IntoIterator<Item = usize>,
) -> Table {
    let header: Vec<String> = header.into_iter().map(Into::into).collect();
    let mut table = Table::new();
    table.load_style(UTF8_BORDERS_ONLY).set_header(header);
    for index in numbers {
        if let Some(column) = table.column_mut(index) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table
}
