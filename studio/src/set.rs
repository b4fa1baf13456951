//! A set of open experiments that are fitted together, put together on the page.

use crate::bench::Bench;
use crate::error::Refusal;
use crate::options::Opened;
use crate::state::Studio;
use bekker::diagnosis::Given;
use bekker::measurement::{Experiment, Share};
use serde::Deserialize;
use std::sync::Arc;

/// What is asked for.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Asked {
    /// Ids of open experiments, each a single one.
    experiments: Vec<String>,
    /// Relative standard deviation of the soil from one to the next; the usual one where it is not given.
    #[serde(default)]
    soil_scatter: Option<f64>,
    /// What they share; what their folders say where it is not given.
    #[serde(default)]
    share: Option<Vec<Share>>,
}

/// Opens the set beside its experiments: the same as `bekker studio` opens for their folders.
pub fn open(studio: &Studio, asked: &Asked) -> Result<Arc<Bench>, Refusal> {
    let benches = asked.experiments.iter().map(|id| studio.bench(id)).collect::<Result<Vec<_>, _>>()?;
    if let Some(twice) = asked.experiments.iter().enumerate().find(|(k, id)| asked.experiments[..*k].contains(id)) {
        return Err(Refusal::bad(format!("`{}` is named twice", twice.1)));
    }
    let experiment =
        Experiment::joint(benches.iter().map(|bench| bench.experiment()).collect()).map_err(Refusal::bad)?;
    let mut given = Given::of_several(&benches.iter().map(|bench| bench.given.clone()).collect::<Vec<_>>())?;
    if let Some(share) = &asked.share {
        given = given.with_share(share);
    }
    if let Some(scatter) = asked.soil_scatter {
        given = given.with_soil_scatter(scatter)?;
    }
    studio.open(Opened { experiment, given, example: false }).map_err(Refusal::bad)
}
