//! What a rover shows beside its signals: how it stands, and what its sensors read.

use bekker::signals::Measurement;
use bekker::simulation::Status;
use bekker_modeldescription::xml::{Entry, Item};
use bekker_modeldescription::{Parameters, Role, Unit, Variable};

/// Values of the output `event`: the places of [`Status::ALL`].
const EVENTS: &[Item] = &{
    let mut items = [Item { name: "", value: 0, doc: "" }; Status::ALL.len()];
    let mut place = 0;
    while place < items.len() {
        let entry = &Status::ALL[place];
        items[place] = Item { name: entry.word, value: place as i64, doc: entry.doc };
        place += 1;
    }
    items
};

/// The output that says why a simulation ended.
pub(super) fn event() -> Entry {
    let variable = Variable {
        name: "event".into(),
        doc: "Why the simulation ended.".into(),
        unit: Unit::ONE,
        default: 0.0,
        min: f64::NEG_INFINITY,
        max: f64::INFINITY,
        role: Role::Signal,
        source: "physics".into(),
    };
    Entry::enumeration(variable, "Event", EVENTS)
}

/// What sensors report of a rover with so many wheels and links.
pub(super) fn measurements(prefix: &str, wheels: usize, links: usize) -> Vec<Variable> {
    let mut all = Vec::new();
    Measurement::of(wheels, links).visit(prefix, &mut |variable, _| all.push(variable));
    all
}
