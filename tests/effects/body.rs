//! Effects of the body: radius, payload, centre of mass, friction of joints.

use bekker::diagnosis::{Rig, steady_point};
use bekker::effects::Effects;
use bekker::rover::{Link, LinkParameters, Rover};
use bekker::signals::{Command, Drive, Signals};
use bekker::simulation::Simulation;
use bekker::terrain::{Profile, Terrain, Waves};

/// Two searches for rest that begin from different guesses, grown over a thousand steps.
const SAME_MOTION: f64 = 1e-6;
/// Identities in which only rounding differs.
const ROUNDING: f64 = 1e-10;

fn rough(mut rover: Rover) -> Rover {
    rover.terrain = Terrain::new(Profile::Waves(Waves { amplitude: 0.02, wavelength: 2.0, start: 0.2 }));
    rover.soil.shear_modulus = 0.01;
    rover
}

fn drive(rover: &Rover, drive: Drive) -> Simulation {
    let value = if drive == Drive::Torque { 1.7 } else { 2.0 };
    let command = Command { drive, values: vec![value; rover.wheels.len()] };
    let mut simulation = Simulation::new(rover.clone(), 0.0, 0.002).expect("settles");
    simulation.advance(&command, 1000).expect("steps");
    simulation
}

fn assert_same(a: &Signals, b: &Signals) {
    assert!(a.body.x > 0.05, "it drives: {} m", a.body.x);
    for (a, b) in [(a.body.x, b.body.x), (a.body.z, b.body.z), (a.body.pitch, b.body.pitch)] {
        assert!((a - b).abs() < SAME_MOTION, "{a} and {b}");
    }
    for (a, b) in a.wheels.iter().zip(&b.wheels) {
        for (a, b) in [(a.torque, b.torque), (a.sinkage, b.sinkage)] {
            assert!((a - b).abs() < SAME_MOTION, "{a} and {b}");
        }
        // Stiffness some 1e5 N/m.
        assert!((a.normal_force - b.normal_force).abs() < 100.0 * SAME_MOTION);
    }
}

#[test]
fn analytic_an_effect_of_the_body_is_a_rover_with_that_body() {
    type Change = fn(&mut Rover);
    let cases: [(Change, Change); 3] = [
        (|rover| rover.effects.payload.mass = 1.3, |rover| rover.body.mass += 1.3),
        (|rover| rover.effects.centre_of_mass.shift = -0.04, |rover| rover.body.centre_of_mass_x -= 0.04),
        (|rover| rover.effects.radius_scale.deviation = 0.03, |rover| rover.wheel.radius *= 1.03),
    ];
    for (effect, data) in cases {
        for kind in [Drive::Torque, Drive::Speed] {
            let plain = rough(Rover::two_wheeled());
            let (mut one, mut other) = (plain.clone(), plain.clone());
            effect(&mut one);
            data(&mut other);
            let (one, other, plain) = (drive(&one, kind), drive(&other, kind), drive(&plain, kind));
            assert_same(one.signals(), other.signals());
            let shows = (one.signals().body.x - plain.signals().body.x).abs();
            assert!(shows > 10.0 * SAME_MOTION, "the effect moves the rover by {shows} m");
        }
    }
}

#[test]
fn analytic_recorded_slip_is_reckoned_with_the_nominal_radius() {
    let mut rover = rough(Rover::two_wheeled());
    rover.effects.radius_scale.deviation = 0.05;
    let nominal = drive(&rover, Drive::Speed);
    rover.wheel.radius *= 1.05;
    rover.effects = Effects::default();
    let known = drive(&rover, Drive::Speed);
    for (nominal, known) in nominal.signals().wheels.iter().zip(&known.signals().wheels) {
        assert!(known.slip > 0.05, "both slips are those of driving: {}", known.slip);
        let expected = 1.0 - (1.0 - known.slip) * 1.05;
        assert!((nominal.slip - expected).abs() < 10.0 * SAME_MOTION, "{} for {expected}", nominal.slip);
    }
}

