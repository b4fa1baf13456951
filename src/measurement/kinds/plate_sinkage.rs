//! Files of a plate that is pressed into the soil: sinkage with force or pressure.

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
use crate::soil_test::SoilTestSignals;
use bekker_modeldescription::Unit;

/// What is measured on the way down.
const MEASURED: [&str; 2] = ["force", "pressure"];

/// Deepest sinkage, m, of a plate that people press by hand or machine: beyond it the sinkage is in mm.
const DEEPEST: f64 = 0.8;

const COURSE: Course = Course { input: "sinkage", held: None, what: "a plate test" };

/// The format of a plate test.
pub(super) struct PlateSinkage;

/// What a column of a soil test may be beside a signal of it, in the format of both kinds.
pub(super) fn unit_of(name: &str, own: &[&str]) -> Option<Unit> {
    match name {
        "condition" => Some(Unit::ONE),
        "time" => Some(Unit::SECOND),
        _ if own.contains(&name) => super::super::vocabulary::unit_in(SoilTestSignals::default(), name),
        _ => None,
    }
}

/// A length that only grows, m.
pub(super) fn travelled(largest: f64, words: &str) -> Option<Limits> {
    let words = format!("a {words} in m of at most {largest} (millimetres?)");
    Some(Limits { range: -largest..=largest, words, likely: Some("mm") })
}

/// What no column gives, of an input and what is measured.
pub(super) fn missing_columns(found: &[(&FoundColumn, Entry)], input: &str, measured: &[&str]) -> Vec<String> {
    let has = |wanted: &str| found.iter().any(|(_, entry)| entry.signal() == Some(wanted));
    let mut missing = Vec::new();
    if !has(input) {
        missing.push(format!("a column for {input}"));
    }
    if !measured.iter().any(|name| has(name)) {
        missing.push(format!("a measured column: {}", measured.join(" or ")));
    }
    missing
}

impl Format for PlateSinkage {
    fn least_rows(&self) -> usize {
        3
    }

    fn signal_unit(&self, name: &str) -> Option<Unit> {
        unit_of(name, &["sinkage", "force", "pressure"])
    }

    fn signal_names(&self) -> Vec<String> {
        ["sinkage", "force", "pressure", "time", "condition"].map(str::to_owned).to_vec()
    }

    fn columns(&self, _: &[String], _: f64) -> Vec<Column> {
        vec![
            column("condition", Use::Condition, None),
            column("time", Use::Time, None),
            column("sinkage", Use::Input, travelled(DEEPEST, "sinkage")),
            column("force", Use::Measured, None),
            column("pressure", Use::Measured, None),
        ]
    }

    fn required(&self) -> &'static [(&'static str, &'static str)] {
        &[("sinkage", "")]
    }

    fn check_commands(&self, _: &Sheet, _: &[String]) -> Result<(), ExperimentError> {
        Ok(())
    }

    fn check_rows(&self, grid: &Grid, _: f64) -> Result<(), ExperimentError> {
        suspicion::downward(grid, &["sinkage", "force", "pressure"])?;
        COURSE.check(grid)
    }

    fn check_repeats(&self, experiment: &Experiment) -> Result<(), ExperimentError> {
        experiment.check_inputs_of_repeats(&["sinkage"])
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
        &[("plate.diameter", "0.1")]
    }

    fn no_wheels(&self) -> Option<&'static str> {
        Some("a `plate_sinkage` experiment has no wheel; leave `wheels` out")
    }

    fn parameter_rules(&self) -> &'static [Rule] {
        PARAMETERS
    }

    fn rules(&self) -> &'static [Rule] {
        RULES
    }

    fn sure_signs(&self) -> &'static [&'static str] {
        &[]
    }

    /// A sinkage beside a force or a pressure, in files without a wheel.
    fn is_told_by(&self, means: &dyn Fn(&[&str]) -> bool) -> bool {
        means(&["sinkage"]) && means(&MEASURED)
    }

    fn signs(&self) -> &'static [&'static str] {
        &MEASURED
    }

    /// Pressures under plates are kilopascals, forces newtons to kilonewtons.
    fn likely_unit(&self, field: &str, largest: f64) -> Option<&'static str> {
        (field == "pressure" && largest < 500.0).then_some("kPa")
    }

    fn mend<'s>(&self, _: &'s Survey, _: &mut Vec<(&'s FoundColumn, Entry)>, _: &mut Plan) {}

    fn missing(&self, found: &[(&FoundColumn, Entry)]) -> Vec<String> {
        missing_columns(found, "sinkage", &MEASURED)
    }

    fn mixes_rows(&self) -> bool {
        true
    }

    fn open_settings(&self) -> &'static [&'static str] {
        &["# `{ run = true }` under [columns] makes a run of the rows with one label of that column"]
    }
}

/// What a column of a plate test may mean beside a signal.
const PARAMETERS: &[Rule] = &[
    sure(&["plate", "diameter"], "plate.diameter"),
    maybe(&["diameter"], "plate.diameter"),
    sure(&["plate", "width"], "plate.width"),
    maybe(&["width"], "plate.width"),
    sure(&["plate", "length"], "plate.length"),
    maybe(&["length"], "plate.length"),
    sure(&["box", "width"], "soil_box.width"),
    sure(&["box", "depth"], "soil_box.depth"),
    sure(&["plate", "speed"], "plate.speed"),
];

/// What words in a column's name mean.
const RULES: &[Rule] = &[
    sure(&["sinkage"], "sinkage"),
    maybe(&["sink"], "sinkage"),
    maybe(&["depth"], "sinkage"),
    maybe(&["penetration"], "sinkage"),
    maybe(&["displacement"], "sinkage"),
    maybe(&["z"], "sinkage"),
    sure(&["force"], "force"),
    sure(&["load"], "force"),
    maybe(&["fz"], "force"),
    maybe(&["f"], "force"),
    sure(&["pressure"], "pressure"),
    maybe(&["stress"], "pressure"),
    maybe(&["p"], "pressure"),
    sure(&["time"], "time"),
    maybe(&["t"], "time"),
    sure(&["condition"], "condition"),
];
