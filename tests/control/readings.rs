//! Claims: bad readings give an error and leave the command alone; answers do not depend on history; and a
//! command of RTC allocates only what Clarabel's timers do.

use crate::control_support::{Case, thesis_rover};
use bekker::control::{ControlError, Controller, Rtc, VelocityControl, VelocityController};
use bekker::signals::{Command, Measurement, Reference};

const BAD: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

/// Gives a reading to a controller, expects a refusal that names `quantity`, and an untouched command.
fn refuses(controller: &mut dyn Controller, measured: &Measurement, goal: f64, quantity: &str) {
    let mut command = Command::speed(vec![7.0, 8.0]);
    let error = controller.command(measured, &Reference { velocity: goal }, &mut command);
    let said = error.expect_err("a bad reading has to be refused").to_string();
    assert!(said.contains(quantity), "`{said}` does not name {quantity}");
    assert_eq!(command, Command::speed(vec![7.0, 8.0]));
}

#[test]
fn property_rtc_refuses_what_is_not_finite() {
    let case = Case::level(thesis_rover());
    let (mut rtc, _) = case.run();
    for bad in BAD {
        refuses(&mut rtc, &Measurement { pitch: bad, ..case.measurement() }, 0.1, "pitch");
        refuses(&mut rtc, &Measurement { velocity: bad, ..case.measurement() }, 0.1, "velocity");
        refuses(&mut rtc, &case.measurement(), bad, "goal");
        let mut measured = case.measurement();
        measured.wheels[1].contact_angle = bad;
        refuses(&mut rtc, &measured, 0.1, "contact angle of wheel 2");
        assert!(rtc.outcome().is_none(), "an old outcome must not look like a new one");
    }
    refuses(&mut rtc, &case.measurement(), f64::MAX, "acceleration");
    refuses(&mut rtc, &Measurement::default(), 0.1, "0 wheels");
}

#[test]
fn property_velocity_control_refuses_what_is_not_finite_and_keeps_its_history() {
    let measured = Case::level(thesis_rover()).measurement();
    let mut controller = VelocityController::new(&thesis_rover(), VelocityControl::default()).expect("valid");
    let mut command = Command::torque(vec![0.0; 2]);
    controller.command(&measured, &Reference { velocity: 0.1 }, &mut command).expect("finite readings");
    let before = controller.clone();
    for bad in BAD {
        let mut spoilt = measured.clone();
        spoilt.wheels[0].speed = bad;
        refuses(&mut controller, &spoilt, 0.1, "speed of wheel 1");
        refuses(&mut controller, &measured, bad, "goal");
    }
    let mut spoilt = measured.clone();
    spoilt.wheels[1].speed = f64::MAX;
    refuses(&mut controller, &spoilt, -0.1 * f64::MAX, "torque of wheel");
    refuses(&mut controller, &Measurement::default(), 0.1, "0 wheels");
    assert_eq!(controller, before);
}

#[test]
fn property_finite_readings_give_finite_torques_however_absurd() {
    for size in [1e-300, 1e-3, 1.0, 1e3, 1e6] {
        for seed in 0..60 {
            let mut case = Case::random(seed, [2, 3, 6][seed as usize % 3]);
            (case.goal, case.velocity) = (case.goal * size, case.velocity * size);
            let mut rtc = Rtc::new(case.nominal.clone(), case.parameters).expect("valid");
            let mut command = Command::torque(Vec::new());
            match rtc.command(&case.measurement(), &case.reference(), &mut command) {
                Ok(()) => assert!(command.values.iter().all(|torque| torque.is_finite()), "{case:?}"),
                Err(error) => panic!("{error} in {case:?}"),
            }
        }
    }
}

#[test]
fn regress_rtc_has_no_history_and_survives_cloning() {
    for wheels in [2, 6] {
        let mut first = Case::random(3, wheels);
        first.parameters.switch_angle = 0.3;
        let (mut rtc, torques) = first.run();
        let mut command = Command::torque(Vec::new());
        for seed in 0..40 {
            let other =
                Case { nominal: first.nominal.clone(), parameters: first.parameters, ..Case::random(seed, wheels) };
            rtc.command(&other.measurement(), &other.reference(), &mut command).expect("finite readings");
        }
        let mut copy = rtc.clone();
        for controller in [&mut rtc, &mut copy] {
            controller.command(&first.measurement(), &first.reference(), &mut command).expect("finite readings");
            let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&command.values), bits(&torques), "{wheels} wheels");
        }
    }
}

#[test]
fn property_controllers_can_move_to_other_threads() {
    fn movable<T: Send + Sync + Clone>() {}
    movable::<Rtc>();
    movable::<VelocityController>();
    movable::<ControlError>();
}
