//! Which call is legal in which mode: one table for each version of the standard (FMI 2.0.4 sec 3.2.3 and
//! 4.2.4, FMI 3.0.2 sec 2.3).
//!
//! Real importers call out of order. What would corrupt the simulation is refused; what is merely out
//! of order is accepted with a warning. OpenModelica, for instance, sets the time of an instance that is
//! only instantiated, sets continuous states in Event Mode and terminates from any mode.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Modes of an instance (states in FMI 2.0), the same for both versions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Mode {
    Instantiated,
    /// FMI 3.0, where structural parameters are set.
    Configuration,
    Initialization,
    /// Co-Simulation, between steps.
    Step,
    /// Model Exchange, and Co-Simulation that uses it.
    Event,
    /// Model Exchange.
    ContinuousTime,
    /// FMI 3.0 Co-Simulation: the importer looks at an instant inside a step.
    IntermediateUpdate,
    /// FMI 3.0 Scheduled Execution.
    ClockActivation,
    Terminated,
    /// The unit could not go on: reset, restore a state or free.
    Failed,
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Instantiated => "Instantiated",
            Self::Configuration => "Configuration Mode",
            Self::Initialization => "Initialization Mode",
            Self::Step => "Step Mode",
            Self::Event => "Event Mode",
            Self::ContinuousTime => "Continuous-Time Mode",
            Self::IntermediateUpdate => "Intermediate Update Mode",
            Self::ClockActivation => "Clock Activation Mode",
            Self::Terminated => "Terminated",
            Self::Failed => "the state after an error",
        })
    }
}

/// What happens to a call in some mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// As the standard has it.
    Legal,
    /// Out of order but harmless: accepted with a warning.
    Tolerated,
    /// Harmful or meaningless: refused with an error.
    Refused,
}

/// The verdicts on one call, in the order of [`Mode`].
pub(crate) struct Row([Verdict; 10]);

impl Row {
    pub(crate) fn verdict(&self, mode: Mode) -> Verdict {
        self.0[mode as usize]
    }
}

/// Reads a row of the tables below at compile time: `+` legal, `~` tolerated, `-` refused.
const fn row(cells: &str) -> Row {
    let cells = cells.as_bytes();
    assert!(cells.len() == 19, "ten cells with a blank between them");
    let mut verdicts = [Verdict::Refused; 10];
    let mut i = 0;
    while i < 10 {
        verdicts[i] = match cells[2 * i] {
            b'+' => Verdict::Legal,
            b'~' => Verdict::Tolerated,
            b'-' => Verdict::Refused,
            _ => panic!("a cell is one of + ~ -"),
        };
        i += 1;
    }
    Row(verdicts)
}

/// Calls that no mode forbids.
pub(crate) const ALWAYS: Row = row("+ + + + + + + + + +");

#[rustfmt::skip]
pub(crate) mod fmi2 {
    use super::{Row, row};
    //                                             Instantiated
    //                                             | (FMI 3.0's Configuration, by a state of that version)
    //                                             | | Initialization
    //                                             | | | Step
    //                                             | | | | Event
    //                                             | | | | | Continuous-Time
    //                                             | | | | | | (unused in FMI 2.0)
    //                                             | | | | | | | (unused in FMI 2.0)
    //                                             | | | | | | | | Terminated
    //                                             | | | | | | | | | Failed
    pub(crate) const SETUP_EXPERIMENT:     Row = row("+ - ~ - - - - - - -");
    pub(crate) const ENTER_INITIALIZATION: Row = row("+ - - - - - - - - -");
    pub(crate) const EXIT_INITIALIZATION:  Row = row("- - + - - - - - - -");
    pub(crate) const TERMINATE:            Row = row("~ - ~ + + + - - ~ ~");
    pub(crate) const RESET:                Row = row("+ + + + + + - - + +");
    pub(crate) const GET:                  Row = row("~ - + + + + - - + +");
    pub(crate) const SET:                  Row = row("+ - + + + + - - ~ -");
    pub(crate) const GET_FMU_STATE:        Row = row("+ - + + + + - - + -");
    pub(crate) const SET_FMU_STATE:        Row = row("+ + + + + + - - + +");
    pub(crate) const ENTER_EVENT_MODE:     Row = row("- - - - ~ + - - - -");
    pub(crate) const NEW_DISCRETE_STATES:  Row = row("- - - - + - - - - -");
    pub(crate) const ENTER_CONTINUOUS:     Row = row("- - - - + ~ - - - -");
    pub(crate) const COMPLETED_STEP:       Row = row("- - - - ~ + - - - -");
    pub(crate) const SET_TIME:             Row = row("~ - ~ - + + - - - -");
    pub(crate) const SET_STATES:           Row = row("- - - - ~ + - - - -");
    pub(crate) const GET_STATES:           Row = row("~ - + - + + - - ~ -");
    pub(crate) const DERIVATIVE:           Row = row("~ - + + + + - - + -");
    pub(crate) const DO_STEP:              Row = row("- - - + - - - - - -");
}

