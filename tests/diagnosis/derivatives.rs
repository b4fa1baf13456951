//! Derivatives through whole drives, from the settled start on, against differences; replays against runs.

use bekker::diagnosis::{Derivatives, Replay, modelled, sensitivity};
use bekker::measurement::{Experiment, Kind, Run, Table};
use bekker::model::{ControlKind, Model};
use bekker::modeldescription::{Lookup, Parameters};
use bekker::rover::Rover;
use bekker::scalar::{Dual, Scalar};
use bekker::signals::Drive;
use bekker::terrain::{Ditch, Profile, Terrain, Waves};
use std::collections::BTreeMap;

/// The default inner step, s, and the time between rows, s.
const STEP: f64 = 0.002;
const PERIOD: f64 = 0.1;
const ROWS: usize = 31;

/// Differences over this share of a value: rounding over it is 1e-9, and a rim of the ditch (where the curvature jumps)
/// is rarely within it.
const SHARE: f64 = 1e-5;

/// Between exact derivatives and differences, relative to the largest derivative of the signal over the drive.
const DIFFERENCES: f64 = 2e-5;

/// Parameters of every kind: soil, vehicle, ground, drives, effects, start.
const FREE: [&str; 22] = [
    "soil.cohesion",
    "soil.friction_angle",
    "soil.k_c",
    "soil.k_phi",
    "soil.exponent",
    "soil.shear_modulus",
    "soil.c1",
    "soil.c2",
    "soil.damping",
    "gravity",
    "rover.mass",
    "rover.centre_of_mass_x",
    "wheel.radius",
    "wheel[2].x",
    "motor.resistance",
    "slip_sinkage.n1",
    "exit_angle.lambda",
    "coulomb_friction.torque",
    "viscous_friction.coefficient",
    "drag.force",
    "tether.stiffness",
    "x0",
];

fn rover(profile: Profile) -> Rover {
    let mut rover = Rover::two_wheeled();
    rover.terrain = Terrain::new(profile);
    rover.soil.k_c = 2e4;
    rover.body.centre_of_mass_x = 0.02;
    rover.effects.slip_sinkage.n1 = 0.2;
    rover.effects.exit_angle.lambda = 0.2;
    rover.effects.coulomb_friction.torque = 0.05;
    rover.effects.viscous_friction.coefficient = 0.02;
    rover.effects.drag.force = 1.0;
    rover.effects.tether.stiffness = 0.3;
    rover
}

fn waves() -> Profile {
    Profile::Waves(Waves { amplitude: 0.02, wavelength: 1.3, start: -3.0 })
}

fn ditch() -> Profile {
    Profile::Ditch(Ditch { depth: 0.05, width: 0.8, position: 0.8 })
}

/// Commands that change from row to row.
fn replay(drive: Drive) -> Replay {
    let time: Vec<f64> = (0..ROWS).map(|row| PERIOD * row as f64).collect();
    let command = |t: &f64| match drive {
        Drive::Speed => 2.0 + (1.7 * t).sin(),
        Drive::Torque => 1.6 + 0.3 * (1.7 * t).sin(),
    };
    Replay::new(drive, STEP, &time, time.iter().flat_map(|t| [0.9 * command(t), command(t)]).collect())
}

/// All signals of a replay, row by row.
fn signals<S: Scalar>(replay: &Replay, rover: Rover<S>, x0: S) -> Vec<Vec<S>> {
    let mut rows = Vec::new();
    replay
        .run(rover, x0, |_, signals| {
            let mut row = Vec::new();
            signals.values(&mut |value| row.push(value));
            rows.push(row);
        })
        .unwrap();
    rows
}

/// The rover and its start with `name` changed.
fn with<S: Scalar>(rover: &Rover<S>, x0: S, name: &str, change: impl Fn(S) -> S) -> (Rover<S>, S) {
    let mut changed = rover.clone();
    changed.visit("", &mut |variable, place| {
        if variable.name == name {
            *place = change(*place);
        }
    });
    (changed, if name == "x0" { change(x0) } else { x0 })
}

