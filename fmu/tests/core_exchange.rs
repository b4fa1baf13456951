//! The plant as differential equations behind the version-neutral border, and its derivatives.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod core_support;

use bekker::model::Model as RoverModel;
use bekker_fmu::Kind;
use bekker_fmu::model::{Continuous, FmuModel};
use bekker_modeldescription::xml::Causality;
use core_support::{all, get, loaded, reference, set};

/// Step of the explicit method of order 4, s.
const FINE: f64 = 1e-4;

fn plant(parameters: &[(&str, f64)]) -> Box<dyn FmuModel> {
    let mut fmu = loaded(&RoverModel::preset("gentle_velocity").unwrap(), Kind::Rover);
    parameters.iter().for_each(|(name, value)| set(&mut *fmu, name, *value));
    fmu.start().unwrap();
    fmu
}

/// Rates at these states.
fn rates(equations: &mut dyn Continuous, x: &[f64]) -> Vec<f64> {
    let mut dx = vec![0.0; x.len()];
    equations.set_states(x).unwrap();
    equations.rates(&mut dx).unwrap();
    dx
}

/// Integrates up to `end` as a tool would that knows the standard alone.
fn integrate(fmu: &mut dyn FmuModel, from: f64, end: f64) {
    let equations = fmu.continuous().unwrap();
    let mut x = vec![0.0; equations.states().len()];
    equations.get_states(&mut x);
    let steps = ((end - from) / FINE).round() as u32;
    for step in 0..steps {
        let moved = |k: &[f64], by: f64| x.iter().zip(k).map(|(x, k)| x + by * k).collect::<Vec<f64>>();
        let k1 = rates(equations, &x);
        let k2 = rates(equations, &moved(&k1, 0.5 * FINE));
        let k3 = rates(equations, &moved(&k2, 0.5 * FINE));
        let k4 = rates(equations, &moved(&k3, FINE));
        x = (0..x.len()).map(|i| x[i] + FINE / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i])).collect();
        equations.set_time(from + f64::from(step + 1) * FINE);
        equations.set_states(&x).unwrap();
        assert_eq!(equations.completed_step().unwrap().terminate, None);
    }
}

#[test]
fn agreement_of_model_exchange_with_co_simulation() {
    const TORQUES: [(&str, f64); 2] = [("wheel[1].torque_command", 1.7), ("wheel[2].torque_command", 1.8)];
    let mut exchange = plant(&[]);
    exchange.continuous().unwrap().check().unwrap();
    TORQUES.iter().for_each(|(name, value)| set(&mut *exchange, name, *value));
    integrate(&mut *exchange, 0.0, 0.6);
    let at_step = |step_size: f64| {
        let mut model = RoverModel::preset("gentle_velocity").unwrap();
        model.stepping.step_size = step_size;
        let mut fmu = loaded(&model, Kind::Rover);
        fmu.start().unwrap();
        TORQUES.iter().for_each(|(name, value)| set(&mut *fmu, name, *value));
        fmu.advance_to(0.6).unwrap();
        ["x", "z", "pitch", "velocity", "wheel[1].speed"].map(|name| get(&*fmu, name))
    };
    let exact = ["x", "z", "pitch", "velocity", "wheel[1].speed"].map(|name| get(&*exchange, name));
    assert!(exact[0] > 0.02, "it has moved: {exact:?}");
    let error =
        |step_size: f64| at_step(step_size).iter().zip(exact).map(|(y, exact)| (y - exact).abs()).fold(0.0, f64::max);
    let (coarse, fine) = (error(0.002), error(0.001));
    println!("errors of the simulation: {coarse:e} at 2 ms, {fine:e} at 1 ms");
    // Order 2, and 1.5 at least where the start from rest is rough.
    assert!(fine < coarse / 2.8, "{fine} after {coarse}");
    assert!(coarse < 1e-3, "{coarse}");
}

