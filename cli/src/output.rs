//! Lines on stdout and files to be written.

use anyhow::{Context, Result};
use std::io::Write;
use std::path::Path;

/// Writes a line to stdout and returns the error from the calling function where that fails: unlike `println!`, which
/// panics when the reader has closed the pipe.
macro_rules! say {
    ($($format:tt)*) => {
        $crate::output::line(format_args!($($format)*))?
    };
}
pub(crate) use say;

/// Writes one line to stdout; used by `say!`.
pub fn line(text: std::fmt::Arguments) -> std::io::Result<()> {
    writeln!(std::io::stdout().lock(), "{text}")
}

/// Refuses a path that cannot be written, before long work is done for it; what a file there holds is kept.
pub fn check_writable(path: &Path) -> Result<()> {
    let opened = std::fs::OpenOptions::new().write(true).create(true).truncate(false).open(path);
    opened.map(drop).with_context(|| format!("cannot write `{}`", path.display()))
}

/// Writes a text to a file; an error names the file.
pub fn write(path: &Path, text: &str) -> Result<()> {
    std::fs::write(path, text).with_context(|| format!("cannot write `{}`", path.display()))?;
    say!("wrote {}", path.display());
    Ok(())
}

/// Writes JSON, ended by a line break.
pub fn write_json(path: &Path, value: &serde_json::Value) -> Result<()> {
    write(path, &format!("{}\n", serde_json::to_string_pretty(value)?))
}

/// Refuses the paths that cannot be written, see [`check_writable`].
pub fn check_all_writable<'a>(paths: impl IntoIterator<Item = &'a Option<std::path::PathBuf>>) -> Result<()> {
    paths.into_iter().flatten().try_for_each(|path| check_writable(path))
}
