//! Effects of the sensors: pitch bias, odometry, lag and dead time, as every door records them.

use bekker::effects::Effects;
use bekker::model::{ControlKind, Model};
use bekker::rover::Rover;
use bekker::signals::{Command, Signals};
use bekker::simulation::{Simulation, Status};
use bekker::terrain::{Profile, Slope, Terrain, Waves};

/// Identities in which only rounding differs.
const ROUNDING: f64 = 1e-12;
const STEP: f64 = 0.002;

fn rover(effects: Effects) -> Rover {
    let mut rover = Rover::two_wheeled();
    rover.terrain = Terrain::new(Profile::Waves(Waves { amplitude: 0.02, wavelength: 1.1, start: 0.2 }));
    rover.soil.shear_modulus = 0.01;
    rover.effects = effects;
    rover
}

fn lagging(time_constant: f64, dead_time: f64) -> Effects {
    let mut effects = Effects::default();
    effects.sensor_lag.time_constant = time_constant;
    effects.sensor_lag.dead_time = dead_time;
    effects
}

/// What is recorded after every step of a drive at 2 rad/s, the start first.
fn records(effects: Effects, steps: usize) -> Vec<Signals> {
    let mut simulation = Simulation::new(rover(effects), 0.0, STEP).expect("settles");
    let mut all = vec![simulation.signals().clone()];
    for _ in 0..steps {
        simulation.advance(&Command::speed(vec![2.0; 2]), 1).expect("steps");
        all.push(simulation.signals().clone());
    }
    all
}

#[test]
fn analytic_a_pitch_bias_is_opposite_after_the_heading_is_reversed() {
    let bias = 0.012;
    let pitch = |slope: f64| {
        let mut rover = Rover::two_wheeled();
        rover.terrain = Terrain::new(Profile::Slope(Slope { slope }));
        rover.effects.pitch_bias.angle = bias;
        let simulation = Simulation::new(rover, 0.0, STEP).expect("settles");
        simulation.signals().body.pitch
    };
    // The same hill, climbed and, turned round, descended: the inclination of the ground as recorded.
    let (up, turned) = (pitch(0.1), -pitch(-0.1));
    assert!((up - turned - 2.0 * bias).abs() < 1e-7, "{up} and {turned}");
}

#[test]
fn analytic_odometry_scales_way_and_speed_and_nothing_else() {
    let mut effects = Effects::default();
    effects.radius_scale.odometry = -0.02;
    let (truth, recorded) = (records(Effects::default(), 800), records(effects, 800));
    let x0 = truth[0].body.x;
    for (truth, recorded) in truth.iter().zip(recorded) {
        assert!((recorded.body.x - x0 - 0.98 * (truth.body.x - x0)).abs() < ROUNDING);
        assert!((recorded.body.velocity - 0.98 * truth.body.velocity).abs() < ROUNDING);
        let mut rest = recorded.clone();
        (rest.body.x, rest.body.velocity) = (truth.body.x, truth.body.velocity);
        assert_eq!(&rest, truth);
    }
}

#[test]
fn analytic_a_lag_answers_a_jump_with_its_exponential() {
    // Imposed wheel speeds jump from 0 to 2 rad/s with the first command.
    let time_constant = 0.1;
    for (k, signals) in records(lagging(time_constant, 0.0), 200).iter().enumerate() {
        let expected = 2.0 * (1.0 - (-(k as f64) * STEP / time_constant).exp());
        let speed = signals.wheels[1].speed;
        assert!((speed - expected).abs() < 1e-10, "{k}: {speed}, expected {expected}");
        if k == 50 {
            assert!((speed / 2.0 - 0.632).abs() < 1e-3, "63 % after one time constant");
        }
    }
}

#[test]
fn analytic_a_dead_time_shifts_the_record_and_leaves_the_energies() {
    let truth = records(Effects::default(), 600);
    let late = records(lagging(0.0, 20.0 * STEP), 600);
    for k in 20..=600 {
        let (truth, late) = (&truth[k - 20], &late[k]);
        for (a, b) in
            [(truth.body.x, late.body.x), (truth.body.pitch, late.body.pitch), (truth.body.power, late.body.power)]
        {
            assert!((a - b).abs() < 1e-9 * (1.0 + a.abs()), "{k}: {a} and {b}");
        }
        assert_eq!(truth.wheels[0].normal_force, late.wheels[0].normal_force, "{k}");
    }
    assert_eq!(truth[600].body.drive_work, late[600].body.drive_work);
    // A dead time between two steps lies between them.
    let between = records(lagging(0.0, 20.37 * STEP), 600);
    for k in 30..=600 {
        let (low, high, x) = (truth[k - 21].body.x, truth[k - 20].body.x, between[k].body.x);
        assert!(x >= low.min(high) && x <= low.max(high), "{k}: {x} in {low}..{high}");
    }
}

