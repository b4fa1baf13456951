//! Lines on standard output that may fail.

/// Writes a line to standard output and returns early with the error where that fails, for example because
/// the reader of a pipe has gone (`println!` would panic).
macro_rules! say {
    ($($text:tt)*) => {{
        use std::io::Write as _;
        writeln!(std::io::stdout().lock(), $($text)*)?
    }};
}

pub(crate) use say;
