//! How far long work is, on standard error: a bar in a terminal, elsewhere a line every ten seconds.

use bekker::diagnosis::Progress;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

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

/// Time between two lines where there is no terminal, and between two looks of the bar at the clock.
const LINES: Duration = Duration::from_secs(10);
const TICK: Duration = Duration::from_millis(500);

/// Tells how far work is until it is dropped.
pub struct Reporter {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

struct Shared {
    at: Mutex<At>,
    ended: Condvar,
}

struct At {
    progress: Progress,
    told: Instant,
    ended: bool,
}

impl Shared {
    fn at(&self) -> MutexGuard<'_, At> {
        self.at.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Reporter {
    /// Starts with the stage `stage`, shown until the first report.
    pub fn start(stage: &'static str) -> Self {
        let progress = Progress { stage, trying: String::new(), done: 0.0, total: 1.0, elapsed: 0.0, remaining: None };
        let at = Mutex::new(At { progress, told: Instant::now(), ended: false });
        let shared = Arc::new(Shared { at, ended: Condvar::new() });
        let seen = Arc::clone(&shared);
        let thread =
            std::thread::spawn(
                move || {
                    if std::io::stderr().is_terminal() { show_bar(&seen) } else { write_lines(&seen) }
                },
            );
        Self { shared, thread: Some(thread) }
    }

    /// Takes a report of progress.
    pub fn tell(&self, progress: Progress) {
        let mut at = self.shared.at();
        (at.progress, at.told) = (progress, Instant::now());
    }
}

impl Drop for Reporter {
    fn drop(&mut self) {
        self.shared.at().ended = true;
        self.shared.ended.notify_all();
        // A reporter that has failed has nothing to clear.
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Calls `show` with the progress as of now, every so often until the work has ended.
fn every(time: Duration, shared: &Shared, mut show: impl FnMut(Progress)) {
    let mut at = shared.at();
    while !at.ended {
        let waited = shared.ended.wait_timeout(at, time);
        at = waited.unwrap_or_else(PoisonError::into_inner).0;
        if at.ended {
            return;
        }
        let now = at.progress.after(at.told.elapsed().as_secs_f64());
        drop(at);
        show(now);
        at = shared.at();
    }
}

fn write_lines(shared: &Shared) {
    every(LINES, shared, |progress| eprintln!("bekker: {}", line(&progress)));
}

/// `20 s, fitting each effect: drag (3 of 12), 38 % done, about 40 s left`.
fn line(progress: &Progress) -> String {
    let share = 100.0 * share(progress);
    format!("{:.0} s, {}, {share:.0} % done, {}", progress.elapsed, progress.doing(), progress.time_left())
}

fn show_bar(shared: &Shared) {
    let bar = ProgressBar::new(FINE);
    if let Ok(style) = ProgressStyle::with_template("[{bar:20}] {percent:>3} % {wide_msg}") {
        bar.set_style(style.progress_chars("=> "));
    }
    every(TICK, shared, |progress| {
        bar.set_position((share(&progress) * FINE as f64) as u64);
        bar.set_message(format!("{:.0} s, {}, {}", progress.elapsed, progress.time_left(), progress.doing()));
    });
    bar.finish_and_clear();
}

fn share(progress: &Progress) -> f64 {
    if progress.total > 0.0 { (progress.done / progress.total).clamp(0.0, 1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn property_a_line_says_what_is_tried_and_how_long_it_may_take() {
        let progress = Progress {
            stage: "fitting each effect",
            trying: "drag (3 of 12)".to_owned(),
            done: 0.38,
            total: 1.0,
            elapsed: 20.2,
            remaining: Some(41.0),
        };
        assert_eq!(line(&progress), "20 s, fitting each effect: drag (3 of 12), 38 % done, about 40 s left");
    }
}