#[test]
fn analytic_a_delay_of_the_tracked_body_adds_to_that_of_all_signals() {
    let mut effects = lagging(0.0, 20.0 * STEP);
    let all = records(effects.clone(), 300);
    effects.tracking_delay.dead_time = 10.0 * STEP;
    let (truth, both) = (records(Effects::default(), 300), records(effects, 300));
    for k in 30..=300 {
        assert_eq!(both[k].wheels, all[k].wheels, "{k}: wheels are not tracked");
        assert_eq!(both[k].body.power, all[k].body.power, "{k}: nor is power");
        let (late, truth) = (&both[k].body, &truth[k - 30].body);
        for (late, truth) in [(late.x, truth.x), (late.velocity, truth.velocity), (late.pitch, truth.pitch)] {
            assert!((late - truth).abs() < 1e-9 * (1.0 + truth.abs()), "{k}: {late} and {truth}");
        }
    }
}

#[test]
fn property_the_record_is_smooth_in_the_dead_time_and_from_zero() {
    let x = |time_constant: f64, dead_time: f64| records(lagging(time_constant, dead_time), 400)[400].body.x;
    let velocity = records(Effects::default(), 400)[400].body.velocity;
    let small = 1e-6;
    // From the neutral value each of the two shifts by the velocity.
    for (slope, name) in
        [((x(small, 0.0) - x(0.0, 0.0)) / small, "lag"), ((x(0.0, small) - x(0.0, 0.0)) / small, "dead time")]
    {
        assert!((slope + velocity).abs() < 0.01 * velocity, "{name}: {slope} m/s, velocity {velocity} m/s");
    }
    // Slopes on both sides of a whole number of steps agree: their difference is curvature, not a kink.
    let at = 10.0 * STEP;
    let (left, right) = ((x(0.05, at) - x(0.05, at - small)) / small, (x(0.05, at + small) - x(0.05, at)) / small);
    assert!((left - right).abs() < 1e-5 * left.abs(), "{left} and {right}");
}

#[test]
fn property_the_motion_does_not_feel_its_sensors_without_a_controller() {
    let mut effects = lagging(0.1, 0.05);
    effects.pitch_bias.angle = 0.02;
    effects.radius_scale.odometry = 0.05;
    let end = |effects: Effects| {
        let mut simulation = Simulation::new(rover(effects), 0.0, STEP).expect("settles");
        simulation.advance(&Command::torque(vec![1.5; 2]), 1000).expect("steps");
        simulation.state().clone()
    };
    assert_eq!(end(effects), end(Effects::default()));
}

#[test]
fn property_a_controller_sees_what_is_recorded() {
    let mut model = Model::preset("gentle_velocity").expect("a preset");
    assert_eq!(model.control.kind, ControlKind::Velocity);
    model.sensors = Default::default();
    // Short beside the loop's own time: 80 ms make it unstable, as they would in a real drive.
    model.rover.effects = lagging(0.005, 0.003);
    model.rover.effects.pitch_bias.angle = 0.02;
    let mut run = model.start().expect("starts");
    assert_eq!(run.advance(200).expect("advances"), Status::Running);
    let before = run.signals().clone();
    run.advance(1).expect("advances");
    let measured = run.measurement();
    assert_eq!(measured.pitch, before.body.pitch);
    assert_eq!(measured.velocity, before.body.velocity);
    assert_eq!(measured.wheels[0].speed, before.wheels[0].speed);
}

#[test]
fn analytic_a_tracking_delay_is_that_of_the_body_alone() {
    const STEPS: usize = 20;
    let mut effects = Effects::default();
    effects.tracking_delay.dead_time = STEPS as f64 * STEP;
    let (truth, recorded) = (records(Effects::default(), 300), records(effects, 300));
    for (k, (truth_now, recorded)) in truth.iter().zip(recorded).enumerate() {
        let then = &truth[k.saturating_sub(STEPS)].body;
        let mut expected = truth_now.clone();
        let body = &mut expected.body;
        (body.x, body.z, body.velocity) = (then.x, then.z, then.velocity);
        (body.pitch, body.pitch_rate) = (then.pitch, then.pitch_rate);
        // The dead time is a whole number of steps but for rounding, between which the record is interpolated.
        for (recorded, expected) in [
            (recorded.body.x, body.x),
            (recorded.body.z, body.z),
            (recorded.body.velocity, body.velocity),
            (recorded.body.pitch, body.pitch),
            (recorded.body.pitch_rate, body.pitch_rate),
        ] {
            assert!((recorded - expected).abs() < 1e-9 * (1.0 + expected.abs()), "{k}: {recorded}, {expected}");
        }
        assert_eq!(recorded.wheels, truth_now.wheels);
        assert_eq!(recorded.body.power, truth_now.body.power);
    }
}
