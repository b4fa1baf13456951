//! Claims: rough-terrain control with wheel-speed loops predicts the loads of steady driving, asks no more torque than the
//! soil gives at the best slip, keeps the slip limit while it moves, needs no more energy than velocity control at its speed,
//! finds wheels in the air, and is a controller like the others in files and snapshots. What the body does not accelerate
//! its links do not either.

use bekker::control::rtc::SoilBelief;
use bekker::control::{
    ControlError, Controller, Criterion, Footing, Rtc, RtcOptions, Solver, SpeedRoughTerrainControl, SpeedRtc,
    VelocityControl,
};
use bekker::model::{ContactAngleSource, ControlKind, Model, Run, SoilSource, Summary, SummaryBuilder, nominal};
use bekker::modeldescription::Lookup;
use bekker::rover::Rover;
use bekker::signals::{Command, Measurement, Reference};
use bekker::simulation::Status;
use bekker::terrain::{Incline, LooseDitch, Profile, Rough, Samples, Terrain};

/// Difference of predicted and true loads in steady driving, of the load: what the issue of the balance accepts.
const LOADS: f64 = 0.05;
/// Torque over that of the soil at the best slip: the loads' error enters it in proportion.
const TORQUES: f64 = 0.01;
/// Slip over the limit that does not count: between two periods the body's speed changes by about as much.
const SLIP: f64 = 0.02;
/// Time beyond the slip limit while the body moves, s: what the issue of the controller accepts.
const BEYOND: f64 = 0.5;
/// Energy a metre over that of velocity control at the same speed: what the issue accepts.
const ENERGY: f64 = 0.005;

pub(super) fn by_speeds(rover: Rover) -> Model {
    let mut model = Model::new("by wheel speeds", rover);
    model.control.kind = ControlKind::RtcSpeed;
    model.control.solver = Solver::ActiveSet;
    if !model.rover.links.is_empty() {
        model.control.lighten();
    }
    model
}

/// The two-wheeled rover on soil that carries it up slopes.
pub(super) fn firm() -> Rover {
    let mut rover = Rover::two_wheeled();
    rover.soil.shear_modulus = 0.01;
    rover
}

pub(super) fn started(model: &Model, speed: f64) -> Run {
    let mut run = model.start().unwrap();
    run.inputs_mut().set("velocity_command", speed).unwrap();
    run
}

/// Drives and sums up; also the longest time in which a wheel was beyond its slip limit while the body moved, s.
fn drive(model: &Model, speed: f64, length: f64, seconds: f64) -> (Run, Summary, f64) {
    let (mut run, mut summary) = (started(model, speed), SummaryBuilder::default());
    summary.push(&run);
    let (mut beyond, mut longest) = (0.0_f64, 0.0_f64);
    let start = run.signals().body.x;
    while run.signals().body.x - start < length && run.time() < seconds && run.status() == Status::Running {
        run.advance(5).unwrap();
        summary.push(&run);
        let Some(rtc) = run.speed_rtc() else { continue };
        let over = run.signals().wheels.iter().zip(rtc.shares());
        let over = over
            .filter(|(wheel, _)| wheel.normal_force > 0.0)
            .any(|(wheel, share)| wheel.slip > share.best.slip + SLIP);
        let moves = run.signals().body.velocity > model.control.rtc_speed.creep;
        beyond = if over && moves { beyond + 0.01 } else { 0.0 };
        longest = longest.max(beyond);
    }
    let summary = summary.summary(&run);
    (run, summary, longest)
}

/// The FSRL rover with lugs of this height (m) before a ditch of loose sand, which it has on its map.
pub(super) fn ditch(wall: f64, lugs: f64) -> Model {
    let mut rover = Rover::fsrl();
    let ditch = LooseDitch {
        width: 0.384,
        wall: wall.to_radians(),
        rounding: 0.08,
        position: 0.8,
        cohesion: 180.0,
        modulus_factor: 1.0,
    };
    rover.terrain = ditch.terrain(rover.soil.cohesion).unwrap();
    let mut model = by_speeds(rover);
    model.control.soil = SoilSource::Map;
    model.set("grousers.height", lugs).unwrap();
    model
}

