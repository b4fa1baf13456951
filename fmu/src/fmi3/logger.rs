//! Messages to the importer.

use super::types::{Environment, LogMessage, Status};
use std::ffi::CString;

/// Names and meanings of the log categories; the names are the standard's suggestions.
pub const LOG_CATEGORIES: &[(&str, &str)] = &[
    (ERROR, "Calls that were refused or failed, and why; always logged."),
    (WARNING, "Calls that were carried out with a reservation; always logged."),
    (EVENTS, "Why a simulation ended, and other events; with debug logging."),
];

const ERROR: &str = "logStatusError";
const WARNING: &str = "logStatusWarning";
const EVENTS: &str = "logEvents";

/// Where an instance's messages go.
pub(super) struct Logger {
    callback: LogMessage,
    environment: Environment,
    events: bool,
}

// SAFETY: the environment is only handed back to the importer's callback, on the thread of the
// importer's own call; the standard makes the importer responsible for what it is.
unsafe impl Send for Logger {}

impl Logger {
    pub(super) fn new(callback: LogMessage, environment: Environment, debug: bool) -> Self {
        Self { callback, environment, events: debug }
    }

    /// Turns debug logging on or off; an empty list of categories means all.
    pub(super) fn configure(&mut self, on: bool, categories: &[&str]) -> Result<(), String> {
        let known = |name: &&&str| LOG_CATEGORIES.iter().any(|(category, _)| category == *name);
        if let Some(name) = categories.iter().find(|name| !known(name)) {
            let all: Vec<&str> = LOG_CATEGORIES.iter().map(|(category, _)| *category).collect();
            return Err(format!("no log category is called `{name}`; known are {}", all.join(", ")));
        }
        if categories.is_empty() || categories.contains(&EVENTS) {
            self.events = on;
        }
        Ok(())
    }

    pub(super) fn error(&self, message: &str) {
        self.send(Status::Error, ERROR, message);
    }

    pub(super) fn warning(&self, message: &str) {
        self.send(Status::Warning, WARNING, message);
    }

    pub(super) fn event(&self, message: &str) {
        if self.events {
            self.send(Status::Ok, EVENTS, message);
        }
    }

    fn send(&self, status: Status, category: &str, message: &str) {
        let Some(callback) = self.callback else { return };
        let text = |words: &str| CString::new(words.replace('\0', "\u{FFFD}")).unwrap_or_default();
        let (category, message) = (text(category), text(message));
        // SAFETY: the importer's function, called on the thread of its own call; the texts live until
        // it returns.
        unsafe { callback(self.environment, status, category.as_ptr(), message.as_ptr()) };
    }
}
