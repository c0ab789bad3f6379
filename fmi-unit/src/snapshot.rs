//! Saved states of an instance: `fmi2FMUstate`, `fmi3FMUState` and their serialized form.
//!
//! A state holds values only, no pointer, so that it may be restored into any instance of the same
//! binary, in another process too, and the simulation goes on bit for bit.

use serde::{Deserialize, Serialize};

use crate::access::{check_outputs, check_parameters, check_sizes, same_parameters};
use crate::instance::{Instance, Interface, Situation};
use crate::legality::Mode;
use crate::model::Variables;
use crate::unit::{Failure, Unit};

/// Version of the serialized form.
const FORMAT: u32 = 2;
/// Bytes of the check sum at the end.
const CHECK: usize = 8;

/// A saved state.
#[derive(Serialize, Deserialize)]
#[serde(bound = "")]
pub(crate) struct Snapshot<U: Unit> {
    situation: Situation<U::Variables>,
    state: Option<U::State>,
}

impl<U: Unit> Instance<U> {
    pub(crate) fn save(&self) -> Snapshot<U> {
        Snapshot {
            situation: self.now.clone(),
            state: self.unit.as_ref().map(|unit| unit.state().clone()),
        }
    }

    /// Saves into a state that exists.
    pub(crate) fn save_into(&self, snapshot: &mut Snapshot<U>) {
        snapshot.situation.clone_from(&self.now);
        match (&self.unit, &mut snapshot.state) {
            (Some(unit), Some(state)) => state.clone_from(unit.state()),
            (unit, state) => *state = unit.as_ref().map(|unit| unit.state().clone()),
        }
    }

    /// Goes back to a saved state. The unit is set up anew only if the parameters differ.
    pub(crate) fn restore(&mut self, snapshot: &Snapshot<U>) -> Result<(), Failure> {
        let Snapshot { situation, state } = snapshot;
        if situation.interface != self.now.interface {
            return Err(Failure(format!(
                "a state of {:?} cannot be restored into {:?}",
                situation.interface, self.now.interface
            )));
        }
        match state {
            None => self.unit = None,
            Some(state) => {
                let reusable = situation.start.to_bits() == self.now.start.to_bits()
                    && same_parameters(&situation.variables, &self.now.variables);
                if self.unit.is_none() || !reusable {
                    let mut variables = situation.variables.clone();
                    let unit =
                        U::new(&mut variables, situation.start).map_err(|mut failures| {
                            let first = (!failures.is_empty()).then(|| failures.swap_remove(0));
                            first.unwrap_or_else(|| Failure("the unit cannot be set up".into()))
                        })?;
                    self.unit = Some(unit);
                }
                self.act(|unit, _, _| unit.set_state(state))?;
            }
        }
        self.now.clone_from(situation);
        Ok(())
    }
}

impl<U: Unit> Snapshot<U> {
    /// Number of bytes of the serialized form.
    pub(crate) fn size(&self) -> Result<usize, Failure> {
        let counter = postcard::ser_flavors::Size::default();
        postcard::serialize_with_flavor(&self.content(), counter)
            .map(|bytes| bytes + CHECK)
            .map_err(unserializable)
    }

    /// Writes the serialized form to the beginning of `bytes`.
    pub(crate) fn serialize(&self, bytes: &mut [u8]) -> Result<(), Failure> {
        let size = self.size()?;
        let given = bytes.len();
        let Some(bytes) = bytes.get_mut(..size) else {
            return Err(Failure(format!(
                "{given} bytes for a state of {size} bytes"
            )));
        };
        let (content, check) = bytes.split_at_mut(size - CHECK);
        postcard::to_slice(&self.content(), content).map_err(unserializable)?;
        check.copy_from_slice(&check_sum(content).to_le_bytes());
        Ok(())
    }

    /// Reads a serialized form, which may be anything.
    pub(crate) fn deserialize(bytes: &[u8]) -> Result<Self, Failure> {
        let damaged = || Failure("the serialized state is damaged".into());
        let (content, check) = bytes.split_last_chunk::<CHECK>().ok_or_else(damaged)?;
        if check_sum(content) != u64::from_le_bytes(*check) {
            return Err(damaged());
        }
        let (format, rest) = postcard::take_from_bytes::<u32>(content).map_err(|_| damaged())?;
        if format != FORMAT {
            return Err(Failure(format!(
                "the serialized state has format {format}, not {FORMAT}"
            )));
        }
        let (token, rest) = postcard::take_from_bytes::<&str>(rest).map_err(|_| damaged())?;
        let expected = U::Variables::MODEL.token;
        if token != expected {
            return Err(Failure(format!(
                "the serialized state is of another model: its token is {token}, not {expected}"
            )));
        }
        let (snapshot, rest) = postcard::take_from_bytes::<Self>(rest).map_err(|_| damaged())?;
        if !rest.is_empty() || !snapshot.is_consistent() {
            return Err(damaged());
        }
        if !snapshot.state.as_ref().is_none_or(U::is_admissible) {
            return Err(Failure(
                "the serialized state is none that this model can be in: it holds numbers that are none or \
                 far too large, or counts that contradict each other"
                    .into(),
            ));
        }
        check_parameters(&snapshot.situation.variables)?;
        check_outputs(&snapshot.situation.variables)?;
        Ok(snapshot)
    }

    fn content(&self) -> (u32, &'static str, &Self) {
        (FORMAT, U::Variables::MODEL.token, self)
    }

    fn is_consistent(&self) -> bool {
        let Situation {
            interface,
            mode,
            start,
            time,
            variables,
            ..
        } = &self.situation;
        let set_up = self.state.is_some();
        use Interface::{CoSimulation, EventfulCoSimulation, ModelExchange};
        let in_one_of = |interfaces: &[Interface]| set_up && interfaces.contains(interface);
        let legal = match mode {
            Mode::Instantiated | Mode::Configuration | Mode::Initialization => !set_up,
            Mode::Step => in_one_of(&[CoSimulation, EventfulCoSimulation]),
            Mode::Event => in_one_of(&[ModelExchange, EventfulCoSimulation]),
            Mode::ContinuousTime => in_one_of(&[ModelExchange]),
            Mode::Terminated => true,
            Mode::IntermediateUpdate | Mode::ClockActivation | Mode::Failed => false,
        };
        // In Configuration Mode the arrays have yet to follow.
        let sized = *mode == Mode::Configuration || check_sizes(variables);
        legal && sized && start.is_finite() && time.is_finite()
    }
}

/// FNV-1a: tells accidental damage, not malice.
fn check_sum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

fn unserializable(error: postcard::Error) -> Failure {
    Failure(format!("the state cannot be serialized: {error}"))
}
