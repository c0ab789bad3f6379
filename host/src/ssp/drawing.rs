//! The `.ssd` of a controller with a plant, drawn: the setpoint at the left, the controller, the plant, the
//! outputs of the system at the right, the measured angle led back below (SSP 1.0 sec 5, lengths in mm).

use super::read::{INPUTS, OPENMODELICA, SSC, SSD};
use crate::Prepared;
use crate::fmu::{Causality, Description, Fmu, Kind, Scalar};
use crate::input::Side;
use crate::input::connections::{Source, Tap};
use crate::input::roles::Role;
use model_description::ssv::{self, Parameter, ParameterSet};
use model_description::xml::{escape, f64_text};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::fs;

/// Namespace that OMSimulator expects of its annotations.
const OMS: &str =
    "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd";
/// Width of the canvas.
const WIDTH: f64 = 200.0;
/// Left edges of controller and plant, and their width.
const LEFT: [f64; 2] = [40.0, 120.0];
const BOX: f64 = 40.0;
/// Lower edge of both, what is left above them, and the distance of connectors.
const LOWER: f64 = 40.0;
const ABOVE: f64 = 25.0;
const PITCH: f64 = 8.0;

/// The names of both components.
const NAMES: [&str; 2] = ["controller", "plant"];

/// What is written.
pub(super) struct Drawing<'a> {
    name: &'a str,
    descriptions: [&'a Description; 2],
    sources: Vec<String>,
    prepared: &'a Prepared<'a>,
    step: f64,
    /// Attributes of the `BaseUnit` of each unit that either FMU defines.
    units: BTreeMap<String, BTreeMap<String, String>>,
    /// Parameter set of each component.
    pub parameters: [Option<String>; 2],
    /// File with the inputs over time.
    pub inputs: Option<String>,
    /// Parameter set with the values of the inputs at the start.
    pub start: Option<String>,
}

/// A connection as it is drawn.
struct Line {
    /// Element and connector; none for the system itself.
    ends: [(Option<Side>, String); 2],
    tap: Tap,
    suppress: bool,
    points: Vec<(f64, f64)>,
}

impl<'a> Drawing<'a> {
    pub fn new(
        name: &'a str,
        fmus: &'a [Fmu; 2],
        sources: Vec<String>,
        prepared: &'a Prepared<'a>,
        step: f64,
    ) -> Self {
        let mut units = BTreeMap::new();
        for fmu in fmus {
            let text = fs::read_to_string(fmu.folder().join("modelDescription.xml"));
            units.extend(base_units(&text.unwrap_or_default()));
        }
        Self {
            name,
            descriptions: [fmus[0].description(), fmus[1].description()],
            sources,
            prepared,
            step,
            units,
            parameters: [None, None],
            inputs: None,
            start: None,
        }
    }

    /// Attributes of the `BaseUnit` of a unit, if either FMU defines it.
    pub fn base_unit(&self, unit: &str) -> Option<&BTreeMap<String, String>> {
        self.units.get(unit)
    }

