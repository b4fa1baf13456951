//! The model against a measured experiment that travels with the program.

use crate::compare::{print, write_page};
use crate::output::say;
use anyhow::{Context, Result};
use bekker::diagnosis::{CompareOptions, Comparison, compare};
use bekker::measurement::Experiment;
use bekker::model::Model;
use std::path::{Path, PathBuf};

/// Files of `examples/sand_wheel`, embedded so that the demo works wherever the program was installed.
const FILES: &[(&str, &str)] = &include!(concat!(env!("OUT_DIR"), "/sand_wheel.rs"));

/// Unpacks the experiment, compares, and writes the page.
pub fn run(out: &Path) -> Result<Vec<(PathBuf, &'static str)>> {
    say!("\n3. The model against measurements: a single wheel at three loads and two speeds");
    let folder = out.join("sand_wheel");
    for (name, text) in FILES {
        let path = folder.join(name);
        let parent = path.parent().unwrap_or(&folder);
        std::fs::create_dir_all(parent).with_context(|| format!("cannot make `{}`", parent.display()))?;
        std::fs::write(&path, text).with_context(|| format!("cannot write `{}`", path.display()))?;
    }
    let experiment = Experiment::read(&folder)?;
    let comparison = compare(
        &Model::preset("two_wheeled")?,
        &experiment,
        &CompareOptions { calibrate: true, ..CompareOptions::default() },
    )?;
    print(&comparison, "   ")?;
    judge(&comparison)?;
    let page = out.join("sand_wheel.html");
    write_page(&comparison, &page)?;
    Ok(vec![(folder, "the experiment"), (page, "overlay and residual plots: open it in a browser")])
}

/// Says what the errors mean beside the noise floor.
fn judge(comparison: &Comparison) -> Result<()> {
    let ratio = |(signal, error): (&String, &f64)| {
        comparison.noise_floor.get(signal).and_then(|floor| floor.value()).map(|floor| error / floor)
    };
    let worst = comparison.fit().rmse.iter().filter_map(ratio).fold(0.0_f64, f64::max);
    if worst > 1.2 {
        say!(
            "   After calibration the error is still up to {worst:.1} times the noise: no soil parameters explain these\n   \
             data, so a physical effect is missing from the model."
        );
    } else {
        say!("   After calibration the error is at the noise floor ({worst:.1} times): nothing is missing.");
    }
    Ok(())
}