#[test]
fn property_entries_of_states_and_derivatives_belong_together() {
    let mut fmu = plant(&[]);
    let description = fmu.description().clone();
    let equations = fmu.continuous().unwrap();
    let (states, derivatives) = (equations.states().to_vec(), equations.derivatives().to_vec());
    let mut x = vec![0.0; states.len()];
    equations.get_states(&mut x);
    let dx = rates(equations, &x);
    let mut sizes = vec![0.0; states.len()];
    equations.nominals(&mut sizes);
    assert_eq!(states.len(), derivatives.len());
    for (k, (&state, &derivative)) in states.iter().zip(&derivatives).enumerate() {
        let (of, by) = (&description.entries[state], &description.entries[derivative]);
        assert_eq!(by.derivative_of, Some(state));
        assert_eq!(by.variable.name, format!("der({})", of.variable.name));
        assert_eq!(of.nominal, Some(sizes[k]));
        assert_eq!((of.causality, by.causality), (Causality::Local, Causality::Local));
        assert_eq!((fmu.get(state), fmu.get(derivative)), (x[k], dx[k]), "{}", of.variable.name);
    }
    let wrong = fmu.continuous().unwrap().set_states(&[0.0]).unwrap_err();
    assert!(wrong.0.contains("expected"), "{wrong}");
    x[2] = f64::NAN;
    let wrong = fmu.continuous().unwrap().set_states(&x).unwrap_err();
    assert!(wrong.0.contains("state.pitch"), "{wrong}");
}

#[test]
fn property_memories_and_noise_are_refused_by_name() {
    for (name, value) in [
        ("multi_pass.growth", 0.2),
        ("sensor_lag.dead_time", 0.05),
        ("sensor_lag.time_constant", 0.05),
        ("sensor.pitch_noise", 0.01),
        ("sensor.wheel_speed_period", 0.1),
    ] {
        let failure = plant(&[(name, value)]).continuous().unwrap().check().unwrap_err();
        assert!(failure.0.contains(name), "{failure}");
    }
    let mut closed = loaded(&RoverModel::preset("gentle_rtc").unwrap(), Kind::RoverWithController);
    assert!(closed.continuous().is_none());
    let mut speeds = loaded(&RoverModel::preset("two_wheeled_speed").unwrap(), Kind::Rover);
    assert!(speeds.continuous().is_none());
    assert!(loaded(&RoverModel::preset("gentle_rtc").unwrap(), Kind::Controller).continuous().is_none());
}

#[test]
fn property_an_end_is_told_with_its_reason() {
    let mut fmu = plant(&[]);
    let pitch = reference(&*fmu, "state.pitch");
    let pitch = fmu.continuous().unwrap().states().iter().position(|&state| state == pitch);
    let equations = fmu.continuous().unwrap();
    let mut x = vec![0.0; equations.states().len()];
    equations.get_states(&mut x);
    let mut z = vec![0.0; equations.indicators()];
    equations.event_indicators(&mut z).unwrap();
    assert!(z.iter().all(|indicator| *indicator > 0.0), "{z:?}");
    assert_eq!(equations.handle_event().unwrap().terminate, None);
    x[pitch.unwrap()] = 1.45;
    equations.set_states(&x).unwrap();
    equations.event_indicators(&mut z).unwrap();
    assert!(z.iter().any(|indicator| *indicator < 0.0));
    let ended = equations.handle_event().unwrap().terminate.unwrap();
    assert!(ended.contains("tipped over"), "{ended}");
    assert_eq!(get(&*fmu, "event"), 2.0);
    // Wheels that spin on the spot: stuck after six radii of the rim's way.
    let mut stuck = plant(&[("drag.force", 60.0)]);
    set(&mut *stuck, "wheel[1].torque_command", 2.5);
    set(&mut *stuck, "wheel[2].torque_command", 2.5);
    let equations = stuck.continuous().unwrap();
    equations.get_states(&mut x);
    let spins: Vec<usize> = {
        let entries = &plant(&[]).description().entries.clone();
        let states = equations.states().to_vec();
        (0..states.len()).filter(|&k| entries[states[k]].variable.name.ends_with(".spin")).collect()
    };
    let mut reason = None;
    for k in 1..=1000 {
        spins.iter().for_each(|&spin| x[spin] = 3.0);
        equations.set_time(f64::from(k) * 0.01);
        equations.set_states(&x).unwrap();
        reason = equations.completed_step().unwrap().terminate;
        if reason.is_some() {
            break;
        }
    }
    assert!(reason.unwrap().contains("stuck"));
}

