//! How the system structure of a controller with a plant looks: the setpoint at the left, the controller, the plant, the
//! outputs of the system at the right, the measured angle led back below (SSP 1.0 sec 5, lengths in mm).

use crate::Prepared;
use crate::fmu::{Causality, Description, Fmu, Scalar};
use crate::input::Side;
use crate::input::connections::{Source, Tap};
use crate::input::roles::Role;
use model_description::ssv::{self, Parameter, ParameterSet};
use model_description::xml::f64_text;
use std::collections::BTreeMap;

/// Width of the canvas.
pub(super) const WIDTH: f64 = 200.0;
/// Left edges of controller and plant, and their width.
pub(super) const LEFT: [f64; 2] = [40.0, 120.0];
pub(super) const BOX: f64 = 40.0;
/// Lower edge of both, what is left above them, and the distance of connectors.
pub(super) const LOWER: f64 = 40.0;
pub(super) const ABOVE: f64 = 25.0;
const PITCH: f64 = 8.0;

/// What is written.
pub(super) struct Drawing<'a> {
    pub name: &'a str,
    descriptions: [&'a Description; 2],
    pub sources: Vec<String>,
    pub prepared: &'a Prepared<'a>,
    pub step: f64,
    /// Parameter set of each component.
    pub parameters: [Option<String>; 2],
    /// File with the inputs over time.
    pub inputs: Option<String>,
    /// Parameter set with the values of the inputs at the start.
    pub start: Option<String>,
}

/// What an input of the system drives: an input of a component, scaled.
pub(super) type Driven = (Side, Scalar, Tap);

/// A connection as it is drawn.
pub(super) struct Line {
    /// Element and connector; none for the system itself.
    pub ends: [(Option<Side>, String); 2],
    pub tap: Tap,
    pub suppress: bool,
    pub points: Vec<(f64, f64)>,
}

impl<'a> Drawing<'a> {
    pub fn new(
        name: &'a str,
        fmus: &'a [Fmu; 2],
        sources: Vec<String>,
        prepared: &'a Prepared<'a>,
        step: f64,
    ) -> Self {
        Self {
            name,
            descriptions: [fmus[0].description(), fmus[1].description()],
            sources,
            prepared,
            step,
            parameters: [None, None],
            inputs: None,
            start: None,
        }
    }

    /// Attributes of the `BaseUnit` of a unit, if either FMU defines it.
    pub fn base_unit(&self, unit: &str) -> Option<&BTreeMap<String, String>> {
        let descriptions = self.descriptions.iter().rev();
        descriptions.filter_map(|d| d.units.get(unit)).next()
    }

