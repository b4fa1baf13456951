//! Self-contained HTML reports: one file, no network, readable on a phone, in light and dark.

mod comparison;
mod diagnosis;
mod drive;
mod kinds;
mod packed;
mod page;
mod plots;
mod saved;
mod set;
pub mod shown;
mod units;
mod words;

pub use comparison::comparison_page;
pub use diagnosis::{diagnosis_page, verdict_in_words};
pub use page::{Page, escape, table};
pub use plots::{LinePlot, Series};
pub use set::{diagnosed_part_page, part_page};
pub use units::{ForPeople, column_for_people, parameter_for_people, short};
