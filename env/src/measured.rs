//! Readings of sensors, in the places of the signals that they measure.

use bekker::modeldescription::Parameters;
use bekker::signals::{Measurement, Signals};

/// Names of the signals that sensors read, in the order of [`read`].
pub fn names(signals: &Signals) -> Vec<String> {
    let body = ["pitch", "pitch_rate", "velocity"].map(str::to_owned);
    let wheel = |k: usize| ["speed", "torque", "contact_angle"].map(|what| format!("wheel[{}].{what}", k + 1));
    let link = |k: usize| ["angle", "rate"].map(|what| format!("link[{}].{what}", k + 1));
    let wheels = (0..signals.wheels.len()).flat_map(wheel);
    body.into_iter().chain(wheels).chain((0..signals.links.len()).flat_map(link)).collect()
}

/// Their places in a row of signals in the vocabulary's order.
pub fn places(signals: &Signals) -> Vec<usize> {
    let mut order = Vec::new();
    signals.clone().visit("", &mut |variable, _| order.push(variable.name));
    names(signals).iter().filter_map(|name| order.iter().position(|other| other == name)).collect()
}

/// Puts readings into their places of a row; those of sensors that have not been read yet stay as they are.
pub fn read(measurement: &Measurement, places: &[usize], row: &mut [f64]) {
    if measurement.wheels.is_empty() {
        return;
    }
    let Measurement { pitch, pitch_rate, velocity, wheels, links, .. } = measurement;
    let wheels = wheels.iter().flat_map(|wheel| [wheel.speed, wheel.torque, wheel.contact_angle]);
    let links = links.iter().flat_map(|link| [link.angle, link.rate]);
    let values = [*pitch, *pitch_rate, *velocity].into_iter().chain(wheels).chain(links);
    for (place, value) in places.iter().zip(values) {
        if let Some(entry) = row.get_mut(*place) {
            *entry = value;
        }
    }
}
