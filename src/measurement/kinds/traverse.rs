//! Files of a rover on a profile: one time series a run.

use super::super::columns::{Column, Use, column, sinkage, slip, velocity, wheel_speed, within};
use super::super::doubts::Doubts;
use super::super::drive;
use super::super::error::{ExperimentError, Problem};
use super::super::experiment::{Experiment, Kind};
use super::super::grid::Grid;
use super::super::import::{Entry, FoundColumn, Plan, Survey, To, USUAL_WHEELS};
use super::super::reading::missing_column;
use super::super::sheet::Sheet;
use super::super::straight;
use super::super::suggestion::{Rule, maybe, sure};
use super::super::suspicion;
use super::super::vocabulary::{numbered, unit_in};
use super::Format;
use crate::signals::{BodySignals, LinkSignals, Signals, WheelSignals};
use crate::vehicle::MAX_COORDINATES;
use bekker_modeldescription::{Lookup, Unit, Variable};
use std::f64::consts::PI;

/// Signals of single wheels that may be recorded as one sum over several of them, say the current of one motor driver.
const SUMMED: [&str; 4] = ["current", "torque", "normal_force", "drawbar_pull"];

/// Fields of wheels by which a rover was told to move, and measured ones that stand in where there are none.
const COMMANDS: [&str; 3] = ["speed_command", "torque_command", "rim_speed_command"];
const MEASURED_SPEEDS: [&str; 2] = ["speed", "rim_speed"];

/// The format of a traverse.
pub(super) struct Traverse;

impl Format for Traverse {
    /// A time series needs some rows to be one.
    fn least_rows(&self) -> usize {
        10
    }

    fn signal_unit(&self, name: &str) -> Option<Unit> {
        match (name, numbered(name)) {
            ("time", _) => Some(Unit::SECOND),
            (_, Some(("wheel", "rim_speed" | "rim_speed_command", _))) => Some(Unit::METRE_PER_SECOND),
            (_, Some(("wheel", "speed_command", _))) => Some(Unit::RADIAN_PER_SECOND),
            (_, Some(("wheel", "torque_command", _))) => Some(Unit::NEWTON_METRE),
            (_, Some(("wheel", field, wheels))) if wheels.len() == 1 || SUMMED.contains(&field) => {
                unit_in(WheelSignals::default(), field)
            }
            (_, Some(("link", field, links))) if links.len() == 1 => unit_in(LinkSignals::default(), field),
            (_, None) => unit_in(BodySignals::default(), name).or_else(|| straight::unit_of(name)),
            _ => None,
        }
    }

    fn signal_names(&self) -> Vec<String> {
        let plain = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        let mut names = plain(&["time", "wheel[k].speed_command", "wheel[k].torque_command"]);
        names.extend(BodySignals::default().list().into_iter().map(|(variable, _)| variable.name));
        let fields = |part: &str, list: Vec<(Variable, f64)>| {
            list.into_iter().map(|(variable, _)| format!("{part}[k].{}", variable.name)).collect::<Vec<_>>()
        };
        names.extend(fields("wheel", WheelSignals::default().list()));
        names.extend(plain(&["wheel[k].rim_speed", "wheel[k].rim_speed_command"]));
        names.extend(fields("link", LinkSignals::default().list()));
        names.extend(plain(&straight::OF_ROUTE.map(|(name, _)| name)));
        names
    }

