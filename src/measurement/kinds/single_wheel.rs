//! Files of a wheel on a carriage: one steady point a row.

use super::super::columns::{Column, Limits, Use, column, sinkage, slip, under_load, velocity, wheel_speed};
use super::super::error::{ExperimentError, Problem};
use super::super::experiment::Experiment;
use super::super::grid::Grid;
use super::super::import::{Entry, FoundColumn, Plan, Survey, falls};
use super::super::sheet::Sheet;
use super::super::suggestion::{Rule, maybe, sure};
use super::super::suspicion;
use super::Format;
use bekker_modeldescription::Unit;

/// What is measured at a steady point.
const MEASURED: [&str; 3] = ["drawbar_pull", "torque", "sinkage"];

/// The format of a wheel on a carriage.
pub(super) struct SingleWheel;

impl Format for SingleWheel {
    /// A steady point stands for itself.
    fn least_rows(&self) -> usize {
        1
    }

    fn signal_unit(&self, name: &str) -> Option<Unit> {
        Some(match name {
            "load" | "drawbar_pull" => Unit::NEWTON,
            "torque" => Unit::NEWTON_METRE,
            "slip" | "condition" => Unit::ONE,
            "sinkage" => Unit::METRE,
            "wheel_speed" => Unit::RADIAN_PER_SECOND,
            "carriage_speed" | "rim_speed" => Unit::METRE_PER_SECOND,
            _ => return None,
        })
    }

    fn signal_names(&self) -> Vec<String> {
        let inputs = ["load", "slip", "wheel_speed"].iter();
        let names = inputs.chain(&MEASURED).chain(&["condition", "carriage_speed", "rim_speed"]);
        names.map(|name| (*name).to_owned()).collect()
    }

    fn columns(&self, _: &[String], radius: f64) -> Vec<Column> {
        let load =
            Limits { range: f64::MIN_POSITIVE..=f64::MAX, words: "a positive load in N".to_owned(), likely: None };
        vec![
            column("condition", Use::Condition, None),
            column("load", Use::Input, Some(load)),
            column("slip", Use::Input, slip()),
            column("wheel_speed", Use::Input, wheel_speed(radius)),
            column("drawbar_pull", Use::Measured, None),
            column("torque", Use::Measured, None),
            column("sinkage", Use::Measured, sinkage(radius)),
            column("carriage_speed", Use::Intermediate, velocity()),
            column("rim_speed", Use::Intermediate, velocity()),
        ]
    }

    fn required(&self) -> &'static [(&'static str, &'static str)] {
        &[
            ("load", ", or a number under [inputs]"),
            ("slip", ", or `carriage_speed` beside `wheel_speed` or `rim_speed`, or a number under [inputs]"),
            ("wheel_speed", ", or `rim_speed`, or `carriage_speed` beside `slip`, or a number under [inputs]"),
        ]
    }

    fn check_commands(&self, _: &Sheet, _: &[String]) -> Result<(), ExperimentError> {
        Ok(())
    }

    fn check_rows(&self, grid: &Grid, radius: f64) -> Result<(), ExperimentError> {
        let Some(load) = grid.values("load") else { return Ok(()) };
        for (row, load) in load.iter().enumerate() {
            for name in ["drawbar_pull", "torque"] {
                let (Some(column), Some(limits)) = (grid.column(name), under_load(name, *load, radius)) else {
                    continue;
                };
                let value = column.values[row];
                if !value.is_nan() && !limits.allow(value) {
                    let expected = limits.expected(&column.source, name);
                    return Err(grid.error_at(row, column, Problem::Implausible { value, expected }));
                }
            }
        }
        Ok(())
    }

    /// Set-points of a carriage do not follow from a feedback loop: repeats have the same.
    fn check_repeats(&self, experiment: &Experiment) -> Result<(), ExperimentError> {
        experiment.check_inputs_of_repeats(&["load", "slip", "wheel_speed"])
    }

    fn look(&self, grid: &Grid, radius: Option<f64>, width: Option<f64>) -> Result<Vec<String>, ExperimentError> {
        suspicion::sinkage(grid, "sinkage")?;
        suspicion::single_wheel::look(grid, radius, width)
    }

    fn has_course(&self) -> bool {
        false
    }

    fn no_wheels(&self) -> Option<&'static str> {
        Some("a `single_wheel` experiment has one wheel; leave `wheels` out")
    }

    fn rules(&self) -> &'static [Rule] {
        RULES
    }

    fn sure_signs(&self) -> &'static [&'static str] {
        &["load", "drawbar_pull"]
    }

    fn signs(&self) -> &'static [&'static str] {
        &["slip"]
    }

    /// Carriages move at centimetres a second.
    fn likely_unit(&self, field: &str, largest: f64) -> Option<&'static str> {
        match field {
            "carriage_speed" | "rim_speed" => (largest > 2.0).then_some("mm/s"),
            "wheel_speed" => (largest > 10.0).then_some("rpm"),
            _ => None,
        }
    }

    fn mend<'s>(&self, survey: &'s Survey, found: &mut Vec<(&'s FoundColumn, Entry)>, _: &mut Plan) {
        turn_pull(survey, found);
    }

    fn missing(&self, found: &[(&FoundColumn, Entry)]) -> Vec<String> {
        let has = |wanted: &str| found.iter().any(|(_, entry)| entry.signal() == Some(wanted));
        let mut missing = Vec::new();
        if !has("load") {
            missing.push("load under [inputs], N: no column gives it".to_owned());
        }
        let speed = has("wheel_speed") || has("rim_speed");
        let carriage = has("carriage_speed");
        if !(speed || carriage && has("slip")) {
            missing.push("wheel_speed under [inputs], rad/s: no column gives it".to_owned());
        }
        if !has("slip") && !carriage {
            missing.push("slip under [inputs]: no column gives it".to_owned());
        }
        if !MEASURED.into_iter().any(has) {
            missing.push("a measured column: drawbar_pull, torque or sinkage".to_owned());
        }
        missing
    }

    fn mixes_rows(&self) -> bool {
        true
    }

    fn open_settings(&self) -> &'static [&'static str] {
        &[]
    }
}

