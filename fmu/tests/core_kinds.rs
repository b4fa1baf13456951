//! A rover and its controller as two models, wired by hand, are the closed loop of both.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod core_support;

use bekker::model::Model as RoverModel;
use bekker::modeldescription::Lookup;
use bekker_fmu::Kind;
use bekker_fmu::model::FmuModel;
use bekker_modeldescription::xml::Causality;
use core_support::{all, get, loaded, reference, set};

/// Control periods that are compared.
const PERIODS: u32 = 150;

fn model(preset: &str, words: &str, parameters: &[(&str, f64)]) -> RoverModel {
    let mut model = RoverModel::from_toml(&format!("preset = \"{preset}\"\n{words}"), None).unwrap();
    for (name, value) in parameters {
        model.set(name, *value).unwrap();
    }
    model
}

/// Wires what is measured of the rover to the controller, and its torques back.
struct Wires {
    measurements: Vec<(usize, usize)>,
    torques: Vec<(usize, usize)>,
}

impl Wires {
    fn new(rover: &dyn FmuModel, controller: &dyn FmuModel, prefix: &str) -> Self {
        let name =
            |model: &dyn FmuModel, reference: usize| model.description().entries[reference].variable.name.clone();
        let inputs = all(controller, Causality::Input).into_iter();
        let inputs = inputs.filter(|&input| name(controller, input) != "velocity_command");
        let measurements =
            inputs.map(|input| (reference(rover, &format!("{prefix}{}", name(controller, input))), input)).collect();
        let outputs = all(controller, Causality::Output).into_iter();
        let torques = outputs.map(|output| (output, reference(rover, &name(controller, output)))).collect();
        Self { measurements, torques }
    }
}

fn carry(wires: &[(usize, usize)], from: &dyn FmuModel, to: &mut dyn FmuModel) {
    for (source, sink) in wires {
        to.set(*sink, from.get(*source));
    }
}

/// Drives both ways and compares every signal at every control period.
fn agree(model: &RoverModel, prefix: &str) {
    let mut whole = loaded(model, Kind::RoverWithController);
    let (mut rover, mut controller) = (loaded(model, Kind::Rover), loaded(model, Kind::Controller));
    [&mut whole, &mut rover, &mut controller].into_iter().for_each(|model| model.start().unwrap());
    let wires = Wires::new(&*rover, &*controller, prefix);
    let period = controller.inner_step();
    let shared: Vec<(usize, usize)> = all(&*whole, Causality::Output)
        .into_iter()
        .map(|output| (output, reference(&*rover, &whole.description().entries[output].variable.name)))
        .collect();
    let start = get(&*whole, "x");
    for k in 1..=PERIODS {
        let (time, goal) = (f64::from(k) * period, 0.2 + 0.1 * f64::from(k / 40));
        set(&mut *whole, "velocity_command", goal);
        whole.advance_to(time).unwrap();
        set(&mut *controller, "velocity_command", goal);
        carry(&wires.measurements, &*rover, &mut *controller);
        controller.advance_to(time).unwrap();
        carry(&wires.torques, &*controller, &mut *rover);
        rover.advance_to(time).unwrap();
        for (one, other) in &shared {
            let name = &whole.description().entries[*one].variable.name;
            let (one, other) = (whole.get(*one), rover.get(*other));
            assert_eq!(one.to_bits(), other.to_bits(), "{}, {name} after {k} periods: {one}, {other}", model.name);
        }
    }
    assert!((get(&*whole, "x") - start).abs() > 0.05, "the rover has moved");
}

#[test]
fn agreement_two_models_are_the_closed_loop_to_the_last_bit() {
    agree(&model("gentle_rtc", "", &[]), "");
    agree(&model("gentle_velocity", "", &[]), "");
    agree(&model("rocker_bogie_velocity", "[control]\nkind = \"rtc\"\n", &[("rtc.minimum_load", 0.2)]), "");
    agree(&model("gentle_velocity", "[control]\nkind = \"velocity_tuned\"\n", &[]), "");
}

#[test]
fn agreement_also_with_the_errors_of_sensors_and_with_estimators() {
    let noise = [
        ("sensor.pitch_noise", 0.01),
        ("sensor.velocity_bias", 0.01),
        ("sensor.velocity_period", 0.03),
        ("sensor.wheel_speed_noise", 0.05),
        ("sensor.wheel_speed_resolution", 0.02),
        ("sensor.contact_angle_noise", 0.02),
        ("rtc.speed_kp", 0.2),
        ("rtc.speed_ki", 1.0),
    ];
    agree(&model("gentle_rtc", "", &noise), "measured.");
    let words = "[control]\nkind = \"rtc\"\ncontact_angles = \"estimator\"\nsoil = \"estimator\"\n";
    let further = [&noise[..], &[("sensor.pitch_rate_noise", 0.005), ("sensor.torque_noise", 0.02)]].concat();
    agree(&model("gentle_rtc", words, &further), "measured.");
    agree(
        &model("gentle_rtc_speed", "[control]\ncontact_angles = \"estimator\"\nsoil = \"map\"\n", &noise[..6]),
        "measured.",
    );
}

