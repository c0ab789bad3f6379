//! Turns names into positions: what is read, scaled and written at every communication point.

use super::Simulation;
use super::master::{Feed, Inputs, Member, Outputs};
use super::recording::{Column, Slot};
use crate::fmu::{Causality, Kind, Scalar, Signals, short};
use crate::input::connections::{Source, Tap, Wiring};
use crate::input::roles::Role;
use crate::input::setpoints::Table;
use crate::input::{Error, Pair, Side};
use std::collections::BTreeMap;

/// Everything a communication point needs. A row is `time`, `setpoint`, the driven inputs, outputs of the
/// plant, outputs of the controller.
pub(super) struct Plan {
    pub(super) columns: Vec<Column>,
    pub(super) roles: BTreeMap<Role, Slot>,
    /// The controller, then the plant.
    pub(super) members: Vec<Member>,
    pub(super) warnings: Vec<String>,
}

/// Position of the setpoint in a row.
pub(super) const SETPOINT: usize = 1;

/// The first step that begins at `time` \[s\] or later.
pub(crate) fn step_of(time: f64, step: f64) -> usize {
    (time / step - 1e-6).ceil().max(0.0) as usize
}

impl Plan {
    pub(super) fn new(
        pair: Pair<'_>,
        wiring: &Wiring,
        table: &Table,
        simulation: &Simulation,
    ) -> Result<Self, Error> {
        let mut columns = vec![
            Column::new("time", Some("s")),
            Column::new("setpoint", Some("rad")),
        ];
        for &(side, input) in &table.inputs {
            columns.push(column(pair, side, input));
        }
        let plant = outputs(pair, wiring, Side::Plant);
        let controller = outputs(pair, wiring, Side::Controller);
        let add = |columns: &mut Vec<Column>, side, scalars: &[Scalar]| {
            let first = columns.len();
            columns.extend(scalars.iter().map(|&s| column(pair, side, s)));
            Outputs {
                signals: Signals::new(pair.of(side), scalars),
                range: first..columns.len(),
            }
        };
        let plant_outputs = add(&mut columns, Side::Plant, &plant);
        let controller_outputs = add(&mut columns, Side::Controller, &controller);
        let slot = |tap: Tap| {
            let position = match tap.source {
                Source::Setpoint => Some(SETPOINT),
                Source::Output(Side::Plant, scalar) => plant
                    .iter()
                    .position(|s| *s == scalar)
                    .map(|p| p + plant_outputs.range.start),
                Source::Output(Side::Controller, scalar) => controller
                    .iter()
                    .position(|s| *s == scalar)
                    .map(|p| p + controller_outputs.range.start),
            };
            // `outputs` lists every source of the wiring.
            Slot::new(position.unwrap_or(SETPOINT), tap)
        };
        let inputs = |side| -> Result<Inputs, Error> {
            let mut scalars = Vec::new();
            let mut feeds = Vec::new();
            for connection in wiring.connections.iter().filter(|c| c.side == side) {
                scalars.push(connection.input);
                feeds.push(plain(slot(connection.tap)));
            }
            for (position, &(of, input)) in table.inputs.iter().enumerate() {
                if of != side {
                    continue;
                }
                if wiring.feeds(side, input) {
                    return Err(Error::TwoSources {
                        place: simulation.setpoints_place().or_line(1),
                        name: pair.name(side, input),
                    });
                }
                scalars.push(input);
                feeds.push(plain(Slot {
                    column: SETPOINT + 1 + position,
                    factor: 1.0,
                    offset: 0.0,
                }));
            }
            Ok(Inputs {
                signals: Signals::new(pair.of(side), &scalars),
                values: vec![0.0; scalars.len()],
                feeds,
            })
        };
        let end = table.rows.last().map_or(0.0, |row| row.time);
        let mut warnings = Vec::new();
        if let Some(until) = simulation.until
            && end >= until
        {
            warnings.push(format!(
                "setpoints go on to {} s, but the run ends at {until} s",
                short(end)
            ));
        }
        let roles = wiring
            .roles
            .iter()
            .map(|(role, tap)| (*role, slot(*tap)))
            .collect();
        let inputs = [inputs(Side::Controller)?, inputs(Side::Plant)?];
        let outputs = [controller_outputs, plant_outputs];
        let members = inputs.into_iter().zip(outputs).zip([true, false]);
        let member = |((inputs, outputs), leads)| Member {
            inputs,
            outputs,
            leads,
        };
        Ok(Self {
            columns,
            roles,
            members: members.map(member).collect(),
            warnings,
        })
    }
}

/// A value that is scaled only.
fn plain(slot: Slot) -> Feed {
    Feed {
        slot,
        map: Vec::new(),
    }
}

/// Every scalar output, then whatever else the wiring reads. Elements of arrays, which FMI 2.0 lists one by
/// one, are left out in both versions: there may be hundreds.
fn outputs(pair: Pair<'_>, wiring: &Wiring, side: Side) -> Vec<Scalar> {
    let description = pair.of(side);
    let mut scalars: Vec<_> = description
        .numeric_scalars(Causality::Output)
        .filter(|scalar| !description.variable(*scalar).name.ends_with(']'))
        .collect();
    let taps = wiring
        .connections
        .iter()
        .map(|c| &c.tap)
        .chain(wiring.roles.values());
    for tap in taps {
        if let Source::Output(of, scalar) = tap.source
            && of == side
            && !scalars.contains(&scalar)
        {
            scalars.push(scalar);
        }
    }
    scalars
}

fn column(pair: Pair<'_>, side: Side, scalar: Scalar) -> Column {
    let variable = pair.of(side).variable(scalar);
    let mut column = Column::new(pair.name(side, scalar), variable.unit.as_deref());
    if variable.kind == Kind::Enumeration {
        column.items = variable
            .items
            .iter()
            .map(|i| (i.value, i.name.clone()))
            .collect();
    }
    column
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_counted_in_spite_of_rounding() {
        for k in 0..100_000usize {
            assert_eq!(step_of(k as f64 * 0.000_25, 0.000_25), k);
        }
        assert_eq!(step_of(0.5, 1.0 / 60.0), 30);
        assert_eq!(step_of(0.000_26, 0.000_25), 2);
        assert_eq!(step_of(0.0, 0.1), 0);
    }
}
