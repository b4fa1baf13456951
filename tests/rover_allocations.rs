//! Claim: once started, a simulation and a run with commands from outside allocate nothing.

#[path = "support/counting.rs"]
mod counting;

use bekker::model::Model;
use bekker::simulation::Status;

#[test]
fn property_steps_allocate_nothing() {
    for preset in ["two_wheeled", "two_wheeled_speed", "rocker_bogie", "gentle_velocity", "rocker_bogie_velocity"] {
        let mut model = Model::preset(preset).expect("a preset");
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
