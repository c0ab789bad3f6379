//! What a run leaves behind: a table of samples, and how the roles read from it.

use crate::input::connections::Tap;
use crate::input::roles::Role;
use std::collections::BTreeMap;

/// One column of the recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// `time`, `setpoint`, or a variable with its FMU, like `plant.angle`.
    pub name: String,
    /// Unit, if it is known.
    pub unit: Option<String>,
    /// Names of the items by value, for an enumeration.
    pub items: Vec<(i64, String)>,
}

impl Column {
    /// A column of numbers.
    pub fn new(name: impl Into<String>, unit: Option<&str>) -> Self {
        Self {
            name: name.into(),
            unit: unit.map(str::to_owned),
            items: Vec::new(),
        }
    }
}

/// A value of a row, scaled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slot {
    /// Column.
    pub column: usize,
    /// Factor.
    pub factor: f64,
    /// Offset.
    pub offset: f64,
}

impl Slot {
    pub(super) fn new(column: usize, tap: Tap) -> Self {
        Self {
            column,
            factor: tap.factor,
            offset: tap.offset,
        }
    }

    /// The value in a row.
    pub fn value(&self, row: &[f64]) -> f64 {
        self.factor * row[self.column] + self.offset
    }
}

/// Samples of a run. Row k holds the setpoint and the outputs of both FMUs at communication point k, from which on
/// the plant gets those of the controller. Where the controller steps first it made them of the same row; side by
/// side of the one before.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    columns: Vec<Column>,
    roles: BTreeMap<Role, Slot>,
    data: Vec<f64>,
}

impl Recording {
    /// An empty recording with room for `rows`; the columns begin with `time`.
    pub(crate) fn new(columns: Vec<Column>, roles: BTreeMap<Role, Slot>, rows: usize) -> Self {
        let data = Vec::with_capacity(rows * columns.len());
        Self {
            columns,
            roles,
            data,
        }
    }

    pub(crate) fn push(&mut self, row: &[f64]) {
        debug_assert_eq!(row.len(), self.columns.len());
        self.data.extend_from_slice(row);
    }

    /// The columns: `time`, `setpoint`, inputs that a file drives, outputs of the plant, of the controller.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// The rows.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        self.data.chunks_exact(self.columns.len().max(1))
    }

    /// Where a role reads from, if it is played.
    pub fn slot(&self, role: Role) -> Option<Slot> {
        self.roles.get(&role).copied()
    }

    /// The values of a column.
    pub fn column(&self, column: usize) -> Vec<f64> {
        self.rows().map(|row| row[column]).collect()
    }

    /// The values of a role, if it is played.
    pub fn role(&self, role: Role) -> Option<Vec<f64>> {
        let slot = self.slot(role)?;
        Some(self.rows().map(|row| slot.value(row)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roles_are_scaled_columns() {
        let columns = ["time", "setpoint", "plant.phi"]
            .map(|n| Column::new(n, None))
            .to_vec();
        let slot = Slot {
            column: 2,
            factor: 2.0,
            offset: 1.0,
        };
        let mut recording = Recording::new(columns, BTreeMap::from([(Role::Angle, slot)]), 2);
        recording.push(&[0.0, 1.0, 10.0]);
        recording.push(&[0.5, 1.0, 20.0]);
        assert_eq!(recording.rows().len(), 2);
        assert_eq!(recording.column(0), [0.0, 0.5]);
        assert_eq!(recording.role(Role::Angle), Some(vec![21.0, 41.0]));
        assert_eq!(recording.role(Role::Torque), None);
    }
}
