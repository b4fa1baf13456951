//! `bekker parameters`.

use crate::model::ModelArguments;
use anyhow::Result;
use bekker::carriage::SteadyPoint;
use bekker::model::{ModelKind, PRESETS};
use bekker::modeldescription::{Lookup, Variable};
use bekker::soil_test::{SoilTestSignals, TEST_EFFECTS};
use std::io::Write;

/// List every parameter, input and signal of a model: name, value, unit, range, meaning, source.
#[derive(clap::Args)]
pub struct Parameters {
    #[command(flatten)]
    model: ModelArguments,
    /// List the built-in models instead.
    #[arg(long, conflicts_with = "effects")]
    models: bool,
    /// List the effects instead.
    #[arg(long)]
    effects: bool,
    /// Print the model as a TOML file instead, ready to be changed and simulated.
    #[arg(long, conflicts_with_all = ["models", "effects"])]
    toml: bool,
}

impl Parameters {
    pub fn run(self) -> Result<()> {
        let mut out = std::io::stdout().lock();
        if self.models {
            for (name, meaning) in PRESETS {
                writeln!(out, "{name:24} {}", meaning.trim())?;
            }
            return Ok(());
        }
        let mut model = self.model.load()?;
        if self.effects {
            for (name, meaning) in model.rover.effects.list() {
                writeln!(out, "{name:24} {meaning}")?;
            }
            writeln!(out, "# of tests of the soil")?;
            for (name, meaning) in TEST_EFFECTS {
                writeln!(out, "{name:24} {}", meaning.trim())?;
            }
            return Ok(());
        }
        if self.toml {
            write!(out, "{}", model.to_toml()?)?;
            return Ok(());
        }
        writeln!(out, "# Parameters of `{}` (name = value unit [range] meaning; source)", model.name)?;
        for (variable, value) in model.list() {
            let range = format!("{} .. {}", shown(variable.min), shown(variable.max));
            let Variable { name, unit, doc, source, .. } = &variable;
            writeln!(out, "{name} = {} {} [{range}] {doc} ({source})", shown(value), unit.symbol)?;
        }
        writeln!(out, "\n# Inputs")?;
        describe(&mut out, model.inputs().list())?;
        writeln!(out, "\n# Signals")?;
        match model.kind {
            ModelKind::Carriage => return describe(&mut out, SteadyPoint::<f64>::default().list()),
            ModelKind::SoilTest => return describe(&mut out, SoilTestSignals::<f64>::default().list()),
            ModelKind::Rover => {}
        }
        let mut signals = model.start()?.signals().clone();
        describe(&mut out, signals.list())
    }
}

fn describe(out: &mut impl Write, variables: Vec<(Variable, f64)>) -> Result<()> {
    for (variable, _) in variables {
        writeln!(out, "{} [{}] {}", variable.name, variable.unit.symbol, variable.doc)?;
    }
    Ok(())
}

/// A number in a form that reads back to the same one.
fn shown(value: f64) -> String {
    if value == 0.0 || (1e-3..1e6).contains(&value.abs()) { format!("{value}") } else { format!("{value:e}") }
}
