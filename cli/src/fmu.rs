//! `bekker fmu`.

use crate::model::ModelArguments;
use crate::output::say;
use anyhow::{Context, Result};
use bekker_fmu_package::{Kind, Options, Platform, Version};
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
    /// Version of the standard: 2 (2.0, which nearly every tool reads) or 3 (3.0). Where missing 3, and 2 in a system.
    #[arg(long, value_parser = version, value_name = "2|3")]
    fmi: Option<Version>,
    /// What of the model the FMU offers: the whole (closed-loop), its rover, or its controller; of a wheel on a carriage,
    /// that. What the model file says where missing.
    #[arg(long, value_name = "rover|controller|closed-loop|carriage")]
    kind: Option<Kind>,
    /// Shows the same quantity of every wheel, link or obstacle as one array, `wheels.slip` (FMI 3.0 only).
    #[arg(long)]
    arrays: bool,
    /// A library for another platform to pack besides this machine's: .so, .dll or .dylib, built from fmu/; the file says for
    /// which platform it is. May be given several times.
    #[arg(long, value_name = "FILE")]
    library: Vec<PathBuf>,
    /// Of a system: gives it the inputs that no FMU feeds (velocity_command) as its own, where FMPy sets them. Ecos and
    /// libcosim refuse a system that has inputs.
    #[arg(long)]
    system_inputs: bool,
}

/// Where the consequences are told.
const SEE: &str = "examples/fmu.md, `Rover and controller`, says what that costs and how it is avoided";

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
        let Self { fmi: version, kind, arrays, library: libraries, system_inputs, .. } = self;
        let platforms = bekker_fmu_package::platforms_of(&libraries)?;
        let options = Options { version, kind, arrays, libraries, system_inputs, date };
        bekker_fmu_package::export(&model, &options, &path)?;
        let platforms: Vec<String> = platforms.iter().map(Platform::to_string).collect();
        say!("wrote {}, which runs on {}", path.display(), platforms.join(", "));
        if path.extension().is_some_and(|extension| extension == "ssp") {
            say!(
                "A master that steps rover and controller side by side delays the torques by one of its steps: {SEE}."
            );
        }
        Ok(())
    }
}

/// The date that reproducible builds agree on (<https://reproducible-builds.org/specs/source-date-epoch/>).
fn source_date() -> Result<Option<u64>> {
    let text = std::env::var("SOURCE_DATE_EPOCH").ok();
    text.map(|text| text.parse().with_context(|| format!("SOURCE_DATE_EPOCH is `{text}`, expected seconds")))
        .transpose()
}
