//! `bekker demo`: the whole tool in one command.

mod chapter4;
mod measurement;

use crate::output::say;
use anyhow::{Context, Result};
use bekker::model::Model;
use std::path::PathBuf;

/// Chapter 4's rover under both controllers, an FMU, and the diagnosis of a wheel experiment.
#[derive(clap::Args)]
pub struct Demo {
    /// Folder to write to.
    #[arg(long, default_value = "bekker-out")]
    out: PathBuf,
}

impl Demo {
    pub fn run(self) -> Result<()> {
        std::fs::create_dir_all(&self.out).with_context(|| format!("cannot make `{}`", self.out.display()))?;
        let mut written = chapter4::run(&self.out)?;
        say!("\n2. An FMU of the rover under rough-terrain control");
        let fmu = self.out.join("gentle_rtc.fmu");
        bekker_fmu_package::export(&Model::preset("gentle_rtc")?, &bekker_fmu_package::Options::default(), &fmu)?;
        say!("   FMI 3.0, co-simulation; load it with FMPy or any tool that takes FMI 3.0.");
        written.push((fmu, "the rover under rough-terrain control as an FMU"));
        written.extend(measurement::run(&self.out)?);
        say!("\nWritten:");
        for (path, what) in &written {
            say!("   {:40} {what}", path.display().to_string());
        }
        say!("\nNext: open the page of the diagnosis; then");
        say!("   bekker parameters gentle_rtc                     every parameter, its unit, range and source");
        say!("   bekker simulate gentle_rtc --csv drive.csv       your own drive (--set soil.cohesion=500 ..)");
        say!("   bekker diagnose YOUR_FOLDER --html report.html   your own measurements");
        Ok(())
    }
}
