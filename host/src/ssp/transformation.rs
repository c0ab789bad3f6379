//! What happens to a value on its way: unit conversions and the transformations of SSP 1.0 sec 4.4.2.

use std::collections::BTreeMap;
use std::fmt::Display;

/// A transformation of a number. Truth values travel as 0 and 1, items of enumerations as their values.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Transformation {
    /// Values of the source with what stands for them; empty: all values are taken as they are.
    pub map: Vec<(f64, f64)>,
    /// Factor, after the map.
    pub factor: f64,
    /// Offset, after the factor.
    pub offset: f64,
}

impl Transformation {
    /// A linear one: `factor * value + offset`.
    pub fn linear(factor: f64, offset: f64) -> Self {
        Self {
            map: Vec::new(),
            factor,
            offset,
        }
    }

    /// None at all.
    pub fn identity() -> Self {
        Self::linear(1.0, 0.0)
    }

    /// A map.
    pub fn mapping(map: Vec<(f64, f64)>) -> Self {
        Self {
            map,
            ..Self::identity()
        }
    }

    /// Whether it leaves every value as it is.
    pub fn is_identity(&self) -> bool {
        *self == Self::identity()
    }

    /// The transformed value; none if a map has no entry for it.
    pub fn apply(&self, value: f64) -> Option<f64> {
        let value = if self.map.is_empty() {
            value
        } else {
            self.map.iter().find(|(from, _)| *from == value)?.1
        };
        Some(self.factor * value + self.offset)
    }

    /// This one, then `next`.
    pub fn then(self, next: &Self) -> Self {
        if next.is_identity() {
            return self;
        }
        if self.is_identity() {
            return next.clone();
        }
        if self.map.is_empty() && next.map.is_empty() {
            return Self::linear(
                next.factor * self.factor,
                next.factor * self.offset + next.offset,
            );
        }
        // A map has finitely many entries: each is followed to its end. Behind a linear one its entries are
        // looked up by the values from which they come.
        let entries = if self.map.is_empty() {
            let before = |from: f64| (from - self.offset) / self.factor;
            next.map.iter().map(|&(from, _)| before(from)).collect()
        } else {
            self.map.iter().map(|(from, _)| *from).collect::<Vec<_>>()
        };
        let follow = |from| Some((from, next.apply(self.apply(from)?)?));
        let mut met: Vec<_> = entries.into_iter().filter_map(follow).collect();
        if met.is_empty() {
            // No value gets through; no entries at all would let every one through.
            met.push((f64::NAN, f64::NAN));
        }
        Self::mapping(met)
    }
}

/// A unit in terms of the base units of SI (SSP 1.0 sec 4.3.2, FMI 3.0 sec 2.4.3).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Unit {
    exponents: [i32; 8],
    factor: f64,
    offset: f64,
}

impl Unit {
    /// From a `BaseUnit`; none if an attribute is not a number.
    pub fn new(base: roxmltree::Node<'_, '_>) -> Option<Self> {
        let attributes = base.attributes();
        let named = attributes.map(|a| (a.name().to_owned(), a.value().to_owned()));
        Self::of_attributes(&named.collect())
    }

    /// The same from the attributes by name.
    pub fn of_attributes(attributes: &BTreeMap<String, String>) -> Option<Self> {
        let text = |name: &str| attributes.get(name).map(|text| text.trim());
        let mut exponents = [0; 8];
        let names = ["kg", "m", "s", "A", "K", "mol", "cd", "rad"];
        for (exponent, name) in exponents.iter_mut().zip(names) {
            if let Some(text) = text(name) {
                *exponent = text.parse().ok()?;
            }
        }
        let number =
            |name, otherwise: f64| text(name).map_or(Some(otherwise), |text| text.parse().ok());
        Some(Self {
            exponents,
            factor: number("factor", 1.0).filter(|factor| *factor != 0.0)?,
            offset: number("offset", 0.0)?,
        })
    }

