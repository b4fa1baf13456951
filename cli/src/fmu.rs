//! `bekker fmu`.

use crate::model::ModelArguments;
use crate::output::say;
use anyhow::Result;
use std::path::PathBuf;

/// Write a model as an FMU (FMI 3.0, co-simulation); no compiler is needed.
#[derive(clap::Args)]
pub struct Fmu {
    #[command(flatten)]
    model: ModelArguments,
    /// Where to write; the model's name with .fmu where missing.
    #[arg(long, short)]
    output: Option<PathBuf>,
}

impl Fmu {
    pub fn run(self) -> Result<()> {
        let model = self.model.load()?;
        let path = self.output.unwrap_or_else(|| PathBuf::from(format!("{}.fmu", model.name)));
        bekker_fmu_package::export(&model, &path)?;
        say!("wrote {}", path.display());
        Ok(())
    }
}
