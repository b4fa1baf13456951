//! What the instantiation token is made of: the texts of a description with their lengths, its numbers in their bits. The XML would
//! do as well, but the library of an FMU, which checks the token, needs no other part of what writes it, and is tens of
//! kilobytes smaller without.

use super::{Description, Entry, Experiment, Kind};
use crate::Variable;

/// A description as bytes, the date apart. A unit stands for itself by its symbol. Arrays follow from the entries and from the
/// packed text, which is the content; the categories of the log are the same for all.
pub(super) fn bytes(description: &Description) -> Vec<u8> {
    let Description { name, identifier, description: about, version, license, author, copyright, .. } = description;
    let Experiment { start, stop, step } = description.experiment;
    let mut bytes = Bytes(Vec::new());
    let texts = [name, identifier, about, version, license, author, copyright];
    for text in texts.into_iter().chain([&description.generation_tool, &description.content]) {
        bytes.text(text);
    }
    for number in [start, stop, step, description.inner_step] {
        bytes.number(number);
    }
    for entry in &description.entries {
        bytes.entry(entry);
    }
    bytes.0
}

struct Bytes(Vec<u8>);

impl Bytes {
    fn text(&mut self, text: &str) {
        self.0.extend((text.len() as u64).to_le_bytes());
        self.0.extend(text.as_bytes());
    }

    fn number(&mut self, number: f64) {
        self.0.extend(number.to_bits().to_le_bytes());
    }

    fn entry(&mut self, entry: &Entry) {
        // What an entry depends on follows from the kind of model, as the names do.
        let Entry { variable, kind, start, causality, variability, derivative_of, nominal, .. } = entry;
        // The value that an entry starts with takes the place of the default.
        let Variable { name, doc, unit, default: _, min, max, role: _, source } = variable;
        for text in [name, &**doc, unit.symbol, &**source, causality.word(), variability.word()] {
            self.text(text);
        }
        let state = derivative_of.map_or(f64::NAN, |state| state as f64);
        for number in [*start, *min, *max, nominal.unwrap_or(f64::NAN), state] {
            self.number(number);
        }
        if *kind == Kind::Integer {
            self.text("integer");
        }
        if let Kind::Enumeration { name, items } = kind {
            self.text(name);
            self.number(items.len() as f64);
            for item in *items {
                self.text(item.name);
                self.text(item.doc);
                self.number(item.value as f64);
            }
        }
    }
}
