//! The thesis's results beside ours: simulations and experiments of sections 2.3, 2.4, 2.6, 3.3, 3.5 and 4.4, each as a [`Finding`].
//!
//! A finding is computed, never stored: it drives the same models, sensors, estimators and controllers as every door
//! and states the assumptions that the thesis leaves open. Nothing is tuned towards a published number; where ours
//! differs, the row says why.

mod benign;
mod challenging;
pub mod contact_angles;
mod contender;
mod digging;
mod ditch;
mod ditch_rover;
mod drive;
pub mod instruments;
pub mod on_board;
mod oracle;
mod page;
mod paths;
mod pull;
mod reconfiguration;
mod sensitivity;
mod sled;
pub mod soil;
pub mod soil_on_board;
pub mod soil_testbed;
mod stresses;
mod tables;

pub use bekker::report::{LinePlot, Series};
pub use drive::{Course, Drive, drive, drive_at};
pub use page::reproduction_page;
pub use tables::{plot_csv, rows_csv};

use serde::Serialize;

/// Why a study could not be done: whatever its model, estimator or controller said.
pub type ReproductionError = Box<dyn std::error::Error + Send + Sync>;

/// One study of the thesis that can be done again.
#[derive(Clone, Copy, Debug)]
pub struct Study {
    /// Its name for the command line.
    pub id: &'static str,
    /// Does it with this many trials of everything that is noisy or varied; the same number gives the same bits.
    pub run: fn(usize) -> Result<Vec<Finding>, ReproductionError>,
}

/// All studies, in the thesis's order.
pub const STUDIES: &[Study] = &[
    Study { id: "stresses", run: |_| Ok(vec![soil::stress_distributions()?, soil::drawbar_pull_of_models()?]) },
    Study { id: "bevameter", run: |trials| Ok(vec![soil_testbed::bevameter(trials as u64)?]) },
    Study { id: "wheel_testbed", run: |trials| Ok(vec![soil_testbed::wheel_testbed(trials as u64)?]) },
    Study { id: "soil_on_board", run: |trials| Ok(vec![soil_on_board::rover_identification(trials as u64)?]) },
    Study { id: "undulating", run: |trials| Ok(vec![contact_angles::undulating(count(trials))?]) },
    Study { id: "rock", run: |trials| Ok(vec![contact_angles::rock(count(trials))?]) },
    Study { id: "incline", run: |trials| Ok(vec![contact_angles::incline(count(trials))?]) },
    Study { id: "paths", run: paths::paths },
    Study { id: "reconfiguration", run: reconfiguration::reconfiguration },
    Study { id: "benign", run: benign::benign },
    Study { id: "sensitivity", run: sensitivity::sensitivity },
    Study { id: "challenging", run: challenging::challenging },
    Study { id: "ditch", run: ditch::ditch },
    Study { id: "sled", run: sled::sled },
    Study { id: "pull", run: pull::pull },
    Study { id: "digging", run: digging::digging },
    Study { id: "digging_along", run: digging::digging_along },
];

/// Trials as the studies of contact angles count them.
fn count(trials: usize) -> u32 {
    u32::try_from(trials).unwrap_or(u32::MAX)
}

/// Median and interval of a quantity over seeds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// Median.
    pub median: f64,
    /// 10 % quantile.
    pub low: f64,
    /// 90 % quantile.
    pub high: f64,
    /// Trials.
    pub trials: usize,
}

/// One number of the thesis beside ours.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// What is compared, with its unit: "RMS error of the front contact angle, deg".
    pub quantity: String,
    /// The thesis's figure; `None` where it gives none.
    pub thesis: Option<f64>,
    /// Ours, in the same unit.
    pub ours: Spread,
    /// Why they differ, or what ours assumes.
    pub reason: String,
}

/// One experiment or simulation of the thesis, done again.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// Name for files and anchors: `contact_angles_undulating`.
    pub id: String,
    /// Where in the thesis: "2.6.1, figure 2.23".
    pub section: String,
    /// What was done, in one line.
    pub title: String,
    /// The numbers.
    pub rows: Vec<Row>,
    /// The figures.
    pub plots: Vec<LinePlot>,
    /// What the thesis leaves open and we assume.
    pub assumptions: Vec<String>,
}

impl Spread {
    /// Median and 10-90 % interval of the finite values, by linear interpolation between order statistics;
    /// `None` without any.
    #[must_use]
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut values: Vec<f64> = values.into_iter().filter(|value| value.is_finite()).collect();
        values.sort_by(f64::total_cmp);
        let last = values.len().checked_sub(1)?;
        let at = |share: f64| {
            let place = share * last as f64;
            let below = place as usize;
            let above = (below + 1).min(last);
            values[below] + (place - below as f64) * (values[above] - values[below])
        };
        Some(Self { median: at(0.5), low: at(0.1), high: at(0.9), trials: values.len() })
    }

    /// A figure that does not scatter: the same in each of `trials`.
    #[must_use]
    pub fn exact(value: f64) -> Self {
        Self { median: value, low: value, high: value, trials: 1 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_spread_interpolates_between_order_statistics() {
        let spread = Spread::of([4.0, 0.0, 2.0, f64::NAN, 1.0, 3.0]);
        assert_eq!(spread, Some(Spread { median: 2.0, low: 0.4, high: 3.6, trials: 5 }));
        assert_eq!(Spread::of([f64::NAN]), None);
    }
}
