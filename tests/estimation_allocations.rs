//! Claim: an update of the contact angles, and a reading of the sensors, allocate nothing.

#[path = "support/counting.rs"]
mod counting;

use bekker::estimation::{ContactAngleEstimation, ContactAngles};
use bekker::model::{Model, nominal};
use bekker::modeldescription::Lookup;
use bekker::sensors::{SensorSuite, Sensors};
use bekker::signals::Measurement;

#[test]
fn property_updates_allocate_nothing() {
    for preset in ["gentle_velocity", "rocker_bogie_velocity"] {
        let model = Model::preset(preset).expect("a preset");
        let mut sensors = Sensors::default();
        sensors.set("pitch_noise", 0.01).expect("a parameter");
        let mut suite = SensorSuite::new(sensors, 1);
        let mut estimator = ContactAngles::new(&nominal(&model.rover), ContactAngleEstimation::default())
            .expect("every wheel has a pair");
        let run = model.start().expect("starts");
        let mut measured = Measurement::default();
        suite.read(0.0, run.signals(), &mut measured);
        let count = counting::allocations(|| {
            for k in 0..100 {
                suite.read(f64::from(k) * 0.01, run.signals(), &mut measured);
                estimator.update(&measured).expect("finite readings");
            }
        });
        assert_eq!(count, 0, "{preset}");
    }
}
