//! `bekker compare`.

use crate::diagnosis_text::print_uncounted;
use crate::experiments::{Experiments, files, write_pages};
use crate::import;
use crate::output::{check_writable, say};
use crate::progress::Reporter;
use crate::saving::{Saving, print_sources};
use crate::soil_from::SoilFrom;
use crate::windows::Windows;
use anyhow::{Context, Result};
use bekker::diagnosis::{
    Calibration, Comparison, STANDARD_ERROR, UnansweredRows, Uncounted, UncountedRows, compare, determined_in_words,
};
use bekker::report::{comparison_page, part_page};
use std::path::{Path, PathBuf};

/// Run a model on the inputs of an experiment and see where it fails.
#[derive(clap::Args)]
#[command(after_help = import::FORMAT)]
pub struct Compare {
    #[command(flatten)]
    experiments: Experiments,
    #[command(flatten)]
    soil: SoilFrom,
    /// Calibrate the free parameters first, within their bounds.
    #[arg(long)]
    calibrate: bool,
    /// Switch effects on, separated by commas; their parameters and the free ones are calibrated.
    #[arg(long, value_delimiter = ',', value_name = "EFFECTS")]
    with: Vec<String>,
    /// Write a self-contained page with overlay and residual plots; of several experiments one of each.
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    #[command(flatten)]
    windows: Windows,
    #[command(flatten)]
    saving: Saving,
}

impl Compare {
    pub fn run(self) -> Result<()> {
        let (experiment, given) = self.experiments.read()?;
        let given = self.soil.add_to(given)?;
        let saving = self.saving.prepare(&experiment)?;
        let mut pages = self.html.iter().flat_map(|path| files(&experiment, path));
        pages.try_for_each(|path| check_writable(&path))?;
        let calibrate = self.calibrate || !self.with.is_empty();
        let reporter = Reporter::start(if calibrate { "calibrating the model" } else { "running the model" });
        let comparison = compare(given, &experiment, &self.windows.options(calibrate, self.with));
        drop(reporter);
        let comparison = comparison?;
        print(&comparison, "")?;
        match &self.html {
            Some(path) if !experiment.parts.is_empty() => {
                let what = if calibrate { "calibrated together" } else { "compared as given" };
                let found = std::iter::once(what.to_owned()).chain(determined_in_words(&comparison.identified));
                let found = found.collect::<Vec<_>>().join(". ");
                let page = |part| part_page(&experiment, part, &comparison.part_models[part].1, &found);
                write_pages(&experiment, path, page)?;
            }
            Some(path) => {
                write_page(&comparison, path)?;
                say!("wrote {}", path.display());
            }
            None => {}
        }
        let what = if calibrate { "the calibrated model" } else { "the model as it was compared" };
        saving.write_all(&comparison.model, &comparison.part_models, what)
    }
}

/// Writes the page of a comparison.
pub fn write_page(comparison: &Comparison, path: &Path) -> Result<()> {
    std::fs::write(path, comparison_page(comparison)).with_context(|| format!("cannot write `{}`", path.display()))
}

/// Most stretches of rows without an answer that are printed.
const MOST_UNANSWERED: usize = 8;

/// Prints errors, free parameters, and where the model fails most; every line starts with `indent`.
pub fn print(comparison: &Comparison, indent: &str) -> Result<()> {
    say!("{indent}{}: {} runs", comparison.experiment.name, comparison.experiment.runs.len());
    print_sources(&comparison.sources, indent)?;
    print_errors(comparison, indent)?;
    print_unanswered(comparison, "as given", &comparison.given_unanswered, indent)?;
    if comparison.calibrated.is_some() {
        print_unanswered(comparison, "calibrated", &comparison.unanswered, indent)?;
    }
    let others = |rows: &&UncountedRows| rows.why != Uncounted::NoAnswer;
    print_uncounted(&comparison.uncounted.iter().filter(others).cloned().collect::<Vec<_>>(), indent)?;
    for caution in &comparison.cautions {
        say!("{indent}caution: {caution}");
    }
    if let Some((calibration, _)) = &comparison.calibrated {
        print_parameters(calibration, indent)?;
        for words in determined_in_words(&comparison.identified) {
            say!("{indent}{words}");
        }
    }
    say!("{indent}where it fails most (mean residual, measured minus modelled):");
    for failure in comparison.failures.iter().take(4) {
        let (level, noise) = (&failure.level, failure.ratio());
        let place = failure.place().map_or_else(String::new, |place| format!(" at {place}"));
        let noise = noise.map_or_else(|| "noise unknown".to_owned(), |ratio| format!("{ratio:.1} times the noise"));
        say!("{indent}  {:14} {:+.4}{place} ({noise})", failure.signal, level.mean);
    }
    Ok(())
}

pub fn print_errors(comparison: &Comparison, indent: &str) -> Result<()> {
    let wide = comparison.fit().rmse.keys().map(String::len).max().unwrap_or(0).max(16);
    say!("{indent}{:wide$} {:>12} {:>12} {:>12}", "error (RMS, SI)", "as given", "calibrated", "noise floor");
    let cell = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.5}"));
    for (signal, best) in &comparison.fit().rmse {
        let given = comparison.given.as_ref().ok().and_then(|fit| fit.rmse.get(signal).copied());
        let calibrated = comparison.calibrated.as_ref().map(|_| *best);
        let floor = comparison.noise_floor.get(signal).and_then(|floor| floor.value());
        say!("{indent}{signal:wide$} {:>12} {:>12} {:>12}", cell(given), cell(calibrated), cell(floor));
    }
    if let Err(error) = &comparison.given {
        say!("{indent}with the given parameters the model has no answer anywhere: {error}");
    }
    Ok(())
}

/// Prints the rows that the model cannot answer.
fn print_unanswered(comparison: &Comparison, which: &str, unanswered: &[UnansweredRows], indent: &str) -> Result<()> {
    if unanswered.is_empty() {
        return Ok(());
    }
    let count: usize = unanswered.iter().map(UnansweredRows::count).sum();
    let all: usize = comparison.experiment.runs.iter().map(|run| run.data.rows()).sum();
    say!("{indent}{which}, the model has no answer in {count} of {all} rows, which its errors leave out:");
    for rows in unanswered.iter().take(MOST_UNANSWERED) {
        say!("{indent}  {rows}");
    }
    if unanswered.len() > MOST_UNANSWERED {
        say!("{indent}  and {} more", unanswered.len() - MOST_UNANSWERED);
    }
    Ok(())
}

pub fn print_parameters(calibration: &Calibration, indent: &str) -> Result<()> {
    say!(
        "{indent}calibrated (chi-square {:.0} for {} degrees of freedom; {} of {} searches agree; +- is the {STANDARD_ERROR}):",
        calibration.chi_square,
        calibration.degrees_of_freedom,
        calibration.agreeing,
        calibration.searches
    );
    for parameter in &calibration.parameters {
        let deviation = parameter.deviation.map_or_else(String::new, |deviation| format!(" +- {deviation:.3e}"));
        let variable = &parameter.variable;
        let bound = parameter.bound_note().map_or_else(String::new, |note| format!("  {}", note.to_uppercase()));
        let undetermined = parameter.deviation.is_none() && !parameter.at_bound;
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
