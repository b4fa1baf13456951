//! Claims: the baselines do what their names say, each is a word of `[control] kind`, and only slip control is told
//! the true slip.

use crate::control_support::{Case, thesis_rover};
use bekker::control::{
    ControlError, Controller, EqualTorque, EqualTorqueController, SlipControl, SlipController, TunedVelocity,
    VelocityControl, soil_slope,
};
use bekker::model::{Model, Run};
use bekker::modeldescription::Lookup;
use bekker::signals::{Command, Measurement, Reference, WheelMeasurement};

fn started(text: &str) -> Run {
    let mut run = Model::from_toml(text, None).unwrap().start().unwrap();
    run.inputs_mut().set("velocity_command", 0.2).unwrap();
    run
}

/// The thesis's rover on its gentle ground, of a soil that carries it (K = 10 mm), under a kind of control.
fn gentle(kind: &str) -> String {
    format!("preset = 'gentle_velocity'\n[control]\nkind = '{kind}'\n[parameters]\nsoil.shear_modulus = 0.01\n")
}

#[test]
fn property_every_kind_drives_over_gentle_ground() {
    for kind in ["velocity", "velocity_tuned", "rtc", "slip", "equal_torque"] {
        let mut run = started(&gentle(kind));
        run.advance(5000).unwrap();
        let x = run.signals().body.x;
        // Velocity control loses its slip, rough-terrain control droops; the other two hold the body's speed.
        let (least, most) = if ["slip", "equal_torque"].contains(&kind) { (1.9, 2.05) } else { (1.4, 1.9) };
        assert!((least..most).contains(&x), "{kind}: {x} m in 10 s at 0.2 m/s");
    }
}

#[test]
fn property_slip_control_gives_all_wheels_the_same_slip() {
    let mut run = started(&gentle("slip"));
    run.advance(2500).unwrap();
    for _ in 0..20 {
        run.advance(50).unwrap();
        let slip = [run.signals().wheels[0].slip, run.signals().wheels[1].slip];
        assert!((slip[0] - slip[1]).abs() < 0.01, "slips {slip:?} at t = {}", run.time());
        assert!((run.signals().body.velocity - 0.2).abs() < 0.01, "{} m/s", run.signals().body.velocity);
    }
}

#[test]
fn property_slip_control_needs_its_privileged_channel() {
    let case = Case::level(thesis_rover());
    let mut controller =
        SlipController::new(thesis_rover(), SlipControl::default(), VelocityControl::default()).unwrap();
    let (goal, mut command) = (Reference { velocity: 0.2 }, Command::torque(vec![0.0; 2]));
    let unknown = controller.command(&case.measurement(), &goal, &mut command).unwrap_err();
    assert_eq!(unknown, ControlError::Privileged { expected: 2, found: 0 });
    controller.reveal([0.1, 0.1].into_iter());
    controller.command(&case.measurement(), &goal, &mut command).unwrap();
    // Used up: yesterday's truth is not today's.
    assert!(controller.command(&case.measurement(), &goal, &mut command).is_err());
}

#[test]
fn analytic_slip_control_asks_for_the_speed_that_gives_the_slip() {
    // At the wanted speed no slip is asked for: r omega = V. Wheels turn at 2 rad/s with 20 % slip, V = 0.16 m/s.
    let gains = VelocityControl { kp: 1.0, ki: 0.0, ..VelocityControl::default() };
    let parameters = SlipControl { gain: 0.5, integral_gain: 0.0, ..SlipControl::default() };
    let mut controller = SlipController::new(thesis_rover(), parameters, gains).unwrap();
    let wheel = WheelMeasurement { speed: 2.0, ..WheelMeasurement::default() };
    let mut measured = Measurement { velocity: 0.16, wheels: vec![wheel; 2], ..Measurement::default() };
    let mut command = Command::torque(Vec::new());
    let mut torque = |measured: &Measurement, goal: f64| {
        controller.reveal([0.2, 0.2].into_iter());
        controller.command(measured, &Reference { velocity: goal }, &mut command).unwrap();
        command.values[0]
    };
    assert!((torque(&measured, 0.16) - (1.6 - 2.0)).abs() < 1e-12);
    // Twice as fast is wanted: half the relative error of 1/2 is a slip of 1/4, r omega = 0.16/0.75.
    assert!((torque(&measured, 0.32) - (1.6 / 0.75 - 2.0)).abs() < 1e-12);
    // The body turns nose up at 0.5 rad/s: the encoder sees that much more than the ground.
    measured.pitch_rate = 0.5;
    assert!((torque(&measured, 0.16) - (1.2 + 0.5 - 2.0)).abs() < 1e-12);
}

