//! Messages to the importer.

use super::Status;
use std::ffi::{CStr, CString};

/// Names and meanings of the log categories; the names are the standard's suggestions.
pub const LOG_CATEGORIES: &[(&str, &str)] = &[
    (ERROR, "Calls that were refused or failed, and why; always logged."),
    (DISCARD, "Values that do not exist for what the importer tries; always logged."),
    (WARNING, "Why a simulation ended on the way; always logged."),
    (EVENTS, "Other events; with debug logging."),
];

const ERROR: &str = "logStatusError";
const DISCARD: &str = "logStatusDiscard";
const WARNING: &str = "logStatusWarning";
const EVENTS: &str = "logEvents";

/// FMI 2.0's name for all categories.
const ALL: &str = "logAll";

/// The importer's function, with its environment: takes status, category and message.
pub(crate) trait Sink: Send {
    fn send(&self, status: Status, category: &CStr, message: &CStr);
}

/// Where an instance's messages go.
pub(crate) struct Logger {
    sink: Box<dyn Sink>,
    events: bool,
}

impl Logger {
    pub(crate) fn new(sink: impl Sink + 'static, debug: bool) -> Self {
        Self { sink: Box::new(sink), events: debug }
    }

    /// Turns debug logging on or off; an empty list of categories means all.
    pub(crate) fn configure(&mut self, on: bool, categories: &[&str]) -> Result<(), String> {
        let known = |name: &&&str| **name == ALL || LOG_CATEGORIES.iter().any(|(category, _)| category == *name);
        if let Some(name) = categories.iter().find(|name| !known(name)) {
            let all: Vec<&str> = LOG_CATEGORIES.iter().map(|(category, _)| *category).collect();
            return Err(format!("no log category is called `{name}`; known are {}", all.join(", ")));
        }
        if categories.is_empty() || categories.contains(&EVENTS) || categories.contains(&ALL) {
            self.events = on;
        }
        Ok(())
    }

    pub(crate) fn error(&self, message: &str) {
        self.send(Status::Error, ERROR, message);
    }

    /// A call that was not carried out, as an error or as one that the importer may try otherwise.
    pub(crate) fn refused(&self, status: Status, message: &str) {
        let category = if status == Status::Discard { DISCARD } else { ERROR };
        self.send(status, category, message);
    }

    /// The end of a simulation on the way, which a host may take for its usual end.
    pub(crate) fn ended(&self, time: f64, reason: &str) {
        self.send(Status::Warning, WARNING, &format!("the simulation ends at {time} s: {reason}"));
    }

    pub(crate) fn event(&self, message: &str) {
        if self.events {
            self.send(Status::Ok, EVENTS, message);
        }
    }

    fn send(&self, status: Status, category: &str, message: &str) {
        let text = |words: &str| CString::new(words.replace('\0', "\u{FFFD}")).unwrap_or_default();
        self.sink.send(status, &text(category), &text(message));
    }
}
