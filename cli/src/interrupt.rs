//! Ctrl-C: the first ends the work with the results so far, the second ends the program.

use anyhow::{Context, Result};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

/// Exit code of a program that a signal ended.
const INTERRUPTED: i32 = 130;

/// What the first Ctrl-C does to long work.
pub const KEEP: &str = "ending with what is known";

static STOP: AtomicBool = AtomicBool::new(false);

/// Listens to Ctrl-C from now on; `then` says what the first one does.
pub fn listen(then: &'static str) -> Result<()> {
    ctrlc::set_handler(move || {
        if STOP.swap(true, Ordering::SeqCst) {
            std::process::exit(INTERRUPTED);
        }
        eprintln!("bekker: interrupted; {then} (Ctrl-C again to quit at once)");
    })
    .context("cannot listen to Ctrl-C")
}

/// Ends the program where Ctrl-C came before there was anything to tell; `files` are those that were asked for.
pub fn with_nothing<'a>(why: &dyn std::fmt::Display, files: impl IntoIterator<Item = &'a PathBuf>) -> ! {
    let mut names = Vec::new();
    for file in files {
        names.push(format!("`{}`", file.display()));
        // The check that it can be written has made it.
        if std::fs::metadata(file).is_ok_and(|known| known.len() == 0) {
            let _ = std::fs::remove_file(file);
        }
    }
    let names =
        if names.is_empty() { String::new() } else { format!(", so nothing is written to {}", names.join(", ")) };
    eprintln!("bekker: {why}{names}");
    std::process::exit(INTERRUPTED);
}

/// Whether Ctrl-C was pressed.
pub fn stopped() -> bool {
    STOP.load(Ordering::SeqCst)
}