/// A pull that falls with slip has its sign turned.
fn turn_pull(survey: &Survey, found: &mut [(&FoundColumn, Entry)]) {
    let of = |found: &[(&FoundColumn, Entry)], signal: &str| {
        found.iter().position(|(_, entry)| entry.signal() == Some(signal))
    };
    let (Some(pull), Some(slip)) = (of(found, "drawbar_pull"), of(found, "slip")) else { return };
    let mut pairs = (Vec::new(), Vec::new());
    for sheet in &survey.sheets {
        let (Some(a), Some(b)) = (sheet.position(&found[slip].0.name), sheet.position(&found[pull].0.name)) else {
            continue;
        };
        for row in &sheet.rows {
            if let (Some(slip), Some(pull)) = (sheet.value(&row.cells[a]), sheet.value(&row.cells[b])) {
                pairs.0.push(slip);
                pairs.1.push(pull);
            }
        }
    }
    if falls(&pairs.0, &pairs.1) {
        found[pull].1.turned = true;
        found[pull].1.guesses.push("it falls with slip, so that its sign is taken as turned".to_owned());
    }
}

/// What words in a column's name mean.
const RULES: &[Rule] = &[
    sure(&["drawbar"], "drawbar_pull"),
    sure(&["drawbar", "pull"], "drawbar_pull"),
    maybe(&["dp"], "drawbar_pull"),
    maybe(&["fx"], "drawbar_pull"),
    maybe(&["pull"], "drawbar_pull"),
    maybe(&["traction"], "drawbar_pull"),
    sure(&["load"], "load"),
    sure(&["vertical", "load"], "load"),
    sure(&["normal", "force"], "load"),
    sure(&["vertical", "force"], "load"),
    maybe(&["weight"], "load"),
    maybe(&["fz"], "load"),
    maybe(&["fn"], "load"),
    maybe(&["w"], "load"),
    sure(&["sinkage"], "sinkage"),
    maybe(&["sink"], "sinkage"),
    maybe(&["depth"], "sinkage"),
    maybe(&["z"], "sinkage"),
    sure(&["slip"], "slip"),
    sure(&["slip", "ratio"], "slip"),
    maybe(&["i"], "slip"),
    maybe(&["s"], "slip"),
    sure(&["torque"], "torque"),
    maybe(&["moment"], "torque"),
    maybe(&["my"], "torque"),
    maybe(&["t"], "torque"),
    sure(&["wheel", "speed"], "wheel_speed"),
    sure(&["angular", "velocity"], "wheel_speed"),
    sure(&["angular", "speed"], "wheel_speed"),
    sure(&["omega"], "wheel_speed"),
    sure(&["rpm"], "wheel_speed"),
    sure(&["rim", "speed"], "rim_speed"),
    maybe(&["circumferential"], "rim_speed"),
    maybe(&["vr"], "rim_speed"),
    sure(&["carriage", "speed"], "carriage_speed"),
    sure(&["carriage", "velocity"], "carriage_speed"),
    maybe(&["forward", "speed"], "carriage_speed"),
    maybe(&["forward", "velocity"], "carriage_speed"),
    maybe(&["travel", "speed"], "carriage_speed"),
    maybe(&["velocity"], "carriage_speed"),
    maybe(&["vx"], "carriage_speed"),
    maybe(&["v"], "carriage_speed"),
    sure(&["condition"], "condition"),
];
