//! Claims: the speed loops of rough-terrain control keep torque-commanded wheels from running away, find wheels in the
//! air, leave everything alone where they are neutral, and let controllers be compared at equal speed.

use bekker::control::{Footing, RoughTerrainControl};
use bekker::model::{ControlKind, Model, Run, Summary, SummaryBuilder};
use bekker::modeldescription::Lookup;
use bekker::rover::Rover;
use bekker::simulation::Status;
use bekker::terrain::{Profile, Samples, Terrain};

/// Difference of mean speeds that counts as equal, of them: rim speeds and energy a metre rise about in proportion to the speed, so
/// that it takes no part in differences of 5 % and more.
const EQUAL: f64 = 0.02;
/// Gains of the loops: those of velocity control.
const LOOPS: [(&str, f64); 2] = [("rtc.speed_kp", 0.5), ("rtc.speed_ki", 20.0)];

fn drive(model: &Model, command: f64, seconds: f64) -> (Run, Summary, Status) {
    let mut run = model.start().unwrap();
    run.inputs_mut().set("velocity_command", command).unwrap();
    let mut summary = SummaryBuilder::default();
    summary.push(&run);
    let mut status = Status::Running;
    while run.time() < seconds && status == Status::Running {
        status = run.advance(10).unwrap();
        summary.push(&run);
    }
    let summary = summary.summary(&run);
    (run, summary, status)
}

/// A drive of `model` at the mean speed `speed`, m/s: bisection on the command.
fn at_speed(model: &Model, speed: f64, seconds: f64) -> Summary {
    let (mut low, mut high) = (0.0, 10.0 * speed);
    for _ in 0..11 {
        let middle = 0.5 * (low + high);
        let (_, summary, status) = drive(model, middle, seconds);
        if summary.speed < speed && status == Status::Running { low = middle } else { high = middle }
    }
    drive(model, low, seconds).1
}

#[test]
fn property_at_equal_speed_the_loops_keep_the_wheels_from_running_away() {
    let mut velocity = Model::preset("gentle_velocity").unwrap();
    velocity.control.kind = ControlKind::Velocity;
    let (_, held, _) = drive(&velocity, 0.25, 15.0);
    let rtc = Model::preset("gentle_rtc").unwrap();
    let free = at_speed(&rtc, held.speed, 15.0);
    let mut looped = rtc.clone();
    for (name, value) in LOOPS {
        looped.set(name, value).unwrap();
    }
    let trimmed = at_speed(&looped, held.speed, 15.0);
    for summary in [&free, &trimmed] {
        assert!((summary.speed - held.speed).abs() < EQUAL * held.speed, "{} m/s, {} m/s", summary.speed, held.speed);
    }
    let (rims, energies) =
        ([free.largest_rim_speed, held.largest_rim_speed], [free.energy_per_metre, held.energy_per_metre]);
    // The motors' 24 V end it at 1.03 m/s.
    assert!(rims[0] > 2.5 * rims[1], "K = 30 mm: a commanded torque runs away: {rims:?} m/s");
    assert!(energies[0] > 1.1 * energies[1], "{energies:?} J/m");
    assert!(trimmed.largest_rim_speed < 3.0 * held.largest_rim_speed);
    assert!((trimmed.energy_per_metre / held.energy_per_metre - 1.0).abs() < 0.05);
}

/// Three wheels on a chassis, the middle one over a hole.
fn over_a_hole() -> Model {
    let mut model = Model::new("over a hole", Rover::rigid(&[-0.35, 0.0, 0.35]));
    let samples = Samples::new(&[-3.0, -0.2, -0.15, 0.15, 0.2, 3.0], &[0.0, 0.0, -0.2, -0.2, 0.0, 0.0]).unwrap();
    model.rover.terrain = Terrain::new(Profile::Samples(std::sync::Arc::new(samples)));
    model.control.kind = ControlKind::Rtc;
    model
}

#[test]
fn property_a_wheel_in_the_air_is_found_and_held() {
    let mut model = over_a_hole();
    let (free, ..) = drive(&model, 0.1, 1.0);
    let runaway = free.signals().wheels[1].speed;
    for (name, value) in LOOPS {
        model.set(name, value).unwrap();
    }
    let (held, ..) = drive(&model, 0.1, 1.0);
    let wheel = &held.signals().wheels[1];
    let outcome = held.rtc().unwrap().outcome().unwrap();
    assert_eq!(wheel.normal_force, 0.0, "the middle wheel has to hang in the air");
    assert!(runaway > 2.5, "a torque without a loop runs away: {runaway} rad/s");
    assert!(wheel.speed.abs() < 1.25, "1 rad/s is wanted, found {}", wheel.speed);
    assert_eq!(outcome.footing, [Footing::Loaded, Footing::Lifted, Footing::Loaded]);
    assert!(outcome.forces[2] == 0.0 && outcome.forces[3] == 0.0, "a wheel in the air carries nothing");
    assert!(outcome.feasible, "the others carry all");
}

#[test]
fn property_neutral_loops_change_nothing() {
    let model = Model::preset("gentle_rtc").unwrap();
    assert_eq!(model.control.rtc, RoughTerrainControl::default());
    let mut other = model.clone();
    // Where the loops are off, their band means nothing.
    other.set("rtc.speed_band", 3.0).unwrap();
    other.set("sensor.wheel_speed_noise", 0.1).unwrap();
    let (ours, ..) = drive(&model, 0.25, 1.0);
    let (theirs, ..) = drive(&other, 0.25, 1.0);
    assert_eq!(ours.signals(), theirs.signals());
    assert!(ours.rtc().unwrap().outcome().unwrap().trim.iter().all(|trim| *trim == 0.0));
}

#[test]
fn property_integral_action_holds_the_speed_that_proportional_action_leaves() {
    let mut model = Model::preset("gentle_rtc").unwrap();
    model.set("soil.shear_modulus", 0.01).unwrap();
    let (_, droop, _) = drive(&model, 0.2, 20.0);
    model.set("rtc.integral_gain", 100.0).unwrap();
    let (_, held, _) = drive(&model, 0.2, 20.0);
    assert!((held.speed - 0.2).abs() < 0.02 * 0.2, "{} m/s of 0.2 m/s", held.speed);
    assert!((droop.speed - 0.2).abs() > 0.02 * 0.2, "the droop has to be there: {} m/s", droop.speed);
}