/// Differences over 1e-6 of typical sizes, and the accuracy of the quadrature along the rim, whose cuts carry no
/// derivatives.
const DIFFERENCES: f64 = 2e-5;

#[test]
fn agreement_of_derivatives_with_differences_and_with_each_other() {
    // At the limit by the supply a torque no longer follows its command.
    let mut fmu = plant(&[("motor.inverse_voltage", 0.0)]);
    set(&mut *fmu, "wheel[1].torque_command", 1.7);
    set(&mut *fmu, "wheel[2].torque_command", 1.8);
    fmu.advance_to(0.5).unwrap();
    // In co-simulation: how outputs answer to inputs at once.
    let inputs = all(&*fmu, Causality::Input);
    let outputs = ["wheel[1].torque", "wheel[2].current", "power", "wheel[1].slip"].map(|name| reference(&*fmu, name));
    let mut out = [0.0; 4];
    fmu.directional(&outputs, &inputs, &[1.0, 0.5], &mut out).unwrap();
    assert_eq!((out[0], out[3]), (1.0, 0.0));
    let constant = 100.0 * 0.0234;
    assert!((out[1] - 0.5 / constant).abs() < 1e-12, "{out:?}");
    let current = |k: usize| get(&*fmu, &format!("wheel[{k}].current"));
    let expected = 2.0 * 2.32 * (current(1) + 0.5 * current(2)) / constant;
    assert!((out[2] - expected).abs() < 1e-12 * expected, "{out:?}, {expected}");
    let event = reference(&*fmu, "event");
    assert!(fmu.directional(&[event], &inputs, &[1.0, 0.0], &mut [0.0]).unwrap_err().0.contains("event"));
    let soil = reference(&*fmu, "soil.cohesion");
    assert!(fmu.directional(&outputs[..1], &[soil], &[1.0], &mut [0.0]).unwrap_err().0.contains("soil.cohesion"));
    assert!(fmu.directional(&outputs, &inputs, &[1.0], &mut out).is_err());

    // In Model Exchange: everything by everything, under way.
    integrate(&mut *fmu, 0.0, 0.2);
    let (states, derivatives) = {
        let equations = fmu.continuous().unwrap();
        (equations.states().to_vec(), equations.derivatives().to_vec())
    };
    let signals = reference(&*fmu, "x")..reference(&*fmu, "event");
    let unknowns: Vec<usize> = derivatives.iter().copied().chain(signals).collect();
    let knowns: Vec<usize> = states.iter().chain(&inputs).copied().collect();
    let mut x = vec![0.0; states.len()];
    fmu.continuous().unwrap().get_states(&mut x);
    let mut sizes = vec![1.0; knowns.len()];
    fmu.continuous().unwrap().nominals(&mut sizes[..states.len()]);
    let torques: Vec<f64> = inputs.iter().map(|&input| fmu.get(input)).collect();
    let mut at = |known: usize, by: f64| {
        let (mut x, mut torques) = (x.clone(), torques.clone());
        if known < x.len() {
            x[known] += by
        } else {
            torques[known - x.len()] += by
        }
        inputs.iter().zip(&torques).for_each(|(&input, &torque)| fmu.set(input, torque));
        rates(fmu.continuous().unwrap(), &x);
        unknowns.iter().map(|&unknown| fmu.get(unknown)).collect::<Vec<f64>>()
    };
    let differences: Vec<Vec<f64>> = (0..knowns.len())
        .map(|known| {
            let h = 1e-6 * sizes[known];
            at(known, h).iter().zip(at(known, -h)).map(|(more, less)| (more - less) / 2e-6).collect()
        })
        .collect();
    let here = at(0, 0.0);
    let mut matrix = Vec::new();
    for known in 0..knowns.len() {
        let mut column = vec![0.0; unknowns.len()];
        fmu.directional(&unknowns, &knowns[known..=known], &[sizes[known]], &mut column).unwrap();
        for (i, exact) in column.iter().enumerate() {
            let room = DIFFERENCES * (1.0 + here[i].abs() + exact.abs());
            let name = |reference: usize| fmu.description().entries[reference].variable.name.clone();
            let pair = (name(unknowns[i]), name(knowns[known]));
            assert!((exact - differences[known][i]).abs() < room, "{pair:?}: {exact}, {}", differences[known][i]);
        }
        matrix.push(column);
    }
    let weights: Vec<f64> = (0..unknowns.len()).map(|i| (i as f64).sin()).collect();
    let mut pulled = vec![0.0; knowns.len()];
    fmu.adjoint(&unknowns, &knowns, &weights, &mut pulled).unwrap();
    for (known, pulled) in pulled.iter().enumerate() {
        let expected: f64 = matrix[known].iter().zip(&weights).map(|(a, b)| a * b).sum::<f64>() / sizes[known];
        let scale: f64 = matrix[known].iter().map(|a| a.abs()).sum::<f64>() / sizes[known];
        assert!((pulled - expected).abs() <= 1e-12 * (1.0 + scale), "{pulled}, {expected}");
    }
    let mut closed = loaded(&RoverModel::preset("gentle_rtc").unwrap(), Kind::RoverWithController);
    closed.start().unwrap();
    let (x, goal) = (reference(&*closed, "x"), reference(&*closed, "velocity_command"));
    assert!(closed.directional(&[x], &[goal], &[1.0], &mut [0.0]).is_err());
}

