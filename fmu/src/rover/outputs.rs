//! What a rover shows beside its signals: events and measurements.

use bekker::signals::{Measurement, Signals};
use bekker::simulation::{Event, Status};
use bekker_modeldescription::xml::{Entry, Item};
use bekker_modeldescription::{Role, Unit, Variable};
use std::borrow::Cow;

/// Values of the output `event`.
pub(super) const EVENTS: &[Item] = &[
    Item { name: "running", value: 0, doc: "The simulation goes on." },
    Item { name: "stuck", value: 1, doc: "The wheels turn, the rover does not move." },
    Item { name: "tipped_over", value: 2, doc: "The pitch is beyond 80 degrees." },
    Item { name: "belly_contact", value: 3, doc: "The chassis touches the ground." },
    Item { name: "left_terrain", value: 4, doc: "A wheel is beyond the known ground." },
    Item { name: "sunk_to_axle", value: 5, doc: "A wheel has sunk to its axle." },
];

/// The value of the output `event`, a number of [`EVENTS`].
pub(super) fn number(status: Status) -> f64 {
    match status {
        Status::Running => 0.0,
        Status::Ended(Event::Stuck) => 1.0,
        Status::Ended(Event::TippedOver) => 2.0,
        Status::Ended(Event::BellyContact) => 3.0,
        Status::Ended(Event::LeftTerrain) => 4.0,
        Status::Ended(Event::SunkToAxle) => 5.0,
    }
}

/// The output that says why a simulation ended.
pub(super) fn event() -> Entry {
    Entry::enumeration(signal("event", "Why the simulation ended.", Unit::ONE), "Event", EVENTS)
}

fn signal(name: &str, doc: impl Into<Cow<'static, str>>, unit: Unit) -> Variable {
    Variable {
        name: name.into(),
        doc: doc.into(),
        unit,
        default: 0.0,
        min: f64::NEG_INFINITY,
        max: f64::INFINITY,
        role: Role::Signal,
        source: "physics".into(),
    }
}

/// What sensors report of a rover with so many wheels and links: names as the signals have them, in the order of
/// [`readings`].
pub(super) fn measurements(prefix: &str, wheels: usize, links: usize) -> Vec<Variable> {
    let speed = Unit::RADIAN_PER_SECOND;
    let mut all = vec![
        ("pitch".to_owned(), "Measured pitch of the chassis, nose up positive.", Unit::RADIAN),
        ("pitch_rate".to_owned(), "Measured rate of the pitch.", speed),
        (
            "velocity".to_owned(),
            "Measured speed of the chassis reference point along its path.",
            Unit::METRE_PER_SECOND,
        ),
    ];
    for k in 1..=wheels {
        all.push((format!("wheel[{k}].speed"), "Encoder speed relative to the carrying body.", speed));
        all.push((
            format!("wheel[{k}].torque"),
            "Torque from the motor current, wheel side of the gear.",
            Unit::NEWTON_METRE,
        ));
        all.push((format!("wheel[{k}].contact_angle"), "Contact angle as a sensor reports it.", Unit::RADIAN));
    }
    for j in 1..=links {
        all.push((format!("link[{j}].angle"), "Measured angle of the joint that carries the link.", Unit::RADIAN));
        all.push((format!("link[{j}].rate"), "Measured rate of that angle.", speed));
    }
    let named = |name: String| bekker_modeldescription::join(prefix, &name);
    all.into_iter().map(|(name, doc, unit)| signal(&named(name), doc, unit)).collect()
}

/// Calls `f` with the place of every reading.
pub(super) fn readings(measurement: &mut Measurement, mut f: impl FnMut(&mut f64)) {
    let Measurement { pitch, pitch_rate, velocity, wheels, links, .. } = measurement;
    [pitch, pitch_rate, velocity].into_iter().for_each(&mut f);
    for wheel in wheels {
        [&mut wheel.speed, &mut wheel.torque, &mut wheel.contact_angle].into_iter().for_each(&mut f);
    }
    for link in links {
        [&mut link.angle, &mut link.rate].into_iter().for_each(&mut f);
    }
}

/// Writes every reading into `places`.
pub(super) fn write_readings<'a>(measurement: &Measurement, mut places: impl Iterator<Item = &'a mut f64>) {
    let mut put = |value: f64| places.next().into_iter().for_each(|place| *place = value);
    let Measurement { pitch, pitch_rate, velocity, wheels, links, .. } = measurement;
    [*pitch, *pitch_rate, *velocity].into_iter().for_each(&mut put);
    wheels.iter().for_each(|wheel| [wheel.speed, wheel.torque, wheel.contact_angle].into_iter().for_each(&mut put));
    links.iter().for_each(|link| [link.angle, link.rate].into_iter().for_each(&mut put));
}

/// Writes what sensors without errors read of `signals` into `places`.
pub(super) fn write_true<'a>(signals: &Signals, mut places: impl Iterator<Item = &'a mut f64>) {
    let mut put = |value: f64| places.next().into_iter().for_each(|place| *place = value);
    let body = &signals.body;
    [body.pitch, body.pitch_rate, body.velocity].into_iter().for_each(&mut put);
    signals
        .wheels
        .iter()
        .for_each(|wheel| [wheel.speed, wheel.torque, wheel.contact_angle].into_iter().for_each(&mut put));
    signals.links.iter().for_each(|link| [link.angle, link.rate].into_iter().for_each(&mut put));
}