    fn columns(&self, names: &[String], radius: f64) -> Vec<Column> {
        let (wheels, links) = (wheels(names), links(names));
        let drive = |field: &str, used: Use| if driving(names).contains(&field) { used } else { Use::Measured };
        let mut columns = vec![column("time", Use::Time, None)];
        for k in 1..=wheels {
            columns.push(column(format!("wheel[{k}].speed_command"), Use::Input, wheel_speed(radius)));
            columns.push(column(format!("wheel[{k}].torque_command"), Use::Input, None));
            columns.push(column(format!("wheel[{k}].rim_speed_command"), Use::Intermediate, velocity()));
        }
        let mut signals = Signals::<f64>::of(wheels, links);
        for (variable, _) in signals.list() {
            let field = variable.name.rsplit('.').next().unwrap_or_default();
            let limits = match field {
                "slip" => slip(),
                "sinkage" => sinkage(radius),
                "speed" => wheel_speed(radius),
                "pitch" | "contact_angle" | "angle" => {
                    within(PI, "an angle in rad within -pi .. pi (degrees?)", Some("deg"))
                }
                "velocity" => velocity(),
                _ => None,
            };
            let used = if variable.name.starts_with("wheel[") { drive(field, Use::Input) } else { Use::Measured };
            columns.push(column(variable.name, used, limits));
        }
        // Missing rim speeds are missing wheel speeds, which may be where they do not drive.
        let rim = drive("rim_speed", Use::Intermediate);
        columns.extend((1..=wheels).map(|k| column(format!("wheel[{k}].rim_speed"), rim, velocity())));
        let sums = names.iter().filter(|name| {
            let several = numbered(name).is_some_and(|(_, _, n)| n.len() > 1 && n.iter().all(|k| *k <= wheels));
            several && self.signal_unit(name).is_some()
        });
        columns.extend(sums.map(|name| column(name, Use::Measured, None)));
        columns.extend(straight::columns());
        columns
    }

    fn required(&self) -> &'static [(&'static str, &'static str)] {
        &[("time", ", or a column with `time_stamp = true` under [columns]")]
    }

    fn check_commands(&self, sheet: &Sheet, names: &[String]) -> Result<(), ExperimentError> {
        let commands = |what: &str| names.iter().filter(|n| n.ends_with(what)).count();
        let (speeds, torques) = (commands(".speed_command"), commands(".torque_command"));
        let measured = names.iter().any(|name| name == "wheel[1].speed");
        if speeds + torques == 0 && !measured {
            let instead = " or `wheel[1].torque_command`, or the measured `wheel[k].speed` of every wheel";
            return Err(missing_column(sheet, Kind::Traverse, "wheel[1].speed_command", instead));
        }
        if speeds > 0 && torques > 0 {
            return Err(sheet
                .error(Problem::Header("speed and torque commands in one run; give one of them"))
                .at_line(sheet.header_line));
        }
        Ok(())
    }

    fn complete(&self, grid: &mut Grid, doubts: &mut Doubts) -> Result<(), ExperimentError> {
        drive::fill(grid, &MEASURED_SPEEDS, doubts)
    }

    fn check_rows(&self, _: &Grid, _: f64) -> Result<(), ExperimentError> {
        Ok(())
    }

    /// Commands may come from a feedback loop and differ.
    fn check_repeats(&self, _: &Experiment) -> Result<(), ExperimentError> {
        Ok(())
    }

    fn look(&self, grid: &Grid, radius: Option<f64>, _: Option<f64>) -> Result<Vec<String>, ExperimentError> {
        let own = grid.names();
        own.iter().filter(|name| name.ends_with("].sinkage")).try_for_each(|name| suspicion::sinkage(grid, name))?;
        Ok(suspicion::traverse::look(grid, radius))
    }

    fn look_at_signs(&self, grid: &Grid) -> Vec<String> {
        suspicion::traverse::look_at_signs(grid)
    }

    fn has_course(&self) -> bool {
        true
    }

    fn no_wheels(&self) -> Option<&'static str> {
        None
    }

    fn rules(&self) -> &'static [Rule] {
        RULES
    }

    fn sure_signs(&self) -> &'static [&'static str] {
        &["time"]
    }

    fn signs(&self) -> &'static [&'static str] {
        &[]
    }

    /// Rovers move at up to metres a second.
    fn likely_unit(&self, field: &str, largest: f64) -> Option<&'static str> {
        match field {
            "velocity" | "rim_speed" | "rim_speed_command" => (largest > 20.0).then_some("mm/s"),
            "speed" | "speed_command" => (largest > 30.0).then_some("rpm"),
            "heading" => (largest > 2.0 * PI).then_some("deg"),
            "yaw_rate" => (largest > 5.0).then_some("deg/s"),
            _ => None,
        }
    }

    fn mend<'s>(&self, survey: &'s Survey, found: &mut Vec<(&'s FoundColumn, Entry)>, plan: &mut Plan) {
        drive_by_speed(found);
        one_place(found, plan);
        runs_by_label(survey, found, plan);
    }

    fn missing(&self, found: &[(&FoundColumn, Entry)]) -> Vec<String> {
        let has = |wanted: &str| found.iter().any(|(_, entry)| entry.signal() == Some(wanted));
        let mut missing = Vec::new();
        // Recorded speeds drive the model where there is no command.
        let drives = |signal: &str| {
            let field = numbered(signal).map_or(signal, |(_, field, _)| field);
            COMMANDS.contains(&field) || MEASURED_SPEEDS.contains(&field)
        };
        if !found.iter().any(|(_, entry)| entry.signal().is_some_and(drives)) {
            missing.push(
                "what drives the wheels: a column for speed_command, torque_command or their measured speed".to_owned(),
            );
        }
        if !has("time") {
            missing.push("a column for time".to_owned());
        }
        missing
            .push("`model`, the vehicle: a built-in model (`bekker parameters --models`) or a model file".to_owned());
        missing
    }

    fn mixes_rows(&self) -> bool {
        false
    }

    fn open_settings(&self) -> &'static [&'static str] {
        &["# model = \"two_wheeled_speed\"   # fill in: the vehicle"]
    }
}

