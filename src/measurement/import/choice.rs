//! A proposal that a person changes: what each column becomes, and numbers that no file gives.

use super::super::experiment::Kind;
use super::super::mapping::{Factor, Side};
use super::super::suggestion;
use super::super::vocabulary::{alike, parameter};
use super::entry::{Entry, To};
use super::propose::missing;
use super::{ImportError, Proposal};
use serde::{Deserialize, Serialize};

/// Values of a column that are shown.
const EXAMPLES: usize = 4;

/// What a column becomes.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Meaning {
    /// A signal's name, `wheel[1,2].torque_command` for one column of several wheels, `parameter NAME`, `time_stamp`, or `run`
    /// for a column that tells the runs apart.
    pub target: String,
    /// Its unit; SI where missing.
    #[serde(default)]
    pub unit: Option<String>,
    /// Whether it is counted in the other direction than the model counts.
    #[serde(default)]
    pub turned: bool,
    /// The side of the vehicle, where both have a column: the model has their mean.
    #[serde(default)]
    pub side: Option<Side>,
}

/// A column as it was found, and what is proposed for it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProposedColumn {
    /// Its name in the files.
    pub name: String,
    /// Its first values, as they stand there.
    pub examples: Vec<String>,
    /// What it becomes; `None` where it is left out.
    pub meaning: Option<Meaning>,
    /// Why it is left out, or what of its meaning is a guess; empty where nothing is doubtful.
    pub note: String,
}

impl To {
    fn name(&self) -> String {
        match self {
            Self::Signal(name) => name.clone(),
            Self::Wheels(field, wheels) => {
                let wheels: Vec<String> = wheels.iter().map(usize::to_string).collect();
                format!("wheel[{}].{field}", wheels.join(","))
            }
            Self::Parameter(name) => format!("parameter {name}"),
            Self::TimeStamp => "time_stamp".to_owned(),
            Self::Run => "run".to_owned(),
        }
    }

    /// The target called `name`.
    fn named(kind: Kind, name: &str) -> Result<Self, String> {
        let of_several = |rest: &str| {
            let (wheels, field) = rest.split_once("].")?;
            let wheels: Option<Vec<usize>> = wheels.split(',').map(|wheel| wheel.parse().ok()).collect();
            wheels.filter(|wheels| wheels.len() > 1).map(|wheels| (field.to_owned(), wheels))
        };
        match name {
            "time_stamp" => return Ok(Self::TimeStamp),
            "run" => return Ok(Self::Run),
            _ => {}
        }
        if let Some(name) = name.strip_prefix("parameter ") {
            return parameter(name, &[]).map(|_| Self::Parameter(name.to_owned()));
        }
        let unit = |signal: &str| kind.format().signal_unit(signal);
        if let Some((field, wheels)) = name.strip_prefix("wheel[").and_then(of_several)
            && unit(&format!("wheel[1].{field}")).is_some()
        {
            return Ok(Self::Wheels(field, wheels));
        }
        if unit(name).is_some() {
            return Ok(Self::Signal(name.to_owned()));
        }
        let near = alike(kind, name);
        let near = if near.is_empty() { String::new() } else { format!("; did you mean {}?", near.join(", ")) };
        Err(format!("a {} experiment has no signal `{name}`{near}", kind.name()))
    }
}

impl Proposal {
    /// The columns with what is proposed for each, in the order of the files.
    #[must_use]
    pub fn columns(&self) -> Vec<ProposedColumn> {
        let columns = self.survey.columns.iter().map(|column| {
            let entry = self.plan.entries.iter().find(|(name, _)| *name == column.name).map(|(_, entry)| entry);
            let left_out = self.plan.ignored.iter().find(|(name, _)| *name == column.name);
            ProposedColumn {
                name: column.name.clone(),
                examples: column.texts.iter().take(EXAMPLES).cloned().collect(),
                meaning: entry.map(|entry| Meaning {
                    target: entry.target.name(),
                    unit: entry.unit.clone(),
                    turned: entry.turned,
                    side: entry.side,
                }),
                note: entry
                    .map(|entry| entry.guesses.join("; "))
                    .or_else(|| left_out.map(|(_, reason)| reason.clone()))
                    .unwrap_or_default(),
            }
        });
        columns.collect()
    }

