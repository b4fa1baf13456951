//! The rover's motion: rest, symmetry, energy, order of the integrator, events.

use bekker::rover::{Link, LinkParameters, Rover};
use bekker::signals::Command;
use bekker::simulation::{Event, Simulation, Status};
use bekker::terrain::{Profile, Samples, Slope, Step, Terrain, Waves};
use std::sync::Arc;

/// Forces at rest balance to this share of the weight: what the issue asks.
const FORCE_BALANCE: f64 = 1e-6;
/// A parked rover may move this far in a minute, m.
const PARKED: f64 = 1e-3;
/// Energies balance to this share of the drives' work: what the issue asks.
const ENERGY_BALANCE: f64 = 0.01;
/// Mirrored drives differ by rounding only, grown over a thousand steps.
const MIRRORED: f64 = 1e-9;

fn slope(angle: f64) -> Terrain {
    Terrain::new(Profile::Slope(Slope { slope: angle.to_radians() }))
}

fn waves(amplitude: f64, wavelength: f64) -> Terrain {
    Terrain::new(Profile::Waves(Waves { amplitude, wavelength, start: 0.4 }))
}

fn drive(rover: &Rover, command: &Command, step_size: f64, duration: f64) -> Simulation {
    let mut simulation = Simulation::new(rover.clone(), 0.0, step_size).expect("settles");
    simulation.advance(command, (duration / step_size).round() as u64).expect("steps");
    simulation
}

#[test]
fn analytic_forces_of_the_settled_rover_balance_its_weight() {
    for rover in [Rover::two_wheeled(), Rover::rigid(&[-0.4, -0.1, 0.1, 0.45]), Rover::rocker_bogie()] {
        for angle in [0.0, 5.0, -12.0] {
            let mut rover = rover.clone();
            rover.terrain = slope(angle);
            let locked = Command::speed(vec![0.0; rover.wheels.len()]);
            let at_rest = drive(&rover, &locked, 0.002, 0.002);
            let weight = rover.total_mass() * rover.environment.gravity;
            let (mut x, mut z) = (0.0, 0.0);
            for wheel in &at_rest.signals().wheels {
                let (sin, cos) = wheel.contact_angle.sin_cos();
                x += wheel.drawbar_pull * cos - wheel.normal_force * sin;
                z += wheel.drawbar_pull * sin + wheel.normal_force * cos;
            }
            assert!(x.abs() < FORCE_BALANCE * weight, "{angle} deg: {x} N along x");
            assert!((z - weight).abs() < FORCE_BALANCE * weight, "{angle} deg: {z} N carry {weight} N");
        }
    }
}

#[test]
fn analytic_a_centre_of_mass_ahead_loads_the_front_wheel_by_the_lever() {
    let mut rover = Rover::two_wheeled();
    rover.body.centre_of_mass_x = 0.1;
    rover.body.centre_of_mass_z = 0.0;
    let at_rest = drive(&rover, &Command::speed(vec![0.0; 2]), 0.002, 0.002);
    let [rear, front] = [0, 1].map(|k| at_rest.signals().wheels[k].normal_force);
    let pitch = at_rest.signals().body.pitch;
    // Moments about the rear wheel; the lever arms shrink alike with the pitch.
    let expected = 10.0 * 9.81 * (0.35 + 0.1) / 0.7;
    assert!((front - expected).abs() < FORCE_BALANCE * 98.1, "front {front}, rear {rear}, pitch {pitch}");
    assert!(pitch < 0.0, "it sinks more in front, nose down");
}

#[test]
fn property_a_parked_rover_stays_on_slopes_that_the_soil_can_carry() {
    for (angle, locked) in [(0.0, false), (3.0, false), (10.0, true), (20.0, true), (-15.0, true)] {
        let mut rover = Rover::two_wheeled();
        rover.terrain = slope(angle);
        let command = if locked { Command::speed(vec![0.0; 2]) } else { Command::torque(vec![0.0; 2]) };
        let mut parked = Simulation::new(rover, 0.0, 0.002).expect("settles");
        let x = parked.signals().body.x;
        let status = parked.advance(&command, 30_000).expect("steps");
        assert_eq!(status, Status::Running, "{angle} deg");
        let moved = (parked.signals().body.x - x).abs();
        assert!(moved < PARKED, "{angle} deg: moved {moved} m in a minute");
    }
}

