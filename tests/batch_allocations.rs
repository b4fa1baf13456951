//! Claim: a batch whose runs go on allocates nothing in a step, side by side as well as one by one, with controllers too.

#[path = "support/counting.rs"]
mod counting;

use bekker::batch::{Batch, Kernel};
use bekker::model::{Model, Run};
use bekker::simulation::Status;

#[test]
fn property_steps_of_a_batch_allocate_nothing() {
    for kernel in [Kernel::Single, Kernel::Portable, Kernel::best()] {
        for (preset, input) in [("two_wheeled", 1.0), ("rocker_bogie_speed", 1.0), ("gentle_velocity", 0.1)] {
            let mut model = Model::preset(preset).expect("a preset");
            // An effect with a memory, which runs side by side have too.
            model.rover.effects.winding_heat.thermal_resistance = 10.0;
            let runs: Vec<Run> = (0..13).map(|_| model.start().expect("starts")).collect();
            let mut batch = Batch::on(runs, 1, kernel).expect("a batch");
            let mut inputs = vec![input; batch.len() * batch.input_count()];
            let mut out = vec![0.0; batch.len() * batch.signal_count()];
            batch.step(&inputs, 10, None).expect("steps");
            let count = counting::allocations(|| {
                for _ in 0..10 {
                    // Every call is a new command.
                    inputs.iter_mut().for_each(|value| *value += 1e-4);
                    batch.step(&inputs, 10, None).expect("steps");
                    batch.signals(&mut out);
                }
            });
            assert!(batch.statuses().iter().all(|status| *status == Status::Running), "{preset}");
            assert_eq!(count, 0, "{preset}, {kernel:?}: allocations in 100 steps");
        }
    }
}