    /// Names that a column may be given, `[k]` for a number in brackets, each with its SI unit.
    #[must_use]
    pub fn targets(&self) -> Vec<(String, &'static str)> {
        let format = self.kind.format();
        let unit = |name: &str| format.signal_unit(&name.replace("[k]", "[1]")).map_or("", |unit| unit.symbol);
        format.signal_names().into_iter().map(|name| (name.clone(), unit(&name))).collect()
    }

    /// Says what a column becomes; `None` leaves it out. [`settings`](Self::settings) follow.
    ///
    /// # Errors
    /// [`ImportError::Choice`] where there is no such column or signal, or the signal is not measured in that unit.
    pub fn choose(&mut self, column: &str, meaning: Option<&Meaning>) -> Result<(), ImportError> {
        if !self.survey.columns.iter().any(|known| known.name == column) {
            return Err(ImportError::Choice(format!("no file has a column `{column}`")));
        }
        if self.columns().iter().any(|known| known.name == column && known.meaning.as_ref() == meaning) {
            return Ok(());
        }
        let entry = meaning.map(|meaning| self.entry(column, meaning)).transpose().map_err(ImportError::Choice)?;
        let at = self.plan.entries.iter().position(|(name, _)| name == column);
        self.plan.ignored.retain(|(name, _)| name != column);
        self.plan.unsure.retain(|line| !line.starts_with(&format!("`{column}` ")));
        match (at, entry) {
            (Some(at), Some(entry)) => self.plan.entries[at].1 = entry,
            (None, Some(entry)) => self.plan.entries.push((column.to_owned(), entry)),
            (at, None) => {
                at.map(|at| self.plan.entries.remove(at));
                self.plan.ignored.push((column.to_owned(), "left out by hand".to_owned()));
            }
        }
        let of = |name: &String| self.survey.columns.iter().find(|column| column.name == *name);
        let found = self.plan.entries.iter().filter_map(|(name, entry)| Some((of(name)?, entry.clone())));
        self.plan.missing = missing(self.kind, &found.collect::<Vec<_>>());
        self.tell();
        Ok(())
    }

    fn entry(&self, column: &str, meaning: &Meaning) -> Result<Entry, String> {
        let target = To::named(self.kind, &meaning.target).map_err(|error| format!("column `{column}`: {error}"))?;
        let named = match &target {
            To::Signal(name) => Some((name.clone(), false)),
            To::Wheels(field, _) => Some((format!("wheel[1].{field}"), false)),
            To::Parameter(name) => Some((name.clone(), true)),
            To::TimeStamp | To::Run => None,
        };
        let unit = meaning.unit.clone().filter(|unit| !unit.is_empty());
        let si = named.and_then(|(name, is_parameter)| suggestion::unit_of(self.kind, &name, is_parameter));
        if let (Some(si), Some(unit)) = (si, &unit) {
            Factor::of_signal(si, Some(unit)).map_err(|error| format!("column `{column}`: {error}"))?;
        }
        let side = meaning.side.filter(|_| matches!(target, To::Signal(_) | To::Wheels(..)));
        Ok(Entry { unit, turned: meaning.turned, side, ..Entry::to(target) })
    }

    /// Fills in a number that no file gives: a parameter of the rig, or an input that is the same in all rows.
    ///
    /// # Errors
    /// [`ImportError::Choice`] where it is not a finite number.
    pub fn fill(&mut self, name: &str, value: f64) -> Result<(), ImportError> {
        if !value.is_finite() {
            return Err(ImportError::Choice(format!("`{name}`: expected a number")));
        }
        self.plan.filled.insert(name.to_owned(), value);
        self.tell();
        Ok(())
    }
}
