//! The rover as explicit differential equations, and their derivatives.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker::equations::{Equations, NoEquations, States, derivative_of};
use bekker::model::{AnyPlant, ControlKind, Model};
use bekker::modeldescription::{Lookup, Parameters};
use bekker::signals::Command;
use bekker::simulation::{Event, Simulation};

/// Step of the explicit method of order 4, s: a third of its limit of stability on the stiffest state, 2.8 over about
/// 1e4 /s, and so that its own error is far under those that are compared.
const FINE: f64 = 1e-4;
/// Room for an order that is measured at finite steps.
const ORDER: f64 = 0.4;
/// As tests/rover_derivatives.rs has it: where the shear changes its sign or builds up quickly, the quadrature along the
/// rim is cut, and the cuts carry no derivatives, so these are exact to the quadrature's own accuracy, 1e-6 of the load.
const DIFFERENCES: f64 = 2e-5;
/// How long the drives are, s.
const DRIVE: f64 = 0.4;

fn model(preset: &str, parameters: &[(&str, f64)]) -> Model {
    let mut model = Model::preset(preset).unwrap();
    model.control.kind = ControlKind::Torque;
    for (name, value) in parameters {
        model.set(name, *value).unwrap();
    }
    model
}

/// A simulation of `model` that has made `steps` inner steps under `torques`.
fn under_way(model: &Model, torques: &[f64], steps: u64) -> Simulation {
    let mut run = model.start().unwrap();
    run.inputs_mut().set_all(torques).unwrap();
    run.advance(steps).unwrap();
    match run.simulation() {
        AnyPlant::JointCoordinates(simulation) => Simulation::clone(simulation),
        #[allow(unreachable_patterns, reason = "without the feature `rigid` there is one plant")]
        _ => panic!("another plant"),
    }
}

fn states(equations: &mut Equations) -> Vec<f64> {
    let mut x = Vec::new();
    equations.visit_states(|place| x.push(*place));
    x
}

fn put(equations: &mut Equations, x: &[f64]) {
    let mut next = x.iter();
    equations.visit_states(|place| *place = *next.next().unwrap());
}

fn rates(equations: &mut Equations, x: &[f64]) -> Vec<f64> {
    put(equations, x);
    equations.evaluate().unwrap();
    let mut dx = Vec::new();
    equations.rates(&mut |rate| dx.push(rate));
    dx
}

fn signals(equations: &Equations) -> Vec<f64> {
    let mut y = Vec::new();
    equations.signals().values(&mut |value| y.push(value));
    y
}

/// One step of the classical method of Runge and Kutta.
fn step(equations: &mut Equations, x: &[f64], h: f64) -> Vec<f64> {
    let moved = |k: &[f64], by: f64| x.iter().zip(k).map(|(x, k)| x + by * k).collect::<Vec<f64>>();
    let k1 = rates(equations, x);
    let k2 = rates(equations, &moved(&k1, 0.5 * h));
    let k3 = rates(equations, &moved(&k2, 0.5 * h));
    let k4 = rates(equations, &moved(&k3, h));
    (0..x.len()).map(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i])).collect()
}

/// The signals after `DRIVE` seconds of the simulation with this step.
fn simulated(from: &Simulation, torques: &[f64], step_size: f64) -> Vec<f64> {
    let mut simulation = Simulation::from_state(from.rover().clone(), from.state().clone(), step_size).unwrap();
    simulation.advance(&Command::torque(torques.to_vec()), (DRIVE / step_size).round() as u64).unwrap();
    let mut y = Vec::new();
    simulation.signals().values(&mut |value| y.push(value));
    y
}