/// Fields of wheels that drive a traverse: commands or, where `names` have none, measured speeds.
fn driving(names: &[String]) -> &'static [&'static str] {
    let commanded = |name: &String| numbered(name).is_some_and(|(_, field, _)| COMMANDS.contains(&field));
    if names.iter().any(commanded) { &COMMANDS } else { &MEASURED_SPEEDS }
}

/// How many wheels the commands of a traverse name, or the measured speeds in their place: wheels are numbered from 1
/// without a gap.
fn wheels(names: &[String]) -> usize {
    let driven =
        |k: usize| driving(names).iter().any(|field| names.iter().any(|name| *name == format!("wheel[{k}].{field}")));
    (1..).take_while(|k| driven(*k)).count()
}

/// How many links a traverse measures: as many as the highest number that a column names, no more than a rover may have.
fn links(names: &[String]) -> usize {
    let has = |k: usize| names.iter().any(|n| *n == format!("link[{k}].angle") || *n == format!("link[{k}].rate"));
    (1..=MAX_COORDINATES - 3).rev().find(|k| has(*k)).unwrap_or(0)
}

/// Without a command the recorded speeds of the wheels drive the model.
fn drive_by_speed(found: &mut [(&FoundColumn, Entry)]) {
    if found.iter().any(|(_, entry)| entry.signal().is_some_and(|signal| signal.ends_with("command"))) {
        return;
    }
    for (column, entry) in found.iter_mut() {
        let Some(signal) = entry.signal().map(str::to_owned) else { continue };
        let Some((_, field @ ("speed" | "rim_speed"), numbers)) = numbered(&signal) else { continue };
        // A number in the name is that of the wheel; else the speed is that of all of a side.
        let own = column.name.chars().any(|c| c.is_ascii_digit());
        let wheels = if own { numbers } else { (1..=USUAL_WHEELS).collect() };
        entry.target = To::Wheels(field.to_owned(), wheels);
        entry.guesses.push("there is no command: this recorded speed drives the model".to_owned());
    }
}

/// Positions give `x`: it is left out beside both of them, and one of them alone is.
fn one_place(found: &mut Vec<(&FoundColumn, Entry)>, plan: &mut Plan) {
    let is = |entry: &Entry, name: &str| entry.target == To::Signal(name.to_owned());
    let [east, north] = ["easting", "northing"].map(|name| found.iter().any(|(_, entry)| is(entry, name)));
    let reason = |entry: &Entry| match (east, north) {
        (true, true) => is(entry, "x").then_some("`easting` and `northing` give the way"),
        _ if is(entry, "easting") || is(entry, "northing") => Some("a position needs `easting` and `northing`"),
        _ => None,
    };
    found.retain(|(column, entry)| {
        plan.ignored.extend(reason(entry).map(|reason| (column.name.clone(), reason.to_owned())));
        reason(entry).is_none()
    });
}

