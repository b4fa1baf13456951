//! `bekker studio`.

use crate::experiments::{Together, folders_and_model, read_together};
use crate::model::ModelArguments;
use crate::output::say;
use crate::soil_from::SoilFrom;
use crate::{example, import, interrupt};
use anyhow::{Context, Result, bail};
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
    /// Folders of experiments, each with `experiment.toml` and CSV files. Several are fitted together, as by `bekker
    /// diagnose`: they share the soil's parameters, or what --share names, and each keeps its rig and noise. MODEL: a model file (TOML) or the name of a built-in
    /// model; else the one that `experiment.toml` names, or a plain rover or wheel.
    #[arg(value_name = "EXPERIMENT.. [MODEL]")]
    experiments: Vec<PathBuf>,
    /// Open several experiments each by itself; one of them is chosen on the page.
    #[arg(long, conflicts_with_all = ["soil_scatter", "share"])]
    apart: bool,
    /// The model beside the experiments, as MODEL.
    #[arg(long, value_name = "MODEL")]
    model: Option<String>,
    #[command(flatten)]
    together: Together,
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
        let (folders, last) = folders_and_model(&self.experiments);
        if let (Some(last), Some(model)) = (&last, &self.model) {
            bail!("two models are given: {last} and --model {model}");
        }
        let arguments = ModelArguments::of(last.or(self.model), self.effects_from, self.changes);
        let given = self.soil.add_to(arguments.given()?)?;
        let opened = |experiment| -> Result<Opened> {
            let given = self.together.add_to(given.clone(), &experiment)?;
            Ok(Opened { experiment, given, example: false })
        };
        let experiments = match folders {
            [] => vec![Opened { example: true, ..opened(shipped()?)? }],
            folders if self.apart => {
                folders.iter().map(|folder| opened(import::read(folder)?)).collect::<Result<_>>()?
            }
            folders => vec![opened(read_together(folders, import::read)?)?],
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
fn shipped() -> Result<Experiment> {
    let texts = example::FILES.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect();
    Experiment::from_texts(&texts).context("the shipped example")
}

fn pack(model: &Model) -> Result<Vec<u8>, String> {
    bekker_fmu_package::pack(model, &bekker_fmu_package::Options::default()).map_err(|error| error.to_string())
}