    /// How a value in this unit becomes one in another; none if they measure different things.
    pub fn to(&self, other: &Self) -> Option<Transformation> {
        if self == other {
            return Some(Transformation::identity());
        }
        // Base value = factor * value + offset.
        (self.exponents == other.exponents).then(|| {
            Transformation::linear(
                self.factor / other.factor,
                (self.offset - other.offset) / other.factor,
            )
        })
    }
}

/// A unit of a signal: its name and, if it is known, its meaning.
#[derive(Clone, Debug)]
pub(super) struct NamedUnit {
    pub name: String,
    pub unit: Option<Unit>,
}

impl NamedUnit {
    /// The conversion to another unit. Errors: why there is none; the bare numbers are then taken.
    pub fn to(&self, other: &Self) -> Result<Transformation, String> {
        let (from, to) = (&self.name, &other.name);
        match (&self.unit, &other.unit) {
            (Some(unit), Some(target)) => unit.to(target).ok_or_else(|| {
                format!("{from} cannot be converted to {to}, they measure different things")
            }),
            _ if from == to => Ok(Transformation::identity()),
            (None, _) => Err(unknown(from, to, from)),
            (_, None) => Err(unknown(from, to, to)),
        }
    }
}

fn unknown(from: impl Display, to: impl Display, which: impl Display) -> String {
    format!("{from} cannot be converted to {to}, since {which} has no BaseUnit")
}

#[cfg(test)]
mod tests {
    use super::*;
    use roxmltree::Document;

    fn unit(attributes: &str) -> Unit {
        let text = format!("<BaseUnit {attributes}/>");
        Unit::new(Document::parse(&text).unwrap().root_element()).unwrap()
    }

    #[test]
    fn mappings_that_do_not_meet_let_nothing_through() {
        let (first, second) = ([(0.0, 5.0)], [(1.0, 2.0)]);
        let both =
            Transformation::mapping(first.to_vec()).then(&Transformation::mapping(second.to_vec()));
        assert!(!both.is_identity());
        assert_eq!((both.apply(0.0), both.apply(1.0)), (None, None));
    }

    #[test]
    fn units_are_converted_by_their_base_units() {
        let degree = unit("rad='1' factor='0.017453292519943295'");
        let radian = unit("rad='1'");
        let half_turn = degree.to(&radian).unwrap().apply(180.0).unwrap();
        assert!((half_turn - std::f64::consts::PI).abs() < 1e-15);
        let celsius = unit("K='1' offset='273.15'");
        let fahrenheit = unit("K='1' factor='0.5555555555555556' offset='255.3722222222222'");
        let boiling = celsius.to(&fahrenheit).unwrap().apply(100.0).unwrap();
        assert!((boiling - 212.0).abs() < 1e-9, "{boiling}");
        assert_eq!(radian.to(&celsius), None);
        assert!(radian.to(&radian).unwrap().is_identity());
        assert!(Unit::new(Document::parse("<B kg='x'/>").unwrap().root_element()).is_none());
    }

    #[test]
    fn transformations_are_composed_in_the_order_of_the_signal() {
        let double = Transformation::linear(2.0, 1.0);
        let negate = Transformation::linear(-1.0, 0.5);
        assert_eq!(double.clone().then(&negate).apply(3.0), Some(-6.5));
        let swap = Transformation::mapping(vec![(0.0, 1.0), (1.0, 0.0)]);
        assert_eq!(swap.clone().then(&swap).apply(1.0), Some(1.0));
        assert_eq!(swap.clone().then(&double).apply(0.0), Some(3.0));
        let late = double.then(&Transformation::mapping(vec![(7.0, 1.0)]));
        assert_eq!((late.apply(3.0), late.apply(4.0)), (Some(1.0), None));
        let lost = swap.then(&Transformation::mapping(vec![(1.0, 4.0)]));
        assert_eq!(lost.map, [(0.0, 4.0)]);
    }
}
