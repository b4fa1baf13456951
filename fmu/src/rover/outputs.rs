//! What a rover shows beside its signals: how it stands, and what its sensors read.

use bekker::model::Model;
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

/// `event` as an integer, for tools that skip enumerations.
pub(super) fn event_code() -> Entry {
    let words: Vec<String> = EVENTS.iter().map(|item| format!("{} {}", item.value, item.name)).collect();
    let doc = format!("Number of `event`, for tools that do not read enumerations: {}.", words.join(", "));
    Entry::integer(whole("event_code", doc, (EVENTS.len() - 1) as f64))
}

/// The seed of the sensors' noise, for random draws by the importer.
///
/// # Errors
/// A sentence where the model's seed is larger than the integers of FMI 2.0.
pub(super) fn seed(model: &Model) -> Result<Entry, String> {
    let (seed, largest) = (f64::from(model.stepping.seed), f64::from(i32::MAX));
    if seed > largest {
        return Err(format!(
            "simulation.seed = {seed} is larger than the integers of an FMU; expected at most {largest}"
        ));
    }
    let doc = "Seed of the sensors' noise: another one draws other noise of the same size.".into();
    Ok(Entry::integer_parameter(whole("simulation.seed", doc, largest), seed))
}

/// An integer from 0 on.
fn whole(name: &str, doc: String, max: f64) -> Variable {
    let (name, doc, source) = (name.to_owned(), doc.into(), "".into());
    Variable { name, doc, unit: Unit::ONE, default: 0.0, min: 0.0, max, role: Role::Fixed, source }
}

/// What sensors report of a rover with so many wheels and links.
pub(super) fn measurements(prefix: &str, wheels: usize, links: usize) -> Vec<Variable> {
    let mut all = Vec::new();
    Measurement::of(wheels, links).visit(prefix, &mut |variable, _| all.push(variable));
    all
}