#[test]
fn analytic_a_rig_feels_radius_and_payload() {
    let plain = Rig::of(&Rover::two_wheeled());
    let mut effective = plain.clone();
    effective.effects.radius_scale.deviation = 0.04;
    effective.effects.payload.mass = 0.8;
    for slip in [-0.4, 0.1, 0.5] {
        let here = steady_point(&effective, 50.0, slip, 2.0).expect("a steady point");
        let mut known = plain.clone();
        known.wheel.radius *= 1.04;
        // V/(r omega) of the larger wheel.
        let share = if slip >= 0.0 { 1.0 - slip } else { 1.0 / (1.0 + slip) } / 1.04;
        let true_slip = if share <= 1.0 { 1.0 - share } else { 1.0 / share - 1.0 };
        let there = steady_point(&known, 50.0 + 0.8 * 9.81, true_slip, 2.0).expect("a steady point");
        for (a, b) in
            [(here.drawbar_pull, there.drawbar_pull), (here.torque, there.torque), (here.sinkage, there.sinkage)]
        {
            assert!((a - b).abs() < ROUNDING * (1.0 + b.abs()), "slip {slip}: {a} and {b}");
        }
    }
}

#[test]
fn analytic_friction_of_a_joint_is_a_constant_moment_against_its_rate() {
    for rate in [-0.3, -0.05, 0.08, 0.5] {
        let mut rover = rough(Rover::rocker_bogie());
        let mut state = rover.settled_at(0.5).expect("settles");
        state.rate[3] = rate;
        let command = Command::torque(vec![0.2; 3]);
        let accelerations = |rover: &Rover| rover.rate_of_change(&state, &command).expect("finite").rate;
        let free = accelerations(&rover);
        rover.effects.suspension_friction.moment = 0.4;
        let rubbing = accelerations(&rover);
        // The same moment from a viscous bearing.
        rover.effects = Effects::default();
        rover.links[0].parameters.damping += 0.4 / rate.abs();
        let viscous = accelerations(&rover);
        assert!((rubbing[3] - free[3]) * rate < 0.0, "against the motion");
        for i in 0..4 {
            // Smooth over 0.005 rad/s: 0.5 % at 0.05 rad/s.
            let (a, b) = (rubbing[i] - free[i], viscous[i] - free[i]);
            assert!((a - b).abs() < 0.006 * (viscous[3] - free[3]).abs(), "{rate} rad/s: {a} and {b}");
        }
    }
}

#[test]
fn property_friction_of_a_joint_holds_a_link_without_chatter() {
    // A link of its own weight on a level joint: 0.5 kg at 0.1 m pulls with 0.49 N m.
    let mut rover = Rover::two_wheeled();
    let parameters = LinkParameters {
        z: 0.3,
        centre_of_mass_x: 0.1,
        centre_of_mass_z: 0.3,
        damping: 0.0,
        ..LinkParameters::default()
    };
    rover.links = vec![Link { parent: 0, parameters }];
    let swing = |moment: f64, rate: f64| {
        let mut rover = rover.clone();
        rover.effects.suspension_friction.moment = moment;
        let mut state = rover.settled_at(0.0).unwrap_or_else(|_| bekker::rover::State::at_rest(&rover, 0.0, 0.095));
        state.position[3] = 0.0;
        state.rate[3] = rate;
        let mut simulation = Simulation::from_state(rover, state, 0.002).expect("starts");
        let mut reversals = 0;
        let mut before = 0.0;
        for _ in 0..1500 {
            simulation.advance(&Command::speed(vec![0.0; 2]), 1).expect("steps");
            let rate = simulation.state().rate[3];
            reversals += usize::from(rate * before < 0.0);
            before = rate;
        }
        (simulation.state().position[3], reversals)
    };
    let (free, swings) = swing(0.0, 0.0);
    assert!(swings >= 4, "a free link swings: {swings} reversals, at {free} rad");
    let (held, _) = swing(1.0, 0.0);
    // Below the moment it creeps at the smooth reversal's rate: 0.005 rad/s times 0.49/sqrt(1 - 0.49^2).
    assert!(held.abs() < 1.2 * 3.0 * 0.005 * 0.49 / (1.0 - 0.49 * 0.49_f64).sqrt(), "{held} rad in 3 s");
    // Chatter would reverse the joint at every step or two, 1500 in all; with friction it may swing a little
    // faster at its smaller amplitude. The hardest stop is that of a fast link by the largest moment.
    for (moment, rate) in [(0.05, 0.0), (0.3, 0.0), (1.0, 1.0), (5.0, 1.0)] {
        let (_, reversals) = swing(moment, rate);
        assert!(reversals <= 2 * swings, "{moment} N m: {reversals} reversals with friction, {swings} without");
    }
}

#[test]
fn regress_friction_of_joints_is_nothing_on_a_rigid_chassis() {
    let mut rover = rough(Rover::two_wheeled());
    let free = drive(&rover, Drive::Torque);
    rover.effects.suspension_friction.moment = 3.0;
    assert_eq!(drive(&rover, Drive::Torque).signals(), free.signals());
}