#[test]
fn property_a_state_saved_between_steps_of_an_integrator_goes_on() {
    let mut fmu = plant(&[("winding_heat.thermal_resistance", 5.0)]);
    set(&mut *fmu, "wheel[1].torque_command", 1.7);
    set(&mut *fmu, "wheel[2].torque_command", 1.8);
    integrate(&mut *fmu, 0.0, 0.1);
    let bytes = fmu.serialise().unwrap();
    let mut other = plant(&[]);
    other.deserialise(&bytes).unwrap();
    integrate(&mut *fmu, 0.1, 0.2);
    integrate(&mut *other, 0.1, 0.2);
    assert_eq!(core_support::bits(&*other), core_support::bits(&*fmu));
    assert_eq!(other.serialise().unwrap(), fmu.serialise().unwrap());
}

#[test]
fn agreement_of_the_stated_dependencies_with_derivatives() {
    // Every derivative that is not zero at some points of a drive is stated, and every stated torque has one.
    let mut fmu = plant(&[]);
    let description = fmu.description().clone();
    let torques = ["wheel[1].torque_command", "wheel[2].torque_command"].map(|name| reference(&*fmu, name));
    let states = fmu.continuous().unwrap().states().to_vec();
    let knowns = [&torques[..], &states].concat();
    let derivatives = fmu.continuous().unwrap().derivatives().to_vec();
    let unknowns: Vec<usize> = all(&*fmu, Causality::Output)
        .into_iter()
        .filter(|reference| !description.entries[*reference].variable.name.starts_with("event"))
        .filter(|reference| !description.entries[*reference].variable.name.starts_with("measured"))
        .chain(derivatives)
        .collect();
    let mut seen = vec![vec![false; knowns.len()]; unknowns.len()];
    for (until, torque) in [(0.3, 1.7), (0.6, -1.2), (0.9, 2.5)] {
        set(&mut *fmu, "wheel[1].torque_command", torque);
        set(&mut *fmu, "wheel[2].torque_command", 0.9 * torque);
        fmu.advance_to(until).unwrap();
        for (k, known) in knowns.iter().enumerate() {
            let mut column = vec![0.0; unknowns.len()];
            fmu.directional(&unknowns, &[*known], &[1.0], &mut column).unwrap();
            seen.iter_mut().zip(column).for_each(|(row, value)| row[k] |= value != 0.0);
        }
    }
    for (unknown, row) in unknowns.iter().zip(&seen) {
        let entry = &description.entries[*unknown];
        let stated = description.dependencies(entry);
        let name = &entry.variable.name;
        for (known, seen) in knowns.iter().zip(row) {
            let of = &description.entries[*known].variable.name;
            assert!(!seen || stated.contains(known), "`{name}` depends on `{of}`, which is not stated");
            let torque_of_output = torques.contains(known) && entry.causality == Causality::Output;
            assert!(!torque_of_output || *seen || !stated.contains(known), "`{name}` does not depend on `{of}`");
        }
    }
}

