//! Which experiments a command works on: one folder, or several that are fitted together, and the model.

use crate::import;
use crate::model::ModelChanges;
use crate::output::write;
use anyhow::{Context, Result, bail};
use bekker::diagnosis::{CompareError, Given};
use bekker::measurement::{Experiment, Share};
use std::path::{Path, PathBuf};

/// Folders and the model behind them.
#[derive(clap::Args)]
pub struct Experiments {
    /// Folders of experiments, each with `experiment.toml` and CSV files. Several are fitted together: they share the soil's
    /// parameters, unless --share or `[shared]` in the folders says otherwise, and each keeps its rig and noise. MODEL: a model file
    /// (TOML) or the name of a built-in model; else the one that `experiment.toml` names, or a plain rover or wheel.
    #[arg(required = true, value_name = "EXPERIMENT.. [MODEL]")]
    experiments: Vec<PathBuf>,
    #[command(flatten)]
    changes: ModelChanges,
    #[command(flatten)]
    together: Together,
}

/// What is said of several experiments that are fitted together.
#[derive(clap::Args)]
pub struct Together {
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
        let (folders, model) = folders_and_model(&self.experiments);
        let experiment = read_together(folders, read_one)?;
        let given = self.together.add_to(self.changes.with(model).given()?, &experiment)?;
        Ok((experiment, given))
    }
}

impl Together {
    /// Adds what is said to what is given.
    pub fn add_to(&self, given: Given, experiment: &Experiment) -> Result<Given> {
        let option = self.soil_scatter.map(|_| "--soil-scatter").or(self.share.as_ref().map(|_| "--share"));
        if let Some(option) = option.filter(|_| experiment.parts.is_empty()) {
            bail!("{option}: this is a single experiment; it says something of several that are fitted together");
        }
        let given = match &self.share {
            Some(share) => given.with_share(share),
            None => given,
        };
        match self.soil_scatter {
            Some(deviation) => Ok(given.with_soil_scatter(deviation)?),
            None => Ok(given),
        }
    }
}

/// Folders, and the model behind them: what is no folder and stands last.
pub fn folders_and_model(paths: &[PathBuf]) -> (&[PathBuf], Option<String>) {
    match paths {
        [folders @ .., last] if !folders.is_empty() && !last.is_dir() => {
            (folders, Some(last.to_string_lossy().into_owned()))
        }
        folders => (folders, None),
    }
}

/// The experiment of a folder, or several as one.
pub fn read_together(folders: &[PathBuf], read_one: impl Fn(&Path) -> Result<Experiment>) -> Result<Experiment> {
    let mut read = folders.iter().map(|folder| read_one(folder)).collect::<Result<Vec<_>>>()?;
    Ok(if read.len() == 1 { read.remove(0) } else { Experiment::joint(read)? })
}

/// Writes the page of each of several experiments; the name of the experiment stands behind that of the file.
pub fn write_pages(
    experiment: &Experiment,
    path: &Path,
    page: impl Fn(usize) -> Result<String, CompareError>,
) -> Result<()> {
    for (part, file) in files(experiment, path).iter().enumerate() {
        write(file, &page(part)?)?;
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
