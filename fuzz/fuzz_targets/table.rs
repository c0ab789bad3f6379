//! CSV files: setpoints and measurements.
#![no_main]

use host::input::measurement::{self, Options};
use host::input::setpoints::Table;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let file = fuzz::file("some.csv", bytes);
    if let Some(table) = fuzz::judge(Table::read(&file, fuzz::pair(), None)) {
        assert!(
            table
                .rows
                .iter()
                .all(|row| row.values.iter().all(|value| value.is_finite()))
        );
        let _ = (table.duration(), table.first_change());
    }
    if let Some((_, signals)) = fuzz::judge(measurement::read(&file, &Options::default())) {
        assert!(
            signals
                .angle
                .iter()
                .chain(&signals.torque)
                .all(|value| value.is_finite())
        );
    }
});
