//! Structural parameters and the arrays whose size follows them.

use crate::{VALID, only};
use model_description::{Dimension, ModelDescription, fmi2, read};

const END: &str = "</ModelVariables>";
const POINTS: &str = "<UInt64 name=\"points\" valueReference=\"50\" causality=\"structuralParameter\" variability=\"fixed\" \
                      start=\"4\" min=\"1\" max=\"9\" description=\"d\"/>";
const ARRAY: &str = "<Float64 name=\"curve\" valueReference=\"40\" causality=\"parameter\" variability=\"fixed\" unit=\"m\" \
                     start=\"2\" description=\"d\"><Dimension valueReference=\"50\"/></Float64>";

/// The end of the variables after an array and its structural parameter, both on line 31.
fn with(array: &str, points: &str) -> String {
    format!("{array}{points}{END}")
}

fn whole() -> ModelDescription {
    read(&VALID.replace(END, &with(ARRAY, POINTS)), "t.xml").unwrap()
}

#[test]
fn an_array_has_the_size_that_its_parameter_starts_with() {
    let description = whole();
    let curve = description.variable(40).unwrap();
    let expected = Dimension {
        size: 4,
        parameter: Some(50),
    };
    assert_eq!(curve.dimension, Some(expected));
    assert_eq!(curve.element_names().last().unwrap(), "curve[4]");
}

/// As scalars of the size at the start, each with the one start value.
#[test]
fn fmi2_has_the_array_but_not_its_parameter() {
    let text = fmi2::write(&whole());
    assert!(!text.contains("points"));
    let document = roxmltree::Document::parse(&text).unwrap();
    let elements = document.descendants().filter(|n| {
        let name = n.attribute("name").unwrap_or_default();
        name.starts_with("curve[")
    });
    let values = elements.map(|n| {
        let value = n.first_element_child().unwrap();
        (
            n.attribute("valueReference").unwrap(),
            value.attribute("start").unwrap(),
        )
    });
    let expected = [("40", "2"), ("41", "2"), ("42", "2"), ("43", "2")];
    assert_eq!(values.collect::<Vec<_>>(), expected);
}

#[test]
fn structural_parameters() {
    for (from, to, message) in [
        (
            "start=\"4\"",
            "start=\"0\"",
            "start 0 is outside its range 1 to 9",
        ),
        ("start=\"4\" ", "", "missing attribute `start`"),
        (
            "min=\"1\"",
            "min=\"0\"",
            "a structural parameter needs a `min` of at least 1",
        ),
        (
            "max=\"9\" ",
            "",
            "a structural parameter needs a `max` of at most 4294967295",
        ),
        (
            "fixed",
            "tunable",
            "a tunable structural parameter needs Reconfiguration Mode, which no unit has",
        ),
        (
            "fixed",
            "discrete",
            "a variable of causality structuralParameter cannot be discrete",
        ),
        (
            "UInt64",
            "Int32",
            "structural parameters, and they alone, are of type UInt64",
        ),
    ] {
        let message = format!("t.xml:31: variable points: {message}");
        only(END, &with(ARRAY, &POINTS.replace(from, to)), &message);
    }
    only(
        END,
        &with(
            ARRAY,
            &format!(
                "{POINTS}{}",
                POINTS.replace("points", "more").replace("50", "51")
            ),
        ),
        "t.xml:31: variable more: no `Dimension` names this structural parameter",
    );
}

#[test]
fn dimensions() {
    only(
        END,
        &with(&ARRAY.replace("\"50\"/>", "\"20\"/>"), ""),
        "t.xml:31: variable curve: dimension 20 is no structural parameter",
    );
    only(
        END,
        &with(&ARRAY.replace("start=\"2\"", "start=\"2 2 2 2\""), POINTS),
        "t.xml:31: variable curve: 4 start values: one for all elements, whose number may change",
    );
    only(
        END,
        &with(&ARRAY.replace("\"50\"/>", "\"50\" start=\"4\"/>"), POINTS),
        "t.xml:31: Dimension 50: either `start` or `valueReference`",
    );
}
