//! `bekker simulate`.

use crate::carriage::Points;
use crate::model::{ModelArguments, assignment};
use crate::output::{check_writable, say};
use crate::progress;
use anyhow::{Context, Result, anyhow, bail};
use bekker::measurement::{Record, Table};
use bekker::model::{Model, ModelKind, Run, Summary, SummaryBuilder};
use bekker::modeldescription::Lookup;
use bekker::simulation::Status;
use std::path::PathBuf;

/// Time between two recorded rows where none is given, s.
const EVERY: f64 = 0.02;

/// Drive a rover and write its signals as CSV; or the steady points of a wheel on a carriage, one for each row of inputs.
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
    /// Inputs over time: a CSV with the columns `time` and inputs by name, each row held until the next. A wheel on a
    /// carriage needs no `time`: its columns are load (N), slip and wheel_speed (rad/s).
    #[arg(long, value_name = "FILE")]
    input_file: Option<PathBuf>,
    /// Time between two recorded rows, in seconds; 0.02 where missing.
    #[arg(long)]
    every: Option<f64>,
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
        if model.kind == ModelKind::Carriage {
            return self.carriage(&model);
        }
        let every = self.every.unwrap_or(EVERY);
        let inputs = match &self.input_file {
            Some(file) => Some(InputTable::read(file, &model)?),
            None => None,
        };
        let mut run = model.start()?;
        for input in &self.inputs {
            let (name, value) = assignment(input)?;
            if inputs.as_ref().is_some_and(|table| table.names.iter().any(|column| column == name)) {
                bail!("input `{name}` is given twice: by --input and as a column of --input-file");
            }
            run.inputs_mut().set(name, value)?;
        }
        let stride = steps("--every", every, run.step_size())?;
        let rows = rows(self.duration, model.stepping.duration, every)?;
        if let Some(path) = &self.csv {
            check_writable(path)?;
        }
        let drive = Drive { rows, stride, signals: self.signals.as_deref(), inputs: inputs.as_ref() };
        let (table, summary) = drive.record(&mut run, &model.name)?;
        print_summary(&model.name, &summary, run.status())?;
        if let Some(path) = &self.csv {
            table.save(path).with_context(|| format!("cannot write `{}`", path.display()))?;
            say!("wrote {} ({} rows)", path.display(), table.rows());
        }
        Ok(())
    }

    /// Steady points of a wheel on a carriage.
    fn carriage(&self, model: &Model) -> Result<()> {
        if self.duration.is_some() || self.every.is_some() {
            bail!("`{}` is a wheel on a carriage: a steady point has no --duration and no --every", model.name);
        }
        let points = Points::read(&self.inputs, self.input_file.as_deref())?;
        if let Some(path) = &self.csv {
            check_writable(path)?;
        }
        let table = points.solve(model, self.signals.as_deref())?;
        print_points(&model.name, &table)?;
        if let Some(path) = &self.csv {
            table.save(path).with_context(|| format!("cannot write `{}`", path.display()))?;
            say!("wrote {} ({} rows)", path.display(), table.rows());
        }
        Ok(())
    }
}

/// The single point, or lowest and highest values of several.
fn print_points(name: &str, table: &Table) -> Result<()> {
    say!("{name}: {} steady points", table.rows());
    let mut units = bekker::carriage::SteadyPoint::<f64>::default();
    for (variable, _) in units.list() {
        let Some(column) = table.column(&variable.name) else { continue };
        let low = column.iter().copied().fold(f64::INFINITY, f64::min);
        let high = column.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let range = if low == high { format!("{low:.6}") } else { format!("{low:.6} .. {high:.6}") };
        say!("  {} {range} {}", variable.name, variable.unit.symbol);
    }
    Ok(())
}

/// How a run is driven and recorded.
struct Drive<'a> {
    rows: u64,
    stride: u64,
    signals: Option<&'a [String]>,
    inputs: Option<&'a InputTable>,
}

impl Drive<'_> {
    fn record(&self, run: &mut Run, name: &str) -> Result<(Table, Summary)> {
        let mut record = Record::new(&mut run.signals().clone(), self.signals)?;
        let mut summary = SummaryBuilder::default();
        let bar = progress::bar(self.rows, name);
        record.push(run.time(), run.signals())?;
        summary.push(run);
        for _ in 0..self.rows {
            self.advance(run, self.stride)?;
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

/// How many recorded rows follow the start; a model's own duration (`given` is `None`) is rounded to whole rows.
fn rows(given: Option<f64>, own: f64, every: f64) -> Result<u64> {
    let Some(duration) = given else { return Ok(((own / every).round() as u64).max(1)) };
    let ratio = duration / every;
    if ratio.is_finite() && ratio >= 0.5 && (ratio - ratio.round()).abs() < 1e-6 {
        Ok(ratio.round() as u64)
    } else {
        bail!("--duration {duration}: expected a positive whole multiple of --every {every} s")
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
        let Some(times) = table.column("time") else { bail!("`{}`: expected a column `time`", file.display()) };
        if !times.first().is_some_and(|time| *time <= 0.0) {
            bail!(
                "`{}`: expected the first row at time 0 or before, so that inputs are known from the start",
                file.display()
            );
        }
        if !times.is_sorted() {
            bail!("`{}`: expected rows in the order of their `time`", file.display());
        }
        if names.is_empty() {
            bail!("`{}`: expected at least one column of an input ({})", file.display(), known.join(", "));
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

fn print_summary(name: &str, summary: &Summary, status: Status) -> Result<()> {
    let energy = summary.energy_per_metre;
    let energy = if energy.is_finite() { format!("{energy:.1}") } else { "-".to_owned() };
    say!("{name}: {:.2} m in {:.2} s, {:.1} cm/s", summary.distance, summary.time, 100.0 * summary.speed);
    say!(
        "  mean slip {:.1} %, power dissipated {:.2} W, electrical {:.2} W, {energy} J/m, largest pitch {:.1} deg",
        100.0 * summary.slip,
        summary.power,
        summary.electrical_power,
        summary.largest_pitch.to_degrees()
    );
    if let Status::Ended(event) = status {
        say!("  ended early: {event}");
    }
    Ok(())
}