#[test]
fn property_a_rover_on_a_slope_beyond_its_friction_slides() {
    let mut rover = Rover::two_wheeled();
    rover.terrain = slope(40.0);
    rover.soil.cohesion = 0.0;
    rover.soil.friction_angle = 20.0_f64.to_radians();
    let sliding = drive(&rover, &Command::speed(vec![0.0; 2]), 0.002, 2.0);
    assert!(sliding.signals().body.x < -0.05, "x = {}", sliding.signals().body.x);
}

#[test]
fn property_driving_backward_mirrors_driving_forward() {
    let mut rover = Rover::two_wheeled();
    rover.soil.shear_modulus = 0.01;
    rover.terrain = slope(4.0);
    let forward = drive(&rover, &Command::torque(vec![1.7, 1.9]), 0.002, 2.0);
    rover.terrain = slope(-4.0);
    let backward = drive(&rover, &Command::torque(vec![-1.9, -1.7]), 0.002, 2.0);
    let (f, b) = (forward.signals(), backward.signals());
    assert!(f.body.x.abs() > 0.05, "it drives: {}", f.body.x);
    for (there, back) in [(f.body.x, -b.body.x), (f.body.z, b.body.z), (f.body.pitch, -b.body.pitch)] {
        assert!((there - back).abs() < MIRRORED, "{there} against {back}");
    }
    for (there, back) in f.wheels.iter().zip(b.wheels.iter().rev()) {
        assert!((there.normal_force - back.normal_force).abs() < 1e-6 * 98.1);
        assert!((there.drawbar_pull + back.drawbar_pull).abs() < 1e-6 * 98.1);
    }
}

#[test]
fn property_work_of_the_drives_is_soil_loss_and_energy_gained() {
    let mut rocker_bogie = Rover::rocker_bogie();
    rocker_bogie.links[0].parameters.damping = 0.5;
    rocker_bogie.effects.drag.force = 0.5;
    rocker_bogie.effects.coulomb_friction.torque = 0.02;
    rocker_bogie.effects.gear_efficiency.eta = 0.8;
    rocker_bogie.effects.suspension_friction.moment = 0.1;
    rocker_bogie.effects.payload.mass = 0.5;
    rocker_bogie.effects.centre_of_mass.shift = 0.02;
    rocker_bogie.effects.radius_scale.deviation = 0.03;
    let mut hard = Rover::two_wheeled();
    hard.soil.shear_modulus = 0.01;
    let cases = [
        (hard.clone(), waves(0.03, 2.0), Command::torque(vec![1.5; 2])),
        (hard.clone(), waves(0.03, 2.0), Command::speed(vec![2.5; 2])),
        (Rover::two_wheeled(), waves(0.02, 1.5), Command::speed(vec![3.0; 2])),
        (rocker_bogie.clone(), waves(0.01, 0.7), Command::torque(vec![0.38; 3])),
        (rocker_bogie, waves(0.01, 0.7), Command::speed(vec![1.5; 3])),
    ];
    for (mut rover, terrain, command) in cases {
        rover.terrain = terrain;
        let mut simulation = Simulation::new(rover, 0.0, 0.002).expect("settles");
        let start = simulation.signals().body.mechanical_energy;
        simulation.advance(&command, 2500).expect("steps");
        let body = &simulation.signals().body;
        let gained = body.mechanical_energy - start;
        let left = body.drive_work - body.soil_loss - body.other_loss - gained;
        assert!(body.drive_work > 0.5, "the drives work: {} J", body.drive_work);
        assert!(left.abs() < ENERGY_BALANCE * body.drive_work, "{command:?}: {left} J of {} J", body.drive_work);
    }
}

