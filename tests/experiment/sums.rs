//! One current recorded for two wheels: the model's value is the sum over them, and a fit can use it.

use bekker::diagnosis::{CompareOptions, compare};
use bekker::measurement::Experiment;
use bekker::model::Model;

/// Time between rows, s, and rows of the drive.
const PERIOD: f64 = 0.05;
const ROWS: usize = 60;

/// Two simulated currents, added in mA and divided again by 1000, differ from the sum in A by rounding, A.
const ROUNDING: f64 = 1e-12;

#[test]
fn agreement_a_recorded_sum_is_the_sum_of_the_model() {
    let model = Model::preset("two_wheeled_speed").unwrap();
    let mut run = model.start().unwrap();
    let steps = (PERIOD / run.step_size()).round() as u64;
    let mut csv = "t [ms];command;I [mA]\n".to_owned();
    for row in 0..ROWS {
        let current: f64 = run.signals().wheels.iter().map(|wheel| wheel.current).sum();
        let command = 2.0 + (row as f64 * 0.3).sin();
        csv += &format!("{};{command:?};{:?}\n", 50 * row, 1e3 * current);
        run.inputs_mut().set_all(&[command, command]).unwrap();
        run.advance(steps).unwrap();
    }
    let toml = r#"name = "one driver for two motors"
kind = "traverse"
[columns]
"t [ms]" = { signal = "time", unit = "ms" }
command = { signal = "speed_command", wheels = [1, 2] }
"I [mA]" = { signal = "current", wheels = [1, 2], unit = "mA" }
[[run]]
file = "drive.csv"
"#;
    let texts = [("experiment.toml", toml), ("drive.csv", &csv)].map(|(name, text)| (name.to_owned(), text.to_owned()));
    let experiment = Experiment::from_texts(&texts.into()).unwrap();
    assert_eq!(experiment.signals(), ["wheel[1+2].current"]);
    let comparison = compare(&model, &experiment, &CompareOptions::default()).unwrap();
    let rmse = comparison.fit().rmse["wheel[1+2].current"];
    assert!(rmse < ROUNDING, "{rmse} A");
    let measured = &comparison.fit().runs[0].signal("wheel[1+2].current").unwrap().measured;
    assert!(measured.iter().any(|current| *current > 0.1), "the motors draw a current: {measured:?}");
}
