//! `--soil-from` and `--save-soil`: what is known of a soil, from one experiment to the next.

use crate::output::{check_writable, say, write};
use anyhow::{Context, Result, bail};
use bekker::diagnosis::{CalibratedParameter, Comparison, Given};
use bekker::known_soil::KnownSoil;
use std::path::PathBuf;

/// A soil that another experiment has found.
#[derive(clap::Args)]
pub struct SoilFrom {
    /// What another experiment found of the soil, a file of `bekker calibrate --save-soil`: a prior of its parameters together. It
    /// goes before the priors of a class of soil and after the experiment's own [priors].
    #[arg(long, value_name = "FILE")]
    soil_from: Option<PathBuf>,
}

impl SoilFrom {
    /// The same with the known soil.
    pub fn add_to(&self, given: Given) -> Result<Given> {
        let Some(path) = &self.soil_from else { return Ok(given) };
        let name =
            path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned());
        Ok(given.with_soil(KnownSoil::read(path)?, &name))
    }
}

/// Where what is found of the soil goes.
#[derive(clap::Args)]
pub struct SaveSoil {
    /// Write what is found of the soil, with its covariance, for `--soil-from` of other experiments.
    #[arg(long, value_name = "FILE")]
    save_soil: Option<PathBuf>,
}

impl SaveSoil {
    /// Refuses a place that cannot be written, before long work is done for it.
    pub fn prepare(&self) -> Result<()> {
        self.save_soil.iter().try_for_each(|path| check_writable(path))
    }

    /// Writes what was found, where that is asked for.
    pub fn write(&self, comparison: &Comparison) -> Result<()> {
        let Some(path) = &self.save_soil else { return Ok(()) };
        let several = |own: &CalibratedParameter| own.variable.name.starts_with("soil in ");
        if comparison.calibrated.iter().any(|(calibration, _)| calibration.parameters.iter().any(several)) {
            bail!(
                "{}: the experiments stand on several soils, and a file is of one; calibrate those on one soil together",
                path.display()
            );
        }
        let soil =
            comparison.soil.as_ref().context("no parameter of the soil was calibrated: there is nothing to save")?;
        write(path, &soil.to_toml()?)?;
        let names: Vec<&str> = soil.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
        say!("  it is {} with their covariance", names.join(", "));
        Ok(())
    }
}
