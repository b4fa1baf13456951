//! `bekker fmu`.

use crate::model::ModelArguments;
use crate::output::say;
use anyhow::{Context, Result};
use bekker_fmu_package::{Kind, Options, Version};
use std::path::PathBuf;

/// Write a model as an FMU or, with an output that ends in .ssp, as a system of a rover's FMU and its controller's; no
/// compiler is needed.
#[derive(clap::Args)]
pub struct Fmu {
    #[command(flatten)]
    model: ModelArguments,
    /// Where to write; the model's name with .fmu where missing.
    #[arg(long, short)]
    output: Option<PathBuf>,
    /// Version of the standard: 2 (2.0, which nearly every tool reads) or 3 (3.0).
    #[arg(long, value_parser = version, default_value = "3", value_name = "2|3")]
    fmi: Version,
    /// What of the model the FMU offers: the whole (closed-loop), its rover, or its controller; of a wheel on a carriage,
    /// that. What the model file says where missing.
    #[arg(long, value_name = "rover|controller|closed-loop|carriage")]
    kind: Option<Kind>,
    /// Shows the same quantity of every wheel, link or obstacle as one array, `wheels.slip` (FMI 3.0 only).
    #[arg(long)]
    arrays: bool,
    /// A library for 64 bit Windows to pack besides this system's.
    #[arg(long, value_name = "DLL")]
    windows: Option<PathBuf>,
}

fn version(text: &str) -> Result<Version, String> {
    match text {
        "2" | "2.0" => Ok(Version::Fmi2),
        "3" | "3.0" => Ok(Version::Fmi3),
        _ => Err("expected 2 or 3".into()),
    }
}

impl Fmu {
    pub fn run(self) -> Result<()> {
        let model = self.model.load()?;
        let path = self.output.unwrap_or_else(|| PathBuf::from(format!("{}.fmu", model.name)));
        let date = source_date()?;
        let options = Options { version: self.fmi, kind: self.kind, arrays: self.arrays, windows: self.windows, date };
        bekker_fmu_package::export(&model, &options, &path)?;
        say!("wrote {}", path.display());
        Ok(())
    }
}

/// The date that reproducible builds agree on (<https://reproducible-builds.org/specs/source-date-epoch/>).
fn source_date() -> Result<Option<u64>> {
    let text = std::env::var("SOURCE_DATE_EPOCH").ok();
    text.map(|text| text.parse().with_context(|| format!("SOURCE_DATE_EPOCH is `{text}`, expected seconds")))
        .transpose()
}
