//! The program as its users call it, and what the tests of all its commands need.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The shipped experiment.
pub const SAND: &str = "../examples/sand_wheel";

pub fn bekker() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_bekker"));
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    command
}

pub fn call(arguments: &[&str]) -> Output {
    bekker().args(arguments).output().expect("the program starts")
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Stdout of a call that must succeed.
pub fn done(arguments: &[&str]) -> String {
    let output = call(arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

pub fn file(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name)
}

pub fn shown(path: &Path) -> &str {
    path.to_str().expect("the path is UTF-8")
}

/// A call that must be refused with exit 1 and one line on stderr that holds every one of `names`.
pub fn refused(arguments: &[&str], names: &[&str]) {
    let output = call(arguments);
    let error = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {error}");
    assert_eq!(error.trim_end().lines().count(), 1, "{arguments:?}: {error}");
    assert!(!error.contains("panicked"), "{arguments:?}: {error}");
    for name in names {
        assert!(error.contains(name), "{arguments:?} does not name `{name}`: {error}");
    }
}

pub fn json(path: &Path) -> serde_json::Value {
    serde_json::from_str(&std::fs::read_to_string(path).expect("the file is there")).expect("it is JSON")
}

/// An empty place for a folder.
pub fn new_folder(name: &str) -> PathBuf {
    let folder = file(name);
    let _ = std::fs::remove_dir_all(&folder);
    folder
}
