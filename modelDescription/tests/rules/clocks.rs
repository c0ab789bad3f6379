//! Clocks and event indicators.

use crate::{VALID, only};
use model_description::read;

const END: &str = "</ModelVariables>";

/// The end of the variables with a clock before it, on line 31.
fn with(attributes: &str) -> String {
    format!(
        "<Clock name=\"tick\" causality=\"input\" variability=\"discrete\" description=\"d\" {attributes}/>{END}"
    )
}

const WHOLE: &str = "valueReference=\"30\" intervalVariability=\"fixed\" priority=\"0\"";

#[test]
fn a_whole_clock_is_read() {
    let description = read(&VALID.replace(END, &with(WHOLE)), "t.xml").unwrap();
    let clock = &description.clocks[0];
    assert_eq!((&*clock.name, clock.value_reference), ("tick", 30));
}

#[test]
fn attributes_of_clocks() {
    only(
        END,
        &with(&WHOLE.replace("fixed", "countdown")),
        "t.xml:31: Clock tick: a clock must have intervalVariability=\"fixed\"",
    );
    only(
        END,
        &with(&format!("{WHOLE} intervalDecimal=\"0.1\"")),
        "t.xml:31: Clock tick: unknown attribute `intervalDecimal`",
    );
    only(
        END,
        &with(&WHOLE.replace("priority=\"0\"", "priority=\"-1\"")),
        "t.xml:31: Clock tick: priority `-1` is not a number from 0",
    );
}

#[test]
fn clocks_come_after_variables_under_their_own_name() {
    only(
        END,
        &with(&WHOLE.replace("30", "21")),
        "t.xml:31: clock tick: value reference 21 must be greater than those of all variables and of the clocks before",
    );
    only(
        END,
        &with(WHOLE).replace("\"tick\"", "\"mode\""),
        "t.xml:31: clock or variable mode: name already used in line 25",
    );
}

#[test]
fn partitions_need_a_clock() {
    only(
        "<CoSimulation modelIdentifier=\"Tank\"/>",
        "<CoSimulation modelIdentifier=\"Tank\"/><ScheduledExecution modelIdentifier=\"Tank\"/>",
        "t.xml:4: `ScheduledExecution` needs a clock",
    );
}

#[test]
fn event_indicators_are_continuous() {
    let indicator = |reference: u32| {
        format!("<EventIndicator valueReference=\"{reference}\"/></ModelStructure>")
    };
    let end = "</ModelStructure>";
    assert!(read(&VALID.replace(end, &indicator(2)), "t.xml").is_ok());
    only(
        end,
        &indicator(20),
        "t.xml:37: EventIndicator 20: variable valve.count is not continuous",
    );
}
