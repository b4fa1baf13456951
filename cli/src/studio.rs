//! `bekker studio`.

use crate::model::ModelArguments;
use crate::output::say;
use crate::soil_from::SoilFrom;
use crate::{example, import, interrupt};
use anyhow::{Context, Result};
use bekker::diagnosis::Given;
use bekker::measurement::Experiment;
use bekker::model::Model;
use bekker_studio::{Opened, Options, StudioError};
use std::net::{IpAddr, SocketAddr};
use std::path::PathBuf;

/// Open the workbench: a page in the browser on which a diagnosis is done by looking.
///
/// It runs on this machine, loads nothing from elsewhere, and ends with Ctrl-C. Without an experiment it opens the shipped example.
#[derive(clap::Args)]
#[command(after_help = import::FORMAT)]
pub struct Studio {
    /// Folders of experiments, each with `experiment.toml` and CSV files.
    experiments: Vec<PathBuf>,
    /// The model beside the experiments: a model file (TOML) or the name of a built-in model.
    #[arg(long, value_name = "MODEL")]
    model: Option<String>,
    /// Add effects of your own: a TOML file with `[[effect]]` tables; may be given several times.
    #[arg(long, value_name = "FILE")]
    effects_from: Vec<PathBuf>,
    /// Set a parameter by its name, SI units; may be given several times.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    changes: Vec<String>,
    #[command(flatten)]
    soil: SoilFrom,
    /// Port to listen on; 8137 or, where that is taken, a free one if not given.
    #[arg(long, value_name = "N")]
    port: Option<u16>,
    /// Address to listen on. Any other than the loopback interface's can be reached from other machines, which then need the token in
    /// the address that is printed.
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1")]
    bind: IpAddr,
}

impl Studio {
    pub fn run(self) -> Result<()> {
        let arguments = ModelArguments::of(self.model, self.effects_from, self.changes);
        let given = self.soil.add_to(arguments.given()?)?;
        let experiments = if self.experiments.is_empty() {
            vec![shipped(given)?]
        } else {
            let opened = |folder: &PathBuf| {
                let experiment = import::read(folder)?;
                Ok(Opened { experiment, given: given.clone(), example: false })
            };
            self.experiments.iter().map(opened).collect::<Result<_>>()?
        };
        interrupt::listen("the workbench ends")?;
        let options = Options { experiments, fmu: Some(pack), ..Options::default() };
        let at = |port| Options { address: SocketAddr::new(self.bind, port), ..options.clone() };
        let usual = options.address.port();
        let studio = match bekker_studio::Studio::start(at(self.port.unwrap_or(usual))) {
            // Another workbench runs already.
            Err(StudioError::Bind { .. }) if self.port.is_none() => bekker_studio::Studio::start(at(0)),
            started => started,
        }?;
        say!("The workbench is open at {}", studio.url());
        if !self.bind.is_loopback() {
            say!("Other machines can reach it; whoever has this address may use it. Nothing is encrypted.");
        }
        say!("Ctrl-C ends it.");
        Ok(studio.run(interrupt::stopped)?)
    }
}

/// The experiment that travels with the program.
fn shipped(given: Given) -> Result<Opened> {
    let texts = example::FILES.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect();
    let experiment = Experiment::from_texts(&texts).context("the shipped example")?;
    Ok(Opened { experiment, given, example: true })
}

fn pack(model: &Model) -> Result<Vec<u8>, String> {
    bekker_fmu_package::pack(model, &bekker_fmu_package::Options::default()).map_err(|error| error.to_string())
}
