//! Types and values of variables, and the typed buffers that cross the C interface.

use super::description::Variable;
use std::fmt;

/// Type of a variable. Real, Integer of FMI 2.0 are Float64, Int32.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names are the standard's")]
pub enum Kind {
    Float32,
    Float64,
    Int8,
    UInt8,
    Int16,
    UInt16,
    Int32,
    UInt32,
    Int64,
    UInt64,
    Boolean,
    Enumeration,
    String,
    Binary,
    Clock,
}

impl Kind {
    /// Whether values can be connected, recorded and plotted as numbers.
    pub fn is_numeric(self) -> bool {
        !matches!(self, Self::String | Self::Binary | Self::Clock)
    }

    /// The integers that the type admits.
    fn integers(self) -> Option<(i128, i128)> {
        Some(match self {
            Self::Int8 => (i8::MIN.into(), i8::MAX.into()),
            Self::UInt8 => (0, u8::MAX.into()),
            Self::Int16 => (i16::MIN.into(), i16::MAX.into()),
            Self::UInt16 => (0, u16::MAX.into()),
            Self::Int32 => (i32::MIN.into(), i32::MAX.into()),
            Self::UInt32 => (0, u32::MAX.into()),
            Self::Int64 | Self::Enumeration => (i64::MIN.into(), i64::MAX.into()),
            Self::UInt64 => (0, u64::MAX.into()),
            _ => return None,
        })
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self:?}")
    }
}

/// A value to be given to a variable before a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// For floating-point types.
    Float(f64),
    /// For integers and enumerations.
    Integer(i128),
    /// For Boolean.
    Boolean(bool),
    /// For String.
    Text(String),
}

impl Value {
    /// Reads a value for `variable`, of its type: an item's name or number for an enumeration, true, false,
    /// 1 or 0 for Boolean. Errors: what was expected, as text that follows "expected".
    pub fn parse(text: &str, variable: &Variable) -> Result<Self, String> {
        match variable.kind {
            Kind::Float32 | Kind::Float64 => match text.trim().parse::<f64>() {
                Ok(number) if number.is_finite() => Ok(Self::Float(number)),
                _ => Err("a finite number".into()),
            },
            Kind::Boolean => match text.trim() {
                "true" | "1" => Ok(Self::Boolean(true)),
                "false" | "0" => Ok(Self::Boolean(false)),
                _ => Err("true or false".into()),
            },
            Kind::Enumeration => {
                let text = text.trim();
                let item = variable
                    .items
                    .iter()
                    .find(|i| i.name == text || text.parse() == Ok(i.value));
                item.map(|item| Self::Integer(item.value.into()))
                    .ok_or_else(|| {
                        let items: Vec<_> =
                            variable.items.iter().map(|i| i.name.as_str()).collect();
                        format!("one of {}", items.join(", "))
                    })
            }
            Kind::String => Ok(Self::Text(text.to_owned())),
            Kind::Binary | Kind::Clock => Err(format!("no value: {} cannot be set", variable.kind)),
            kind => {
                let (low, high) = kind.integers().unwrap_or((0, 0));
                match text.trim().parse::<i128>() {
                    Ok(number) if (low..=high).contains(&number) => Ok(Self::Integer(number)),
                    _ => Err(format!("an integer from {low} to {high}")),
                }
            }
        }
    }

    /// As a number; None for text.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Float(number) => Some(*number),
            Self::Integer(number) => Some(*number as f64),
            Self::Boolean(truth) => Some(f64::from(u8::from(*truth))),
            Self::Text(_) => None,
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Float(number) => write!(f, "{number}"),
            Self::Integer(number) => write!(f, "{number}"),
            Self::Boolean(truth) => write!(f, "{truth}"),
            Self::Text(text) => f.write_str(text),
        }
    }
}

macro_rules! buffers {
    (floats { $($float:ident($float_type:ty),)* } integers { $($integer:ident($integer_type:ty),)* }) => {
        /// Values of one type, as they cross the C interface. Enumerations travel as Int64 in FMI 3.0 and
        /// as Int32 in 2.0; Boolean is a byte, since an FMU may write other values than 0 and 1.
        #[derive(Clone, Debug, PartialEq)]
        #[allow(missing_docs, reason = "the names are the standard's")]
        pub enum Buffer {
            Boolean(Vec<u8>),
            $($float(Vec<$float_type>),)*
            $($integer(Vec<$integer_type>),)*
        }

        impl Buffer {
            /// Number of values.
            pub fn len(&self) -> usize {
                match self {
                    Self::Boolean(values) => values.len(),
                    $(Self::$float(values) => values.len(),)*
                    $(Self::$integer(values) => values.len(),)*
                }
            }

            /// Whether there are no values.
            pub fn is_empty(&self) -> bool {
                self.len() == 0
            }

            /// Appends a zero.
            pub(super) fn push_zero(&mut self) {
                match self {
                    Self::Boolean(values) => values.push(0),
                    $(Self::$float(values) => values.push(0.0),)*
                    $(Self::$integer(values) => values.push(0),)*
                }
            }

            /// Copies the values at the first of each pair of positions to the second, as numbers.
            /// 64-bit integers beyond 2⁵³ are rounded.
            pub(super) fn scatter(&self, positions: &[(usize, usize)], numbers: &mut [f64]) {
                match self {
                    Self::Boolean(values) => {
                        for &(from, to) in positions {
                            numbers[to] = f64::from(u8::from(values[from] != 0));
                        }
                    }
                    $(Self::$float(values) => {
                        for &(from, to) in positions {
                            numbers[to] = f64::from(values[from]);
                        }
                    })*
                    $(Self::$integer(values) => {
                        for &(from, to) in positions {
                            numbers[to] = values[from] as f64;
                        }
                    })*
                }
            }

            /// The reverse of `scatter`. Numbers are rounded to the nearest value of the type.
            pub(super) fn gather(&mut self, positions: &[(usize, usize)], numbers: &[f64]) {
                match self {
                    Self::Boolean(values) => {
                        for &(to, from) in positions {
                            values[to] = u8::from(numbers[from] != 0.0);
                        }
                    }
                    $(Self::$float(values) => {
                        for &(to, from) in positions {
                            values[to] = numbers[from] as $float_type;
                        }
                    })*
                    $(Self::$integer(values) => {
                        for &(to, from) in positions {
                            values[to] = numbers[from].round() as $integer_type;
                        }
                    })*
                }
            }

            /// Stores a value that was parsed for this type.
            pub(super) fn store(&mut self, position: usize, value: &Value) {
                match (self, value) {
                    (Self::Boolean(values), Value::Boolean(truth)) => {
                        values[position] = u8::from(*truth);
                    }
                    $((Self::$float(values), Value::Float(number)) => {
                        values[position] = *number as $float_type;
                    })*
                    $((Self::$integer(values), Value::Integer(number)) => {
                        values[position] = *number as $integer_type;
                    })*
                    _ => {}
                }
            }
        }
    };
}

