//! Parameters that change between two steps.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod core_support;

use bekker::model::{Model as RoverModel, Plant, RunError};
use bekker::modeldescription::{Lookup, Parameters};
use bekker_fmu::Kind;
use bekker_fmu::model::FmuModel;
use bekker_modeldescription::xml::Variability;
use core_support::{bits, get, loaded, reference, set};

fn variability(model: &dyn FmuModel, name: &str) -> Variability {
    model.description().entries[reference(model, name)].variability
}

#[test]
fn property_a_parameter_that_stays_changes_nothing() {
    for preset in ["two_wheeled", "gentle_rtc", "rocker_bogie_velocity"] {
        let model = RoverModel::preset(preset).unwrap();
        let mut run = model.start().unwrap();
        run.advance(100).unwrap();
        let mut same = run.clone();
        same.retune(&model).unwrap();
        [&mut run, &mut same].into_iter().for_each(|run| assert!(run.advance(200).is_ok()));
        let values = |run: &bekker::model::Run| {
            let mut all = Vec::new();
            run.signals().values(&mut |value: f64| all.push(value.to_bits()));
            all
        };
        assert_eq!(values(&same), values(&run), "{preset}");
    }
}

#[test]
fn analytic_forces_follow_a_new_parameter_from_the_next_step_on() {
    let mut fmu = loaded(&RoverModel::preset("two_wheeled").unwrap(), Kind::Rover);
    set(&mut *fmu, "wheel[1].torque_command", 1.6);
    set(&mut *fmu, "wheel[2].torque_command", 1.6);
    fmu.start().unwrap();
    fmu.advance_to(0.5).unwrap();
    let mut dragged = fmu.duplicate();
    set(&mut *dragged, "drag.force", 5.0);
    let before = get(&*fmu, "velocity");
    fmu.advance_to(0.502).unwrap();
    dragged.advance_to(0.502).unwrap();
    // Drag is regularised about standstill (drag.rs); at this speed it acts in full on 10 kg, for one step of 2 ms. The
    // soil answers to the difference of speed within the step, by its slope over the mass: under a tenth.
    let lost = get(&*fmu, "velocity") - get(&*dragged, "velocity");
    assert!(before > 0.01);
    assert!((lost / (5.0 / 10.0 * 0.002) - 1.0).abs() < 0.3, "{lost}");
    // Further on the two part for good, and both are simulated on.
    fmu.advance_to(1.0).unwrap();
    dragged.advance_to(1.0).unwrap();
    assert_ne!(bits(&*fmu), bits(&*dragged));
}

#[test]
fn property_gains_of_a_controller_change_with_its_history_kept() {
    let model = RoverModel::preset("gentle_velocity").unwrap();
    let mut controller = loaded(&model, Kind::Controller);
    controller.start().unwrap();
    let period = controller.inner_step();
    controller.advance_to(10.0 * period).unwrap();
    let torque = |model: &dyn FmuModel| get(model, "wheel[1].torque_command");
    let wanted = 0.25 / 0.1;
    // Ten steps of the integral on an error that does not change, and the direct part.
    let integral = 10.0 * 20.0 * period * wanted;
    assert!((torque(&*controller) - (0.5 * wanted + integral)).abs() < 1e-12);
    set(&mut *controller, "velocity_control.kp", 0.1);
    set(&mut *controller, "velocity_control.ki", 0.0);
    controller.advance_to(11.0 * period).unwrap();
    assert!((torque(&*controller) - (0.1 * wanted + integral)).abs() < 1e-12, "the integral is kept");
}

#[test]
fn property_what_makes_the_vehicle_waits_for_a_start() {
    let model = RoverModel::preset("gentle_rtc").unwrap();
    let fmu = loaded(&model, Kind::RoverWithController);
    for name in ["soil.cohesion", "slip_sinkage.n1", "rtc.gain", "sensor.pitch_noise", "gravity", "motor.resistance"] {
        assert_eq!(variability(&*fmu, name), Variability::Tunable, "{name}");
    }
    for name in [
        "wheel.radius",
        "wheel[1].x",
        "rover.mass",
        "terrain.amplitude",
        "rtc.period",
        "sensor_lag.dead_time",
        "slip_sinkage.length",
    ] {
        assert_eq!(variability(&*fmu, name), Variability::Fixed, "{name}");
    }
    let mut other = model.clone();
    other.set("wheel.radius", 0.11).unwrap();
    let refused = model.start().unwrap().retune(&other);
    assert_eq!(refused, Err(RunError::NotTunable { name: "wheel.radius".to_owned() }));
    let mut outside = model.clone();
    outside.rover.soil.cohesion = -1.0;
    assert!(model.start().unwrap().retune(&outside).is_err());
    let mut rigid = model.clone();
    rigid.stepping.plant = Plant::RigidBodies;
    if rigid.start().is_ok() {
        let fmu = loaded(&rigid, Kind::RoverWithController);
        assert_eq!(variability(&*fmu, "soil.cohesion"), Variability::Fixed);
    }
}
