//! Which experiments a command works on: one folder, or several on one soil, and the model.

use crate::compare::write_page;
use crate::import;
use crate::model::ModelChanges;
use crate::output::say;
use anyhow::{Context, Result, bail};
use bekker::diagnosis::{CompareOptions, Given, compare};
use bekker::measurement::{Experiment, Share};
use bekker::model::Model;
use std::path::{Path, PathBuf};

/// Folders and the model behind them.
#[derive(clap::Args)]
pub struct Experiments {
    /// Folders of experiments, each with `experiment.toml` and CSV files. Several are fitted together: they share the soil's
    /// parameters, unless --share or `[shared]` in the folders says otherwise, and each keeps its rig and noise. MODEL: a model file (TOML) or the name of a built-in model; else the one that
    /// `experiment.toml` names, or a plain rover or wheel.
    #[arg(required = true, value_name = "EXPERIMENT.. [MODEL]")]
    experiments: Vec<PathBuf>,
    #[command(flatten)]
    changes: ModelChanges,
    /// Of several experiments: relative standard deviation of the soil from one to the next, 0 where all were made in one bed; 0.05 if not
    /// given.
    #[arg(long, value_name = "SHARE")]
    soil_scatter: Option<f64>,
    /// Of several experiments: what they share, separated by commas; of what is not named each has its own. A vehicle has its wheels, masses
    /// and drive, a drive motor and gear. If not given: what their folders name alike in `[shared]`, else the soil alone.
    #[arg(long, value_delimiter = ',', value_name = "soil,vehicle,drive", value_parser = share)]
    share: Option<Vec<Share>>,
}

fn share(name: &str) -> Result<Share> {
    let known = Share::ALL.map(Share::name).join(", ");
    Share::find(name).with_context(|| format!("expected one or more of {known}, separated by commas"))
}

impl Experiments {
    /// The experiment, or several as one, and what is given beside. What is no folder and stands last is the model.
    pub fn read(self) -> Result<(Experiment, Given)> {
        self.read_by(import::read)
    }

    /// The same of experiments that may still have to be made.
    pub fn read_plan(self) -> Result<(Experiment, Given)> {
        self.read_by(import::read_plan)
    }

    fn read_by(self, read_one: impl Fn(&Path) -> Result<Experiment>) -> Result<(Experiment, Given)> {
        let (folders, model) = match self.experiments.as_slice() {
            [folders @ .., last] if !folders.is_empty() && !last.is_dir() => (folders, Some(last)),
            folders => (folders, None),
        };
        let mut read = folders.iter().map(|folder| read_one(folder)).collect::<Result<Vec<_>>>()?;
        let experiment = if read.len() == 1 { read.remove(0) } else { Experiment::joint(read)? };
        let model = model.map(|path| path.to_string_lossy().into_owned());
        let mut given = self.changes.with(model).given()?;
        if let Some(deviation) = self.soil_scatter {
            if experiment.parts.is_empty() {
                bail!("--soil-scatter: this is a single experiment; it says how the soils of several differ");
            }
            given = given.with_soil_scatter(deviation)?;
        }
        if let Some(share) = &self.share {
            if experiment.parts.is_empty() {
                bail!("--share: this is a single experiment; it says what several have in common");
            }
            given = given.with_share(share);
        }
        Ok((experiment, given))
    }
}

/// Writes a page of each of several experiments with its model, whose first lines say what was found of all; the name of the experiment
/// stands behind that of the file.
pub fn write_pages(
    experiment: &Experiment,
    models: &[(String, Model)],
    found: &str,
    determined: &[String],
    page: &Path,
) -> Result<()> {
    for (part, (name, model)) in experiment.parts.iter().zip(models) {
        let mut comparison = compare(model, &part.experiment, &CompareOptions::default())?;
        let together = std::iter::once(format!("fitted together with the others of {}: {found}", experiment.name));
        let determined = determined.iter().map(|words| format!("all together: {words}"));
        comparison.sources.splice(0..0, together.chain(determined));
        let path = beside(page, name);
        write_page(&comparison, &path)?;
        say!("wrote {}", path.display());
    }
    Ok(())
}

/// The files that are written for `file`: itself or, of several experiments, one of each.
pub fn files(experiment: &Experiment, file: &Path) -> Vec<PathBuf> {
    match experiment.parts.as_slice() {
        [] => vec![file.to_path_buf()],
        parts => parts.iter().map(|part| beside(file, &part.name)).collect(),
    }
}

/// The file `page`, with a name behind its own.
pub fn beside(page: &Path, name: &str) -> PathBuf {
    let stem = page.file_stem().unwrap_or_default().to_string_lossy();
    let ending = page.extension().map(|ending| format!(".{}", ending.to_string_lossy())).unwrap_or_default();
    page.with_file_name(format!("{stem}-{name}{ending}"))
}
