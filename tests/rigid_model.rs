//! Models that choose the plant of rigid bodies: files, names, errors, runs.

#![cfg(feature = "rigid")]
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker::model::{Model, Plant};
use bekker::modeldescription::Lookup;
use bekker::obstacle::{Obstacle, ObstacleKind};
use bekker::simulation::{Event, Status};

const ROCKY: &str = r#"
preset = "rocker_bogie_velocity"
[terrain]
preset = "flat"
[simulation]
plant = "rigid_bodies"
[[obstacle]]
kind = "rock"
x = 0.5
height = 0.04
width = 0.2
friction = 0.8
[[obstacle]]
kind = "ledge"
x = 1.0
height = 0.02
"#;

#[test]
fn property_a_model_with_obstacles_reads_back_to_the_last_bit() {
    let mut model = Model::from_toml(ROCKY, None).unwrap();
    assert_eq!(model.stepping.plant, Plant::RigidBodies);
    assert_eq!(model.obstacles.len(), 2);
    assert_eq!(model.obstacles[1].kind, ObstacleKind::Ledge);
    model.set("obstacle[1].friction", 0.123_456_789).unwrap();
    model.set("rover.belly_friction", 0.31).unwrap();
    let back = Model::from_toml(&model.to_toml().unwrap(), None).unwrap();
    assert_eq!(back.obstacles, model.obstacles);
    assert_eq!(back.clone().list(), model.clone().list());
    assert_eq!(back.stepping, model.stepping);
}

#[test]
fn property_a_run_drives_over_obstacles_under_a_controller() {
    let mut run = Model::from_toml(ROCKY, None).unwrap().start().unwrap();
    run.inputs_mut().set("velocity_command", 0.1).unwrap();
    let mut copy = run.clone();
    assert_eq!(run.advance(4_000), Ok(Status::Running));
    assert!(run.signals().body.x > 0.5, "x = {}", run.signals().body.x);
    assert!(run.measurement().wheels.len() == 3 && run.time() > 7.9);
    copy.advance(4_000).unwrap();
    assert_eq!(run.signals(), copy.signals());
}

#[test]
fn property_without_obstacles_only_the_order_of_the_step_differs() {
    let mut model = Model::preset("gentle_velocity").unwrap();
    let way = |model: &Model| {
        let mut run = model.start().unwrap();
        run.advance(2_000).unwrap();
        run.signals().body.x
    };
    let joints = way(&model);
    model.stepping.plant = Plant::RigidBodies;
    let bodies = way(&model);
    // As without a loop, see `rigid_agreement.rs`.
    assert!((joints - bodies).abs() < 1e-3 * joints, "{bodies} m, expected {joints} m");
    assert_ne!(joints, bodies, "they are two plants");
}

#[test]
fn property_a_rover_held_by_a_wall_is_an_event_of_the_run() {
    let mut model = Model::preset("two_wheeled_speed").unwrap();
    model.rover.soil.shear_modulus = 0.01;
    model.stepping.plant = Plant::RigidBodies;
    model.obstacles.push(Obstacle::block(0.8, 0.5, 0.2));
    let mut run = model.start().unwrap();
    run.inputs_mut().set_all(&[2.5, 2.5]).unwrap();
    assert_eq!(run.advance(10_000), Ok(Status::Ended(Event::Stuck)));
}

#[test]
fn property_errors_say_what_was_expected() {
    let refused = |text: &str| Model::from_toml(text, None).expect_err("refused").to_string();
    let joints = refused(&ROCKY.replace("rigid_bodies", "joint_coordinates"));
    assert!(joints.contains("2 [[obstacle]]") && joints.contains("rigid_bodies"), "{joints}");
    let low = refused(&ROCKY.replace("height = 0.04", "height = -0.04"));
    assert!(low.contains("obstacle[1].height") && low.contains("0.001"), "{low}");
    let kind = refused(&ROCKY.replace("\"rock\"", "\"boulder\""));
    assert!(kind.contains("boulder") && kind.contains("ledge"), "{kind}");
    let key = refused(&ROCKY.replace("friction = 0.8", "grip = 0.8"));
    assert!(key.contains("grip"), "{key}");
    let plant = refused(&ROCKY.replace("rigid_bodies", "rigid"));
    assert!(plant.contains("joint_coordinates"), "{plant}");
    let mut model = Model::preset("two_wheeled").unwrap();
    model.obstacles.push(Obstacle::rock(1.0, 0.05, 0.2));
    let error = model.start().expect_err("soil only").to_string();
    assert!(error.contains("1 obstacles") && error.contains("simulation.plant = \"rigid_bodies\""), "{error}");
    let wide = Model::from_toml(&ROCKY.replace("x = 0.5", "x = 0.2"), None).unwrap().start().expect_err("overlaps");
    assert!(wide.to_string().contains("obstacle 1 at x = 0.2 m"), "{wide}");
}

#[test]
fn property_only_this_plant_has_obstacles_among_its_names() {
    let mut model = Model::from_toml(ROCKY, None).unwrap();
    let names = |model: &mut Model| model.list().into_iter().map(|(variable, _)| variable.name).collect::<Vec<_>>();
    assert!(names(&mut model).contains(&"obstacle[2].width".to_owned()));
    model.stepping.plant = Plant::JointCoordinates;
    assert!(!names(&mut model).iter().any(|name| name.starts_with("obstacle") || name == "rover.belly_friction"));
}