#[test]
fn property_loads_and_torques_of_steady_driving_are_predicted() {
    let slope = |rover: Rover, degrees: f64| {
        let incline = Incline { slope: degrees.to_radians(), length: 8.0, ..Incline::default() };
        by_speeds(Rover { terrain: incline.terrain().unwrap(), ..rover })
    };
    let cases = [
        (by_speeds(Rover::two_wheeled()), 0.2, 4.0),
        (slope(firm(), 8.0), 0.2, 8.0),
        (slope(firm(), -8.0), 0.2, 8.0),
        (slope(Rover::rocker_bogie(), 8.0), 0.15, 9.0),
        (by_speeds(Rover::fsrl()), 0.06, 5.0),
        (slope(Rover::fsrl(), 10.0), 0.06, 22.0),
    ];
    for (number, (model, speed, seconds)) in cases.iter().enumerate() {
        let mut run = started(model, *speed);
        assert_eq!(run.advance((seconds / 0.002) as u64).unwrap(), Status::Running);
        let rtc = run.speed_rtc().unwrap();
        assert!(rtc.outcome().unwrap().feasible, "case {number}");
        let belief = SoilBelief::new(model.rover.wheel, model.rover.soil);
        for (k, (wheel, share)) in run.signals().wheels.iter().zip(rtc.shares()).enumerate() {
            let load = wheel.normal_force;
            assert!(
                (share.load / load - 1.0).abs() <= LOADS,
                "case {number}, wheel {k}: {} N for {load} N",
                share.load
            );
            let most = belief.best(load).torque;
            assert!(wheel.torque <= most * (1.0 + TORQUES), "case {number}, wheel {k}: {} of {most} N m", wheel.torque);
        }
    }
}

#[test]
fn property_no_torque_beyond_the_best_slip_is_asked_for_where_the_ground_gives_no_more() {
    // Steeper than the soil carries the rover up: it comes to a stand, and until then no wheel runs away.
    let incline = Incline { length: 8.0, ..Incline::default() };
    let model = by_speeds(Rover { terrain: incline.terrain().unwrap(), ..Rover::fsrl() });
    let mut run = started(&model, 0.06);
    let belief = SoilBelief::new(model.rover.wheel, model.rover.soil);
    let (mut bound, mut moved) = (0, false);
    while run.time() < 20.0 && run.status() == Status::Running {
        run.advance(5).unwrap();
        // The torque was decided on a period ago, at the speed of that time.
        let moves = run.signals().body.velocity > model.control.rtc_speed.creep;
        if !std::mem::replace(&mut moved, moves) {
            continue;
        }
        let rtc = run.speed_rtc().unwrap();
        for (wheel, share) in run.signals().wheels.iter().zip(rtc.shares()) {
            let most = belief.best(share.load).torque;
            assert!(wheel.torque <= most * (1.0 + TORQUES), "{} of {most} N m at t = {}", wheel.torque, run.time());
            bound += u32::from(wheel.torque > 0.9 * most);
        }
    }
    assert!(bound > 10, "the limit has to be reached");
}

#[test]
fn property_the_slip_limit_is_kept_while_the_rover_moves() {
    for (wall, lugs) in [(8.0, 0.0), (20.0, 0.01)] {
        let (run, summary, beyond) = drive(&ditch(wall, lugs), 0.06, 1.8, 60.0);
        assert!(summary.distance >= 1.8, "walls of {wall} degrees: {:?} after {} m", run.status(), summary.distance);
        assert!(beyond <= BEYOND, "walls of {wall} degrees: {beyond} s beyond the limit");
    }
}

#[test]
fn property_velocity_control_at_the_same_speed_needs_no_less_energy() {
    for modulus in [0.03, 0.01] {
        let mut model = by_speeds(Rover::two_wheeled());
        model.rover.soil.shear_modulus = modulus;
        model.rover.terrain = Rough { steepest: 5.0_f64.to_radians(), seed: 7, ..Rough::default() }.terrain().unwrap();
        model.control.contact_angles = ContactAngleSource::Estimator;
        let (_, ours, beyond) = drive(&model, 0.25, 3.0, 60.0);
        assert!(beyond <= BEYOND);
        let mut velocity = model.clone();
        velocity.control.kind = ControlKind::Velocity;
        // The secant method on the command.
        let (mut command, mut theirs) = (0.25, drive(&velocity, 0.25, 3.0, 60.0).1);
        let (mut before, mut speed) = (0.0, 0.0);
        for _ in 0..6 {
            let next = command + (ours.speed - theirs.speed) * (command - before) / (theirs.speed - speed);
            (before, speed, command) = (command, theirs.speed, next);
            theirs = drive(&velocity, command, 3.0, 60.0).1;
            if (theirs.speed / ours.speed - 1.0).abs() < 1e-3 {
                break;
            }
        }
        assert!((theirs.speed / ours.speed - 1.0).abs() < 0.01, "{} and {} m/s", theirs.speed, ours.speed);
        let over = ours.energy_per_metre / theirs.energy_per_metre - 1.0;
        assert!(over <= ENERGY, "K = {modulus} m: {} and {} J/m", ours.energy_per_metre, theirs.energy_per_metre);
    }
}