    pub fn description(&self, side: Side) -> &'a Description {
        self.descriptions[side as usize]
    }

    /// Inputs of the system: their names and what they drive. The setpoint may drive several.
    pub fn outside(&self) -> Vec<(String, Vec<Driven>)> {
        let connections = &self.prepared.wiring().connections;
        let setpoint = connections
            .iter()
            .filter(|c| c.tap.source == Source::Setpoint);
        let setpoint: Vec<_> = setpoint.map(|c| (c.side, c.input, c.tap)).collect();
        let mut outside = Vec::new();
        if !setpoint.is_empty() {
            outside.push(("setpoint".to_owned(), setpoint));
        }
        for &(side, input) in self.prepared.table().map_or(&[][..], |table| &table.inputs) {
            let bare = self.description(side).name_of(input);
            let taken = outside.iter().any(|(name, _)| *name == bare);
            let name = if taken {
                format!("{side}.{bare}")
            } else {
                bare
            };
            outside.push((name, vec![(side, input, Tap::plain(Source::Setpoint))]));
        }
        outside
    }

    /// The inputs over time as CSV; none without setpoints.
    pub fn inputs_over_time(&self) -> Option<String> {
        let table = self.prepared.table()?;
        let mut csv = "time".to_owned();
        for (name, _) in self.outside() {
            csv += &format!(",{name}");
        }
        // A setpoint that is connected to nothing has no column.
        let first = usize::from(self.outside().len() == table.inputs.len());
        for row in &table.rows {
            csv += &format!("\n{}", f64_text(row.time));
            for value in &row.values[first..] {
                csv += &format!(",{}", f64_text(*value));
            }
        }
        csv.push('\n');
        Some(csv)
    }

    /// The values of the inputs at the start: for tools that know no inputs over time, and where there are none.
    pub fn start_values(&self) -> Option<ParameterSet> {
        let outside = self.outside();
        let values: Vec<f64> = match self.prepared.table() {
            Some(table) => {
                let first = usize::from(outside.len() == table.inputs.len());
                table.rows.first()?.values[first..].to_vec()
            }
            None => {
                let values = self.prepared.values();
                let pair = self.prepared.pair();
                vec![values.number(pair, Side::Plant, "initial.angle")?]
            }
        };
        let parameter = |((name, _), value): (&(String, _), f64)| Parameter {
            name: name.clone(),
            value: ssv::Value::Real(value),
            unit: None,
            line: 0,
        };
        Some(ParameterSet {
            name: format!("{}, inputs at the start", self.name),
            parameters: outside.iter().zip(values).map(parameter).collect(),
            ..ParameterSet::default()
        })
    }

    /// Inputs of a component from the top: those from outside, then those from the other component.
    pub fn inputs(&self, side: Side) -> Vec<Scalar> {
        let outside = self.outside();
        let mut inputs: Vec<_> = outside
            .iter()
            .flat_map(|(_, targets)| targets.iter())
            .filter(|(of, ..)| *of == side)
            .map(|(_, input, _)| *input)
            .collect();
        let connections = self.prepared.wiring().connections.iter();
        let from_other = connections.filter(|c| c.side == side && c.tap.source != Source::Setpoint);
        inputs.extend(from_other.map(|c| c.input));
        inputs
    }

    /// Outputs of a component from the top: those that are connected or lead out of the system, then the
    /// other scalar ones.
    pub fn outputs(&self, side: Side) -> Vec<Scalar> {
        let wiring = self.prepared.wiring();
        let connected = wiring.connections.iter().map(|c| c.tap);
        let leading_out = self.results();
        let mut outputs = Vec::new();
        let mut add = |scalar| {
            if !outputs.contains(&scalar) {
                outputs.push(scalar);
            }
        };
        for tap in connected.chain(leading_out.iter().map(|(_, tap)| *tap)) {
            if let Source::Output(of, scalar) = tap.source
                && of == side
            {
                add(scalar);
            }
        }
        let description = self.description(side);
        description
            .numeric_scalars(Causality::Output)
            .filter(|scalar| !description.variable(*scalar).name.ends_with(']'))
            .for_each(add);
        outputs
    }

    /// Outputs of the system: angle and torque.
    pub fn results(&self) -> Vec<(String, Tap)> {
        let roles = &self.prepared.wiring().roles;
        let known = [("angle", Role::Angle), ("torque", Role::Torque)];
        let result = |(name, role): (&str, Role)| Some((name.to_owned(), *roles.get(&role)?));
        let results = known.into_iter().filter_map(result);
        results
            .filter(|(_, tap)| matches!(tap.source, Source::Output(..)))
            .collect()
    }

    pub fn height(&self) -> f64 {
        let count = |side| self.inputs(side).len().max(self.outputs(side).len());
        PITCH * (1 + count(Side::Controller).max(count(Side::Plant))) as f64
    }

    /// Height of the n-th connector from the top.
    pub fn level(&self, position: usize) -> f64 {
        LOWER + self.height() - PITCH * (position + 1) as f64
    }

    pub fn place(&self, side: Side, scalar: Scalar, inward: bool) -> (f64, f64) {
        let all = if inward {
            self.inputs(side)
        } else {
            self.outputs(side)
        };
        let position = all.iter().position(|s| *s == scalar).unwrap_or(0);
        let x = LEFT[side as usize] + if inward { 0.0 } else { BOX };
        (x, self.level(position))
    }

    /// All connections; those from outside come first.
    pub fn lines(&self) -> Vec<Line> {
        let mut lines = Vec::new();
        for (index, (name, targets)) in self.outside().into_iter().enumerate() {
            let level = self.outside_level(index);
            for (side, input, tap) in targets {
                let (x, y) = self.place(side, input, true);
                let bend = x - 5.0 - 3.0 * index as f64;
                lines.push(Line {
                    ends: [
                        (None, name.clone()),
                        (Some(side), self.description(side).name_of(input)),
                    ],
                    tap,
                    suppress: false,
                    points: bent(level, bend, y),
                });
            }
        }
        let mut below = 0;
        for connection in &self.prepared.wiring().connections {
            let Source::Output(from, output) = connection.tap.source else {
                continue;
            };
            let (x, y) = self.place(from, output, false);
            let (to_x, to_y) = self.place(connection.side, connection.input, true);
            let points = if x < to_x {
                bent(y, (x + to_x) / 2.0, to_y)
            } else {
                let (right, left) = (
                    x + 6.0 + 3.0 * f64::from(below),
                    to_x - 6.0 - 3.0 * f64::from(below),
                );
                let low = LOWER - 12.0 - 4.0 * f64::from(below);
                below += 1;
                vec![(right, y), (right, low), (left, low), (left, to_y)]
            };
            let unit = |side, scalar| self.description(side).variable(scalar).unit.as_deref();
            lines.push(Line {
                ends: [
                    (Some(from), self.description(from).name_of(output)),
                    (
                        Some(connection.side),
                        self.description(connection.side).name_of(connection.input),
                    ),
                ],
                tap: connection.tap,
                // The factor of a connections file is the whole conversion.
                suppress: unit(from, output) != unit(connection.side, connection.input),
                points,
            });
        }
        for (index, (name, tap)) in self.results().into_iter().enumerate() {
            let Source::Output(side, output) = tap.source else {
                continue;
            };
            let (x, y) = self.place(side, output, false);
            let level = self.result_level(index);
            let points = match side {
                Side::Plant => bent(y, x + 15.0 + 3.0 * index as f64, level),
                Side::Controller => {
                    let bend = x + 6.0;
                    vec![(bend, y), (bend, level)]
                }
            };
            lines.push(Line {
                ends: [
                    (Some(side), self.description(side).name_of(output)),
                    (None, name),
                ],
                tap,
                suppress: tap != Tap::plain(tap.source),
                points,
            });
        }
        lines
    }

    /// Height at which an input of the system is: the setpoint beside the controller, others above.
    pub fn outside_level(&self, index: usize) -> f64 {
        match index {
            0 => self.level(0),
            index => LOWER + self.height() + 6.0 * index as f64,
        }
    }

    /// Height at which an output of the system is: the first beside the plant, others below.
    pub fn result_level(&self, index: usize) -> f64 {
        match index {
            0 => self.level(0),
            index => 10.0 * index as f64,
        }
    }
}

/// A horizontal line with a step, unless it needs none.
fn bent(from: f64, bend: f64, to: f64) -> Vec<(f64, f64)> {
    if from == to {
        return Vec::new();
    }
    vec![(bend, from), (bend, to)]
}
