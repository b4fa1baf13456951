//! The right-hand side differentiated exactly, against differences.

#[path = "effects_support/mod.rs"]
mod support;

use bekker::effects::Effects;
use bekker::modeldescription::{Lookup, Parameters};
use bekker::rover::{Rover, State, Track};
use bekker::scalar::{Dual, Scalar};
use bekker::signals::Command;
use bekker::terrain::{Profile, Terrain, Waves};

/// Central differences of smooth functions in double precision are good to about the square of the step's
/// cube root; relative to the largest derivative of the same parameter.
const DIFFERENCES: f64 = 2e-5;

fn moving(rover: &Rover) -> State {
    let mut state = rover.settled_at(0.9).expect("settles");
    state.rate[0] = 0.1;
    state.rate[2] = 0.05;
    state.rate[3] = -0.02;
    for (k, wheel) in state.wheels.iter_mut().enumerate() {
        wheel.spin = 2.4 + 0.1 * k as f64;
        wheel.hold.travel = 0.6;
        wheel.hold.turn = 0.75;
        wheel.winding_rise = 20.0;
        wheel.dug_slip = 0.3;
    }
    // The front wheel's track ends within the middle wheel's contact.
    state.wheels[2].track = Track { low: 0.86, high: 1.1 };
    state
}

/// Effects of soil and wheel, all of whose parameters act on the accelerations here.
const SWITCHED_ON: [&str; 12] = [
    "slip_sinkage",
    "exit_angle",
    "multi_pass",
    "grousers",
    "bulldozing",
    "flexible_wheel",
    "rate",
    "moisture",
    "soft_patch",
    "slope_strength",
    "rim_adhesion",
    "rolling_resistance",
];

/// Effects at values at which each acts, away from their bounds: typical ones, and others where those do not act here.
fn switch_on(effects: &mut Effects) {
    let typical = SWITCHED_ON.iter().flat_map(|id| support::switched_on(id));
    typical.for_each(|(name, value)| effects.set(&name, value).expect("a parameter"));
    effects.slip_sinkage.n1 = 0.3;
    effects.slip_sinkage.growth = 0.2;
    effects.slip_sinkage.carried = 0.001;
    effects.exit_angle.lambda = 0.2;
    effects.multi_pass.growth = 0.3;
    effects.grousers.height = 0.006;
    effects.grousers.share = 0.8;
    effects.bulldozing.share = 0.8;
    effects.flexible_wheel.compliance = 5e-5;
    effects.flexible_wheel.arm_share = 0.5;
    effects.flexible_wheel.arc_by_sinkage = 0.7;
    effects.flexible_wheel.arc_by_load = 4.0;
    effects.rate.exponent = 0.1;
    effects.moisture.content = 0.1;
    effects.moisture.cohesion_slope = 5000.0;
    effects.soft_patch.softening = 0.3;
    effects.soft_patch.centre = 1.05;
    effects.soft_patch.half_width = 0.25;
    effects.slope_strength.beta = 0.1;
    effects.rim_adhesion.loss = 0.6;
    effects.rolling_resistance.coefficient = 0.05;
    effects.rolling_resistance.growth = 0.04;
    effects.coulomb_friction.torque = 0.05;
    effects.viscous_friction.coefficient = 0.02;
    effects.drag.force = 1.0;
}

fn accelerations<S: Scalar>(rover: &Rover<S>, state: &State<S>, command: &Command) -> Vec<S> {
    let rate = rover.rate_of_change(state, command).expect("finite");
    let spins = rate.wheels.iter().map(|(spin, _)| *spin);
    rate.rate.iter().copied().chain(spins).collect()
}

#[test]
fn property_derivatives_in_every_parameter_agree_with_differences() {
    let mut rover = Rover::rocker_bogie();
    rover.terrain = Terrain::new(Profile::Waves(Waves { amplitude: 0.02, wavelength: 1.3, start: -3.0 }));
    switch_on(&mut rover.effects);
    rover.effects.gear_efficiency.eta = 0.8;
    rover.effects.torque_scale.deviation = 0.05;
    rover.effects.radius_scale.deviation = 0.02;
    rover.effects.payload.mass = 0.4;
    rover.effects.centre_of_mass.shift = 0.01;
    rover.effects.suspension_friction.moment = 0.2;
    // On warm windings, so that the supply's limit and the torque constant feel the heat.
    rover.effects.winding_heat.thermal_resistance = 10.0;
    // Limits that do not bind here; at 0 (no limit) a difference would ask for a negative one.
    rover.motor.inverse_torque_limit = 0.05;
    rover.motor.inverse_current_limit = 0.05;
    rover.effects.voltage_limit.inverse_voltage = 0.02;
    for length in [0.05, 0.0] {
        rover.effects.slip_sinkage.length = length;
        check(&rover);
    }
}

/// Fails where an exact derivative in a parameter of the rover differs from the differences.
fn check(rover: &Rover) {
    let state = moving(rover);
    let command = Command::torque(vec![0.3, 0.2, 0.25]);
    let names: Vec<(String, f64)> =
        rover.clone().list().into_iter().map(|(variable, value)| (variable.name, value)).collect();
    let dual_state = state.map(&Dual::<1>::from);
    let mut felt = 0;
    // The law at once is no limit of small lengths at one instant.
    for (name, value) in names.into_iter().filter(|(name, value)| name != "slip_sinkage.length" || *value > 0.0) {
        let mut dual: Rover<Dual<1>> = rover.map(&Dual::<1>::from);
        dual.visit("", &mut |variable, place| {
            if variable.name == name {
                *place = place.derivative(0);
            }
        });
        let exact: Vec<f64> =
            accelerations(&dual, &dual_state, &command).iter().map(|a| a.eps.0.map_or(0.0, |eps| eps[0])).collect();
        let step = 1e-6 * value.abs().max(1e-3);
        let at = |value: f64| {
            let mut changed = rover.clone();
            changed.visit("", &mut |variable, place| {
                if variable.name == name {
                    *place = value;
                }
            });
            accelerations(&changed, &state, &command)
        };
        let (above, below) = (at(value + step), at(value - step));
        let scale = exact.iter().fold(0.0_f64, |m, d| m.max(d.abs()));
        for ((exact, above), below) in exact.iter().zip(&above).zip(&below) {
            let difference = (above - below) / (2.0 * step);
            // Rounding of the accelerations (to 1e-13 of 10 m/s^2) over the step.
            let rounding = 1e-12 / step;
            assert!((exact - difference).abs() < DIFFERENCES * scale + rounding, "{name}: {exact} and {difference}");
        }
        felt += usize::from(scale > 0.0);
        // How soon the ground follows the slip is no matter of one instant.
        let acts = SWITCHED_ON.contains(&name.split('.').next().unwrap_or_default()) && name != "slip_sinkage.length";
        assert!(scale > 0.0 || !acts, "{name} acts");
    }
    assert!(felt > 25, "{felt} parameters act on the accelerations here");
}
