//! `bekker simulate`.

use crate::model::{ModelArguments, assignment};
use crate::progress;
use anyhow::{Context, Result, anyhow, bail};
use bekker::measurement::{Record, Table};
use bekker::model::{Model, Run, Summary, SummaryBuilder};
use bekker::modeldescription::Lookup;
use bekker::simulation::Status;
use std::path::PathBuf;

/// Drive a rover and write its signals as CSV.
#[derive(clap::Args)]
pub struct Simulate {
    #[command(flatten)]
    model: ModelArguments,
    /// Length of the run in seconds; the model's own where missing.
    #[arg(long)]
    duration: Option<f64>,
    /// Hold an input at a value, for example velocity_command=0.2; may be given several times.
    #[arg(long = "input", value_name = "NAME=VALUE")]
    inputs: Vec<String>,
    /// Inputs over time: a CSV with the columns `time` and inputs by name, each row held until the next.
    #[arg(long, value_name = "FILE")]
    input_file: Option<PathBuf>,
    /// Time between two recorded rows, in seconds.
    #[arg(long, default_value_t = 0.02)]
    every: f64,
    /// Signals to record, separated by commas; all where missing.
    #[arg(long, value_delimiter = ',')]
    signals: Option<Vec<String>>,
    /// Where to write the CSV; only the summary is printed where missing.
    #[arg(long)]
    csv: Option<PathBuf>,
}

impl Simulate {
    pub fn run(self) -> Result<()> {
        let model = self.model.load()?;
        let duration = self.duration.unwrap_or(model.stepping.duration);
        if !(duration > 0.0 && duration.is_finite()) {
            bail!("--duration {duration}: expected a finite time of more than 0 s");
        }
        let inputs = match &self.input_file {
            Some(file) => Some(InputTable::read(file, &model)?),
            None => None,
        };
        let mut run = model.start()?;
        for input in &self.inputs {
            let (name, value) = assignment(input)?;
            run.inputs_mut().set(name, value)?;
        }
        let drive = Drive { duration, every: self.every, signals: self.signals.as_deref(), inputs: inputs.as_ref() };
        let (table, summary) = drive.record(&mut run, &model.name)?;
        print_summary(&model.name, &summary, run.status());
        if let Some(path) = &self.csv {
            table.save(path).with_context(|| format!("cannot write `{}`", path.display()))?;
            println!("wrote {} ({} rows)", path.display(), table.rows());
        }
        Ok(())
    }
}

/// How a run is driven and recorded.
struct Drive<'a> {
    duration: f64,
    every: f64,
    signals: Option<&'a [String]>,
    inputs: Option<&'a InputTable>,
}

impl Drive<'_> {
    fn record(&self, run: &mut Run, name: &str) -> Result<(Table, Summary)> {
        let stride = steps("--every", self.every, run.step_size())?;
        let rows = (self.duration / (stride as f64 * run.step_size())).round() as u64;
        let mut record = Record::new(&mut run.signals().clone(), self.signals)?;
        let mut summary = SummaryBuilder::default();
        let bar = progress::bar(rows, name);
        record.push(run.time(), run.signals())?;
        summary.push(run);
        for _ in 0..rows {
            self.advance(run, stride)?;
            record.push(run.time(), run.signals())?;
            summary.push(run);
            bar.inc(1);
            if run.status() != Status::Running {
                break;
            }
        }
        bar.finish_and_clear();
        let figures = summary.summary(run);
        Ok((record.into_table(), figures))
    }

    /// One recorded stretch; inputs from a table change at the inner step that follows their time.
    fn advance(&self, run: &mut Run, stride: u64) -> Result<()> {
        let Some(inputs) = self.inputs else {
            run.advance(stride)?;
            return Ok(());
        };
        for _ in 0..stride {
            inputs.apply(run)?;
            run.advance(1)?;
        }
        Ok(())
    }
}

/// How many inner steps make `seconds`.
fn steps(what: &str, seconds: f64, step_size: f64) -> Result<u64> {
    let ratio = seconds / step_size;
    if ratio.is_finite() && ratio >= 0.5 && (ratio - ratio.round()).abs() < 1e-6 {
        Ok(ratio.round() as u64)
    } else {
        Err(anyhow!("{what} {seconds}: expected a whole multiple of the inner step {step_size} s"))
    }
}

/// Inputs over time.
struct InputTable {
    table: Table,
    names: Vec<String>,
}

impl InputTable {
    fn read(file: &std::path::Path, model: &Model) -> Result<Self> {
        let table = Table::read(file)?;
        let known: Vec<String> = model.inputs().list().into_iter().map(|(variable, _)| variable.name).collect();
        let names: Vec<String> = table.names().iter().filter(|name| *name != "time").cloned().collect();
        if table.column("time").is_none() {
            bail!("`{}`: expected a column `time`", file.display());
        }
        if let Some(strange) = names.iter().find(|name| !known.contains(name)) {
            bail!("`{}`: column `{strange}` is no input of this model ({})", file.display(), known.join(", "));
        }
        Ok(Self { table, names })
    }

    /// Sets the inputs to the last row whose time has come.
    fn apply(&self, run: &mut Run) -> Result<()> {
        let Some(times) = self.table.column("time") else { return Ok(()) };
        let now = run.time() + 1e-9;
        let Some(row) = times.partition_point(|time| *time <= now).checked_sub(1) else { return Ok(()) };
        for name in &self.names {
            if let Some(value) = self.table.value(name, row) {
                run.inputs_mut().set(name, value)?;
            }
        }
        Ok(())
    }
}

fn print_summary(name: &str, summary: &Summary, status: Status) {
    println!("{name}: {:.2} m in {:.2} s, {:.1} cm/s", summary.distance, summary.time, 100.0 * summary.speed);
    println!(
        "  mean slip {:.1} %, power dissipated {:.2} W, electrical {:.2} W, {:.1} J/m, largest pitch {:.1} deg",
        100.0 * summary.slip,
        summary.power,
        summary.electrical_power,
        summary.energy_per_metre,
        summary.largest_pitch.to_degrees()
    );
    if let Status::Ended(event) = status {
        println!("  ended early: {event}");
    }
}