#[test]
fn agreement_the_simulation_tends_to_the_equations_with_order_two() {
    let heat = [("winding_heat.thermal_resistance", 10.0), ("winding_heat.time_constant", 1.0)];
    let digs = [("slip_sinkage.n1", 0.4), ("slip_sinkage.length", 0.05)];
    let deepens = [("slip_sinkage.growth", 0.3), ("slip_sinkage.carried", 0.001), ("slip_sinkage.length", 0.05)];
    // Windings warm behind each step: first order in what they dissipate, and in nothing else.
    let (body, dissipated): (&[usize], &[usize]) = (&[0, 1, 2, 3, 4, 9, 10, 11, 12], &[7]);
    for (preset, parameters, torques, signals_of, expected) in [
        ("gentle_velocity", &[("slip_sinkage.n1", 0.4)][..], vec![1.7, 1.8], body, 2.0),
        ("gentle_velocity", &digs, vec![1.7, 1.8], body, 2.0),
        ("gentle_velocity", &deepens, vec![1.7, 1.8], body, 2.0),
        ("rocker_bogie_velocity", &[("viscous_friction.coefficient", 0.02)], vec![0.20, 0.22, 0.24], body, 2.0),
        ("gentle_velocity", &heat, vec![1.7, 1.8], body, 2.0),
        ("gentle_velocity", &heat, vec![1.7, 1.8], dissipated, 1.0),
    ] {
        // Under way, so that nothing starts from standstill; the limit by the supply voltage is a kink, at which the order falls.
        let smooth = [&[("motor.inverse_voltage", 0.0)][..], parameters].concat();
        let from = under_way(&model(preset, &smooth), &torques, 300);
        let from = Simulation::from_state(from.rover().clone(), from.state().clone(), 0.001).unwrap();
        let mut fine = Equations::at(&from);
        fine.torques_mut().copy_from_slice(&torques);
        let mut x = states(&mut fine);
        for _ in 0..(DRIVE / FINE).round() as usize {
            x = step(&mut fine, &x, FINE);
        }
        rates(&mut fine, &x);
        let exact = signals(&fine);
        assert!(exact[2].abs() > 0.01, "{preset} drives at {} m/s", exact[2]);
        let error = |step_size: f64| {
            let y = simulated(&from, &torques, step_size);
            signals_of.iter().map(|&i| (y[i] - exact[i]).powi(2)).sum::<f64>().sqrt()
        };
        let errors = [0.002, 0.001, 0.0005].map(error);
        println!("{preset}: {errors:?}");
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((order - expected).abs() < ORDER, "{preset}: order {order} of {errors:?}, expected {expected}");
        }
    }
}

#[test]
fn agreement_tangents_are_the_limit_of_differences() {
    for (preset, parameters, torques) in [
        ("gentle_velocity", vec![("winding_heat.thermal_resistance", 10.0)], vec![1.7, 1.8]),
        ("challenging_velocity", vec![("slip_sinkage.n1", 0.4), ("drag.force", 1.0)], vec![1.6, 1.7]),
        ("gentle_velocity", vec![("slip_sinkage.n1", 0.4), ("slip_sinkage.length", 0.05)], vec![1.7, 1.8]),
        ("rocker_bogie_velocity", vec![("grousers.height", 0.005), ("rate.exponent", 0.1)], vec![0.20, 0.22, 0.24]),
    ] {
        let simulation = under_way(&model(preset, &parameters), &torques, 300);
        let mut equations = Equations::at(&simulation);
        let (x, wheels) = (states(&mut equations), torques.len());
        let mut at = |x: &[f64], u: &[f64]| {
            equations.torques_mut().copy_from_slice(u);
            let dx = rates(&mut equations, x);
            [dx, signals(&equations)].concat()
        };
        let here = at(&x, &torques);
        let mut nominals = Vec::new();
        Equations::at(&simulation).nominals(|size| nominals.push(size));
        for known in 0..x.len() + wheels {
            let mut seed = vec![0.0; x.len() + wheels];
            seed[known] = 1.0;
            let size = nominals.get(known).copied().unwrap_or(1.0);
            let moved = |by: f64| {
                let mut all = [x.clone(), torques.clone()].concat();
                all[known] += by * size;
                all
            };
            let mut difference = |h: f64| {
                let (more, less) = (moved(h), moved(-h));
                let (more, less) = (at(&more[..x.len()], &more[x.len()..]), at(&less[..x.len()], &less[x.len()..]));
                more.iter().zip(&less).map(|(a, b)| (a - b) / (2.0 * h)).collect::<Vec<f64>>()
            };
            let (coarse, fine) = (difference(2e-6), difference(1e-6));
            let tangent = Equations::at(&simulation).tangent(&seed[..x.len()], &seed[x.len()..]).unwrap();
            let exact = [tangent.rates, tangent.signals].concat();
            assert_eq!(exact.len(), here.len());
            for (i, exact) in exact.iter().enumerate() {
                // Both in units of the known's typical size; what two differences of a kink differ by is no derivative.
                let (exact, smooth) = (exact * size, (coarse[i] - fine[i]).abs());
                let room = DIFFERENCES * (1.0 + here[i].abs() + exact.abs()) + 10.0 * smooth;
                assert!((exact - fine[i]).abs() < room, "{preset}: {i} by {known}: {exact}, {}", fine[i]);
            }
        }
    }
}

