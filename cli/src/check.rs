//! `bekker check`.

use crate::output::say;
use anyhow::{Context, Result, bail};
use bekker_fmu_import::{Fmu, FmuDoor};
use bekker_fmu_package::{Options, Version};
use bekker_script::{Core, Door, Script, drive};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};

/// Drive scripted tests and compare what comes with what they expect.
#[derive(clap::Args)]
#[command(
    after_help = "Exit codes: 0 all as expected, 1 something is not, 2 a script could not be read or a drive not be \
                        made.\nThe format of scripts: examples/scripts.md."
)]
pub struct Check {
    /// Scripts (TOML).
    #[arg(required = true, value_name = "SCRIPT")]
    scripts: Vec<PathBuf>,
    /// What to drive; may be given several times or separated by commas. `fmu` is both versions; `environment` needs a
    /// Python with the package bekker.
    #[arg(long, value_delimiter = ',', default_value = "core", value_name = "core|fmu|fmi2|fmi3|environment|all")]
    on: Vec<Target>,
    /// Drive this FMU instead, made by any tool: FMI 2.0 or 3.0 with co-simulation.
    #[arg(long, value_name = "FILE", conflicts_with = "on")]
    fmu: Option<PathBuf>,
    /// Write what the core gives as what the scripts expect from now on, into the files that they name.
    #[arg(long, conflicts_with_all = ["on", "fmu"])]
    record: bool,
    /// The interpreter that has the package bekker.
    #[arg(long, default_value = "python3", value_name = "PROGRAM")]
    python: PathBuf,
}

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Target {
    Core,
    Fmu,
    Fmi2,
    Fmi3,
    Environment,
    All,
}

impl Target {
    /// The doors behind a word.
    fn doors(self) -> &'static [Target] {
        match self {
            Self::Core => &[Self::Core],
            Self::Fmu => &[Self::Fmi2, Self::Fmi3],
            Self::Fmi2 => &[Self::Fmi2],
            Self::Fmi3 => &[Self::Fmi3],
            Self::Environment => &[Self::Environment],
            Self::All => &[Self::Core, Self::Fmi2, Self::Fmi3, Self::Environment],
        }
    }
}

/// Scripts could not be read, or drives not be made.
const TROUBLE: u8 = 2;

impl Check {
    /// Whatever goes wrong with one script is said, and the others are checked all the same.
    pub fn run(&self) -> ExitCode {
        let (mut passed, mut failed, mut trouble) = (0, 0, 0);
        for script in &self.scripts {
            for outcome in self.script(script) {
                match outcome {
                    Ok(true) => passed += 1,
                    Ok(false) => failed += 1,
                    Err(error) => {
                        eprintln!("bekker: {}", crate::message(&error));
                        trouble += 1;
                    }
                }
            }
        }
        let troubled = if trouble > 0 { format!(", {trouble} could not be made") } else { String::new() };
        println!("{passed} as expected, {failed} not{troubled}");
        match (failed, trouble) {
            (0, 0) => ExitCode::SUCCESS,
            (_, 0) => ExitCode::FAILURE,
            _ => ExitCode::from(TROUBLE),
        }
    }

    /// Whether each drive of one script gives what is expected.
    fn script(&self, file: &Path) -> Vec<Result<bool>> {
        if self.record {
            return vec![record(file).map(|()| true)];
        }
        let script = match Script::read(file) {
            Ok(script) => script,
            Err(refused) => return vec![Err(refused.into())],
        };
        if let Some(fmu) = &self.fmu {
            return vec![on_file(&script, fmu)];
        }
        let mut doors: Vec<Target> = Vec::new();
        for door in self.on.iter().flat_map(|target| target.doors()) {
            if !doors.contains(door) {
                doors.push(*door);
            }
        }
        doors.into_iter().map(|door| self.on(&script, door)).collect()
    }

    fn on(&self, script: &Script, door: Target) -> Result<bool> {
        match door {
            Target::Fmi2 => on_own_fmu(script, Version::Fmi2),
            Target::Fmi3 => on_own_fmu(script, Version::Fmi3),
            Target::Environment => on_environment(script, &self.python),
            Target::Core | Target::Fmu | Target::All => judge(script, &mut Core::new(script)),
        }
    }
}

fn judge(script: &Script, door: &mut dyn Door) -> Result<bool> {
    let report = script.check(door).with_context(|| format!("{}", script.file.display()))?;
    say!("{report}");
    Ok(report.passed())
}

/// An FMU file that the user names.
fn on_file(script: &Script, file: &Path) -> Result<bool> {
    let place = || format!("{} on {}", script.file.display(), file.display());
    let fmu = Fmu::open(file).with_context(place)?;
    judge(script, &mut FmuDoor::new(&fmu, script).with_context(place)?)
}

/// An FMU that is packed for this drive.
fn on_own_fmu(script: &Script, version: Version) -> Result<bool> {
    let folder = tempfile::tempdir().context("no folder for the FMU")?;
    let file = folder.path().join("model.fmu");
    bekker_fmu_package::export(&script.model, &Options { version: Some(version), ..Options::default() }, &file)
        .with_context(|| format!("{}", script.file.display()))?;
    on_file(script, &file)
}

/// Drives the gymnasium environment in a Python process, which prints the report.
fn on_environment(script: &Script, python: &Path) -> Result<bool> {
    let output = Command::new(python)
        .args(["-m", "bekker", "check", "--on", "environment"])
        .arg(&script.file)
        .stderr(Stdio::inherit())
        .output()
        .with_context(|| format!("cannot run `{}`, expected a Python interpreter (--python)", python.display()))?;
    let report = String::from_utf8_lossy(&output.stdout);
    // An interpreter without the package ends with 1 too, but reports nothing.
    match output.status.code() {
        Some(code @ (0 | 1)) if !report.is_empty() => {
            say!("{}", report.trim_end());
            Ok(code == 0)
        }
        _ => bail!(
            "{}: the environment could not be driven; `{}` must have the package bekker (--python)",
            script.file.display(),
            python.display()
        ),
    }
}

fn record(file: &Path) -> Result<()> {
    let script = Script::read_to_record(file)?;
    let recording = drive(&script, &mut Core::new(&script)).with_context(|| format!("{}", script.file.display()))?;
    let written = script.write_expected(&recording)?;
    say!("recorded {} samples of {} signals in {}", recording.times.len(), recording.names.len(), written.display());
    Ok(())
}
