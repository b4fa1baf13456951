//! What is saved: models, and pages that need no server. Of several experiments on one soil each has its own.

use crate::bench::Bench;
use crate::error::Refusal;
use crate::options::FmuPacker;
use crate::trial::part_number;
use bekker::diagnosis::{CompareOptions, Workbench, compare};
use bekker::model::Model;
use bekker::report::shown::Values;
use bekker::report::{comparison_page, diagnosed_part_page, diagnosis_page, part_page};
use serde::Deserialize;

/// Where a saved model comes from.
const FROM: &str = "the model of the workbench";

/// What is asked for.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Asked {
    what: What,
    #[serde(default)]
    values: Values,
    /// Of which of several experiments, by its short name; of the first where it is not given.
    #[serde(default)]
    part: Option<String>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum What {
    /// The model as TOML.
    Toml,
    /// The model as an FMU.
    Fmu,
    /// The page of a comparison with this model.
    Report,
    /// The page of the last diagnosis.
    Diagnosis,
}

/// A file.
pub struct File {
    /// Its content type.
    pub kind: &'static str,
    /// Its name.
    pub name: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

const PAGE: &str = "text/html; charset=utf-8";

/// The file that is asked for.
pub fn export(bench: &Bench, asked: &Asked, fmu: Option<FmuPacker>) -> Result<File, Refusal> {
    let workbench = bench.workbench();
    let part = part_number(&workbench, asked.part.as_deref())?;
    let model = || model(&workbench, part, &asked.values);
    let (kind, ending, bytes) = match asked.what {
        What::Toml => ("application/toml", "toml", model()?.to_toml().map_err(Refusal::bad)?.into_bytes()),
        What::Fmu => {
            let pack = fmu.ok_or_else(|| Refusal::missing("packer of FMUs in this program"))?;
            ("application/octet-stream", "fmu", pack(&model()?).map_err(Refusal::bad)?)
        }
        What::Report => (PAGE, "html", report(bench, &workbench, part, &model()?)?.into_bytes()),
        What::Diagnosis => (PAGE, "html", diagnosed(bench, part)?.into_bytes()),
    };
    let of_part = part.map(|k| format!("-{}", workbench.experiment().parts[k].name)).unwrap_or_default();
    // A header holds ASCII; the page names the file itself.
    let of_part: String = of_part.chars().map(|c| if c.is_ascii() { c } else { '_' }).collect();
    Ok(File { kind, name: format!("{}{of_part}.{ending}", bench.id), bytes })
}

fn model(workbench: &Workbench, part: Option<usize>, values: &Values) -> Result<Model, Refusal> {
    Ok(match part {
        None => workbench.model(values)?,
        Some(k) => workbench.model_of_part(k, values)?,
    })
}

/// The page that `bekker compare` writes for a model.
fn report(bench: &Bench, workbench: &Workbench, part: Option<usize>, model: &Model) -> Result<String, Refusal> {
    let experiment = workbench.experiment();
    if let Some(k) = part {
        return Ok(part_page(experiment, k, model, FROM)?);
    }
    let given = bench.given.clone().with_model(model.clone(), FROM);
    let comparison = compare(given, experiment, &CompareOptions::default())?;
    Ok(comparison_page(&comparison))
}

/// The page that `bekker diagnose` writes for the last search.
fn diagnosed(bench: &Bench, part: Option<usize>) -> Result<String, Refusal> {
    let found = bench.diagnosis().ok_or_else(|| Refusal::missing("diagnosis yet: rank the effects first"))?;
    match part {
        Some(k) => Ok(diagnosed_part_page(&found, k)?),
        None => Ok(diagnosis_page(&found)),
    }
}