#[test]
fn property_step_refinement_converges_with_order_two() {
    let mut rover = Rover::two_wheeled();
    rover.soil.shear_modulus = 0.01;
    // The limit by the supply is a kink, at which the order falls.
    rover.motor.inverse_voltage = 0.0;
    rover.terrain = waves(0.02, 3.0);
    let end = |step_size| drive(&rover, &Command::torque(vec![1.6; 2]), step_size, 3.2).signals().body.x;
    let reference = end(0.00025);
    let [coarse, middle, fine] = [0.008, 0.004, 0.002].map(|step_size| (end(step_size) - reference).abs());
    for (larger, smaller) in [(coarse, middle), (middle, fine)] {
        let order = (larger / smaller).log2();
        assert!((1.6..3.0).contains(&order), "order {order:.2} from {larger:.2e} to {smaller:.2e}");
    }
    assert!(fine < 1e-4, "the default step is off by {fine} m after 3 s of acceleration");
}

#[test]
fn property_stays_stable_from_standstill_to_full_slip_at_the_default_step() {
    // A light rim on hard soil: rates of the spin up to 1e5/s.
    let mut rover = Rover::two_wheeled();
    rover.wheel.inertia = 0.001;
    rover.soil.k_phi = 5e6;
    rover.soil.shear_modulus = 0.005;
    // A supply would keep the wheels from spinning.
    rover.motor.inverse_voltage = 0.0;
    for speed in [0.0, 0.001, 0.02, 0.5, 5.0, 30.0] {
        let command = Command::speed(vec![speed; 2]);
        let simulation = drive(&rover, &command, 0.002, 4.0);
        let velocity = simulation.signals().body.velocity;
        assert!((0.0..=speed * 0.1 + 1e-9).contains(&velocity), "{velocity} m/s at {speed} rad/s");
    }
    let spinning = drive(&rover, &Command::torque(vec![6.0; 2]), 0.002, 2.0);
    assert!(spinning.signals().wheels.iter().all(|wheel| wheel.slip > 0.5 && wheel.slip <= 1.0));
}

#[test]
fn property_a_drive_at_its_supply_voltage_settles_where_the_back_emf_leaves_it() {
    // Down to the smallest winding resistance allowed: the slope of the torque in the speed is 5500 N m s/rad there.
    for resistance in [2.32, 0.5, 0.1, 0.01, 0.001] {
        let mut rover = Rover::two_wheeled();
        rover.soil.shear_modulus = 0.01;
        rover.motor.resistance = resistance;
        rover.effects.voltage_limit.inverse_voltage = 1.0 / 4.0;
        let simulation = drive(&rover, &Command::torque(vec![5.0; 2]), 0.002, 4.0);
        let constant = rover.motor.gear_ratio * rover.motor.torque_constant;
        for wheel in &simulation.signals().wheels {
            let speed = (4.0 - resistance * wheel.current) / constant;
            assert!((wheel.speed - speed).abs() < 1e-6, "{resistance} Ohm: {} rad/s, expected {speed}", wheel.speed);
        }
    }
}

#[test]
fn property_the_same_inputs_give_the_same_bits_and_a_clone_goes_on_alike() {
    let mut rover = Rover::rocker_bogie();
    rover.terrain = waves(0.01, 0.7);
    let command = Command::torque(vec![0.3; 3]);
    let once = drive(&rover, &command, 0.002, 2.0);
    let again = drive(&rover, &command, 0.002, 2.0);
    assert_eq!(once.signals(), again.signals());
    let mut half = drive(&rover, &command, 0.002, 1.0);
    let mut copy = half.clone();
    half.advance(&command, 500).expect("steps");
    copy.advance(&command, 500).expect("steps");
    assert_eq!(half.signals(), copy.signals());
    assert_eq!(half.signals(), once.signals());
}