#[test]
fn property_a_wheel_in_the_air_is_found_and_turns_with_the_ground() {
    let mut model = by_speeds(Rover::rigid(&[-0.35, 0.0, 0.35]));
    let samples = Samples::new(&[-3.0, -0.2, -0.15, 0.15, 0.2, 3.0], &[0.0, 0.0, -0.2, -0.2, 0.0, 0.0]).unwrap();
    model.rover.terrain = Terrain::new(Profile::Samples(std::sync::Arc::new(samples)));
    let mut run = started(&model, 0.1);
    run.advance(500).unwrap();
    let wheel = &run.signals().wheels[1];
    let outcome = run.speed_rtc().unwrap().outcome().unwrap();
    assert_eq!(wheel.normal_force, 0.0, "the middle wheel has to hang in the air");
    assert!(outcome.footing[1] != Footing::Loaded && outcome.footing[0] == Footing::Loaded, "{:?}", outcome.footing);
    assert!(wheel.speed > 0.5 && wheel.speed < 2.5, "1 rad/s and the others' slip is wanted, found {}", wheel.speed);
}

#[test]
fn analytic_what_the_rover_does_not_accelerate_its_links_do_not_either() {
    // A wish of ten weights: what counts for the bogie is the acceleration that the soil gives.
    let simulation = Model::new("", Rover::fsrl()).start().unwrap();
    let rover = nominal(&Rover::fsrl());
    let parameters = bekker::control::RoughTerrainControl { gain: 1.0, minimum_load: 0.01, ..Default::default() };
    for solver in [Solver::Clarabel, Solver::ActiveSet] {
        let mut rtc =
            Rtc::with_options(rover.clone(), parameters, RtcOptions { solver, ..Default::default() }).unwrap();
        let measured = Measurement::of(3, 1);
        rtc.command(&measured, &Reference { velocity: 98.1 }, &mut Command::torque(vec![0.0; 3])).unwrap();
        let outcome = rtc.outcome().unwrap();
        assert!(!outcome.feasible);
        let pulls: f64 = outcome.forces.iter().step_by(2).sum();
        let acceleration = pulls / rover.mass;
        // About the pivot, by hand: the bogie's weight and inertia, its wheels' loads, and pulls at the rim.
        let link = rover.links[0];
        let arm = [link.centre_of_mass_x - link.x, link.centre_of_mass_z - link.z];
        let carried = link.mass * (arm[0] * rover.gravity - arm[1] * acceleration);
        let wheels = (1..3).map(|k| {
            let [x, z] = rover.wheel_centres[k];
            outcome.forces[2 * k + 1] * (x - link.x) - outcome.forces[2 * k] * (z - rover.wheel.radius - link.z)
        });
        let miss = wheels.sum::<f64>() - carried;
        assert!(miss.abs() < 1e-6 * rover.weight(), "{miss} N m about the pivot at {acceleration} m/s2");
        assert!(outcome.joint_shortfall[0].abs() < 1e-6 * rover.weight());
    }
    drop(simulation);
}

#[test]
fn property_least_electrical_power_is_no_more_than_that_of_other_slips() {
    // Two wheels whose loads differ much: shares of the pull by the controller and by a search over them.
    let mut rover = firm();
    rover.body.centre_of_mass_x = -0.2;
    let model = by_speeds(rover);
    let mut run = started(&model, 0.2);
    run.advance(3000).unwrap();
    let rtc = run.speed_rtc().unwrap();
    assert_eq!(rtc.outcome().unwrap().criterion, Criterion::ElectricalPower);
    let belief = SoilBelief::new(model.rover.wheel, model.rover.soil);
    let loads = [rtc.shares()[0].load, rtc.shares()[1].load];
    let power = |slips: [f64; 2]| -> (f64, f64) {
        let states = [belief.at(loads[0], slips[0]), belief.at(loads[1], slips[1])];
        let one = |k: usize| {
            rtc.nominal().winding_power(states[k].torque) + states[k].torque * 0.2 / (0.1 * (1.0 - slips[k]))
        };
        (one(0) + one(1), states[0].pull + states[1].pull)
    };
    let (ours, pull) = power([rtc.shares()[0].slip, rtc.shares()[1].slip]);
    for step in -20..=20 {
        let rear = rtc.shares()[0].slip + 0.002 * f64::from(step);
        // The front slip that gives the same pull.
        let (mut low, mut high) = (-0.5, 0.9);
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if power([rear, middle]).1 < pull { low = middle } else { high = middle }
        }
        assert!(
            power([rear, low]).0 >= ours * (1.0 - 1e-4),
            "rear slip {rear}: {} W, ours {ours} W",
            power([rear, low]).0
        );
    }
}