#[test]
fn property_derivatives_are_finite_wherever_an_integrator_looks() {
    let mut fmu = plant(&[]);
    let equations = fmu.continuous().unwrap();
    let mut start = vec![0.0; equations.states().len()];
    equations.get_states(&mut start);
    let at_rest = rates(equations, &start);
    // Every state far away, one at a time and all together.
    for size in [1.0, 1e2, 1e4, 1e8] {
        for sign in [-1.0, 1.0] {
            let mut all = start.clone();
            for k in 0..start.len() {
                let mut x = start.clone();
                x[k] += sign * size;
                all[k] += sign * size;
                assert!(rates(equations, &x).iter().all(|rate| rate.is_finite()), "state {k} moved by {}", sign * size);
            }
            assert!(rates(equations, &all).iter().all(|rate| rate.is_finite()), "all states moved by {}", sign * size);
        }
    }
    // High above the ground nothing but weight acts, deep below it the ground lifts.
    let mut x = start.clone();
    x[1] += 50.0;
    assert!((rates(equations, &x)[4] + 9.81).abs() < 1e-9);
    x[1] = -50.0;
    assert!(rates(equations, &x)[4] > 0.0);
    assert_eq!(rates(equations, &start), at_rest, "nothing is kept of it");
}

#[test]
fn property_a_lost_motion_is_an_error_that_says_so() {
    let mut fmu = plant(&[]);
    set(&mut *fmu, "wheel[1].torque_command", 1.7);
    set(&mut *fmu, "wheel[2].torque_command", 1.8);
    let equations = fmu.continuous().unwrap();
    let mut x = vec![0.0; equations.states().len()];
    equations.get_states(&mut x);
    // Euler's method with twenty-five times the step that it stands.
    let step = 5e-3;
    let lost = (1..=200).find_map(|k| {
        let dx = rates(equations, &x);
        x.iter_mut().zip(dx).for_each(|(x, dx)| *x += step * dx);
        equations.set_time(f64::from(k) * step);
        equations.set_states(&x).unwrap();
        equations.completed_step().err()
    });
    let lost = lost.unwrap().0;
    assert!(lost.contains("does not follow the equations") && lost.contains("implicit"), "{lost}");
}

#[test]
fn agreement_of_co_simulation_with_model_exchange_at_the_start() {
    let torques = [("wheel[1].torque_command", 1.7), ("wheel[2].torque_command", 1.8)];
    let (mut steps, mut exchange) = (plant(&[]), plant(&[]));
    for fmu in [&mut steps, &mut exchange] {
        torques.iter().for_each(|(name, value)| set(&mut **fmu, name, *value));
        fmu.start().unwrap();
    }
    let mut dx = vec![0.0; exchange.continuous().unwrap().states().len()];
    exchange.continuous().unwrap().rates(&mut dx).unwrap();
    for reference in all(&*steps, Causality::Output) {
        let name = steps.description().entries[reference].variable.name.clone();
        // Sensors are read before the first command acts.
        if !name.starts_with("measured") {
            assert_eq!(steps.get(reference), exchange.get(reference), "{name}");
        }
    }
    assert_eq!(get(&*steps, "wheel[2].torque"), 1.8);
    assert!(get(&*steps, "power") > 0.1);
}
