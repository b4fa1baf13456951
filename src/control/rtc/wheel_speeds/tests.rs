//! Claim: a rover that drives gets a command also where the optimiser gives up, for a while.

use super::*;
use crate::control::rtc::Unsolved;
use crate::motor::Motor;
use crate::wheel::Wheel;

/// A controller of a rover of 10 kg on two wheels, rolling on level ground at 0.2 m/s.
fn rolling_on_level_ground() -> (SpeedRtc, Measurement, Demand, Command) {
    let rover = Nominal {
        gravity: 9.81,
        mass: 10.0,
        centre_of_mass: [0.0, 0.05],
        wheel_centres: vec![[-0.2, 0.0], [0.2, 0.0]],
        wheel_bodies: vec![0, 0],
        links: Vec::new(),
        wheel: Wheel::default(),
        motor: Motor::default(),
        soil: Soil { shear_modulus: 0.01, ..Soil::default() },
    };
    let mut measured = Measurement::of(2, 0);
    measured.velocity = 0.2;
    measured.wheels.iter_mut().for_each(|wheel| wheel.speed = 0.2 / rover.wheel.radius);
    let parameters = SpeedRoughTerrainControl::default();
    let rtc = SpeedRtc::new(rover, parameters, VelocityControl::default(), RtcOptions::default()).unwrap();
    let demand = Demand { acceleration: 0.0, speed: 0.2, criterion: Criterion::ElectricalPower };
    (rtc, measured, demand, Command::torque(vec![0.0; 2]))
}

fn gives_up() -> Result<Found, ControlError> {
    Err(Unsolved { problem: "forces", status: "too many iterations".into() }.into())
}

#[test]
fn property_where_the_optimiser_gives_up_the_last_forces_stay_for_a_second() {
    let (mut rtc, measured, demand, mut command) = rolling_on_level_ground();
    rtc.command(&measured, &Reference { velocity: 0.2 }, &mut command).unwrap();
    let (last, shares) = (rtc.outcome().unwrap().clone(), rtc.shares().to_vec());
    assert!(last.feasible);
    for _ in 1..(MOST_LOST / rtc.options.period) as usize {
        let before = rtc.outcome.take();
        rtc.act(gives_up(), &demand, &measured, before, &mut command).unwrap();
        let outcome = rtc.outcome().unwrap();
        assert!(!outcome.feasible && command.values.iter().all(|torque| torque.is_finite()), "{command:?}");
        assert_eq!((&outcome.forces, rtc.shares()), (&last.forces, &shares[..]));
    }
    // By rounding the next one or the one after it is beyond a second.
    let answers = [(); 2].map(|()| {
        let before = rtc.outcome.take();
        rtc.act(gives_up(), &demand, &measured, before, &mut command)
    });
    assert!(matches!(answers[1], Err(ControlError::Optimiser(_))), "{answers:?}");
}

#[test]
fn property_without_a_command_before_the_error_is_the_answer() {
    let (mut rtc, measured, demand, mut command) = rolling_on_level_ground();
    let answer = rtc.act(gives_up(), &demand, &measured, None, &mut command);
    assert!(matches!(answer, Err(ControlError::Optimiser(_))) && rtc.outcome().is_none(), "{answer:?}");
}

/// Torques and loads of two solutions of one problem by an interior-point method, relative: its gap of 1e-8 of the objective, near whose
/// minimum the forces differ by the root.
const MIRRORED: f64 = 1e-4;

#[test]
fn property_driving_backward_over_mirrored_ground_mirrors_torques_loads_and_slips() {
    let (mut forward, mut measured, _, mut ahead) = rolling_on_level_ground();
    let (mut backward, mut mirrored, _, mut back) = rolling_on_level_ground();
    // Up a slope over uneven ground, so that loads differ and slips are large.
    measured.pitch = 0.1;
    for (k, (angle, speed)) in [(0.15, 1.3), (0.05, 1.1)].into_iter().enumerate() {
        measured.wheels[k].contact_angle = angle;
        measured.wheels[k].speed *= speed;
    }
    mirrored.pitch = -measured.pitch;
    mirrored.velocity = -measured.velocity;
    for k in 0..2 {
        mirrored.wheels[k].contact_angle = -measured.wheels[1 - k].contact_angle;
        mirrored.wheels[k].speed = -measured.wheels[1 - k].speed;
    }
    for round in 0..5 {
        forward.command(&measured, &Reference { velocity: 0.2 }, &mut ahead).unwrap();
        backward.command(&mirrored, &Reference { velocity: -0.2 }, &mut back).unwrap();
        let close = |a: f64, b: f64| (a - b).abs() < MIRRORED * a.abs().max(b.abs());
        for k in 0..2 {
            let (one, other) = (forward.shares()[k], backward.shares()[1 - k]);
            assert!(close(ahead.values[k], -back.values[1 - k]), "{round}: {ahead:?} {back:?}");
            assert!(close(one.load, other.load) && close(one.slip, other.slip), "{round}: {one:?} {other:?}");
            assert!(one.slip > 0.02, "the wheels pull: {one:?}");
        }
        assert!((forward.shares()[0].load / forward.shares()[1].load - 1.0).abs() > 0.1, "loads differ");
    }
}