/// The largest error of a derivative, and where it is.
fn worst_derivative(profile: Profile, drive: Drive) -> (f64, String) {
    let (rover, x0, replay) = (rover(profile), 0.2, replay(drive));
    let mut signal_names: Vec<String> = Vec::new();
    replay
        .run(rover.clone(), x0, |row, signals| {
            if row == 0 {
                signal_names = signals.clone().list().into_iter().map(|(variable, _)| variable.name).collect();
            }
        })
        .unwrap();
    let mut worst = (0.0, String::new());
    for name in FREE {
        let (dual, start) = with(&rover.map(&Dual::<1>::from), Dual::from(x0), name, |value| value.derivative(0));
        let exact = signals(&replay, dual, start);
        let value = rover.clone().list().into_iter().find(|(v, _)| v.name == name).map_or(x0, |(_, value)| value);
        let step = SHARE * value.abs();
        let moved = |by: f64| {
            let (rover, x0) = with(&rover, x0, name, |value| value + by);
            signals(&replay, rover, x0)
        };
        let (above, below) = (moved(step), moved(-step));
        for (k, signal) in signal_names.iter().enumerate() {
            let slope = |row: usize| exact[row][k].eps.0.map_or(0.0, |eps| eps[0]);
            let difference = |row: usize| (above[row][k] - below[row][k]) / (2.0 * step);
            let scale = (0..ROWS).map(|row| slope(row).abs()).fold(0.0, f64::max);
            let size = (0..ROWS).map(|row| exact[row][k].re.abs()).fold(0.0, f64::max);
            for row in 0..ROWS {
                let error = (slope(row) - difference(row)).abs() / (scale + 1e-9 * size / step + f64::MIN_POSITIVE);
                if error > worst.0 {
                    worst = (error, format!("{name}, {signal}, row {row}: {} and {}", slope(row), difference(row)));
                }
            }
        }
        let felt = exact.iter().flatten().any(|value| value.eps.0.is_some_and(|eps| eps[0] != 0.0));
        assert!(felt, "{name} is felt");
    }
    worst
}

fn check_derivatives(profile: &Profile, drive: Drive) {
    let worst = worst_derivative(profile.clone(), drive);
    assert!(worst.0 < DIFFERENCES, "{worst:?}");
}

#[test]
fn agreement_derivatives_of_a_drive_on_waves() {
    check_derivatives(&waves(), Drive::Speed);
    check_derivatives(&waves(), Drive::Torque);
}

#[test]
fn agreement_derivatives_of_a_drive_through_a_ditch() {
    check_derivatives(&ditch(), Drive::Speed);
    check_derivatives(&ditch(), Drive::Torque);
}

#[test]
fn agreement_derivatives_of_a_rest() {
    for (rover, x0) in [(rover(waves()), 0.9), (rover(waves()), 0.4), (Rover::rocker_bogie(), 0.3)] {
        for name in ["soil.k_phi", "soil.exponent", "soil.friction_angle", "rover.mass", "rover.centre_of_mass_x", "x0"]
        {
            let (dual, start) = with(&rover.map(&Dual::<1>::from), Dual::from(x0), name, |value| value.derivative(0));
            let flat = |state: bekker::rover::State| [state.position, vec![state.wheels[0].hold.travel]].concat();
            let state = dual.settled_at(start).unwrap();
            assert_eq!(state.map(&|s| s.re), rover.settled_at(x0).unwrap(), "real parts are those of plain numbers");
            let exact = flat(state.map(&|s| s.eps.0.map_or(0.0, |eps| eps[0])));
            let value = rover.clone().list().into_iter().find(|(v, _)| v.name == name).map_or(x0, |(_, value)| value);
            let step = 1e-4 * value.abs().max(0.01);
            let moved = |by: f64| {
                let (rover, x0) = with(&rover, x0, name, |value| value + by);
                flat(rover.settled_at(x0).unwrap())
            };
            let (above, below) = (moved(step), moved(-step));
            let scale = exact.iter().fold(0.0_f64, |m, d| m.max(d.abs()));
            for ((exact, above), below) in exact.iter().zip(&above).zip(&below) {
                let difference = (above - below) / (2.0 * step);
                // A rest is found to 1e-8 m/s^2: 1e-11 m, or 1e-8 of the holding.
                let rest = 1e-8 / step;
                let error = (exact - difference).abs();
                assert!(error < DIFFERENCES * scale + rest, "{name} at {x0}: {exact} and {difference}");
            }
        }
    }
}

#[test]
fn agreement_a_replay_is_a_run_to_the_last_bit() {
    for (drive, kind) in [(Drive::Speed, ControlKind::Speed), (Drive::Torque, ControlKind::Torque)] {
        let mut model = Model::new("replay", rover(waves()));
        model.control.kind = kind;
        model.start.x0 = 0.2;
        let mut run = model.start().unwrap();
        let replayed = signals(&replay(drive), model.rover.clone(), 0.2);
        for (row, signals) in replayed.iter().enumerate() {
            let mut plain = Vec::new();
            run.signals().values(&mut |value| plain.push(value));
            assert_eq!(*signals, plain, "row {row}");
            let time = PERIOD * row as f64;
            let command = if drive == Drive::Speed { 2.0 + (1.7 * time).sin() } else { 1.6 + 0.3 * (1.7 * time).sin() };
            run.inputs_mut().set_all(&[0.9 * command, command]).unwrap();
            run.advance((PERIOD / STEP).round() as u64).unwrap();
        }
    }
}

