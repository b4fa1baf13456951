//! `bekker separate`.

use crate::experiments::Experiments;
use crate::import;
use crate::output::{check_all_writable, say, write_json};
use crate::progress::Reporter;
use crate::saving::print_sources;
use crate::soil_from::SoilFrom;
use anyhow::Result;
use bekker::diagnosis::{
    EffectSight, NoiseSource, SeparateOptions, Separation, SmallestStrength, determined_in_words, separate,
};
use std::path::PathBuf;

/// See what an experiment, made or planned, can tell apart, what it determines of the soil, and which tests would determine the rest.
///
/// Measured columns of its CSV files may be empty.
#[derive(clap::Args)]
#[command(after_help = import::FORMAT)]
pub struct Separate {
    #[command(flatten)]
    experiments: Experiments,
    #[command(flatten)]
    soil: SoilFrom,
    /// Effects to look at, separated by commas; all if not given.
    #[arg(long, value_delimiter = ',', value_name = "EFFECTS")]
    candidates: Option<Vec<String>>,
    /// Effects that are known to act, separated by commas: their parameters are free in the baseline.
    #[arg(long, value_delimiter = ',', value_name = "EFFECTS")]
    with: Vec<String>,
    /// Look from the given parameters, even where there are measurements to calibrate to.
    #[arg(long)]
    as_given: bool,
    /// Write the result as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

impl Separate {
    pub fn run(self) -> Result<()> {
        let (experiment, given) = self.experiments.read_plan()?;
        let given = self.soil.add_to(given)?;
        check_all_writable([&self.json])?;
        let options = SeparateOptions { candidates: self.candidates, added: self.with, calibrate: !self.as_given };
        let reporter = Reporter::start("looking at what the experiment can tell apart");
        let separation = separate(given, &experiment, &options);
        drop(reporter);
        let separation = separation?;
        print(&separation)?;
        if let Some(path) = &self.json {
            write_json(path, &separation.to_json())?;
        }
        Ok(())
    }
}

/// Prints what an experiment can tell apart.
pub fn print(separation: &Separation) -> Result<()> {
    let place = if separation.calibrated { "calibrated to it" } else { "at the given parameters" };
    say!("{}: what it can tell apart, the model {place}", separation.name);
    print_sources(&separation.sources, "")?;
    let planned = separation.noise.values().any(|noise| noise.source == NoiseSource::Default);
    let note = if planned { " (default: usual instruments; every row counts as independent)" } else { "" };
    say!("noise of one sample{note}:");
    for (signal, noise) in &separation.noise {
        say!("  {signal:22} {:.3e} ({})", noise.model.deviation, noise.source.name());
    }
    let absorbing: Vec<&str> = separation.absorbing.iter().map(|(name, _)| name.as_str()).collect();
    say!("calibration may absorb what it can of an effect with {}", absorbing.join(", "));
    say!("{:22} {:>8}  smallest strength that would be found", "effect", "visible");
    for sight in &separation.effects {
        say!("{:22} {:>6.1} %  {}", sight.effect, 100.0 * sight.visible_share, strength(sight));
    }
    if !separation.invisible.is_empty() {
        say!("without any signature, so invisible to this experiment: {}", separation.invisible.join(", "));
    }
    let mut ties = separation.ties().peekable();
    if ties.peek().is_none() {
        say!("no two visible effects look alike (cosine over 0.8)");
    } else {
        say!("pairs that look alike (cosine over 0.8) or the same (over 0.99):");
    }
    for pair in ties {
        say!("  {:44} {:.3} {}", pair.effects.join(" and "), pair.cosine, pair.likeness.name());
    }
    print_determined(separation)
}

/// Prints what an experiment determines of its free parameters, and the tests that would determine the rest.
fn print_determined(separation: &Separation) -> Result<()> {
    for words in determined_in_words(&separation.identified) {
        say!("{words}");
    }
    if !separation.additions.is_empty() {
        say!("cheapest additions, each on a bed prepared anew:");
    }
    for addition in &separation.additions {
        let open = if addition.open.is_empty() {
            String::new()
        } else {
            format!("; still open: {}", addition.open.join(", "))
        };
        say!("  {}: determines {}{open}", addition.text, addition.determines.join(", "));
    }
    Ok(())
}

fn strength(sight: &EffectSight) -> String {
    if sight.smallest.is_empty() {
        return if sight.visible {
            format!("visible at some strength (size up to {:.0} standard deviations)", sight.size)
        } else {
            "cannot be seen within its bounds".to_owned()
        };
    }
    let one = |strength: &SmallestStrength| {
        let (name, unit) = (&strength.variable.name, strength.variable.unit.symbol);
        let unit = if unit == "1" { String::new() } else { format!(" {unit}") };
        let bounds = format!("bounds {} .. {}", strength.variable.min, strength.variable.max);
        match strength.value {
            Some(value) => format!("{name} = {value:.3e}{unit} ({bounds})"),
            None => format!("{name} cannot be seen within its bounds ({bounds}{unit})"),
        }
    };
    sight.smallest.iter().map(one).collect::<Vec<_>>().join(", ")
}
