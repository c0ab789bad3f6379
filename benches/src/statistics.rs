//! Order statistics of measured durations.

use std::time::{Duration, Instant};

use comfy_table::{CellAlignment, Table, presets};

/// Measured durations, sorted.
pub struct Durations(Vec<Duration>);

impl Durations {
    /// Of at least one duration.
    pub fn new(mut durations: Vec<Duration>) -> Self {
        assert!(!durations.is_empty(), "nothing was measured");
        durations.sort_unstable();
        Self(durations)
    }

    /// The duration that a share of all does not exceed.
    pub fn quantile(&self, share: f64) -> Duration {
        let last = self.0.len() - 1;
        self.0[(share * last as f64).round() as usize]
    }

    /// Median, 99th percentile and maximum, as text.
    pub fn row(&self) -> String {
        [0.5, 0.99, 1.0]
            .map(|share| format!("{:>10}", text(self.quantile(share))))
            .join(" ")
    }
}

/// How long `work` takes.
pub fn time<T>(work: impl FnOnce() -> T) -> (Duration, T) {
    let start = Instant::now();
    let result = work();
    (start.elapsed(), result)
}

/// A duration with three digits in a fitting unit.
pub fn text(duration: Duration) -> String {
    let seconds = duration.as_secs_f64();
    match seconds {
        s if s >= 1.0 => format!("{s:.2} s"),
        s if s >= 1e-3 => format!("{:.2} ms", s * 1e3),
        s if s >= 1e-6 => format!("{:.2} us", s * 1e6),
        s => format!("{:.0} ns", s * 1e9),
    }
}

/// Rows of equal length as text: the columns `left` aligned left, all others right.
pub fn aligned(rows: &[Vec<String>], left: &[usize]) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING).add_rows(rows);
    for (index, column) in table.column_iter_mut().enumerate() {
        if !left.contains(&index) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table.trim_fmt()
}
