//! Claim: once started, a simulation and a run with commands from outside allocate nothing, with effects of the user's
//! own too.

#[path = "support/counting.rs"]
mod counting;

use bekker::model::Model;
use bekker::modeldescription::Lookup;
use bekker::simulation::Status;

/// One effect of the user's own at each hook.
const EFFECTS: [(&str, &str); 4] = [
    ("body.force_x", "-a * max(travelled, 0) * tanh(velocity / 0.01)"),
    ("drive.friction", "a * tanh(speed / 0.01)"),
    ("contact.drawbar_pull", "-a * normal_force * abs(slip) ^ 1.5"),
    ("soil.cohesion", "1 - a * exp(-x ^ 2) * sin(contact_angle)"),
];

fn model(preset: &str) -> Model {
    let mut model = Model::preset(preset).expect("a preset");
    let mut text = String::new();
    for (k, (target, expression)) in EFFECTS.iter().enumerate() {
        text += &format!("[[effect]]\nid = 'own{k}'\ntarget = '{target}'\nexpression = '{expression}'\n");
        text += if target.starts_with("soil") { "mode = 'factor'\n" } else { "" };
        text += "parameters.a = { neutral = 0, min = 0, max = 1 }\n";
    }
    model.add_effects(&text).expect("effects");
    (0..EFFECTS.len()).for_each(|k| model.set(&format!("own{k}.a"), 0.01).expect("a parameter"));
    model
}

#[test]
fn property_steps_allocate_nothing() {
    for preset in ["two_wheeled", "two_wheeled_speed", "rocker_bogie", "gentle_velocity", "rocker_bogie_velocity"] {
        let mut model = model(preset);
        // Effects with a memory.
        model.rover.effects.sensor_lag.time_constant = 0.005;
        model.rover.effects.sensor_lag.dead_time = 0.003;
        model.rover.effects.winding_heat.thermal_resistance = 10.0;
        let mut run = model.start().expect("starts");
        let inputs = run.inputs().clone();
        let mut values = Vec::new();
        bekker::modeldescription::Parameters::values(&inputs, &mut |value| values.push(value));
        run.advance(20).expect("advances");
        let mut status = Status::Running;
        let count = counting::allocations(|| {
            for k in 0..50 {
                // Small changes, so that every call is a new command.
                let command = 0.1 + 1e-4 * f64::from(k);
                values.iter_mut().for_each(|value| *value = command);
                run.inputs_mut().set_all(&values).expect("in range");
                status = run.advance(10).expect("advances");
            }
        });
        assert_eq!(status, Status::Running, "{preset}");
        assert_eq!(count, 0, "{preset}: allocations in 500 steps");
    }
}
