//! `bekker diagnose`.

use crate::diagnosis_text::print;
use crate::model::ModelArguments;
use crate::output::{check_all_writable, say, write, write_json};
use crate::{import, interrupt, progress};
use anyhow::{Context, Result};
use bekker::diagnosis::{Control, DiagnoseOptions, Progress, diagnose};
use bekker::report::diagnosis_page;
use std::path::PathBuf;

/// Find out which physical effect is missing from the model.
#[derive(clap::Args)]
#[command(after_help = import::FORMAT)]
pub struct Diagnose {
    /// Folder of the experiment, with `experiment.toml` and CSV files.
    experiment: PathBuf,
    #[command(flatten)]
    model: ModelArguments,
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
    /// Threads to work on; all cores if not given. The result does not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    threads: Option<u32>,
    /// Write the result as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write a self-contained page with plots.
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// Write the improved model, ready for `bekker simulate` and `bekker fmu`.
    #[arg(long, value_name = "FILE")]
    save: Option<PathBuf>,
}

impl Diagnose {
    pub fn run(self) -> Result<()> {
        let experiment = import::read(&self.experiment)?;
        let model = self.model.load()?;
        check_all_writable([&self.json, &self.html, &self.save])?;
        if let Some(threads) = self.threads {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads as usize);
            pool.build_global().context("cannot start the threads")?;
        }
        interrupt::listen()?;
        let options = DiagnoseOptions {
            candidates: self.candidates,
            added: self.with,
            max_effects: self.max_effects,
            draws: self.draws as usize,
        };
        let bar = progress::share_bar();
        let tell = |at: Progress| progress::show(&bar, at.stage, at.done, at.total);
        let control = Control { progress: &tell, stop: &interrupt::stopped, ..Control::default() };
        let diagnosis = diagnose(&model, &experiment, &options, &control);
        bar.finish_and_clear();
        let diagnosis = diagnosis?;
        print(&diagnosis)?;
        if let Some(path) = &self.json {
            write_json(path, &diagnosis.to_json())?;
        }
        if let Some(path) = &self.html {
            write(path, &diagnosis_page(&diagnosis))?;
        }
        if let Some(path) = &self.save {
            write(path, &diagnosis.improved.to_toml()?)?;
        }
        if diagnosis.interrupted {
            say!("interrupted: what was not done is missing from this result");
        }
        Ok(())
    }
}
