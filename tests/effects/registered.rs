//! Effects of other crates: registered, the library's own groups act as the library does, with the same derivatives.

use crate::support::{DRIVES, Drive, Settings, carriage, carriage_with, drive, drive_model, model, switched_on};
use bekker::diagnosis::{Rig, steady_point};
use bekker::effects::{
    Drag, Effects, FlexibleWheel, GearEfficiency, MultiPass, RadiusScale, Registrable, RimAdhesion, SensorLag, Tether,
    ViscousFriction, VoltageLimit, WindingHeat,
};
use bekker::model::Model;
use bekker::modeldescription::{Lookup, Parameters};
use bekker::motor::{self, Motor};
use bekker::rover::Rover;
use bekker::scalar::Dual;
use bekker::signals::Command;
use bekker::simulation::Simulation;

/// Real parts of numbers with and without derivatives differ by the rounding of a few elementary functions.
const ROUNDING: f64 = 1e-12;
/// Derivatives add up in another order, over 0.2 s of motion.
const DERIVATIVES: f64 = 1e-9;

/// Id under which a group of the library is registered.
const OWN: &str = "own";

/// Settings of an effect of the library, as those of the registered one.
fn renamed(id: &str, settings: &Settings) -> Settings {
    let own = |name: &String| format!("{OWN}{}", name.strip_prefix(id).unwrap());
    settings.iter().map(|(name, value)| (own(name), *value)).collect()
}

/// Fails where `G`, registered, does not act like the library's effect `id`, on a carriage and in all drives. The group gives
/// its type only.
fn assert_same<G: Registrable>(group: &G, id: &str) {
    assert_same_at(group, id, &switched_on(id));
}

/// The same with these parameters.
fn assert_same_at<G: Registrable>(_: &G, id: &str, on: &Settings) {
    let own = renamed(id, on);
    let mut rover = Rover::two_wheeled();
    rover.soil.shear_modulus = 0.01;
    rover.effects.register::<G>(OWN, "").unwrap();
    own.iter().for_each(|(name, value)| rover.set(name, *value).unwrap());
    let (library, registered) = (carriage(on).unwrap(), carriage_with(&Rig::of(&rover)).unwrap());
    assert_eq!(library.bits(), registered.bits(), "{id} on a carriage");
    for kind in DRIVES {
        let mut model = model(kind, &Settings::new());
        model.register_effect::<G>(OWN, "").unwrap();
        own.iter().for_each(|(name, value)| model.rover.set(name, *value).unwrap());
        let (library, registered) = (drive(kind, on).unwrap(), drive_model(kind, &model).unwrap());
        assert_eq!(library.bits(), registered.bits(), "{id}, {kind:?}");
    }
}

/// Calls [`assert_same`] on every group of the library. The pattern is exhaustive: without a line for each effect of the table
/// it does not compile.
macro_rules! assert_all_same {
    ($($id:ident,)*) => {
        let Effects { $($id,)* custom: _, registered: _ } = Effects::<f64>::default();
        $(assert_same(&$id, stringify!($id));)*
    };
}

#[test]
fn agreement_registered_groups_act_like_those_of_the_library_to_the_last_bit() {
    assert_all_same! {
        slip_sinkage,
        exit_angle,
        multi_pass,
        grousers,
        bulldozing,
        flexible_wheel,
        rate,
        moisture,
        soft_patch,
        slope_strength,
        coulomb_friction,
        viscous_friction,
        gear_efficiency,
        torque_scale,
        winding_heat,
        voltage_limit,
        radius_scale,
        payload,
        centre_of_mass,
        pitch_bias,
        drag,
        tether,
        sensor_lag,
        suspension_friction,
        rim_adhesion,
        rolling_resistance,
        tracking_delay,
    }
}

#[test]
fn agreement_a_registered_effect_may_keep_the_slip_to_which_the_ground_is_dug() {
    let on = [("slip_sinkage.n1", 0.4), ("slip_sinkage.length", 0.05)].map(|(name, value)| (name.to_owned(), value));
    assert_same_at(&Effects::<f64>::default().slip_sinkage, "slip_sinkage", &on.to_vec());
}

#[test]
fn property_neutral_registered_effects_change_nothing_bit_for_bit() {
    let none = Settings::new();
    for kind in DRIVES {
        let mut with = model(kind, &none);
        with.register_effect::<GearEfficiency>(OWN, "").unwrap();
        with.register_effect::<SensorLag>("lag", "").unwrap();
        with.register_effect::<FlexibleWheel>("tyre", "").unwrap();
        assert_eq!(drive_model(kind, &with).unwrap().bits(), drive(kind, &none).unwrap().bits(), "{kind:?}");
    }
}

