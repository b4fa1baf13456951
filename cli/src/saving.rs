//! `--save`: the model that a comparison, a calibration or a diagnosis leaves behind.

use crate::experiments::{beside, files};
use crate::output::{check_writable, say, write};
use anyhow::{Result, bail};
use bekker::measurement::{Experiment, Kind};
use bekker::model::{Model, ModelKind};
use std::path::PathBuf;

/// Where the model goes, and on which rover.
#[derive(clap::Args)]
pub struct Saving {
    /// Write the model, ready for any command: of a single wheel that was measured a wheel on a carriage, unless a rover is
    /// named.
    #[arg(long, value_name = "FILE")]
    save: Option<PathBuf>,
    /// Put the wheel, soil and effects of a single-wheel experiment, or the soil of a plate or shear test, on this rover in the saved
    /// model: a model file or the name of a built-in model.
    #[arg(long, value_name = "MODEL", requires = "save")]
    vehicle: Option<String>,
}

impl Saving {
    /// Refuses what cannot be saved, before long work is done for it, and reads the vehicle.
    pub fn prepare(self, experiment: &Experiment) -> Result<Prepared> {
        let mut written = self.save.iter().flat_map(|path| files(experiment, path));
        written.try_for_each(|path| check_writable(&path))?;
        let Some(name) = &self.vehicle else { return Ok(Prepared { path: self.save, vehicle: None }) };
        if !experiment.parts.is_empty() {
            bail!("--vehicle {name}: of several experiments each keeps its own rig; leave --vehicle out");
        }
        if experiment.kind == Kind::Traverse {
            bail!(
                "--vehicle {name}: a traverse is driven by the rover of its own MODEL; --vehicle is for a single wheel or a test of the soil"
            );
        }
        let (vehicle, _) = Model::find(name, None)?;
        if vehicle.kind != ModelKind::Rover {
            bail!("--vehicle {name}: expected a rover, this is a wheel on a carriage or a test of a soil");
        }
        Ok(Prepared { path: self.save, vehicle: Some(vehicle) })
    }
}

/// A checked place, and the vehicle.
pub struct Prepared {
    path: Option<PathBuf>,
    vehicle: Option<Model>,
}

impl Prepared {
    /// The file, where one is asked for.
    pub fn path(&self) -> Option<&PathBuf> {
        self.path.as_ref()
    }

    /// Writes the model or, of several experiments, that of each: its name stands behind that of the file.
    pub fn write_all(&self, model: &Model, parts: &[(String, Model)], what: &str) -> Result<()> {
        if parts.is_empty() {
            return self.write(model, what);
        }
        for (name, model) in parts {
            self.of_part(name).write(model, &format!("{what}, as it is in {name}"))?;
        }
        Ok(())
    }

    /// The same for one of several experiments.
    fn of_part(&self, name: &str) -> Self {
        Self { path: self.path.as_ref().map(|path| beside(path, name)), vehicle: self.vehicle.clone() }
    }

    /// Writes the model, where that is asked for, says what it is, and whether a rover can use what was measured.
    pub fn write(&self, model: &Model, what: &str) -> Result<()> {
        let Some(path) = &self.path else { return Ok(()) };
        let on_vehicle = self.vehicle.as_ref().map(|vehicle| vehicle.with_rig_of(model)).transpose()?;
        let saved = on_vehicle.as_ref().unwrap_or(model);
        write(path, &saved.to_toml()?)?;
        say!("  it is {what}");
        if let Err(unfit) = saved.check_drive() {
            say!("warning: {unfit}");
        }
        Ok(())
    }
}

/// Prints what was taken from where.
pub fn print_sources(sources: &[String], indent: &str) -> Result<()> {
    sources.iter().try_for_each(|line| {
        say!("{indent}note: {line}");
        Ok(())
    })
}