/// Where time starts anew, the column that changes there holds the label of the run.
fn runs_by_label<'a>(survey: &'a Survey, found: &mut Vec<(&'a FoundColumn, Entry)>, plan: &mut Plan) {
    let Some(time) = found.iter().find(|(_, entry)| entry.target == To::Signal("time".to_owned())) else { return };
    let name = time.0.name.clone();
    let starts = |sheet: &Sheet, label: usize| {
        let at = sheet.position(&name)?;
        let time = |row: usize| sheet.value(&sheet.rows[row].cells[at]);
        let anew: Vec<usize> = (1..sheet.rows.len()).filter(|row| time(*row) <= time(row - 1)).collect();
        let changes = |row: &usize| sheet.rows[*row].cells[label] != sheet.rows[row - 1].cells[label];
        Some(!anew.is_empty() && anew.iter().all(changes))
    };
    let label = |column: &&FoundColumn| {
        let mut marks = survey.sheets.iter().filter_map(|sheet| starts(sheet, sheet.position(&column.name)?));
        column.distinct(survey.sheets.iter().map(|sheet| sheet.rows.len() / 10).sum()).is_some()
            && marks.any(|mark| mark)
    };
    let taken = |column: &&FoundColumn| !found.iter().any(|(other, _)| other.name == column.name);
    if let Some(column) = survey.columns.iter().filter(taken).find(label) {
        plan.ignored.retain(|(name, _)| *name != column.name);
        found.push((column, Entry::to(To::Run)));
    }
}

/// What words in a column's name mean.
const RULES: &[Rule] = &[
    sure(&["time"], "time"),
    sure(&["timestamp"], "time"),
    maybe(&["stamp"], "time"),
    maybe(&["t"], "time"),
    sure(&["pitch"], "pitch"),
    sure(&["pitch", "rate"], "pitch_rate"),
    sure(&["gyro", "pitch"], "pitch_rate"),
    maybe(&["x"], "x"),
    maybe(&["z"], "z"),
    maybe(&["height"], "z"),
    maybe(&["altitude"], "z"),
    sure(&["velocity"], "velocity"),
    maybe(&["speed"], "velocity"),
    maybe(&["v"], "velocity"),
    sure(&["power"], "electrical_power"),
    sure(&["wheel", "speed"], "speed"),
    sure(&["omega"], "speed"),
    sure(&["rpm"], "speed"),
    maybe(&["encoder"], "speed"),
    maybe(&["wheel", "left"], "speed"),
    maybe(&["wheel", "right"], "speed"),
    sure(&["rim", "speed"], "rim_speed"),
    sure(&["torque"], "torque"),
    sure(&["current"], "current"),
    maybe(&["amps"], "current"),
    maybe(&["i"], "current"),
    sure(&["slip"], "slip"),
    sure(&["sinkage"], "sinkage"),
    sure(&["speed", "command"], "speed_command"),
    sure(&["wheel", "speed", "command"], "speed_command"),
    sure(&["velocity", "command"], "rim_speed_command"),
    sure(&["rim", "speed", "command"], "rim_speed_command"),
    sure(&["torque", "command"], "torque_command"),
    maybe(&["speed", "cmd"], "speed_command"),
    maybe(&["wheel", "speed", "cmd"], "speed_command"),
    maybe(&["torque", "cmd"], "torque_command"),
    maybe(&["command"], "speed_command"),
    maybe(&["cmd"], "speed_command"),
    sure(&["heading"], "heading"),
    maybe(&["yaw"], "heading"),
    sure(&["yaw", "rate"], "yaw_rate"),
    sure(&["gyro", "yaw"], "yaw_rate"),
    maybe(&["gyro", "z"], "yaw_rate"),
    sure(&["easting"], "easting"),
    sure(&["northing"], "northing"),
    maybe(&["utm", "x"], "easting"),
    maybe(&["utm", "y"], "northing"),
    maybe(&["dem", "z"], "ground_height"),
    sure(&["ground", "height"], "ground_height"),
];
