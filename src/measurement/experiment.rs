//! An experiment folder, read and checked.

use super::course::{average, repeats_of_equal_rigs};
use super::doubts::Doubts;
use super::error::{ExperimentError, Problem};
use super::files::Files;
use super::joint::Part;
use super::reading::read_runs;
use super::sensor::Sensor;
use super::settings::Settings;
use super::share::Share;
use super::suspicion;
use super::table::Table;
use crate::effects::EffectDefinition;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// What was done in an experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// A wheel on a carriage: every row is a steady point.
    SingleWheel,
    /// A rover on a profile: every run is a time series.
    Traverse,
    /// A plate that is pressed into the soil: every run is the way down of one plate.
    PlateSinkage,
    /// A shear ring or box: every run is the displacement under one normal stress.
    Shear,
}

impl Kind {
    /// All kinds; those that columns of unknown files identify most surely come first.
    pub const ALL: [Self; 4] = [Self::SingleWheel, Self::Shear, Self::PlateSinkage, Self::Traverse];

    /// The kind called `name` in `experiment.toml`.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// Whether the soil alone is tested, without a wheel.
    #[must_use]
    pub fn is_soil_test(self) -> bool {
        matches!(self, Self::PlateSinkage | Self::Shear)
    }

    /// The name in `experiment.toml`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::SingleWheel => "single_wheel",
            Self::Traverse => "traverse",
            Self::PlateSinkage => "plate_sinkage",
            Self::Shear => "shear",
        }
    }
}

/// Knowledge of a parameter from a separate test: a normal distribution.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Prior {
    /// The value that the test gave, in the parameter's unit.
    pub mean: f64,
    /// Its standard deviation.
    #[serde(rename = "sd")]
    pub deviation: f64,
}

/// Measurements, what they were made with and what is known of their noise. Everything in SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    /// Name for people.
    pub name: String,
    /// What was done; where several experiments are joined, in the first of them.
    pub kind: Kind,
    /// The folder it was read from; empty where it was made in memory.
    pub folder: PathBuf,
    /// What is known of the rig, by the model's parameter names.
    pub parameters: BTreeMap<String, f64>,
    /// Parameters known from separate tests.
    pub priors: BTreeMap<String, Prior>,
    /// Class of the soil, whose priors stand in for tests that were not made; one of [`SOIL_CLASSES`](crate::soil_class).
    pub soil_class: Option<String>,
    /// Names of what it has in common with other experiments: those in which a thing has the same name have the same of it.
    pub shared: BTreeMap<Share, String>,
    /// The vehicle or rig: a built-in model or a model file, as the experiment names it.
    pub model: Option<String>,
    /// Stated standard deviation of one sample, by signal.
    pub noise: BTreeMap<String, f64>,
    /// What may be wrong with the sensors of measured signals, by signal; sensors are perfect where it does not say so.
    pub sensors: BTreeMap<String, Sensor>,
    /// Effects of the user's own, neutral unless a parameter says otherwise; candidates of a diagnosis.
    pub effects: Vec<EffectDefinition>,
    /// The runs, in the order of the file.
    pub runs: Vec<Run>,
    /// What is allowed but unlikely: signs, units and sizes that may be mistaken, with what would mend them.
    pub doubts: Vec<String>,
    /// The experiments that this one consists of, see [`joint`](Self::joint); none where it is a single one.
    pub parts: Vec<Part>,
}

/// One recording: a file of an experiment, or the rows of a file that have the same parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// The file's path below the folder, without its ending, with `#1`, `#2` .. where one file holds several runs; or the
    /// name that the experiment gives it.
    pub name: String,
    /// The file.
    pub file: PathBuf,
    /// Runs of the same group repeat the same inputs; rows pair by index.
    pub group: Option<String>,
    /// What was changed for this run, by the model's parameter names.
    pub parameters: BTreeMap<String, f64>,
    /// Profile of the ground, columns `x` and `z`, m; flat where missing.
    pub terrain: Option<Table>,
    /// Where the rover starts, m.
    pub x0: Option<f64>,
    /// Inputs and measured signals; for a traverse also `time`.
    pub data: Table,
    /// Label of the set-point of each row; empty where the file has no such column.
    pub conditions: Vec<Option<String>>,
    /// Names of the input columns. Those of a traverse are commands or, where none were recorded, the measured speeds of the
    /// wheels.
    pub inputs: Vec<String>,
    /// Names of the measured columns that have at least one value; of a plan, all measured columns.
    pub measured: Vec<String>,
}

impl Experiment {
    /// Reads `experiment.toml` in `folder` and the CSV files that it names.
    ///
    /// # Errors
    /// [`ExperimentError`] with file, line and column: the format is described in the [module](super).
    /// The names of parameters are not checked here but by the model that they are given to.
    pub fn read(folder: impl AsRef<Path>) -> Result<Self, ExperimentError> {
        Self::read_from(&Files::Folder(folder.as_ref()), false)
    }

    /// The same for an experiment that may still have to be made: columns of measured signals may be empty, and count
    /// as signals that will be measured.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn read_plan(folder: impl AsRef<Path>) -> Result<Self, ExperimentError> {
        Self::read_from(&Files::Folder(folder.as_ref()), true)
    }

    pub(super) fn read_from(files: &Files, planned: bool) -> Result<Self, ExperimentError> {
        let settings = Settings::read(files)?;
        let mut doubts = Doubts::default();
        let mut runs = read_runs(files, &settings, planned, &mut doubts)?;
        if let Some(course) = settings.kind.format().course().filter(|_| !planned) {
            repeats_of_equal_rigs(&settings, course, &mut runs, &mut doubts);
            average(&mut runs, course, &mut doubts)?;
        }
        let mut experiment = Self {
            name: settings.name,
            kind: settings.kind,
            folder: files.folder(),
            parameters: settings.parameters,
            priors: settings.priors,
            soil_class: settings.soil_class,
            shared: settings.shared,
            model: settings.model,
            effects: settings.effects,
            noise: settings.noise.iter().map(|(name, (sd, _))| (name.clone(), *sd)).collect(),
            sensors: settings.sensors.iter().map(|(name, (sensor, _))| (name.clone(), *sensor)).collect(),
            runs,
            doubts: Vec::new(),
            parts: Vec::new(),
        };
        experiment.doubts = doubts.texts();
        experiment.doubts.extend(suspicion::of_parameters(&experiment));
        let measured = experiment.signals();
        let noise = settings.noise.iter().map(|(name, (_, line))| ("noise", name, line));
        let sensors = settings.sensors.iter().map(|(name, (_, line))| ("sensors", name, line));
        for (table, name, line) in noise.chain(sensors) {
            if !measured.contains(name) {
                let message = format!("no run measures this signal; measured are {}", measured.join(", "));
                return Err(ExperimentError::in_file(&settings.file, Problem::Setting(message))
                    .at_line(*line)
                    .at_column(format!("{table}.{name}")));
            }
        }
        experiment.check_groups()?;
        Ok(experiment)
    }

    /// Names of all signals that some run measures, in the order of their first appearance.
    #[must_use]
    pub fn signals(&self) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for name in self.runs.iter().flat_map(|run| &run.measured) {
            if !names.contains(name) {
                names.push(name.clone());
            }
        }
        names
    }
}