#[test]
fn analytic_equal_torque_follows_its_law_and_limits() {
    let gains = EqualTorque { gain: 5.0, integral_gain: 10.0, period: 0.01 };
    let mut controller = EqualTorqueController::new(&thesis_rover(), gains).unwrap();
    let mut measured = Case::level(thesis_rover()).measurement();
    let mut command = Command::torque(Vec::new());
    let mut torques = |controller: &mut EqualTorqueController, measured: &Measurement, goal: f64| {
        controller.command(measured, &Reference { velocity: goal }, &mut command).unwrap();
        command.values.clone()
    };
    // 10 kg, r = 0.1 m, two wheels: 0.5 N m a m/s^2. a = 5 * 0.2 + 10 * 0.01 * 0.2, then 0.02 more.
    assert!(torques(&mut controller, &measured, 0.2).iter().all(|torque| (torque - 0.51).abs() < 1e-12));
    assert!((torques(&mut controller, &measured, 0.2)[0] - 0.52).abs() < 1e-12);
    // One g at most, and the integral does not wind up on it.
    for _ in 0..1000 {
        assert!(torques(&mut controller, &measured, 5.0)[1] <= 0.5 * 9.81 + 1e-12);
    }
    measured.velocity = 5.0;
    assert!(torques(&mut controller, &measured, 5.0)[0] <= 0.5 * 9.81, "what is left of the integral");
}

#[test]
fn property_tuned_gains_are_damped_on_every_soil_and_the_best() {
    let nominal = thesis_rover();
    let gains = TunedVelocity::default().gains(&nominal).unwrap();
    let slope = soil_slope(&nominal, 0.25);
    assert!((1.0..20.0).contains(&slope), "{slope} N m s/rad");
    // The step responses of the sampled loop, computed here: overshoot of a second-order pair with damping 0.71 is
    // 4.3 %, and more with the zero of the proportional part off the ground.
    for (slope, most) in [(0.0, 1.35), (0.1 * slope, 1.35), (slope, 1.05)] {
        let (mut speed, mut integral, mut peak) = (0.0_f64, 0.0, 0.0_f64);
        for _ in 0..3000 {
            integral += gains.ki * gains.period * (1.0 - speed);
            let torque = gains.kp * (1.0 - speed) + integral;
            // 100 explicit steps a period.
            for _ in 0..100 {
                speed += gains.period / 100.0 * (torque - slope * speed) / nominal.wheel.inertia;
            }
            peak = peak.max(speed);
        }
        assert!((speed - 1.0).abs() < 1e-3, "slope {slope}: {speed} after 30 s");
        assert!(peak < most, "slope {slope}: overshoots to {peak}");
    }
    // A larger period allows less, as does a lighter wheel.
    let slow = TunedVelocity { period: 0.02, ..TunedVelocity::default() }.gains(&nominal).unwrap();
    assert!(slow.ki < 0.5 * gains.ki, "{slow:?}");
}

#[test]
fn regress_words_and_nominal_soil_survive_a_file() {
    let text = "preset = 'gentle_rtc'\n[control]\nsolver = 'active_set'\nstrength = 'thesis'\n[control.nominal_soil]\ncohesion = 500.0\n[parameters]\nsoil.friction_angle = 0.6\n";
    let mut model = Model::from_toml(text, None).unwrap();
    assert_eq!(model.get("nominal.soil.cohesion").unwrap(), 500.0);
    assert_eq!(model.get("nominal.soil.friction_angle").unwrap(), 0.6, "not named: as the true soil's");
    assert_eq!(model.get("soil.cohesion").unwrap(), 1000.0);
    let mut again = Model::from_toml(&model.to_toml().unwrap(), None).unwrap();
    assert_eq!(again.control, model.control);
    assert_eq!(again.list(), model.list());
    let plain = Model::preset("gentle_rtc").unwrap();
    assert!(plain.control.nominal_soil.is_none() && !plain.to_toml().unwrap().contains("nominal"));
    assert!(Model::from_toml("preset = 'gentle_rtc'\n[control]\nsolver = 'simplex'\n", None).is_err());
    let wrong = Model::from_toml("preset = 'gentle_rtc'\n[control.nominal_soil]\ncohesien = 1.0\n", None).unwrap_err();
    assert!(wrong.to_string().contains("nominal.soil.cohesion"), "{wrong}");
}

#[test]
fn property_a_wrong_nominal_soil_changes_what_rough_terrain_control_does() {
    let end = |soil: &str| {
        let mut run = started(&format!("preset = 'gentle_rtc'\n{soil}"));
        run.advance(300).unwrap();
        run.signals().body.x
    };
    let (right, same) = (end(""), end("[control.nominal_soil]\ncohesion = 1000.0\n"));
    assert_eq!(right.to_bits(), same.to_bits(), "the same numbers, the same bits");
    assert!(end("[control.nominal_soil]\nfriction_angle = 0.1\n") < 0.9 * right, "a weak soil is driven gently");
}
