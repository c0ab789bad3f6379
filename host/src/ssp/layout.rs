//! Turns connections into positions: what is read, transformed and written at every communication point.

use super::document::{Kind, Type};
use super::inputs::Table;
use super::order::Link;
use super::parameters::Values;
use super::wiring::{Owner, Wiring};
use crate::fmu::{Scalar, Signals};
use crate::input::setpoints::Row;
use crate::run::master::{Feed, Inputs, Member, Outputs};
use crate::run::plan::step_of;
use crate::run::recording::{Column, Recording, Slot};
use std::collections::BTreeMap;

/// Where in a row everything is.
pub(super) struct Layout {
    pub columns: Vec<Column>,
    /// Inputs of the system in the order of their columns, from 1, with the values at the start.
    outside: Vec<(usize, f64)>,
    /// Column of each point that has one.
    column_of: BTreeMap<usize, usize>,
    /// Outputs of each component: points in the order of their columns.
    outputs: Vec<Vec<usize>>,
    /// Inputs of each component with what feeds them.
    inputs: Vec<Vec<(Scalar, Feed)>>,
    pub links: Vec<Link>,
    /// Outputs of the system that are no other column as it is.
    pub derived: Vec<(Column, Feed)>,
}

impl Layout {
    pub fn new(wiring: &Wiring, values: &Values, table: &Table) -> Self {
        let mut layout = Self {
            columns: vec![Column::new("time", Some("s"))],
            outside: Vec::new(),
            column_of: BTreeMap::new(),
            outputs: vec![Vec::new(); wiring.parts.len()],
            inputs: vec![Vec::new(); wiring.parts.len()],
            links: Vec::new(),
            derived: Vec::new(),
        };
        let column = |point: usize| {
            let of = &wiring.points[point];
            let mut column = Column::new(&of.path, of.unit.as_ref().map(|unit| unit.name.as_str()));
            if let Owner::Part(part, scalar) = of.owner {
                let items = &wiring.parts[part].description().variable(scalar).items;
                column.items = items.iter().map(|i| (i.value, i.name.clone())).collect();
            }
            column
        };
        let is_number = |point: usize| !matches!(wiring.points[point].signal, Some(Type::Other(_)));
        for (point, of) in wiring.points.iter().enumerate() {
            if of.owner != Owner::Root || of.kind != Kind::Input {
                continue;
            }
            let value = values.connectors.get(&point).map(|(value, _)| *value);
            if value.is_some() || table.names.contains(&of.path) {
                layout.column_of.insert(point, layout.columns.len());
                layout.outside.push((point, value.unwrap_or(0.0)));
                layout.columns.push(column(point));
            }
        }
        for (point, of) in wiring.points.iter().enumerate() {
            if let Owner::Part(part, _) = of.owner
                && !of.kind.is_inward()
                && is_number(point)
            {
                layout.outputs[part].push(point);
            }
        }
        // Those of a component stand side by side, as they are read.
        for points in &layout.outputs {
            for &point in points {
                layout.column_of.insert(point, layout.columns.len());
                layout.columns.push(column(point));
            }
        }
        for (target, of) in wiring.points.iter().enumerate() {
            // Circles were refused when the wiring was made.
            let Ok(Some(origin)) = wiring.origin(target) else {
                continue;
            };
            let Some(&from) = layout.column_of.get(&origin.point) else {
                continue;
            };
            let feed = Feed {
                slot: Slot {
                    column: from,
                    factor: origin.transformation.factor,
                    offset: origin.transformation.offset,
                },
                map: origin.transformation.map.clone(),
            };
            match of.owner {
                Owner::Part(part, scalar) if of.kind == Kind::Input => {
                    layout.inputs[part].push((scalar, feed));
                    if let Owner::Part(other, output) = wiring.points[origin.point].owner {
                        layout.links.push(Link {
                            from: other,
                            output,
                            to: part,
                            input: scalar,
                            line: origin.line,
                        });
                    }
                }
                Owner::Root if !of.kind.is_inward() && !origin.transformation.is_identity() => {
                    layout.derived.push((column(target), feed));
                }
                _ => {}
            }
        }
        layout
    }

    pub fn members(&self, wiring: &Wiring, order: &[usize]) -> Vec<Member> {
        let mut members = Vec::new();
        for (place, &part) in order.iter().enumerate() {
            let description = wiring.parts[part].description();
            let inputs = &self.inputs[part];
            let scalars: Vec<_> = inputs.iter().map(|(scalar, _)| *scalar).collect();
            let scalar = |&point: &usize| match wiring.points[point].owner {
                Owner::Part(_, scalar) => Some(scalar),
                _ => None,
            };
            let outputs: Vec<_> = self.outputs[part].iter().filter_map(scalar).collect();
            let first = self.outputs[part]
                .first()
                .and_then(|p| self.column_of.get(p));
            let first = first.copied().unwrap_or(0);
            let later = &order[place + 1..];
            members.push(Member {
                inputs: Inputs {
                    signals: Signals::new(description, &scalars),
                    feeds: inputs.iter().map(|(_, feed)| feed.clone()).collect(),
                    values: vec![0.0; inputs.len()],
                },
                outputs: Outputs {
                    signals: Signals::new(description, &outputs),
                    range: first..first + outputs.len(),
                },
                leads: self
                    .links
                    .iter()
                    .any(|l| l.from == part && later.contains(&l.to)),
            });
        }
        members
    }

    /// First step and values of each change of the inputs of the system.
    pub fn schedule(&self, table: &Table, start: f64, step: f64) -> Vec<(usize, Vec<f64>)> {
        let constant: Vec<_> = self.outside.iter().map(|(_, value)| *value).collect();
        let mut schedule = vec![(0, constant.clone())];
        let position = |name: &String| {
            let name_of = |point: &usize| &self.columns[self.column_of[point]].name;
            let mut outside = self.outside.iter();
            outside.position(|(point, _)| name_of(point) == name)
        };
        let positions: Vec<_> = table.names.iter().map(position).collect();
        for Row { time, values } in &table.rows {
            let mut row = constant.clone();
            for (position, value) in positions.iter().zip(values) {
                if let Some(position) = position {
                    row[*position] = *value;
                }
            }
            schedule.push((step_of(time - start, step), row));
        }
        schedule
    }

    /// Columns that take part in a connection, and those that are made of them.
    pub fn connected(&self) -> Vec<usize> {
        let feeds = self.inputs.iter().flatten().map(|(_, feed)| feed);
        let feeds = feeds.chain(self.derived.iter().map(|(_, feed)| feed));
        let mut connected: Vec<_> = feeds.map(|feed| feed.slot.column).collect();
        connected.extend(self.columns.len()..self.columns.len() + self.derived.len());
        connected.sort_unstable();
        connected.dedup();
        connected
    }

    /// The recording with the outputs of the system.
    pub fn derive(&self, recording: Recording) -> Recording {
        if self.derived.is_empty() {
            return recording;
        }
        let mut columns = recording.columns().to_vec();
        columns.extend(self.derived.iter().map(|(column, _)| column.clone()));
        let rows = recording.rows();
        let mut whole = Recording::new(columns, BTreeMap::new(), rows.len());
        for row in rows {
            let mut row = row.to_vec();
            for (_, feed) in &self.derived {
                row.push(feed.value(&row).unwrap_or(f64::NAN));
            }
            whole.push(&row);
        }
        whole
    }
}
