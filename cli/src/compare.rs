//! `bekker compare`.

use crate::import;
use crate::model::ModelArguments;
use crate::output::{check_writable, say};
use anyhow::{Context, Result};
use bekker::diagnosis::{Calibration, CompareOptions, Comparison, compare};
use bekker::report::comparison_page;
use std::path::{Path, PathBuf};

/// Run a model on the inputs of an experiment and see where it fails.
#[derive(clap::Args)]
#[command(after_help = import::FORMAT)]
pub struct Compare {
    /// Folder of the experiment, with `experiment.toml` and CSV files.
    experiment: PathBuf,
    #[command(flatten)]
    model: ModelArguments,
    /// Calibrate the free parameters first, within their bounds.
    #[arg(long)]
    calibrate: bool,
    /// Switch effects on, separated by commas; their parameters and the free ones are calibrated.
    #[arg(long, value_delimiter = ',', value_name = "EFFECTS")]
    with: Vec<String>,
    /// Write a self-contained page with overlay and residual plots.
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
}

impl Compare {
    pub fn run(self) -> Result<()> {
        let experiment = import::read(&self.experiment)?;
        let model = self.model.load()?;
        if let Some(path) = &self.html {
            check_writable(path)?;
        }
        let calibrate = self.calibrate || !self.with.is_empty();
        let comparison = compare(&model, &experiment, &CompareOptions { calibrate, added: self.with })?;
        print(&comparison, "")?;
        if let Some(path) = &self.html {
            write_page(&comparison, path)?;
            say!("wrote {}", path.display());
        }
        Ok(())
    }
}

/// Writes the page of a comparison.
pub fn write_page(comparison: &Comparison, path: &Path) -> Result<()> {
    std::fs::write(path, comparison_page(comparison)).with_context(|| format!("cannot write `{}`", path.display()))
}

/// Prints errors, free parameters, and where the model fails most; every line starts with `indent`.
pub fn print(comparison: &Comparison, indent: &str) -> Result<()> {
    say!("{indent}{}: {} runs", comparison.experiment.name, comparison.experiment.runs.len());
    print_errors(comparison, indent)?;
    if let Some((calibration, _)) = &comparison.calibrated {
        print_parameters(calibration, indent)?;
    }
    say!("{indent}where it fails most (mean residual, measured minus modelled):");
    for failure in comparison.failures.iter().take(4) {
        let (level, noise) = (&failure.level, failure.ratio());
        let noise = noise.map_or_else(|| "noise unknown".to_owned(), |ratio| format!("{ratio:.1} times the noise"));
        say!(
            "{indent}  {:14} {:+.4} where {} = {:.3} .. {:.3} ({noise})",
            failure.signal,
            level.mean,
            failure.condition,
            level.low,
            level.high
        );
    }
    Ok(())
}

pub fn print_errors(comparison: &Comparison, indent: &str) -> Result<()> {
    say!("{indent}{:16} {:>12} {:>12} {:>12}", "error (RMS, SI)", "as given", "calibrated", "noise floor");
    let cell = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.5}"));
    for (signal, best) in &comparison.fit().rmse {
        let given = comparison.given.as_ref().ok().and_then(|fit| fit.rmse.get(signal).copied());
        let calibrated = comparison.calibrated.as_ref().map(|_| *best);
        let floor = comparison.noise_floor.get(signal).and_then(|floor| floor.value());
        say!("{indent}{signal:16} {:>12} {:>12} {:>12}", cell(given), cell(calibrated), cell(floor));
    }
    if let Err(error) = &comparison.given {
        say!("{indent}the given parameters cannot compute this experiment: {error}");
    }
    Ok(())
}

pub fn print_parameters(calibration: &Calibration, indent: &str) -> Result<()> {
    say!(
        "{indent}calibrated (chi-square {:.0} for {} degrees of freedom; {} of {} searches agree):",
        calibration.chi_square,
        calibration.degrees_of_freedom,
        calibration.agreeing,
        calibration.searches
    );
    for parameter in &calibration.parameters {
        let deviation = parameter.deviation.map_or_else(String::new, |deviation| format!(" +- {deviation:.3e}"));
        let variable = &parameter.variable;
        let bound = if parameter.at_bound { "  ON ITS BOUND" } else { "" };
        let width = variable.max - variable.min;
        // A deviation wider than the bounds says no more than the bounds do.
        let undetermined =
            parameter.deviation.map_or(!parameter.at_bound, |deviation| deviation.is_nan() || deviation > width);
        let unknown = if undetermined { "  NOT DETERMINED" } else { "" };
        say!(
            "{indent}  {:20} {:.4e}{deviation} {} (from {:.4e}, bounds {:e} .. {:e}){bound}{unknown}",
            variable.name,
            parameter.value,
            variable.unit.symbol,
            parameter.start,
            variable.min,
            variable.max
        );
    }
    if calibration.agreeing < 2 {
        say!(
            "{indent}warning: only one search found this best cost; it may not be the least, and another set of parameters may fit better"
        );
    }
    Ok(())
}