/// All signals after 0.2 s with `N` derivatives in the first parameters of `names`.
fn with_derivatives<const N: usize>(rover: &Rover, names: &[&str]) -> Vec<Dual<N>> {
    let mut lifted = rover.map(&Dual::<N>::from);
    lifted.visit("", &mut |variable, place| {
        if let Some(k) = names.iter().position(|name| *name == variable.name) {
            *place = place.derivative(k);
        }
    });
    let mut simulation = Simulation::new(lifted, Dual::from(0.0), 0.002).unwrap();
    simulation.advance(&Command::torque(vec![1.4; rover.wheels.len()]), 100).unwrap();
    let mut signals = Vec::new();
    simulation.signals().values(&mut |value| signals.push(value));
    signals
}

/// Fails where the derivatives in `names` of two rovers differ.
fn assert_same_derivatives<const N: usize>([a, b]: [&Rover; 2], [names, others]: [&[&str]; 2]) {
    let (a, b) = (with_derivatives::<N>(a, names), with_derivatives::<N>(b, others));
    for (a, b) in a.iter().zip(&b) {
        assert!((a.re - b.re).abs() <= ROUNDING * (1.0 + a.re.abs()), "{} and {}", a.re, b.re);
        for k in 0..names.len() {
            let [a, b] = [a, b].map(|number| number.eps.0.map_or(0.0, |all| all[k]));
            assert!((a - b).abs() <= DERIVATIVES * (1.0 + a.abs()), "derivative {k}: {a} and {b}");
        }
    }
}

