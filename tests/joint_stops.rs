//! Stops of the joints: where a link rests, what they take, and that no drive turns a bogie through.

use bekker::model::Model;
use bekker::rover::{Link, LinkParameters, Rover, State};
use bekker::signals::Command;
use bekker::simulation::{Simulation, Status};

/// A link at rest: its angle agrees with statics to this share of a radian.
const AT_REST: f64 = 1e-4;
/// Energies balance to this share of what the link has at the stop, as in the balance of a driving rover.
const ENERGY_BALANCE: f64 = 0.01;
/// Step at which they do, s: the blow on the stop lasts some hundredths of a second.
const BALANCE_STEP: f64 = 0.0005;
/// Hardest blow of the drives of a preset: the angle beyond a stop, rad. The stops bend by 2 degrees under the weight.
const BENT: f64 = 0.06;

/// A two-wheeled rover whose chassis carries a link of 0.5 kg with its weight 0.1 m ahead of the joint.
fn with_arm(stop: f64) -> Rover {
    let mut rover = Rover::two_wheeled();
    let parameters = LinkParameters {
        z: 0.3,
        centre_of_mass_x: 0.1,
        centre_of_mass_z: 0.3,
        damping: 0.0,
        stop,
        ..LinkParameters::default()
    };
    rover.links = vec![Link { parent: 0, parameters }];
    rover
}

/// The link let go at its zero.
fn let_go(rover: Rover, step_size: f64, seconds: f64) -> (Simulation, f64) {
    let state = State::at_rest(&rover, 0.0, 0.095);
    let mut simulation = Simulation::from_state(rover, state, step_size).expect("starts");
    let start = simulation.signals().body.mechanical_energy;
    simulation.advance(&Command::speed(vec![0.0; 2]), (seconds / step_size).round() as u64).expect("steps");
    (simulation, start)
}

#[test]
fn analytic_a_link_rests_on_its_stop_where_the_spring_carries_it() {
    for stop in [0.2, 0.7] {
        let (simulation, _) = let_go(with_arm(stop), 0.002, 5.0);
        let angle = simulation.state().position[3];
        let pitch = simulation.signals().body.pitch;
        let beyond = 0.5 * 9.81 * 0.1 * (angle + pitch).cos() / LinkParameters::<f64>::default().stop_stiffness;
        assert!((angle + stop + beyond).abs() < AT_REST, "{stop} rad: at {angle}, expected {beyond} beyond");
    }
}

#[test]
fn property_what_a_stop_takes_is_counted() {
    // By then the link has fallen on its stop.
    let (simulation, start) = let_go(with_arm(0.3), BALANCE_STEP, 0.6);
    let body = &simulation.signals().body;
    let fallen = 0.5 * 9.81 * 0.1 * 0.3_f64.sin();
    assert!(body.other_loss > 0.5 * fallen, "the stop takes {} J of {fallen} J", body.other_loss);
    let left = body.drive_work - body.soil_loss - body.other_loss - (body.mechanical_energy - start);
    assert!(left.abs() < ENERGY_BALANCE * fallen, "{left} J of {fallen} J");
}

#[test]
fn property_within_its_stops_a_joint_is_free() {
    let near = |stop: f64| {
        let mut rover = Rover::rocker_bogie();
        rover.links[0].parameters.stop = stop;
        let mut simulation = Simulation::new(rover, 0.0, 0.002).expect("settles");
        simulation.advance(&Command::torque(vec![0.3; 3]), 1000).expect("steps");
        simulation.signals().clone()
    };
    let (free, stopped) = (near(std::f64::consts::PI), near(0.7));
    assert!(free.links[0].angle.abs() < 0.7 && free.body.x.abs() > 0.01, "{free:?}");
    assert_eq!(format!("{free:?}"), format!("{stopped:?}"));
}

#[test]
fn property_no_torque_turns_the_bogie_of_a_preset_through() {
    let plants: &[&str] =
        if cfg!(feature = "rigid") { &["joint_coordinates", "rigid_bodies"] } else { &["joint_coordinates"] };
    for plant in plants {
        for (preset, torques) in [
            ("rocker_bogie", [5.0, 5.0, 5.0]),
            ("rocker_bogie", [-3.0, 5.0, -3.0]),
            ("rocker_bogie", [0.0, -5.0, 5.0]),
            ("fsrl_ditch", [0.706, -0.706, 0.706]),
        ] {
            let text = format!("preset = '{preset}'\n[simulation]\nplant = '{plant}'\n[control]\nkind = 'torque'\n");
            let mut model = Model::from_toml(&text, None).expect("is a model");
            model.rover.body.belly_z = 0.2;
            let stop = model.rover.links[0].parameters.stop;
            let mut run = model.start().expect("settles");
            let mut most: f64 = 0.0;
            for _ in 0..1000 {
                run.inputs_mut().set_all(&torques).expect("three torques");
                if run.advance(1) != Ok(Status::Running) {
                    break;
                }
                most = most.max(run.signals().links[0].angle.abs());
            }
            assert!(most < stop + BENT, "{plant}, {preset} {torques:?}: {most} rad");
        }
    }
}
