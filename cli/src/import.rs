//! `bekker import`.

use crate::output::say;
use anyhow::Result;
use bekker::measurement::{self, Proposal};
use std::path::{Path, PathBuf};

/// How commands that take an experiment point to its format.
pub const FORMAT: &str = "\
The folder holds CSV files and `experiment.toml`; all its keys stand on the page examples/experiments.md:

    name = \"sand box\"
    kind = \"single_wheel\"            # or \"traverse\", \"plate_sinkage\", \"shear\"
    columns.\"DP [kN]\" = { signal = \"drawbar_pull\", unit = \"kN\" }
    run = [{ file = \"run1.csv\" }]

`bekker import FILES` proposes such a folder for files that are there.";

/// Propose an experiment folder for CSV files: which column is which signal, in which unit.
///
/// The mapping follows from the names of the columns, units in them and the ranges of the values. The folder gets copies of
/// the files and an `experiment.toml` with comments that say what is a guess. Nothing is written over.
#[derive(clap::Args)]
#[command(after_help = FORMAT)]
pub struct Import {
    /// CSV files of one experiment, of any separator and decimal mark.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Folder to make; `experiment`, or the file's name where there is one file, if not given.
    #[arg(long, short, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// A wheel on a carriage, a rover on a profile, a plate pressed into the soil, or a shear test; by the columns if not given.
    #[arg(long, value_enum)]
    kind: Option<Kind>,
}

/// Kind of experiment.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Kind {
    #[value(name = "single_wheel", alias = "single-wheel")]
    SingleWheel,
    Traverse,
    #[value(name = "plate_sinkage", alias = "plate-sinkage")]
    PlateSinkage,
    Shear,
}

impl From<Kind> for measurement::Kind {
    fn from(kind: Kind) -> Self {
        match kind {
            Kind::SingleWheel => Self::SingleWheel,
            Kind::Traverse => Self::Traverse,
            Kind::PlateSinkage => Self::PlateSinkage,
            Kind::Shear => Self::Shear,
        }
    }
}

impl Import {
    pub fn run(self) -> Result<()> {
        let proposal = Proposal::of(&self.files, self.kind.map(Into::into))?;
        let named = match self.files.as_slice() {
            [one] => one.file_stem().map(PathBuf::from),
            _ => None,
        };
        let folder = self.output.or(named).unwrap_or_else(|| PathBuf::from("experiment"));
        let imported = proposal.write(&folder)?;
        say!("wrote {}: a {} experiment", folder.display(), proposal.kind.name());
        list("to be checked", &proposal.unsure)?;
        list("to be filled in", &proposal.missing)?;
        match imported.read {
            Ok(experiment) => {
                let rows: usize = experiment.runs.iter().map(|run| run.data.rows()).sum();
                let signals = experiment.signals().join(", ");
                say!("it can be read: {} runs, {rows} rows of {signals}", experiment.runs.len());
                list("doubts", &experiment.doubts)?;
            }
            Err(missing) => say!("it cannot be read yet: {missing}"),
        }
        Ok(())
    }
}

fn list(title: &str, entries: &[String]) -> Result<()> {
    if !entries.is_empty() {
        say!("{title}:");
    }
    for entry in entries {
        say!("  {entry}");
    }
    Ok(())
}

/// Reads an experiment and prints what is doubtful in it.
pub fn read(folder: &Path) -> Result<measurement::Experiment> {
    doubted(measurement::Experiment::read(folder)?)
}

/// Reads an experiment that may still have to be made, and prints what is doubtful in it.
pub fn read_plan(folder: &Path) -> Result<measurement::Experiment> {
    doubted(measurement::Experiment::read_plan(folder)?)
}

/// On the error stream, so that results stay what they are.
fn doubted(experiment: measurement::Experiment) -> Result<measurement::Experiment> {
    for doubt in &experiment.doubts {
        eprintln!("bekker: doubt: {doubt}");
    }
    Ok(experiment)
}
