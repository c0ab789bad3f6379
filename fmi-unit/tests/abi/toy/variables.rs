//! Variables of the toy, as a build script would generate them.

use fmi_unit::{
    Causality, Clock, Dimension, Kind, Model, Values, ValuesMut, Variability, Variable, Variables,
};
use serde::{Deserialize, Serialize};
use std::slice::{from_mut, from_ref};

pub const TIME: u32 = 0;
pub const U: u32 = 1;
pub const X: u32 = 2;
pub const SAMPLES: u32 = 4;
pub const SAMPLED: u32 = 5;
pub const HOLD: u32 = 6;
pub const BEHAVIOUR: u32 = 7;
pub const GAIN: u32 = 10;
pub const SIZE: u32 = 14;
pub const WEIGHT: u32 = 15;
pub const RAMP: u32 = 17;
pub const PERIOD: u32 = 20;
pub const TAU: u32 = 21;
pub const SEED: u32 = 22;
pub const BIAS: u32 = 23;
pub const TWICE: u32 = 24;
pub const FAST: u32 = 30;
pub const SLOW: u32 = 31;

/// Values of `behaviour`.
pub const NORMAL: i64 = 1;
pub const FAIL_IN_EVENT: i64 = 2;
pub const PANIC_IN_EVENT: i64 = 3;
pub const STUCK: i64 = 4;
pub const PANIC_IN_NEW: i64 = 5;
pub const PANIC_IN_OUTPUTS: i64 = 6;
pub const PANIC_IN_DROP: i64 = 7;
pub const FAIL_IN_ADVANCE: i64 = 8;

#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub struct ToyVariables {
    pub u: f64,
    pub x: f64,
    pub der_x: f64,
    pub samples: i32,
    pub sampled: f64,
    /// Input: the clock ticks but samples nothing.
    pub hold: bool,
    pub behaviour: i64,
    /// Jump of x at an event; threshold of x for a step event; unused.
    pub gain: [f64; 3],
    /// Structural parameter: elements of `weight` and `ramp`.
    pub size: u64,
    pub weight: Vec<f64>,
    /// Output: u times each weight.
    pub ramp: Vec<f64>,
    pub period: f64,
    pub tau: f64,
    pub seed: i32,
    pub bias: f64,
    /// Output: 2 u, without any delay.
    pub twice: f64,
}

impl Default for ToyVariables {
    fn default() -> Self {
        Self {
            u: 0.0,
            x: 0.0,
            der_x: 0.0,
            samples: 0,
            sampled: 0.0,
            hold: false,
            behaviour: NORMAL,
            gain: [0.0; 3],
            size: 2,
            weight: vec![1.0; 2],
            ramp: vec![0.0; 2],
            period: 0.1,
            tau: 1.0,
            seed: 1,
            bias: 0.0,
            twice: 0.0,
        }
    }
}

impl Clone for ToyVariables {
    fn clone(&self) -> Self {
        let (weight, ramp) = (self.weight.clone(), self.ramp.clone());
        Self {
            weight,
            ramp,
            ..*self
        }
    }

    /// Without allocation where the sizes agree.
    fn clone_from(&mut self, source: &Self) {
        let [mut weight, mut ramp] = [&mut self.weight, &mut self.ramp].map(std::mem::take);
        weight.clone_from(&source.weight);
        ramp.clone_from(&source.ramp);
        *self = Self {
            weight,
            ramp,
            ..*source
        };
    }
}

const REAL: Variable = Variable {
    name: "",
    value_reference: 0,
    dimension: None,
    kind: Kind::Float64,
    causality: Causality::Parameter,
    variability: Variability::Fixed,
    min: f64::NEG_INFINITY,
    max: f64::INFINITY,
    unit: "s",
    items: &[],
};

/// The size of arrays that follow `size`.
const SIZED: Option<Dimension> = Some(Dimension {
    size: 2,
    parameter: Some(SIZE),
});

const fn real(name: &'static str, value_reference: u32, causality: Causality) -> Variable {
    Variable {
        name,
        value_reference,
        causality,
        variability: Variability::Continuous,
        ..REAL
    }
}

const fn clock(name: &'static str, value_reference: u32) -> Clock {
    Clock {
        name,
        value_reference,
    }
}