    fn description(&self, side: Side) -> &'a Description {
        self.descriptions[side as usize]
    }

    /// Inputs of the system: their names and what they drive. The setpoint may drive several.
    fn outside(&self) -> Vec<(String, Vec<(Side, Scalar, Tap)>)> {
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
    fn inputs(&self, side: Side) -> Vec<Scalar> {
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
    fn outputs(&self, side: Side) -> Vec<Scalar> {
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
    fn results(&self) -> Vec<(String, Tap)> {
        let roles = &self.prepared.wiring().roles;
        let known = [("angle", Role::Angle), ("torque", Role::Torque)];
        let result = |(name, role): (&str, Role)| Some((name.to_owned(), *roles.get(&role)?));
        let results = known.into_iter().filter_map(result);
        results
            .filter(|(_, tap)| matches!(tap.source, Source::Output(..)))
            .collect()
    }

    fn height(&self) -> f64 {
        let count = |side| self.inputs(side).len().max(self.outputs(side).len());
        PITCH * (1 + count(Side::Controller).max(count(Side::Plant))) as f64
    }

    /// Height of the n-th connector from the top.
    fn level(&self, position: usize) -> f64 {
        LOWER + self.height() - PITCH * (position + 1) as f64
    }

    fn place(&self, side: Side, scalar: Scalar, inward: bool) -> (f64, f64) {
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
    fn lines(&self) -> Vec<Line> {
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
    fn outside_level(&self, index: usize) -> f64 {
        match index {
            0 => self.level(0),
            index => LOWER + self.height() + 6.0 * index as f64,
        }
    }

    /// Height at which an output of the system is: the first beside the plant, others below.
    fn result_level(&self, index: usize) -> f64 {
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

/// Attributes of the `BaseUnit` of each unit, by name.
fn base_units(text: &str) -> BTreeMap<String, BTreeMap<String, String>> {
    let Ok(document) = roxmltree::Document::parse(text.trim_start_matches('\u{feff}')) else {
        return BTreeMap::new();
    };
    let units = document.descendants().filter(|n| n.has_tag_name("Unit"));
    let unit = |node: roxmltree::Node<'_, '_>| {
        let base = node.children().find(|c| c.has_tag_name("BaseUnit"))?;
        let pair = |a: roxmltree::Attribute<'_, '_>| (a.name().to_owned(), a.value().to_owned());
        let attributes = base.attributes().map(pair).collect();
        Some((node.attribute("name")?.to_owned(), attributes))
    };
    units.filter_map(unit).collect()
}

/// The file.
pub(super) fn write(drawing: &Drawing<'_>) -> String {
    let mut writer = Writer {
        drawing,
        out: String::new(),
        units: BTreeSet::new(),
        enumerations: BTreeMap::new(),
    };
    writer.root();
    writer.out
}

struct Writer<'a> {
    drawing: &'a Drawing<'a>,
    out: String,
    units: BTreeSet<String>,
    enumerations: BTreeMap<String, Vec<(String, i64)>>,
}

/// Writes a line; formatting to a String cannot fail.
macro_rules! line {
    ($writer:ident, $($arguments:tt)*) => {{
        let _ = writeln!($writer.out, $($arguments)*);
    }};
}

impl Writer<'_> {
    fn root(&mut self) {
        let d = self.drawing;
        let height = LOWER + d.height() + ABOVE;
        line!(self, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>");
        line!(
            self,
            "<ssd:SystemStructureDescription version=\"1.0\" name=\"{}\" generationTool=\"flexarm\"\n    \
             xmlns:ssd=\"{SSD}\"\n    xmlns:ssc=\"{SSC}\"\n    xmlns:oms=\"{OMS}\">",
            escape(d.name)
        );
        line!(self, "  <ssd:System name=\"root\">");
        line!(self, "    <ssd:Connectors>");
        for (index, (name, targets)) in d.outside().iter().enumerate() {
            let (side, input, _) = targets[0];
            let y = d.outside_level(index) / height;
            self.connector("      ", name, "input", (side, input), (0.0, y));
        }
        for (index, (name, tap)) in d.results().iter().enumerate() {
            if let Source::Output(side, output) = tap.source {
                let y = d.result_level(index) / height;
                self.connector("      ", name, "output", (side, output), (1.0, y));
            }
        }
        line!(self, "    </ssd:Connectors>");
        self.binding("    ", d.start.as_ref());
        line!(self, "    <ssd:Elements>");
        for side in [Side::Controller, Side::Plant] {
            self.component(side);
        }
        line!(self, "    </ssd:Elements>");
        line!(self, "    <ssd:Connections>");
        for drawn in d.lines() {
            self.connection(&drawn);
        }
        line!(self, "    </ssd:Connections>");
        line!(
            self,
            "    <ssd:SystemGeometry x1=\"0\" y1=\"0\" x2=\"{WIDTH}\" y2=\"{height}\"/>"
        );
        // OMSimulator keeps the step of its master here.
        let step = f64_text(d.step);
        line!(
            self,
            "    <ssd:Annotations>\n      <ssc:Annotation type=\"{OPENMODELICA}\">\n        <oms:Annotations>\n          \
             <oms:SimulationInformation>\n            <oms:FixedStepMaster description=\"oms-ma\" stepSize=\"{step}\" \
             absoluteTolerance=\"0.0001\" relativeTolerance=\"0.0001\"/>\n          </oms:SimulationInformation>\n        \
             </oms:Annotations>\n      </ssc:Annotation>\n    </ssd:Annotations>"
        );
        line!(self, "  </ssd:System>");
        self.definitions();
        let stop = f64_text(d.prepared.duration());
        match &d.inputs {
            None => line!(
                self,
                "  <ssd:DefaultExperiment startTime=\"0\" stopTime=\"{stop}\"/>"
            ),
            Some(path) => line!(
                self,
                "  <ssd:DefaultExperiment startTime=\"0\" stopTime=\"{stop}\">\n    <ssd:Annotations>\n      \
                 <ssc:Annotation type=\"{INPUTS}\"><Inputs xmlns=\"\" source=\"{}\"/></ssc:Annotation>\n    \
                 </ssd:Annotations>\n  </ssd:DefaultExperiment>",
                escape(path)
            ),
        }
        line!(self, "</ssd:SystemStructureDescription>");
    }

    fn component(&mut self, side: Side) {
        let d = self.drawing;
        let (name, source) = (NAMES[side as usize], &d.sources[side as usize]);
        line!(
            self,
            "      <ssd:Component name=\"{name}\" type=\"application/x-fmu-sharedlibrary\" source=\"{}\">",
            escape(source)
        );
        line!(self, "        <ssd:Connectors>");
        let description = d.description(side);
        for (scalars, kind, x) in [
            (d.inputs(side), "input", 0.0),
            (d.outputs(side), "output", 1.0),
        ] {
            for (position, scalar) in scalars.into_iter().enumerate() {
                let y = (d.level(position) - LOWER) / d.height();
                let name = description.name_of(scalar);
                self.connector("          ", &name, kind, (side, scalar), (x, y));
            }
        }
        line!(self, "        </ssd:Connectors>");
        let x = LEFT[side as usize];
        line!(
            self,
            "        <ssd:ElementGeometry x1=\"{x}\" y1=\"{LOWER}\" x2=\"{}\" y2=\"{}\"/>",
            x + BOX,
            LOWER + d.height()
        );
        self.binding("        ", d.parameters[side as usize].as_ref());
        line!(self, "      </ssd:Component>");
    }

    /// A connector with type and unit of a variable.
    fn connector(
        &mut self,
        indent: &str,
        name: &str,
        kind: &str,
        (side, scalar): (Side, Scalar),
        (x, y): (f64, f64),
    ) {
        let variable = self.drawing.description(side).variable(scalar);
        let signal = match variable.kind {
            Kind::Float32 | Kind::Float64 => {
                let known = |unit: &&String| self.drawing.units.contains_key(*unit);
                match variable.unit.as_ref().filter(known) {
                    Some(unit) => {
                        self.units.insert(unit.clone());
                        format!("<ssc:Real unit=\"{}\"/>", escape(unit))
                    }
                    None => "<ssc:Real/>".to_owned(),
                }
            }
            Kind::Boolean => "<ssc:Boolean/>".to_owned(),
            Kind::Enumeration => {
                let of = format!("{side}.{}", variable.name);
                let items = variable.items.iter().map(|i| (i.name.clone(), i.value));
                self.enumerations.insert(of.clone(), items.collect());
                format!("<ssc:Enumeration name=\"{}\"/>", escape(&of))
            }
            _ => "<ssc:Integer/>".to_owned(),
        };
        line!(
            self,
            "{indent}<ssd:Connector name=\"{}\" kind=\"{kind}\">{signal}<ssd:ConnectorGeometry x=\"{x}\" y=\"{y:.6}\"/></ssd:Connector>",
            escape(name)
        );
    }

    fn binding(&mut self, indent: &str, source: Option<&String>) {
        if let Some(source) = source {
            let source = escape(source);
            line!(self, "{indent}<ssd:ParameterBindings>");
            line!(
                self,
                "{indent}  <ssd:ParameterBinding source=\"{source}\"/>"
            );
            line!(self, "{indent}</ssd:ParameterBindings>");
        }
    }

    fn connection(&mut self, drawn: &Line) {
        let mut attributes = String::new();
        for ((element, connector), end) in drawn.ends.iter().zip(["start", "end"]) {
            if let Some(side) = element {
                let _ = write!(attributes, " {end}Element=\"{}\"", NAMES[*side as usize]);
            }
            let _ = write!(attributes, " {end}Connector=\"{}\"", escape(connector));
        }
        if drawn.suppress {
            attributes.push_str(" suppressUnitConversion=\"true\"");
        }
        line!(self, "      <ssd:Connection{attributes}>");
        let Tap { factor, offset, .. } = drawn.tap;
        if (factor, offset) != (1.0, 0.0) {
            line!(
                self,
                "        <ssc:LinearTransformation factor=\"{}\" offset=\"{}\"/>",
                f64_text(factor),
                f64_text(offset)
            );
        }
        let list = |coordinate: &dyn Fn(&(f64, f64)) -> f64| {
            let texts = drawn.points.iter().map(|point| f64_text(coordinate(point)));
            texts.collect::<Vec<_>>().join(" ")
        };
        let (x, y) = (list(&|p| p.0), list(&|p| p.1));
        line!(
            self,
            "        <ssd:ConnectionGeometry pointsX=\"{x}\" pointsY=\"{y}\"/>"
        );
        line!(self, "      </ssd:Connection>");
    }

    fn definitions(&mut self) {
        if !self.enumerations.is_empty() {
            line!(self, "  <ssd:Enumerations>");
            for (name, items) in std::mem::take(&mut self.enumerations) {
                line!(self, "    <ssc:Enumeration name=\"{}\">", escape(&name));
                for (item, value) in items {
                    line!(
                        self,
                        "      <ssc:Item name=\"{}\" value=\"{value}\"/>",
                        escape(&item)
                    );
                }
                line!(self, "    </ssc:Enumeration>");
            }
            line!(self, "  </ssd:Enumerations>");
        }
        if self.units.is_empty() {
            return;
        }
        line!(self, "  <ssd:Units>");
        for name in std::mem::take(&mut self.units) {
            let mut base = String::new();
            for (attribute, value) in &self.drawing.units[&name] {
                let _ = write!(base, " {attribute}=\"{}\"", escape(value));
            }
            let name = escape(&name);
            line!(
                self,
                "    <ssc:Unit name=\"{name}\"><ssc:BaseUnit{base}/></ssc:Unit>"
            );
        }
        line!(self, "  </ssd:Units>");
    }
}