#[test]
fn property_knowing_the_lugs_makes_the_planned_slip_right() {
    let incline = Incline { slope: 10.0_f64.to_radians(), length: 8.0, ..Incline::default() };
    let mut model = by_speeds(Rover { terrain: incline.terrain().unwrap(), ..Rover::fsrl() });
    model.set("grousers.height", 0.01).unwrap();
    let off = |height: f64| {
        let mut model = model.clone();
        model.control.rtc_speed.lug_height = height;
        let mut run = started(&model, 0.06);
        run.advance(11_000).unwrap();
        let shares = run.speed_rtc().unwrap().shares();
        let slips = run.signals().wheels.iter().zip(shares).map(|(wheel, share)| (share.slip - wheel.slip).abs());
        slips.fold(0.0, f64::max)
    };
    // The largest difference of planned and true slips: the lugs carry the soil along at 1.16 of the radius.
    let (known, unknown) = (off(0.01), off(0.0));
    assert!(known < 0.03 && unknown > 0.1, "{known} with the lugs, {unknown} without");
}

#[test]
fn property_a_brief_drop_of_body_speed_leaves_the_wheel_torques() {
    let torque = |speed_hold: f64, dip: f64| {
        let parameters = SpeedRoughTerrainControl { speed_hold, ..Default::default() };
        let rover = nominal(&firm());
        let mut rtc = SpeedRtc::new(rover, parameters, VelocityControl::default(), RtcOptions::default()).unwrap();
        let mut measured = Measurement::of(2, 0);
        let mut command = Command::torque(vec![0.0; 2]);
        for period in 0..40 {
            measured.velocity = if period < 30 { 0.2 } else { dip };
            // 0.2 m/s on wheels of 0.1 m at a slip of a tenth.
            measured.wheels.iter_mut().for_each(|wheel| wheel.speed = 2.2);
            rtc.command(&measured, &Reference { velocity: 0.2 }, &mut command).unwrap();
        }
        command.values.iter().sum::<f64>()
    };
    assert_eq!(torque(0.3, 0.2), torque(0.0, 0.2), "at a steady speed it changes nothing");
    assert!(torque(0.3, 0.02) > torque(0.0, 0.02) + 0.5, "{} and {} N m", torque(0.3, 0.02), torque(0.0, 0.02));
}

#[test]
fn regress_files_snapshots_and_words() {
    let text = "preset = 'gentle_rtc_speed'\n[control]\ncriterion = 'electrical_power'\nsoil = 'map'\n[parameters]\nrtc_speed.creep = 0.02\n\
                rtc_speed.lug_height = 0.004\nrtc_speed.speed_hold = 0.2\n";
    let model = Model::from_toml(text, None).unwrap();
    assert_eq!(Model::from_toml(&model.to_toml().unwrap(), None).unwrap().control, model.control);
    let mut run = started(&model, 0.2);
    run.advance(400).unwrap();
    let bytes = run.snapshot().unwrap();
    let mut other = started(&model, 0.2);
    other.restore(&bytes).unwrap();
    run.advance(300).unwrap();
    other.advance(300).unwrap();
    assert_eq!(run.signals(), other.signals());
    let torques = Model::from_toml("preset = 'gentle_rtc'\n[control]\ncriterion = 'electrical_power'\n", None).unwrap();
    let refused = torques.start().unwrap_err();
    assert!(refused.to_string().contains(&ControlError::NoSlips.to_string()), "{refused}");
}

#[test]
fn property_a_map_tells_the_soil_at_the_wheels() {
    // Past the ditch's rim, where its sand is: the front wheel's strength differs from the rear wheel's.
    let mut run = started(&ditch(8.0, 0.0), 0.06);
    while run.signals().body.x < 0.6 {
        run.advance(50).unwrap();
    }
    let shares = run.speed_rtc().unwrap().shares();
    let strength = |k: usize| shares[k].best.torque / shares[k].load;
    assert!(strength(2) < 0.9 * strength(0), "{} and {} m", strength(2), strength(0));
    let mut outside = ditch(8.0, 0.0);
    outside.control.soil = SoilSource::Nominal;
    let mut unaware = started(&outside, 0.06);
    unaware.advance(1000).unwrap();
    assert!(unaware.speed_rtc().is_some());
}