buffers! {
    floats {
        Float64(f64),
        Float32(f32),
    }
    integers {
        Int8(i8),
        UInt8(u8),
        Int16(i16),
        UInt16(u16),
        Int32(i32),
        UInt32(u32),
        Int64(i64),
        UInt64(u64),
    }
}

impl Buffer {
    /// An empty buffer for values of `kind`; None if they are not numeric. `wide` tells whether
    /// enumerations are 64 bits wide, as in FMI 3.0.
    pub(super) fn new(kind: Kind, wide: bool) -> Option<Self> {
        Some(match kind {
            Kind::Float32 => Self::Float32(Vec::new()),
            Kind::Float64 => Self::Float64(Vec::new()),
            Kind::Int8 => Self::Int8(Vec::new()),
            Kind::UInt8 => Self::UInt8(Vec::new()),
            Kind::Int16 => Self::Int16(Vec::new()),
            Kind::UInt16 => Self::UInt16(Vec::new()),
            Kind::Int32 => Self::Int32(Vec::new()),
            Kind::UInt32 => Self::UInt32(Vec::new()),
            Kind::UInt64 => Self::UInt64(Vec::new()),
            Kind::Enumeration if !wide => Self::Int32(Vec::new()),
            Kind::Int64 | Kind::Enumeration => Self::Int64(Vec::new()),
            Kind::Boolean => Self::Boolean(Vec::new()),
            Kind::String | Kind::Binary | Kind::Clock => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::description::tests::variable;
    use super::super::description::{Causality, Item};
    use super::*;

    fn parse(kind: Kind, text: &str) -> Result<Value, String> {
        let mut v = variable("v", Causality::Parameter);
        v.kind = kind;
        v.items = vec![Item {
            name: "lqri".into(),
            value: 2,
        }];
        Value::parse(text, &v)
    }

    #[test]
    fn values_are_read_by_type() {
        assert_eq!(parse(Kind::Float64, " 1e-3"), Ok(Value::Float(1e-3)));
        assert_eq!(parse(Kind::Int32, "-7"), Ok(Value::Integer(-7)));
        assert_eq!(
            parse(Kind::UInt64, &u64::MAX.to_string()),
            Ok(Value::Integer(u64::MAX.into()))
        );
        assert_eq!(parse(Kind::Boolean, "1"), Ok(Value::Boolean(true)));
        assert_eq!(parse(Kind::Enumeration, "lqri"), Ok(Value::Integer(2)));
        assert_eq!(parse(Kind::Enumeration, "2"), Ok(Value::Integer(2)));
        for (kind, text, expected) in [
            (Kind::Float64, "NaN", "a finite number"),
            (Kind::Float64, "1,5", "a finite number"),
            (Kind::UInt8, "256", "an integer from 0 to 255"),
            (
                Kind::Int32,
                "1.5",
                "an integer from -2147483648 to 2147483647",
            ),
            (Kind::Boolean, "yes", "true or false"),
            (Kind::Enumeration, "lqr", "one of lqri"),
        ] {
            assert_eq!(parse(kind, text), Err(expected.into()));
        }
    }

    #[test]
    fn buffers_convert_both_ways() {
        for kind in [
            Kind::Float64,
            Kind::Float32,
            Kind::Int8,
            Kind::UInt64,
            Kind::Enumeration,
        ] {
            let mut buffer = Buffer::new(kind, true).unwrap();
            buffer.push_zero();
            buffer.push_zero();
            buffer.gather(&[(1, 0)], &[41.0]);
            let mut back = [0.0; 3];
            buffer.scatter(&[(1, 2), (0, 1)], &mut back);
            assert_eq!(back, [0.0, 0.0, 41.0], "{kind}");
        }
        assert!(Buffer::new(Kind::Clock, true).is_none());
    }

    #[test]
    fn odd_booleans_count_as_true() {
        let buffer = Buffer::Boolean(vec![0, 1, 200]);
        let mut numbers = [9.0; 3];
        buffer.scatter(&[(0, 0), (1, 1), (2, 2)], &mut numbers);
        assert_eq!(numbers, [0.0, 1.0, 1.0]);
    }
}
