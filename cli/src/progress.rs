//! Progress bars on standard error; hidden where that is no terminal.

use indicatif::{ProgressBar, ProgressStyle};

/// A bar of `length` steps with the time left.
pub fn bar(length: u64, what: &str) -> ProgressBar {
    let bar = ProgressBar::new(length);
    if let Ok(style) = ProgressStyle::with_template("{msg:28} [{bar:30}] {percent:>3} % {eta} left") {
        bar.set_style(style.progress_chars("=> "));
    }
    bar.set_message(what.to_owned());
    bar
}

/// Steps of a bar that shows shares.
const FINE: u64 = 1000;

/// A bar for work whose total may grow.
pub fn share_bar() -> ProgressBar {
    let bar = bar(FINE, "reading");
    // The time runs on while a single piece of work takes long.
    bar.enable_steady_tick(std::time::Duration::from_millis(500));
    bar
}

/// Shows how far work is.
pub fn show(bar: &ProgressBar, stage: &'static str, done: f64, total: f64) {
    if bar.is_hidden() {
        return;
    }
    bar.set_message(stage);
    let share = if total > 0.0 { (done / total).clamp(0.0, 1.0) } else { 0.0 };
    bar.set_position((share * FINE as f64) as u64);
}
