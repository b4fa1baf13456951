//! `bekker diagnose`.

use crate::model::ModelArguments;
use crate::output::{check_writable, say};
use anyhow::{Context, Result};
use bekker::diagnosis::{Control, DiagnoseOptions, Diagnosis, diagnose};
use bekker::measurement::Experiment;
use std::path::PathBuf;

/// Find out which physical effect is missing from the model.
#[derive(clap::Args)]
pub struct Diagnose {
    /// Folder of the experiment, with `experiment.toml` and CSV files.
    experiment: PathBuf,
    #[command(flatten)]
    model: ModelArguments,
    /// Candidate effects, separated by commas; all if not given.
    #[arg(long, value_delimiter = ',', value_name = "EFFECTS")]
    candidates: Option<Vec<String>>,
    /// Most effects that are added.
    #[arg(long, default_value_t = 3, value_name = "N")]
    max_effects: usize,
    /// Write the result as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

impl Diagnose {
    pub fn run(self) -> Result<()> {
        let experiment = Experiment::read(&self.experiment)?;
        let model = self.model.load()?;
        if let Some(path) = &self.json {
            check_writable(path)?;
        }
        let options =
            DiagnoseOptions { candidates: self.candidates, max_effects: self.max_effects, ..Default::default() };
        let diagnosis = diagnose(&model, &experiment, &options, &Control::default())?;
        print(&diagnosis)?;
        if let Some(path) = &self.json {
            std::fs::write(path, serde_json::to_string_pretty(&diagnosis.to_json())?)
                .with_context(|| format!("cannot write `{}`", path.display()))?;
        }
        Ok(())
    }
}

fn print(diagnosis: &Diagnosis) -> Result<()> {
    say!("{}: {} {}", diagnosis.experiment.name, diagnosis.verdict.name(), diagnosis.effects.join(", "));
    for step in &diagnosis.steps {
        say!(
            "  {:20} left {:.3} rmse {:?} heldout {:?}",
            step.added.as_deref().unwrap_or("baseline"),
            step.left,
            step.rmse,
            step.heldout_rmse
        );
    }
    for c in diagnosis.candidates.iter().take(8) {
        say!(
            "  {:20} P {:.3} p {:.3} gain {:.1} left {:.2} held {:?} tied {}",
            c.effect,
            c.probability,
            c.p_value,
            c.gain,
            c.left,
            c.heldout_gain,
            c.tied
        );
    }
    say!("  enough {:.3} other {:.3} lack {:?}", diagnosis.share.enough, diagnosis.share.other, diagnosis.lack_of_fit);
    for caution in &diagnosis.cautions {
        say!("  ! {caution}");
    }
    Ok(())
}
