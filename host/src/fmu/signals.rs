//! Moves many scalars of an instance in or out in as few calls as there are types.

use super::description::{Description, Scalar, Version};
use super::error::Error;
use super::instance::Instance;
use super::value::{Buffer, Kind, Value};

/// A fixed list of numeric scalars, ready to be read or written with one call for each type and neither
/// look-up nor allocation. An element of an array moves with its whole array.
#[derive(Clone, Debug)]
pub struct Signals {
    groups: Vec<Group>,
    length: usize,
}

#[derive(Clone, Debug)]
struct Group {
    kind: Kind,
    references: Vec<u32>,
    /// Variables and the position of their first element in `values`.
    variables: Vec<(usize, usize)>,
    values: Buffer,
    /// Position in `values`, position in the list of scalars.
    positions: Vec<(usize, usize)>,
}

impl Signals {
    /// Signals for `scalars`, which must be of `description`. Scalars that are not numeric are left out:
    /// their values stay as they are.
    pub fn new(description: &Description, scalars: &[Scalar]) -> Self {
        let mut signals = Self {
            groups: Vec::new(),
            length: scalars.len(),
        };
        for (position, scalar) in scalars.iter().enumerate() {
            signals.add(description, *scalar, position);
        }
        signals
    }

    fn add(&mut self, description: &Description, scalar: Scalar, position: usize) {
        let variable = description.variable(scalar);
        let kind = variable.kind;
        let index = match self.groups.iter().position(|g| g.kind == kind) {
            Some(index) => index,
            None => {
                let Some(values) = Buffer::new(kind, description.version == Version::V3) else {
                    return;
                };
                self.groups.push(Group {
                    kind,
                    references: Vec::new(),
                    variables: Vec::new(),
                    values,
                    positions: Vec::new(),
                });
                self.groups.len() - 1
            }
        };
        let group = &mut self.groups[index];
        let known = group.variables.iter().find(|(v, _)| *v == scalar.variable);
        let first = match known {
            Some(&(_, first)) => first,
            None => {
                let first = group.values.len();
                group.references.push(variable.reference);
                group.variables.push((scalar.variable, first));
                for element in 0..variable.length() {
                    group.values.push_zero();
                    if let Some(start) = variable.start_of(element) {
                        group.values.store(first + element, &start);
                    }
                }
                first
            }
        };
        group.positions.push((first + scalar.element, position));
    }

    /// Number of scalars.
    pub fn len(&self) -> usize {
        self.length
    }

    /// Whether there are no scalars.
    pub fn is_empty(&self) -> bool {
        self.length == 0
    }

    /// Reads all scalars; `numbers` holds at least as many as there are scalars.
    pub fn read(&mut self, instance: &mut Instance, numbers: &mut [f64]) -> Result<(), Error> {
        for group in &mut self.groups {
            instance.get(&group.references, &mut group.values)?;
            group.values.scatter(&group.positions, numbers);
        }
        Ok(())
    }

    /// Writes all scalars. The other elements of an array keep the value written last, at first their start.
    pub fn write(&mut self, instance: &mut Instance, numbers: &[f64]) -> Result<(), Error> {
        for group in &mut self.groups {
            group.values.gather(&group.positions, numbers);
            instance.set(&group.references, &group.values)?;
        }
        Ok(())
    }

    /// Writes exact values, one for each scalar.
    pub(super) fn write_values(
        &mut self,
        instance: &mut Instance,
        values: &[(Scalar, Value)],
    ) -> Result<(), Error> {
        for group in &mut self.groups {
            for &(to, from) in &group.positions {
                group.values.store(to, &values[from].1);
            }
            instance.set(&group.references, &group.values)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::description::Causality;
    use super::super::description::tests::{description, variable};
    use super::*;

    #[test]
    fn scalars_are_grouped_by_type_and_arrays_kept_whole() {
        let mut array = variable("a", Causality::Parameter);
        array.dimensions = vec![3];
        array.start = vec!["1".into(), "2".into(), "3".into()];
        let mut count = variable("n", Causality::Input);
        count.kind = Kind::Int32;
        let mut text = variable("s", Causality::Input);
        text.kind = Kind::String;
        let d = description(vec![variable("x", Causality::Input), array, count, text]);
        let names = ["a[3]", "x", "n", "a[1]", "s"];
        let scalars: Vec<_> = names.iter().map(|n| d.scalar(n).unwrap()).collect();
        let mut signals = Signals::new(&d, &scalars);
        assert_eq!(signals.len(), 5);
        assert_eq!(signals.groups.len(), 2);
        let group = &mut signals.groups[0];
        assert_eq!(group.references.len(), 2);
        assert_eq!(group.values, Buffer::Float64(vec![1.0, 2.0, 3.0, 0.0]));
        group
            .values
            .gather(&group.positions, &[30.0, 9.0, 0.0, 10.0, 0.0]);
        assert_eq!(group.values, Buffer::Float64(vec![10.0, 2.0, 30.0, 9.0]));
    }
}