#[rustfmt::skip]
pub(crate) mod fmi3 {
    use super::{Row, row};
    //                                             Instantiated
    //                                             | Configuration
    //                                             | | Initialization
    //                                             | | | Step
    //                                             | | | | Event
    //                                             | | | | | Continuous-Time
    //                                             | | | | | | Intermediate Update
    //                                             | | | | | | | Clock Activation
    //                                             | | | | | | | | Terminated
    //                                             | | | | | | | | | Failed
    pub(crate) const ENTER_CONFIGURATION:  Row = row("+ - - - - - - - - -");
    pub(crate) const EXIT_CONFIGURATION:   Row = row("- + - - - - - - - -");
    pub(crate) const ENTER_INITIALIZATION: Row = row("+ - - - - - - - - -");
    pub(crate) const EXIT_INITIALIZATION:  Row = row("- - + - - - - - - -");
    pub(crate) const TERMINATE:            Row = row("~ - ~ + + + - + ~ ~");
    pub(crate) const RESET:                Row = row("+ + + + + + - + + +");
    pub(crate) const GET:                  Row = row("~ ~ + + + + + + + +");
    pub(crate) const SET:                  Row = row("+ + + + + + - + ~ -");
    pub(crate) const GET_FMU_STATE:        Row = row("+ + + + + + - - + -");
    pub(crate) const SET_FMU_STATE:        Row = row("+ + + + + + - - + +");
    pub(crate) const ENTER_EVENT_MODE:     Row = row("- - - + ~ + - - - -");
    pub(crate) const UPDATE_DISCRETE:      Row = row("- - - - + - - - - -");
    pub(crate) const ENTER_CONTINUOUS:     Row = row("- - - - + ~ - - - -");
    pub(crate) const COMPLETED_STEP:       Row = row("- - - - ~ + - - - -");
    pub(crate) const SET_TIME:             Row = row("~ - ~ - ~ + - - - -");
    pub(crate) const SET_STATES:           Row = row("- - - - ~ + - - - -");
    pub(crate) const GET_STATES:           Row = row("~ - + - + + - - ~ -");
    pub(crate) const COUNTS:               Row = row("+ ~ + + + + - + + +");
    pub(crate) const ENTER_STEP_MODE:      Row = row("- - - ~ + - - - - -");
    pub(crate) const CLOCK:                Row = row("- - - - + - - - - -");
    pub(crate) const INTERVAL:             Row = row("- - + ~ + ~ - + - -");
    pub(crate) const SET_INTERVAL:         Row = row("+ - + - - - - - - -");
    pub(crate) const ACTIVATE:             Row = row("- - - - - - - + - -");
    pub(crate) const DERIVATIVE:           Row = row("~ - + + + + - - + -");
    pub(crate) const DO_STEP:              Row = row("- - - + - - - - - -");
}
