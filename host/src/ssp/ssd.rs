//! Writes the `.ssd` of a drawing (SSP 1.0 sec 5).

use super::drawing::{ABOVE, BOX, Drawing, LEFT, LOWER, Line, WIDTH};
use super::read::{INPUTS, OPENMODELICA, SSC, SSD};
use crate::fmu::{Kind, Scalar};
use crate::input::Side;
use crate::input::connections::{Source, Tap};
use model_description::xml::{escape, f64_text};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// Namespace that OMSimulator expects of its annotations.
const OMS: &str =
    "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd";

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
        for side in Side::BOTH {
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
        line!(
            self,
            "      <ssd:Component name=\"{side}\" type=\"application/x-fmu-sharedlibrary\" source=\"{}\">",
            escape(&d.sources[side as usize])
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
                let known = |unit: &&String| self.drawing.base_unit(unit).is_some();
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
                let _ = write!(attributes, " {end}Element=\"{side}\"");
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
            for (attribute, value) in self.drawing.base_unit(&name).into_iter().flatten() {
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