#[test]
fn property_states_have_names_sizes_and_derivatives_in_one_order() {
    let simulation = under_way(&model("rocker_bogie", &[]), &[0.2; 3], 10);
    let mut equations = Equations::at(&simulation);
    let mut named: States = equations.states();
    let list = named.list();
    assert_eq!(list.len(), equations.count());
    assert_eq!(states(&mut equations), list.iter().map(|(_, value)| *value).collect::<Vec<f64>>());
    let at = |name: &str| list.iter().position(|(variable, _)| variable.name == name).unwrap();
    let x = states(&mut equations);
    let dx = rates(&mut equations, &x);
    assert_eq!(dx.len(), list.len());
    for (place, rate) in
        [("x", "velocity_x"), ("z", "velocity_z"), ("pitch", "pitch_rate"), ("link[1].angle", "link[1].rate")]
    {
        assert_eq!(dx[at(place)], x[at(rate)], "{place}");
        let derivative = derivative_of(&list[at(place)].0);
        assert_eq!(derivative.unit, list[at(rate)].0.unit, "{place}");
        assert_eq!(derivative.name, format!("der({place})"));
    }
    let body = &equations.signals().body;
    assert_eq!(dx[at("dissipated_energy")], body.power);
    assert_eq!(dx[at("electrical_energy")], body.electrical_power);
    let mut sizes = Vec::new();
    equations.nominals(|size| sizes.push(size));
    assert_eq!(sizes.len(), list.len());
    assert!(sizes.iter().all(|size| *size > 0.0));
}

#[test]
fn property_indicators_tell_limits_and_ends() {
    let limited = model("two_wheeled", &[("motor.inverse_torque_limit", 0.5), ("voltage_limit.inverse_voltage", 0.01)]);
    let mut equations = Equations::at(&under_way(&limited, &[0.5, 0.5], 100));
    let mut indicate = |torques: [f64; 2], change: &mut dyn FnMut(&mut [f64])| {
        equations.torques_mut().copy_from_slice(&torques);
        let before = states(&mut equations);
        let mut x = before.clone();
        change(&mut x);
        rates(&mut equations, &x);
        let mut z = Vec::new();
        equations.event_indicators(|indicator| z.push(indicator));
        assert_eq!(z.len(), equations.indicators());
        let given: Vec<f64> = equations.signals().wheels.iter().map(|wheel| wheel.torque).collect();
        let ended = equations.ended();
        put(&mut equations, &before);
        (z, given, ended)
    };
    let none = &mut |_: &mut [f64]| {};
    let (z, given, ended) = indicate([1.9, -1.9], none);
    assert!(z.iter().all(|indicator| *indicator > 0.0), "{z:?}");
    assert_eq!((given, ended), (vec![1.9, -1.9], None));
    let (z, given, _) = indicate([2.1, 1.9], none);
    assert!(z[1] < 0.0 && z[3] > 0.0, "{z:?}");
    assert_eq!(given, [2.0, 1.9]);
    let (z, _, _) = indicate([0.0; 2], &mut |x| x[1] += 0.1);
    assert!(z[0] < 0.0 && z[2] < 0.0, "off the ground: {z:?}");
    let (z, _, ended) = indicate([0.0; 2], &mut |x| x[2] = 1.5);
    assert!(z[4] < 0.0, "tipped over: {z:?}");
    assert_eq!(ended, Some(Event::TippedOver));
}

#[test]
fn property_memories_that_are_no_states_are_named() {
    let refused = |preset: &str, parameters: &[(&str, f64)]| model(preset, parameters).check_equations();
    assert_eq!(refused("two_wheeled", &[("winding_heat.thermal_resistance", 5.0)]), Ok(()));
    for (name, effect) in [
        ("multi_pass.growth", "multi_pass"),
        ("sensor_lag.dead_time", "sensor_lag"),
        ("tracking_delay.dead_time", "tracking_delay"),
    ] {
        let error = refused("two_wheeled", &[(name, 0.1)]).unwrap_err().to_string();
        assert!(error.contains(effect) && error.contains(name), "{error}");
    }
    assert_eq!(Model::preset("gentle_rtc").unwrap().check_equations(), Err(NoEquations::Drive));
}
