//! How much of a long drive takes part in the fits.

use bekker::diagnosis::CompareOptions;

/// An option of all commands that fit a drive.
#[derive(clap::Args)]
pub struct Windows {
    /// Different windows of a long drive that take part in the fits, evenly spread. A window has 6 s; a diagnosis lets the others judge the final model.
    #[arg(long, default_value_t = CompareOptions::default().windows as u32, value_name = "N", value_parser = clap::value_parser!(u32).range(8..))]
    windows: u32,
}

impl Windows {
    /// The number.
    pub fn count(&self) -> usize {
        self.windows as usize
    }

    /// Options of a comparison with it.
    pub fn options(&self, calibrate: bool, added: Vec<String>) -> CompareOptions {
        CompareOptions { calibrate, added, windows: self.count() }
    }
}