#[test]
fn property_modes_choose_the_controller() {
    let model = model("challenging_rtc", "", &[]);
    let torques = |mode: f64, angles: [f64; 2]| {
        let mut controller = loaded(&model, Kind::Controller);
        set(&mut *controller, "mode", mode);
        controller.start().unwrap();
        set(&mut *controller, "velocity", 0.2);
        set(&mut *controller, "wheel[1].speed", 2.0);
        set(&mut *controller, "wheel[2].speed", 2.2);
        set(&mut *controller, "wheel[1].contact_angle", angles[0]);
        set(&mut *controller, "wheel[2].contact_angle", angles[1]);
        controller.advance_to(controller.inner_step()).unwrap();
        [1, 2].map(|k| get(&*controller, &format!("wheel[{k}].torque_command")))
    };
    let [velocity, traction, power, dual] = [0.0, 1.0, 2.0, 3.0];
    let (gentle, steep) = ([0.02, -0.05], [0.1, 0.4]);
    assert_eq!(torques(dual, gentle), torques(power, gentle));
    assert_eq!(torques(dual, steep), torques(traction, steep));
    assert_ne!(torques(power, steep), torques(traction, steep));
    assert_ne!(torques(velocity, steep), torques(power, steep));
    let wheel_speeds = 4.0;
    assert_ne!(torques(wheel_speeds, steep), torques(velocity, steep));
    // The usual mode of a model under rough-terrain control.
    assert_eq!(get(&*loaded(&model, Kind::Controller), "mode"), dual);
}

#[test]
fn property_a_controller_holds_its_torques_between_decisions() {
    let model = model("gentle_velocity", "", &[]);
    let mut controller = loaded(&model, Kind::Controller);
    controller.start().unwrap();
    let period = controller.inner_step();
    let torque = |controller: &dyn FmuModel| get(controller, "wheel[1].torque_command");
    assert_eq!(torque(&*controller), 0.0);
    controller.advance_to(0.3 * period).unwrap();
    let first = torque(&*controller);
    assert!(first > 0.0);
    set(&mut *controller, "wheel[1].speed", 5.0);
    controller.advance_to(period).unwrap();
    assert_eq!(torque(&*controller), first);
    controller.advance_to(1.1 * period).unwrap();
    assert!(torque(&*controller) < 0.0);
    assert!((controller.elapsed() - 1.1 * period).abs() < 1e-15);
    assert!(controller.advance_to(0.5 * period).is_err());
}

#[test]
fn property_each_kind_lists_what_it_reads_and_no_more() {
    let model = model("rocker_bogie_velocity", "", &[]);
    let names = |kind| -> Vec<String> {
        let model = loaded(&model, kind);
        model.description().entries.iter().map(|entry| entry.variable.name.clone()).collect()
    };
    let (controller, rover) = (names(Kind::Controller), names(Kind::Rover));
    let has = |list: &[String], name: &str| list.iter().any(|other| other == name);
    for name in ["mode", "soil.cohesion", "rtc.gain", "velocity_control.kp", "link[1].angle", "velocity_command"] {
        assert!(has(&controller, name), "{name}");
    }
    for name in ["terrain.amplitude", "slip_sinkage.n1", "sensor.pitch_noise", "x0", "rover.pitch_inertia"] {
        assert!(!has(&controller, name), "{name}");
    }
    for name in ["terrain.amplitude", "slip_sinkage.n1", "sensor.pitch_noise", "x0", "measured.link[1].rate", "event"] {
        assert!(has(&rover, name), "{name}");
    }
    for name in ["velocity_command", "velocity_control.kp", "mode"] {
        assert!(!has(&rover, name), "{name}");
    }
    assert!(bekker_fmu::Offer::of("[fmu]\nkind = \"boat\"").is_err());
    assert!(bekker_fmu::Offer::of("[fmu]\nkid = \"rover\"").is_err());
    let slip = RoverModel::from_toml("preset = \"gentle_velocity\"\n[control]\nkind = \"slip\"", None).unwrap();
    // Its controller needs the truth, and another one would be no controller of this model.
    for model in [slip, RoverModel::preset("two_wheeled").unwrap(), RoverModel::preset("two_wheeled_speed").unwrap()] {
        let refused = bekker_fmu::describe_as(&model, Kind::Controller).unwrap_err();
        assert!(refused.contains(&model.name) && refused.contains("expected velocity"), "{refused}");
    }
}

#[test]
fn property_the_seed_draws_other_noise_and_the_event_has_a_number() {
    let model = model("gentle_velocity", "", &[]);
    let pitch = |seed: f64| {
        let mut rover = loaded(&model, Kind::Rover);
        set(&mut *rover, "sensor.pitch_noise", 0.01);
        set(&mut *rover, "simulation.seed", seed);
        rover.start().unwrap();
        rover.advance_to(0.1).unwrap();
        assert_eq!((get(&*rover, "event"), get(&*rover, "event_code")), (0.0, 0.0));
        get(&*rover, "measured.pitch")
    };
    assert_eq!(pitch(7.0), pitch(7.0));
    assert_ne!(pitch(7.0), pitch(8.0));
    // The seed of the model file is the one that it starts with.
    let mut seeded = model.clone();
    seeded.stepping.seed = 8;
    assert_eq!(get(&*loaded(&seeded, Kind::Rover), "simulation.seed"), 8.0);
    seeded.stepping.seed = u32::MAX;
    assert!(bekker_fmu::describe_as(&seeded, Kind::Rover).unwrap_err().contains("simulation.seed"));
}

#[test]
fn property_moduli_have_base_units_where_the_exponent_is_whole() {
    let exponents = |n: f64| {
        let model = model("two_wheeled", "", &[("soil.exponent", n)]);
        let description = loaded(&model, Kind::Rover).description().clone();
        ["soil.k_c", "soil.k_phi"]
            .map(|name| description.find(name).unwrap().variable.unit.exponents.map(|e| (e.kg, e.m, e.s)))
    };
    // k_c is a pressure at n = 1, k_phi a pressure a metre.
    assert_eq!(exponents(1.0), [Some((1, -1, -2)), Some((1, -2, -2))]);
    assert_eq!(exponents(0.8), [None, None]);
}
