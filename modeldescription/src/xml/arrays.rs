//! Arrays of FMI 3.0: the same quantity of every wheel, link or obstacle as one variable.

use super::{Causality, Entry, Kind};

/// Which entries of a description are shown together as one array; none by default.
///
/// Entries `wheel[1].slip`, `wheel[2].slip`, .. become `wheels.slip`, whose value reference is that of its first element.
/// Continuous states, their derivatives and enumerations stay by themselves.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Arrays {
    /// References of each array's elements, in the order of the first.
    arrays: Vec<Vec<usize>>,
}

impl Arrays {
    /// All arrays that `entries` allow: at least two numbered parts, of one causality, variability, unit and range.
    #[must_use]
    pub fn of(entries: &[Entry]) -> Self {
        let mut groups: Vec<(String, Vec<usize>)> = Vec::new();
        for (reference, entry) in entries.iter().enumerate() {
            let state = entries.iter().any(|other| other.derivative_of == Some(reference));
            let alone = state || entry.kind != Kind::Real || entry.derivative_of.is_some();
            let Some((name, _)) = numbered(&entry.variable.name).filter(|_| !alone) else { continue };
            match groups.iter_mut().find(|(other, _)| *other == name) {
                Some((_, elements)) => elements.push(reference),
                None => groups.push((name, vec![reference])),
            }
        }
        groups.retain(|(name, elements)| {
            elements.len() > 1
                && entries.iter().all(|entry| entry.variable.name != *name)
                && elements.iter().enumerate().all(|(k, reference)| {
                    let number = numbered(&entries[*reference].variable.name).map(|(_, number)| number);
                    number == Some(k + 1) && alike(&entries[*reference], &entries[elements[0]])
                })
        });
        Self { arrays: groups.into_iter().map(|(_, elements)| elements).collect() }
    }

    /// Whether every entry is shown by itself.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.arrays.is_empty()
    }

    /// The references of an array's elements, where `reference` is one's.
    #[must_use]
    pub fn elements(&self, reference: usize) -> Option<&[usize]> {
        let place = self.arrays.binary_search_by_key(&reference, |elements| elements[0]).ok()?;
        Some(&self.arrays[place])
    }

    /// The reference under which an entry is shown and its place there, from 0 on.
    #[must_use]
    pub fn shown(&self, reference: usize) -> (usize, usize) {
        let place = |elements: &Vec<usize>| Some((elements[0], elements.iter().position(|other| *other == reference)?));
        self.arrays.iter().find_map(place).unwrap_or((reference, 0))
    }

    /// Whether a reference is that of a later element, which no variable has.
    #[must_use]
    pub fn hides(&self, reference: usize) -> bool {
        self.shown(reference).1 > 0
    }

    /// The name under which an entry is shown.
    #[must_use]
    pub fn name(&self, reference: usize, entry: &Entry) -> String {
        let array = self.elements(reference).and_then(|_| numbered(&entry.variable.name));
        array.map_or_else(|| entry.variable.name.clone(), |(name, _)| name)
    }
}

/// `wheels.slip` and 2 of `wheel[2].slip`.
fn numbered(name: &str) -> Option<(String, usize)> {
    let (part, rest) = name.split_once('[')?;
    let (number, member) = rest.split_once("].")?;
    Some((format!("{part}s.{member}"), number.parse().ok()?))
}

fn alike(a: &Entry, b: &Entry) -> bool {
    let of = |entry: &Entry| {
        (entry.causality, entry.variability, entry.variable.unit, entry.variable.min, entry.variable.max)
    };
    a.causality != Causality::Independent && of(a) == of(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Role, Unit, Variable};

    fn variable(name: &str, max: f64) -> Variable {
        let (name, doc, source) = (name.to_owned(), "".into(), "".into());
        Variable { name, doc, unit: Unit::ONE, default: 0.0, min: 0.0, max, role: Role::Signal, source }
    }

    #[test]
    fn property_only_like_parts_become_arrays() {
        let named = |name: &str| Entry::output(variable(name, 1.0));
        let entries = [
            Entry::time(),
            named("wheel[1].slip"),
            named("wheel[1].load"),
            named("wheel[2].slip"),
            Entry::output(variable("wheel[2].load", 2.0)),
            named("link[1].angle"),
            named("measured.wheel[1].speed"),
            named("measured.wheel[2].speed"),
            Entry::state(variable("wheel[1].spin", 1.0), 1.0),
            Entry::state(variable("wheel[2].spin", 1.0), 1.0),
            Entry::derivative(variable("wheel[1].acceleration", 1.0), 8),
            Entry::derivative(variable("wheel[2].acceleration", 1.0), 9),
        ];
        let arrays = Arrays::of(&entries);
        let shown: Vec<String> = (0..entries.len())
            .filter(|reference| !arrays.hides(*reference))
            .map(|reference| arrays.name(reference, &entries[reference]))
            .collect();
        let expected = [
            "time",
            "wheels.slip",
            "wheel[1].load",
            "wheel[2].load",
            "link[1].angle",
            "measured.wheels.speed",
            "wheel[1].spin",
            "wheel[2].spin",
            "wheel[1].acceleration",
            "wheel[2].acceleration",
        ];
        assert_eq!(shown, expected);
        assert_eq!(arrays.elements(1), Some(&[1, 3][..]));
        assert_eq!([arrays.shown(3), arrays.shown(4)], [(1, 1), (4, 0)]);
    }

    #[test]
    fn property_an_array_takes_no_name_that_is_there() {
        let entries =
            ["wheel[1].radius", "wheel[2].radius", "wheels.radius"].map(|name| Entry::output(variable(name, 1.0)));
        assert!(Arrays::of(&entries).is_empty());
    }
}
