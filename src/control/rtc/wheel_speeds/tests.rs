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