static MODEL: Model = Model {
    name: "Toy",
    token: "{toy}",
    variables: &[
        real("time_", TIME, Causality::Independent),
        real("u", U, Causality::Input),
        real("x", X, Causality::Output),
        real("der(x)", 3, Causality::Local),
        Variable {
            kind: Kind::Int32,
            variability: Variability::Discrete,
            ..real("samples", SAMPLES, Causality::Output)
        },
        real("sampled", SAMPLED, Causality::Output),
        Variable {
            kind: Kind::Boolean,
            variability: Variability::Discrete,
            ..real("hold", HOLD, Causality::Input)
        },
        Variable {
            kind: Kind::Enumeration,
            variability: Variability::Discrete,
            items: &[
                (NORMAL, "normal"),
                (FAIL_IN_EVENT, "fail_in_event"),
                (PANIC_IN_EVENT, "panic_in_event"),
                (STUCK, "stuck"),
                (PANIC_IN_NEW, "panic_in_new"),
                (PANIC_IN_OUTPUTS, "panic_in_outputs"),
                (PANIC_IN_DROP, "panic_in_drop"),
                (FAIL_IN_ADVANCE, "fail_in_advance"),
            ],
            ..real("behaviour", BEHAVIOUR, Causality::Input)
        },
        Variable {
            name: "gain",
            value_reference: GAIN,
            dimension: Some(Dimension {
                size: 3,
                parameter: None,
            }),
            min: 0.0,
            max: 10.0,
            unit: "N.m",
            ..REAL
        },
        Variable {
            name: "size",
            value_reference: SIZE,
            kind: Kind::UInt64,
            causality: Causality::StructuralParameter,
            min: 1.0,
            max: 1000.0,
            unit: "",
            ..REAL
        },
        Variable {
            name: "weight",
            value_reference: WEIGHT,
            dimension: SIZED,
            min: 0.0,
            max: 10.0,
            ..REAL
        },
        Variable {
            dimension: SIZED,
            ..real("ramp", RAMP, Causality::Output)
        },
        Variable {
            name: "period",
            value_reference: PERIOD,
            min: 1e-6,
            max: 1e6,
            ..REAL
        },
        Variable {
            name: "tau",
            value_reference: TAU,
            min: 1e-9,
            ..REAL
        },
        Variable {
            name: "seed",
            value_reference: SEED,
            kind: Kind::Int32,
            min: 0.0,
            max: 100.0,
            unit: "",
            ..REAL
        },
        Variable {
            name: "bias",
            value_reference: BIAS,
            variability: Variability::Tunable,
            ..REAL
        },
        real("twice", TWICE, Causality::Output),
    ],
    states: &[X],
    derivatives: &[3],
    event_indicators: &[TWICE],
    clocks: &[clock("fast", FAST), clock("slow", SLOW)],
    event_mode: true,
    scheduled_execution: true,
    model_exchange: true,
    directional_derivatives: true,
    log_categories: &[
        "logStatusError",
        "logStatusWarning",
        "logStatusFatal",
        "logEvents",
    ],
};

impl Variables for ToyVariables {
    const MODEL: &'static Model = &MODEL;

    fn values(&self, value_reference: u32) -> Option<Values<'_>> {
        Some(match value_reference {
            U => Values::Float64(from_ref(&self.u)),
            X => Values::Float64(from_ref(&self.x)),
            3 => Values::Float64(from_ref(&self.der_x)),
            SAMPLES => Values::Int32(from_ref(&self.samples)),
            SAMPLED => Values::Float64(from_ref(&self.sampled)),
            HOLD => Values::Boolean(from_ref(&self.hold)),
            BEHAVIOUR => Values::Enumeration(from_ref(&self.behaviour)),
            GAIN => Values::Float64(&self.gain),
            SIZE => Values::UInt64(from_ref(&self.size)),
            WEIGHT => Values::Float64(&self.weight),
            RAMP => Values::Float64(&self.ramp),
            PERIOD => Values::Float64(from_ref(&self.period)),
            TAU => Values::Float64(from_ref(&self.tau)),
            SEED => Values::Int32(from_ref(&self.seed)),
            BIAS => Values::Float64(from_ref(&self.bias)),
            TWICE => Values::Float64(from_ref(&self.twice)),
            _ => return None,
        })
    }

    fn values_mut(&mut self, value_reference: u32) -> Option<ValuesMut<'_>> {
        Some(match value_reference {
            U => ValuesMut::Float64(from_mut(&mut self.u)),
            X => ValuesMut::Float64(from_mut(&mut self.x)),
            3 => ValuesMut::Float64(from_mut(&mut self.der_x)),
            SAMPLES => ValuesMut::Int32(from_mut(&mut self.samples)),
            SAMPLED => ValuesMut::Float64(from_mut(&mut self.sampled)),
            HOLD => ValuesMut::Boolean(from_mut(&mut self.hold)),
            BEHAVIOUR => ValuesMut::Enumeration(from_mut(&mut self.behaviour)),
            GAIN => ValuesMut::Float64(&mut self.gain),
            SIZE => ValuesMut::UInt64(from_mut(&mut self.size)),
            WEIGHT => ValuesMut::Float64(&mut self.weight),
            RAMP => ValuesMut::Float64(&mut self.ramp),
            PERIOD => ValuesMut::Float64(from_mut(&mut self.period)),
            TAU => ValuesMut::Float64(from_mut(&mut self.tau)),
            SEED => ValuesMut::Int32(from_mut(&mut self.seed)),
            BIAS => ValuesMut::Float64(from_mut(&mut self.bias)),
            TWICE => ValuesMut::Float64(from_mut(&mut self.twice)),
            _ => return None,
        })
    }

    fn resize(&mut self) {
        self.weight.resize(self.size as usize, 1.0);
        self.ramp.resize(self.size as usize, 0.0);
    }
}
