//! Files of a shear ring or box: displacement, normal stress and shear stress.

use super::super::columns::{Column, Limits, Use, column};
use super::super::course::Course;
use super::super::error::ExperimentError;
use super::super::experiment::Experiment;
use super::super::grid::Grid;
use super::super::import::{Entry, FoundColumn, Plan, Survey};
use super::super::sheet::Sheet;
use super::super::suggestion::{Rule, maybe, sure};
use super::super::suspicion;
use super::Format;
use super::plate_sinkage::{missing_columns, travelled, unit_of};
use bekker_modeldescription::Unit;

/// Longest displacement, m: rings turn on, boxes end at centimetres; beyond it the displacement is in mm.
const LONGEST: f64 = 2.0;

const COURSE: Course = Course { input: "displacement", held: Some("normal_stress"), what: "a shear test" };

/// The format of a shear test.
pub(super) struct Shear;

impl Format for Shear {
    fn least_rows(&self) -> usize {
        3
    }

    fn signal_unit(&self, name: &str) -> Option<Unit> {
        unit_of(name, &["displacement", "normal_stress", "shear_stress"])
    }

    fn signal_names(&self) -> Vec<String> {
        ["displacement", "normal_stress", "shear_stress", "time", "condition"].map(str::to_owned).to_vec()
    }

    fn columns(&self, _: &[String], _: f64) -> Vec<Column> {
        let pressed =
            Limits { range: 0.0..=f64::MAX, words: "a normal stress in Pa, not negative".to_owned(), likely: None };
        vec![
            column("condition", Use::Condition, None),
            column("time", Use::Time, None),
            column("displacement", Use::Input, travelled(LONGEST, "displacement")),
            column("normal_stress", Use::Input, Some(pressed)),
            column("shear_stress", Use::Measured, None),
        ]
    }

    fn required(&self) -> &'static [(&'static str, &'static str)] {
        &[("displacement", ""), ("normal_stress", ", or a number under [inputs] or the run's `inputs`")]
    }

    fn check_commands(&self, _: &Sheet, _: &[String]) -> Result<(), ExperimentError> {
        Ok(())
    }

    fn check_rows(&self, grid: &Grid, _: f64) -> Result<(), ExperimentError> {
        suspicion::downward(grid, &["displacement", "shear_stress"])?;
        COURSE.check(grid)
    }

    fn check_repeats(&self, experiment: &Experiment) -> Result<(), ExperimentError> {
        experiment.check_inputs_of_repeats(&["displacement", "normal_stress"])
    }

    fn look(&self, _: &Grid, _: Option<f64>, _: Option<f64>) -> Result<Vec<String>, ExperimentError> {
        Ok(Vec::new())
    }

    fn has_course(&self) -> bool {
        false
    }

    fn course(&self) -> Option<&'static Course> {
        Some(&COURSE)
    }

    fn rig(&self) -> &'static [(&'static str, &'static str)] {
        &[]
    }

    fn no_wheels(&self) -> Option<&'static str> {
        Some("a `shear` experiment has no wheel; leave `wheels` out")
    }

    fn parameter_rules(&self) -> &'static [Rule] {
        PARAMETERS
    }

    fn rules(&self) -> &'static [Rule] {
        RULES
    }

    fn sure_signs(&self) -> &'static [&'static str] {
        &["shear_stress"]
    }

    fn signs(&self) -> &'static [&'static str] {
        &["normal_stress"]
    }

    /// Stresses of soils under small vehicles are kilopascals.
    fn likely_unit(&self, field: &str, largest: f64) -> Option<&'static str> {
        match field {
            "displacement" => (largest > LONGEST).then_some("mm"),
            "normal_stress" | "shear_stress" => (largest < 500.0).then_some("kPa"),
            _ => None,
        }
    }

    fn mend<'s>(&self, _: &'s Survey, _: &mut Vec<(&'s FoundColumn, Entry)>, _: &mut Plan) {}

    fn missing(&self, found: &[(&FoundColumn, Entry)]) -> Vec<String> {
        let mut missing = missing_columns(found, "displacement", &["shear_stress"]);
        if !found.iter().any(|(_, entry)| entry.signal() == Some("normal_stress")) {
            missing.push("normal_stress under [inputs], Pa: no column gives it".to_owned());
        }
        missing
    }

    fn mixes_rows(&self) -> bool {
        true
    }

    fn open_settings(&self) -> &'static [&'static str] {
        &["# `{ run = true }` under [columns] makes a run of the rows with one label of that column"]
    }
}

/// What a column of a shear test may mean beside a signal.
const PARAMETERS: &[Rule] = &[sure(&["shear", "speed"], "shear_box.speed")];

/// What words in a column's name mean.
const RULES: &[Rule] = &[
    sure(&["displacement"], "displacement"),
    maybe(&["shear", "displacement"], "displacement"),
    maybe(&["j"], "displacement"),
    maybe(&["x"], "displacement"),
    sure(&["normal", "stress"], "normal_stress"),
    sure(&["normal", "pressure"], "normal_stress"),
    maybe(&["sigma"], "normal_stress"),
    sure(&["shear", "stress"], "shear_stress"),
    maybe(&["tau"], "shear_stress"),
    sure(&["time"], "time"),
    maybe(&["t"], "time"),
    sure(&["condition"], "condition"),
];
