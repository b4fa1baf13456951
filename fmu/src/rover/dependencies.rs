//! What the variables of a rover's FMU depend on at one instant.
//!
//! In model exchange the torques commanded of the wheels act at once on torques, currents and powers of the drives, and on
//! accelerations; positions, speeds, slip and the forces of the ground follow from the states. In co-simulation no output
//! answers to an input before the next step, so a model that offers nothing else has no such dependence, also not at the start.

use super::plant::References;
use bekker_modeldescription::xml::Entry;
use std::ops::Range;

/// Signals of the whole rover that answer to every torque at once, and of a wheel that answer to its own.
const OF_ALL_TORQUES: [&str; 2] = ["power", "electrical_power"];
const OF_OWN_TORQUE: [&str; 2] = ["torque", "current"];

/// States whose rates are other states: last parts of their names.
const RATES: [(&str, &str); 4] = [("x", "velocity_x"), ("z", "velocity_z"), ("pitch", "pitch_rate"), ("angle", "rate")];

/// Writes what the entries of a rover's FMU depend on; `exchange`: whether it offers model exchange.
pub(super) fn write(entries: &mut [Entry], references: &References, exchange: bool) {
    let inputs: Vec<usize> = references.inputs.clone().collect();
    let states: Vec<usize> = references.states.clone().collect();
    for reference in references.signals.clone() {
        let own = if exchange { feed_through(&entries[reference].variable.name, &inputs) } else { Vec::new() };
        let known = [&own[..], &states].concat();
        set(&mut entries[reference], known, own);
    }
    for (reference, signal) in references.measured.clone().zip(&references.measured_signals) {
        let known = entries[*signal].dependencies.clone().unwrap_or_default();
        // Sensors are read before the first command acts.
        set(&mut entries[reference], known, Vec::new());
    }
    for reference in [references.event, references.event_code] {
        set(&mut entries[reference], states.clone(), Vec::new());
    }
    for reference in references.states.clone() {
        entries[reference].initial_dependencies = Some(Vec::new());
    }
    derivatives(entries, references, &inputs);
}

fn set(entry: &mut Entry, known: Vec<usize>, at_start: Vec<usize>) {
    (entry.dependencies, entry.initial_dependencies) = (Some(known), Some(at_start));
}

fn derivatives(entries: &mut [Entry], references: &References, inputs: &[usize]) {
    let Range { start, end } = references.states;
    let moving: Vec<usize> = (start..end).filter(|state| !is_energy(&entries[*state].variable.name)).collect();
    for (state, derivative) in references.states.clone().zip(references.derivatives.clone()) {
        let rate = rate_of(&entries[state].variable.name);
        let rate = rate.and_then(|rate| (start..end).find(|other| entries[*other].variable.name == rate));
        match rate {
            Some(rate) => set(&mut entries[derivative], vec![rate], Vec::new()),
            None => set(&mut entries[derivative], [inputs, &moving[..]].concat(), inputs.to_vec()),
        }
    }
}

/// Nothing depends on the energies since the start.
fn is_energy(state: &str) -> bool {
    ["_energy", "_work", "_loss"].iter().any(|end| state.ends_with(end))
}

/// The state that is the rate of `state`.
fn rate_of(state: &str) -> Option<String> {
    let (group, last) = state.rsplit_once('.')?;
    RATES.iter().find(|(of, _)| *of == last).map(|(_, rate)| format!("{group}.{rate}"))
}

/// The torques, of all wheels in their order, to which a signal answers at once.
fn feed_through(signal: &str, torques: &[usize]) -> Vec<usize> {
    match of_wheel(signal) {
        Some(wheel) => torques.get(wheel).copied().into_iter().collect(),
        None if OF_ALL_TORQUES.contains(&signal) => torques.to_vec(),
        None => Vec::new(),
    }
}

/// The wheel, from 0 on, whose torque or current a signal is.
fn of_wheel(signal: &str) -> Option<usize> {
    let (number, last) = signal.strip_prefix("wheel[")?.split_once("].")?;
    let number: usize = number.parse().ok()?;
    OF_OWN_TORQUE.contains(&last).then(|| number.checked_sub(1)).flatten()
}
