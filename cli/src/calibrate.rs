//! `bekker calibrate`.

use crate::compare::{print_errors, print_parameters};
use crate::experiments::Experiments;
use crate::import;
use crate::output::{check_all_writable, say, write_json};
use crate::progress::Reporter;
use crate::saving::{Saving, print_sources};
use crate::soil_from::{SaveSoil, SoilFrom};
use crate::windows::Windows;
use anyhow::{Context, Result};
use bekker::diagnosis::{Calibration, Comparison, compare, determined_in_words};
use serde_json::{Map, Value, json};
use std::path::PathBuf;

/// Fit a model's free parameters to an experiment, within their bounds.
#[derive(clap::Args)]
#[command(after_help = import::FORMAT)]
pub struct Calibrate {
    #[command(flatten)]
    experiments: Experiments,
    #[command(flatten)]
    soil: SoilFrom,
    /// Switch effects on, separated by commas; their parameters are calibrated too.
    #[arg(long, value_delimiter = ',', value_name = "EFFECTS")]
    with: Vec<String>,
    #[command(flatten)]
    windows: Windows,
    #[command(flatten)]
    saving: Saving,
    #[command(flatten)]
    save_soil: SaveSoil,
    /// Write parameters and errors as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

impl Calibrate {
    pub fn run(self) -> Result<()> {
        let (experiment, given) = self.experiments.read()?;
        let given = self.soil.add_to(given)?;
        let saving = self.saving.prepare(&experiment)?;
        check_all_writable([&self.json])?;
        self.save_soil.prepare()?;
        let reporter = Reporter::start("calibrating the model");
        let comparison = compare(given, &experiment, &self.windows.options(true, self.with));
        drop(reporter);
        let comparison = comparison?;
        let (calibration, _) = comparison.calibrated.as_ref().context("there was nothing to calibrate")?;
        say!("{}: {} runs", experiment.name, experiment.runs.len());
        print_sources(&comparison.sources, "")?;
        print_errors(&comparison, "")?;
        print_parameters(calibration, "")?;
        for words in determined_in_words(&comparison.identified) {
            say!("{words}");
        }
        say!("weights (standard deviation of one sample, by which residuals were divided):");
        let wide = calibration.weights.keys().map(String::len).max().unwrap_or(0).max(22);
        for (signal, weight) in &calibration.weights {
            let source = comparison.noise_floor.get(signal).map_or("unknown", |floor| floor.source().name());
            let source = if source == "unknown" { "the signal's own scatter: noise unknown" } else { source };
            say!("  {signal:wide$} {weight:.4e} ({source})");
        }
        for caution in &comparison.cautions {
            say!("caution: {caution}");
        }
        self.save_soil.write(&comparison)?;
        if let Some(path) = &self.json {
            write_json(path, &as_json(&comparison, calibration))?;
        }
        saving.write_all(&comparison.model, &comparison.part_models, "the calibrated model")
    }
}

fn as_json(comparison: &Comparison, calibration: &Calibration) -> Value {
    let parameter = |parameter: &bekker::diagnosis::CalibratedParameter| {
        let variable = &parameter.variable;
        let value = json!({
            "value": parameter.value,
            "start": parameter.start,
            "std": parameter.deviation,
            "at_bound": parameter.at_bound,
            "unit": variable.unit.symbol,
            "bounds": [variable.min, variable.max],
            "prior_shift": parameter.prior_shift(),
        });
        (variable.name.clone(), value)
    };
    let floors = comparison
        .noise_floor
        .iter()
        .map(|(signal, floor)| (signal.clone(), json!({"deviation": floor.value(), "source": floor.source().name()})));
    json!({
        "experiment": comparison.experiment.name,
        "parameters": calibration.parameters.iter().map(parameter).collect::<Map<_, _>>(),
        "weights": calibration.weights,
        "noise_floor": floors.collect::<Map<_, _>>(),
        "sources": comparison.sources,
        "rmse_given": comparison.given.as_ref().ok().map(|fit| &fit.rmse),
        "rmse": comparison.fit().rmse,
        "chi_square": calibration.chi_square,
        "degrees_of_freedom": calibration.degrees_of_freedom,
        "converged": calibration.converged,
        "searches": calibration.searches,
        "agreeing": calibration.agreeing,
        "cautions": comparison.cautions,
        "soil": comparison.soil,
        "identified": comparison.identified,
    })
}
