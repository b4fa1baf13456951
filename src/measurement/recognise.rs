//! What the columns of a file are: by the settings, or by their own names.

use super::columns::{Column, Use, mend, quoted};
use super::doubts::Doubts;
use super::error::{ExperimentError, Problem};
use super::experiment::Kind;
use super::mapping::{Factor, Recorded, Scale, Target};
use super::settings::{RunSettings, Settings};
use super::sheet::Sheet;
use super::suggestion;
use super::vocabulary::alike;
use bekker_modeldescription::Unit;

/// A column of a file and what it becomes.
pub(super) struct Recognised {
    /// Index in the file.
    pub position: usize,
    pub target: Target,
}

/// All columns that are for the model.
///
/// # Errors
/// One error that names all unknown columns; one for a column whose unit the file gives otherwise.
pub(super) fn recognised(
    sheet: &Sheet,
    settings: &Settings,
    run: &RunSettings,
    doubts: &mut Doubts,
) -> Result<Vec<Recognised>, ExperimentError> {
    let mut found = Vec::new();
    let mut unknown: Vec<(usize, &String)> = Vec::new();
    for (position, name) in sheet.header.iter().enumerate() {
        if let Some((_, target, _)) = settings.columns.iter().find(|(column, ..)| column == name) {
            found.push(Recognised { position, target: target.clone() });
        } else if settings.ignore.contains(name) {
            continue;
        } else if settings.kind.format().signal_unit(name).is_some() {
            found.push(Recognised {
                position,
                target: Target::Signals(vec![name.clone()], Scale::si(), Recorded::default()),
            });
        } else if !settings.ignores(name) && run.filters.iter().all(|filter| filter.column != *name) {
            unknown.push((position, name));
        }
    }
    let columns = {
        let mut signals: Vec<String> = found.iter().flat_map(|column| names(&column.target)).cloned().collect();
        signals.extend(run.inputs.iter().map(|(name, ..)| name.clone()));
        settings.kind.format().columns(&signals, 1.0)
    };
    let known: Vec<String> = columns.iter().map(|column| column.name.clone()).collect();
    // A signal of a wheel that no command names.
    let beyond = |column: &&Recognised| names(&column.target).iter().any(|name| !known.contains(name));
    unknown.extend(found.iter().filter(beyond).map(|column| (column.position, &sheet.header[column.position])));
    if !unknown.is_empty() {
        unknown.sort_unstable();
        return Err(unknown_columns(sheet, settings.kind, &unknown, &known));
    }
    for column in &found {
        check_unit(sheet, settings.kind, column, doubts)?;
        check_once(sheet, column, &columns)?;
    }
    Ok(found)
}

/// Fails where one sensor is to be compared with several wheels: its values would count several times.
fn check_once(sheet: &Sheet, column: &Recognised, known: &[Column]) -> Result<(), ExperimentError> {
    let measured = |name: &String| known.iter().any(|known| known.name == *name && known.used == Use::Measured);
    let signals = names(&column.target);
    if signals.len() > 1 && signals.iter().any(measured) {
        let problem = "one measured speed for several wheels drives them where there is no command; beside commands give it to one wheel";
        let name = &sheet.header[column.position];
        return Err(sheet.error(Problem::Header(problem)).at_line(sheet.header_line).at_column(name));
    }
    Ok(())
}

/// The signals that a column gives.
pub(super) fn names(target: &Target) -> &[String] {
    match target {
        Target::Signals(names, ..) => names,
        _ => &[],
    }
}

fn unknown_columns(sheet: &Sheet, kind: Kind, unknown: &[(usize, &String)], known: &[String]) -> ExperimentError {
    let shown = |(_, name): &(usize, &String)| {
        let near: Vec<String> = alike(kind, name).into_iter().filter(|near| near != *name).collect();
        let near = match (near.is_empty(), suggestion::line(kind, name)) {
            (false, _) => format!(" (did you mean {}?)", near.join(", ")),
            (true, Some(line)) => format!(" (perhaps {line} under [columns])"),
            (true, None) => String::new(),
        };
        format!("`{name}`{near}")
    };
    let list: Vec<String> = unknown.iter().map(shown).collect();
    let word = if list.len() == 1 { "column" } else { "columns" };
    let problem = Problem::UnknownColumns { unknown: format!("{word} {}", list.join(", ")), known: known.join(", ") };
    let error = sheet.error(problem).at_line(sheet.header_line);
    match unknown {
        [(_, name)] => error.at_column(*name),
        _ => error,
    }
}

/// Fails where the file names a unit, in a row of units or in brackets after the column's name, that is not the one with
/// which the column is read; where the settings say another one outright, that is a doubt.
fn check_unit(sheet: &Sheet, kind: Kind, column: &Recognised, doubts: &mut Doubts) -> Result<(), ExperimentError> {
    let Target::Signals(signals, scale, _) = &column.target else { return Ok(()) };
    let name = &sheet.header[column.position];
    let in_row = sheet.units.get(column.position).cloned().filter(|unit| !unit.is_empty());
    let Some(found) = in_row.or_else(|| suggestion::bracketed(name)) else { return Ok(()) };
    let (Some(signal), true) = (signals.first(), Unit::spelled(&found).is_some()) else { return Ok(()) };
    let Some(unit) = kind.format().signal_unit(signal) else { return Ok(()) };
    // Multipliers are the user's own business: a unit may be part of them.
    if scale.multiplier.abs() != 1.0 {
        return Ok(());
    }
    let same = match (Factor::of_signal(unit, Some(&found)), scale.unit) {
        (Ok(Factor::Fixed(a)), Factor::Fixed(b)) | (Ok(Factor::Weight(a)), Factor::Weight(b)) => a == b,
        _ => false,
    };
    match &scale.symbol {
        _ if same => Ok(()),
        Some(symbol) => {
            let doubt = format!("column {} is read in {symbol}, where the file itself says {found}", quoted(name));
            doubts.add(&sheet.file, doubt);
            Ok(())
        }
        None => {
            let problem = Problem::OtherUnit { read: unit.symbol, mend: mend(name, signal, &found), found };
            Err(sheet.error(problem).at_line(sheet.header_line).at_column(name))
        }
    }
}