#[test]
fn property_events_end_a_run_and_nothing_moves_afterwards() {
    let speed = |value: f64| Command::speed(vec![value; 2]);
    let mut stuck = Rover::two_wheeled();
    stuck.terrain = slope(25.0);
    let mut tall = Rover::two_wheeled();
    tall.body.centre_of_mass_z = 1.5;
    tall.soil.shear_modulus = 0.005;
    tall.soil.cohesion = 20_000.0;
    tall.terrain = waves(0.5, 3.0);
    let mut ledge = Rover::two_wheeled();
    ledge.soil.shear_modulus = 0.005;
    ledge.terrain = Terrain::new(Profile::Step(Step { height: -0.3, length: 0.05, position: 0.5 }));
    let mut short = Rover::two_wheeled();
    short.soil.shear_modulus = 0.01;
    let samples = Samples::new(&[-1.0, 0.0, 0.8], &[0.0; 3]).expect("samples");
    short.terrain = Terrain::new(Profile::Samples(Arc::new(samples)));
    let mut bog = Rover::two_wheeled();
    bog.soil.k_phi = 200_000.0;
    bog.effects.slip_sinkage.n1 = 1.0;
    bog.body.belly_z = 0.1;
    let cases = [
        (stuck, speed(2.5), Event::Stuck),
        (tall, speed(6.0), Event::TippedOver),
        (ledge, speed(2.0), Event::BellyContact),
        (short, speed(2.5), Event::LeftTerrain),
        (bog, speed(25.0), Event::SunkToAxle),
    ];
    for (rover, command, event) in cases {
        let mut simulation = match Simulation::new(rover, 0.0, 0.002) {
            Ok(simulation) => simulation,
            Err(error) => panic!("{event}: {error}"),
        };
        let status = simulation.advance(&command, 20_000).expect("an event is no error");
        assert_eq!(status, Status::Ended(event), "{:?}", simulation.signals());
        let before = simulation.signals().clone();
        assert_eq!(simulation.advance(&command, 100), Ok(status));
        assert_eq!(&before, simulation.signals());
    }
}

#[test]
fn property_a_joint_that_cannot_turn_is_no_joint() {
    let mut rigid = Rover::rigid(&[-0.35, 0.0, 0.35]);
    rigid.terrain = waves(0.02, 2.0);
    rigid.soil.shear_modulus = 0.01;
    rigid.body.centre_of_mass_z = 0.0;
    let mut linked = rigid.clone();
    let (mass, inertia) = (0.5, 0.01);
    // A damper of 1e6 N m s/rad lets the joint turn by some 1e-6 rad in a second.
    let parameters = LinkParameters { x: 0.0, mass, inertia, damping: 1e6, ..Default::default() };
    linked.links = vec![Link { parent: 0, parameters }];
    linked.wheels[1].body = 1;
    linked.body.mass -= mass;
    linked.body.pitch_inertia -= inertia;
    let command = Command::torque(vec![1.2; 3]);
    let (one, other) = (drive(&rigid, &command, 0.002, 1.5), drive(&linked, &command, 0.002, 1.5));
    let (x, y) = (one.signals().body.x, other.signals().body.x);
    assert!(x.abs() > 0.1, "it drives: {x} m");
    assert!((x - y).abs() < 1e-5 * x.abs(), "{x} against {y}");
}

#[test]
fn property_bad_commands_are_named() {
    let mut simulation = Simulation::new(Rover::two_wheeled(), 0.0, 0.002).expect("settles");
    let error = simulation.advance(&Command::torque(vec![1.0]), 1).expect_err("one value for two wheels");
    assert!(error.to_string().contains("1 values") && error.to_string().contains("2 wheels"), "{error}");
    let error = simulation.advance(&Command::torque(vec![1.0, f64::NAN]), 1).expect_err("NaN");
    assert!(error.to_string().contains("wheel 2") && error.to_string().contains("NaN"), "{error}");
    assert!(Simulation::new(Rover::two_wheeled(), 0.0, 0.0).is_err());
    assert!(Simulation::new(Rover::two_wheeled(), f64::NAN, 0.002).is_err());
}
