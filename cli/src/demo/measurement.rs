//! The model against a measured experiment that travels with the program.

use crate::diagnosis_text::print;
use crate::example::FILES;
use crate::output::say;
use anyhow::{Context, Result};
use bekker::diagnosis::{Control, DiagnoseOptions, Given, diagnose};
use bekker::measurement::Experiment;
use bekker::report::diagnosis_page;
use std::path::{Path, PathBuf};

/// Unpacks the experiment, diagnoses it, and writes the page and the improved model.
pub fn run(out: &Path) -> Result<Vec<(PathBuf, &'static str)>> {
    say!("\n3. Which effect is missing? A single wheel at three loads and two speeds, with noise and something hidden");
    let folder = out.join("sand_wheel");
    for (name, text) in FILES {
        let path = folder.join(name);
        let parent = path.parent().unwrap_or(&folder);
        std::fs::create_dir_all(parent).with_context(|| format!("cannot make `{}`", parent.display()))?;
        std::fs::write(&path, text).with_context(|| format!("cannot write `{}`", path.display()))?;
    }
    let experiment = Experiment::read(&folder)?;
    let control = Control::default();
    let diagnosis = diagnose(Given::default(), &experiment, &DiagnoseOptions::default(), &control)?;
    print(&diagnosis)?;
    let page = out.join("sand_wheel.html");
    std::fs::write(&page, diagnosis_page(&diagnosis)).with_context(|| format!("cannot write `{}`", page.display()))?;
    let improved = out.join("improved.toml");
    std::fs::write(&improved, diagnosis.improved.to_toml()?)
        .with_context(|| format!("cannot write `{}`", improved.display()))?;
    Ok(vec![
        (folder, "the experiment"),
        (page, "the diagnosis with all its plots: open it in a browser"),
        (improved, "the improved model, a wheel on a carriage, for any command"),
    ])
}