/// A short drive; runs of one `kind` are repeats.
fn recorded(name: &str, kind: usize) -> Run {
    let names = ["time", "wheel[1].speed_command", "wheel[2].speed_command", "x", "velocity", "wheel[2].torque"];
    let mut data = Table::new(names).unwrap();
    for row in 0..16 {
        let time = PERIOD * f64::from(row);
        let speed = 1.5 + 0.3 * kind as f64 + 0.5 * (2.0 * time).sin();
        data.push(&[time, speed, 0.9 * speed, 0.0, 0.0, 0.0]).unwrap();
    }
    Run {
        name: name.to_owned(),
        file: format!("{name}.csv").into(),
        group: None,
        parameters: BTreeMap::new(),
        terrain: None,
        x0: None,
        data,
        conditions: Vec::new(),
        inputs: names[1..3].iter().map(|name| (*name).to_owned()).collect(),
        measured: names[3..].iter().map(|name| (*name).to_owned()).collect(),
    }
}

fn experiment() -> Experiment {
    let mut runs = vec![recorded("a", 0), recorded("b", 1), recorded("a again", 0), recorded("c", 2)];
    // A repeat of which something else was measured, and one with a load of its own.
    runs[2].measured = vec!["wheel[2].torque".to_owned(), "velocity".to_owned()];
    runs[3].parameters.insert("rover.mass".to_owned(), 12.0);
    Experiment {
        effects: Vec::new(),
        name: "drives".to_owned(),
        kind: Kind::Traverse,
        folder: "drives".into(),
        parameters: BTreeMap::new(),
        priors: BTreeMap::new(),
        soil_class: None,
        shared: BTreeMap::new(),
        sensors: BTreeMap::new(),
        model: None,
        noise: BTreeMap::new(),
        runs,
        doubts: Vec::new(),
        parts: Vec::new(),
    }
}

const SOME: [&str; 7] = [
    "soil.friction_angle",
    "soil.k_phi",
    "soil.exponent",
    "rover.mass",
    "slip_sinkage.n1",
    "coulomb_friction.torque",
    "soil.shear_modulus",
];

#[test]
fn agreement_slopes_of_an_experiment() {
    let experiment = experiment();
    for kind in [ControlKind::Speed, ControlKind::SpeedLoop] {
        let mut model = Model::new("slopes", rover(Profile::Flat));
        model.control.kind = kind;
        let felt = sensitivity(&model, &experiment, &SOME).unwrap();
        let plain = modelled(&model, &experiment).unwrap();
        let exact = kind == ControlKind::Speed;
        assert_eq!(felt.derivatives, if exact { Derivatives::Exact } else { Derivatives::Differences });
        // Forward mode takes powers by logarithms.
        assert!(felt.values.iter().zip(&plain).all(|(a, b)| (a - b).abs() < 1e-9 * b.abs().max(1.0)));
        // Rows of run a: x, velocity, torque; of its repeat: torque, velocity.
        assert_eq!(plain[32..48], plain[96..112]);
        assert_eq!(plain[16..32], plain[112..128]);
        assert!(felt.slopes[3][128..].iter().all(|slope| *slope == 0.0), "the run sets its own mass");
        for (name, slopes) in SOME.iter().zip(&felt.slopes) {
            let value = model.get(name).unwrap();
            let step = 1e-5 * value;
            let at = |value: f64| {
                let mut moved = model.clone();
                moved.set(name, value).unwrap();
                modelled(&moved, &experiment).unwrap()
            };
            let (above, below) = (at(value + step), at(value - step));
            for block in slopes.chunks(16).zip(above.chunks(16).zip(below.chunks(16))) {
                let scale = block.0.iter().fold(0.0_f64, |m, d| m.max(d.abs()));
                for (slope, (above, below)) in block.0.iter().zip(block.1.0.iter().zip(block.1.1)) {
                    let difference = (above - below) / (2.0 * step);
                    // A loop's differences have ten times this test's step, and kinks at the limits.
                    let tolerance = if exact { DIFFERENCES } else { 1e-3 };
                    let rounding = 1e-10 / step;
                    assert!((slope - difference).abs() < tolerance * scale + rounding, "{name}: {slope}, {difference}");
                }
            }
        }
    }
}

#[cfg(feature = "parallel")]
#[test]
fn property_the_bits_do_not_depend_on_the_number_of_threads() {
    let mut model = Model::new("threads", rover(waves()));
    model.control.kind = ControlKind::Speed;
    let experiment = experiment();
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| sensitivity(&model, &experiment, &SOME).unwrap())
    };
    let one = on(1);
    assert_eq!(one, on(2));
    assert_eq!(one, on(5));
}

#[test]
fn property_an_unknown_parameter_is_named() {
    let error = sensitivity(&Model::new("names", rover(waves())), &experiment(), &["soil.cohesio"]).unwrap_err();
    assert!(error.to_string().contains("soil.cohesion"), "{error}");
}