#[test]
fn agreement_derivatives_are_those_of_the_library_however_many_there_are() {
    let mut library = model(Drive::Torque, &Settings::new()).rover;
    let mut registered = library.clone();
    registered.effects.register::<RimAdhesion>("rim", "").unwrap();
    registered.effects.register::<ViscousFriction>("grease", "").unwrap();
    let values = [("rim_adhesion.loss", "rim.loss", 0.5), ("viscous_friction.coefficient", "grease.coefficient", 0.03)];
    for (name, own, value) in values {
        library.set(name, value).unwrap();
        registered.set(own, value).unwrap();
    }
    // More than a part holds, with the effects' parameters in the first part and in the second one.
    let others = [
        "gravity",
        "rover.mass",
        "rover.pitch_inertia",
        "wheel.radius",
        "wheel.width",
        "soil.cohesion",
        "soil.friction_angle",
        "soil.k_phi",
        "soil.exponent",
        "soil.shear_modulus",
        "soil.c1",
        "soil.c2",
    ];
    let names = |[first, last]: [&'static str; 2]| [&[first][..], &others, &[last]].concat();
    let [there, here] =
        [names(["rim_adhesion.loss", "viscous_friction.coefficient"]), names(["rim.loss", "grease.coefficient"])];
    assert_eq!(there.len(), 14);
    assert_same_derivatives::<14>([&library, &registered], [&there, &here]);
}

#[test]
fn agreement_derivatives_at_a_steady_point_are_those_of_the_library() {
    let rig = |change: &dyn Fn(&mut Rover)| {
        let mut rover = Rover::two_wheeled();
        rover.soil.shear_modulus = 0.01;
        change(&mut rover);
        Rig::of(&rover)
    };
    let library = rig(&|rover| rover.set("flexible_wheel.compliance", 1e-4).unwrap());
    let registered = rig(&|rover| {
        rover.effects.register::<FlexibleWheel>(OWN, "").unwrap();
        rover.set("own.compliance", 1e-4).unwrap();
    });
    let point = |rig: &Rig, seeded: &str| {
        let mut lifted = rig.map(&Dual::<1>::from);
        lifted.visit("", &mut |variable, place| {
            if variable.name == seeded {
                *place = place.derivative(0);
            }
        });
        let point = steady_point(&lifted, 30.0, 0.4, 1.0).unwrap();
        [point.drawbar_pull, point.torque, point.sinkage]
    };
    let [there, here] = [point(&library, "flexible_wheel.compliance"), point(&registered, "own.compliance")];
    for (a, b) in there.iter().zip(&here) {
        let [slope, own] = [a, b].map(|number| number.eps.0.map_or(0.0, |all| all[0]));
        assert!((a.re - b.re).abs() <= ROUNDING * a.re.abs(), "{} and {}", a.re, b.re);
        assert!(slope != 0.0 && (slope - own).abs() <= DERIVATIVES * slope.abs(), "{slope} and {own}");
    }
}

#[test]
fn property_parameters_stand_in_the_vocabulary_and_ids_are_refused() {
    let mut model = Model::preset("two_wheeled").unwrap();
    model.register_effect::<Drag>("cable", "A cable.").unwrap();
    model.register_effect::<Drag>("cable", "Once more changes nothing.").unwrap();
    assert_eq!(model.rover.effects.list().last().unwrap(), &("cable".to_owned(), "A cable.".to_owned()));
    let (variable, value) = model.list().into_iter().find(|(variable, _)| variable.name == "cable.force").unwrap();
    assert!(value == 0.0 && variable.max == 100.0 && model.is_tunable("cable.force"));
    assert!(model.set("cable.force", 101.0).is_err(), "out of its bounds");
    for (id, words) in [("drag", "library"), ("soil", "every model"), ("Cable", "no name"), ("cable", "another")] {
        let refused = model.register_effect::<Tether>(id, "").unwrap_err().to_string();
        assert!(refused.contains(words), "{id}: {refused}");
    }
    let own = "[[effect]]\nid = 'cable'\ntarget = 'body.force_x'\nexpression = '-k'\n\
               parameters.k = { neutral = 0.0, min = 0.0, max = 1.0 }\n";
    assert!(model.add_effects(own).unwrap_err().to_string().contains("registered"));
    assert_eq!(model.rover.effects.registered.iter().count(), 1);
}

#[test]
fn property_needs_memories_and_tuning_follow_from_the_facts() {
    let mut model = Model::preset("two_wheeled_speed").unwrap();
    model.register_effect::<VoltageLimit>("supply", "").unwrap();
    model.register_effect::<MultiPass>("ruts", "").unwrap();
    model.register_effect::<RadiusScale>("tyre", "").unwrap();
    let has = |model: &mut Model, name: &str| model.list().iter().any(|(variable, _)| variable.name == name);
    assert!(!has(&mut model, "supply.inverse_voltage"), "a wheel whose speed is imposed does not feel it");
    model.control.kind = bekker::model::ControlKind::Torque;
    assert!(has(&mut model, "supply.inverse_voltage") && !model.is_tunable("tyre.deviation"));
    assert_eq!(model.check_equations(), Ok(()));
    model.set("ruts.growth", 0.2).unwrap();
    let refused = model.check_equations().unwrap_err().to_string();
    assert!(refused.contains("the effect ruts") && refused.contains("ruts.growth = 0"), "{refused}");
}

#[test]
fn property_clones_saved_states_and_files_keep_registered_effects() {
    let register = |model: &mut Model| {
        model.register_effect::<WindingHeat>("heat", "")?;
        model.register_effect::<SensorLag>("lag", "")
    };
    let mut model = Model::preset("rocker_bogie_velocity").unwrap();
    register(&mut model).unwrap();
    for (name, value) in [("heat.thermal_resistance", 10.0), ("lag.dead_time", 0.033), ("lag.time_constant", 0.05)] {
        model.set(name, value).unwrap();
    }
    let mut run = model.start().unwrap();
    run.advance(300).unwrap();
    let bytes = run.snapshot().unwrap();
    let (mut copy, mut other) = (run.clone(), model.start().unwrap());
    other.restore(&bytes).unwrap();
    for run in [&mut run, &mut copy, &mut other] {
        run.advance(300).unwrap();
    }
    assert_eq!(run.signals(), copy.signals());
    assert_eq!(run.signals(), other.signals());
    let text = model.to_toml().unwrap();
    assert!(Model::from_toml(&text, None).unwrap_err().to_string().contains("heat."), "nobody has registered it");
    let mut read = Model::from_toml_with(&text, None, register).unwrap();
    assert_eq!(read.list(), model.list());
    let mut again = read.start().unwrap();
    again.advance(600).unwrap();
    assert_eq!(again.signals(), run.signals());
}

#[test]
fn analytic_of_two_limits_the_tighter_one_holds_whichever_is_asked_first() {
    let supplies = |library: f64, registered: f64| {
        let mut model = model(Drive::Torque, &Settings::new());
        model.register_effect::<VoltageLimit>("supply", "").unwrap();
        model.set("voltage_limit.inverse_voltage", library).unwrap();
        model.set("supply.inverse_voltage", registered).unwrap();
        drive_model(Drive::Torque, &model).unwrap().bits()
    };
    let tight = supplies(0.15, 0.0);
    assert_ne!(tight, supplies(0.05, 0.0), "the tighter limit binds");
    assert_eq!(tight, supplies(0.15, 0.05));
    assert_eq!(tight, supplies(0.05, 0.15));
}

#[test]
fn analytic_gears_in_series_are_inverted_from_the_last_one_on() {
    let mut effects = Effects::default();
    effects.gear_efficiency.eta = 0.8;
    effects.register::<GearEfficiency>("second", "").unwrap();
    effects.set("second.eta", 0.9).unwrap();
    let motor = Motor::default();
    for (speed, torque) in [(2.0, 1.0), (2.0, -1.0), (-0.02, 0.5), (0.0, 0.3)] {
        let driven = motor::drive(&motor, &motor, &effects, speed, torque).unwrap();
        let back = motor::torque_behind(&effects, speed, driven.rim_torque).unwrap();
        assert!((back - torque).abs() < ROUNDING, "{back} of {torque}");
        let h = 1e-6;
        let at = |speed: f64| motor::drive(&motor, &motor, &effects, speed, torque).unwrap().rim_torque;
        let difference = (at(speed + h) - at(speed - h)) / (2.0 * h);
        assert!((driven.slope - difference).abs() < 1e-6 * (1.0 + difference.abs()), "{} {difference}", driven.slope);
    }
    // Far from standstill a share of each is left.
    let driven = motor::drive(&motor, &motor, &effects, 50.0, 10.0).unwrap();
    assert!((driven.rim_torque - 10.0 * 0.8 * 0.9).abs() < 1e-3, "{}", driven.rim_torque);
}
