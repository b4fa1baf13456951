//! `bekker diagnose`.

use crate::diagnosis_text::print;
use crate::experiments::{Experiments, files, write_pages};
use crate::output::{check_all_writable, check_writable, write, write_json};
use crate::progress::Reporter;
use crate::saving::{Saving, print_sources};
use crate::soil_from::SoilFrom;
use crate::windows::Windows;
use crate::{import, interrupt};
use anyhow::{Context, Result, bail};
use bekker::diagnosis::{CompareError, Control, DiagnoseOptions, diagnose};
use bekker::report::{diagnosed_part_page, diagnosis_page};
use std::path::PathBuf;
use std::time::Duration;

/// Find out which physical effect is missing from the model.
#[derive(clap::Args)]
#[command(after_help = import::FORMAT)]
pub struct Diagnose {
    #[command(flatten)]
    experiments: Experiments,
    #[command(flatten)]
    soil: SoilFrom,
    /// Candidate effects, separated by commas; all if not given.
    #[arg(long, value_delimiter = ',', value_name = "EFFECTS")]
    candidates: Option<Vec<String>>,
    /// Effects that are known to act, separated by commas: they are calibrated with the baseline.
    #[arg(long, value_delimiter = ',', value_name = "EFFECTS")]
    with: Vec<String>,
    /// Most effects that are added.
    #[arg(long, default_value_t = 3, value_name = "N")]
    max_effects: usize,
    /// Draws of the bootstrap: p-values are not below 1/(N + 1).
    #[arg(long, default_value_t = 399, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    draws: u32,
    #[command(flatten)]
    windows: Windows,
    /// Threads to work on; all cores if not given. The result does not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    threads: Option<u32>,
    /// Time that the diagnosis may take, in s: it decides what is tried, and what was not is listed. The result then depends
    /// on the clock. The baseline is always calibrated.
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    time: Option<Duration>,
    /// Write the result as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write a self-contained page with plots; of several experiments a page of each with its improved model, the name behind that of the
    /// file.
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    #[command(flatten)]
    saving: Saving,
}

impl Diagnose {
    pub fn run(self) -> Result<()> {
        let (experiment, given) = self.experiments.read()?;
        let given = self.soil.add_to(given)?;
        let saving = self.saving.prepare(&experiment)?;
        check_all_writable([&self.json])?;
        let mut pages = self.html.iter().flat_map(|path| files(&experiment, path));
        pages.try_for_each(|path| check_writable(&path))?;
        if let Some(threads) = self.threads {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads as usize);
            pool.build_global().context("cannot start the threads")?;
        }
        interrupt::listen(interrupt::KEEP)?;
        let options = DiagnoseOptions {
            candidates: self.candidates,
            added: self.with,
            max_effects: self.max_effects,
            draws: self.draws as usize,
            windows: self.windows.count(),
        };
        let reporter = Reporter::start("calibrating the baseline");
        let tell = |at| reporter.tell(at);
        let control = Control { progress: &tell, stop: &interrupt::stopped, budget: self.time, ..Control::default() };
        let diagnosis = diagnose(given, &experiment, &options, &control);
        drop(reporter);
        let diagnosis = match diagnosis {
            Err(CompareError::Interrupted) => interrupt::with_nothing(
                &CompareError::Interrupted,
                [&self.json, &self.html].into_iter().flatten().chain(saving.path()),
            ),
            diagnosis => diagnosis?,
        };
        print_sources(&diagnosis.sources, "")?;
        print(&diagnosis)?;
        if let Some(path) = &self.json {
            write_json(path, &diagnosis.to_json())?;
        }
        if let Some(path) = &self.html {
            if experiment.parts.is_empty() {
                write(path, &diagnosis_page(&diagnosis))?;
            } else {
                write_pages(&experiment, path, |part| diagnosed_part_page(&diagnosis, part))?;
            }
        }
        saving.write_all(&diagnosis.improved, &diagnosis.improved_parts, &diagnosis.improved_is())
    }
}

/// A positive time in seconds.
fn seconds(text: &str) -> Result<Duration> {
    match text.parse::<f64>().ok().and_then(|seconds| Duration::try_from_secs_f64(seconds).ok()) {
        Some(time) if !time.is_zero() => Ok(time),
        _ => bail!("expected a positive number of seconds"),
    }
}
