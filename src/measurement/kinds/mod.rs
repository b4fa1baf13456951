//! What the files of each kind of experiment hold: one [`Format`] a kind, which [`Kind::format`] gives. All other
//! code that reads files is the same for all kinds.

mod plate_sinkage;
mod shear;
mod single_wheel;
mod traverse;

use super::columns::Column;
use super::course::Course;
use super::doubts::Doubts;
use super::error::ExperimentError;
use super::experiment::{Experiment, Kind};
use super::grid::Grid;
use super::import::{Entry, FoundColumn, Plan, Survey};
use super::sheet::Sheet;
use super::suggestion::{Rule, maybe, sure};
use bekker_modeldescription::Unit;

impl Kind {
    /// What its files hold.
    pub(super) fn format(self) -> &'static dyn Format {
        match self {
            Self::SingleWheel => &single_wheel::SingleWheel,
            Self::Traverse => &traverse::Traverse,
            Self::PlateSinkage => &plate_sinkage::PlateSinkage,
            Self::Shear => &shear::Shear,
        }
    }

    /// The kind of unknown files: the first kind for which `means` finds a column of its [`sure_signs`](Format::sure_signs),
    /// or what else [tells](Format::is_told_by) it, else the first with a column of its [`signs`](Format::signs). `means` says whether a column is one of the listed
    /// signals of a kind.
    pub(super) fn told_by(means: impl Fn(Self, &[&str]) -> bool) -> Option<Self> {
        let surely = |kind: &Self| kind.format().is_told_by(&|signals| means(*kind, signals));
        let first = || Self::ALL.into_iter().find(|kind| means(*kind, kind.format().signs()));
        Self::ALL.into_iter().find(surely).or_else(first)
    }
}

/// What a column of a wheel's or rover's experiment may mean beside a signal.
const WHEEL_PARAMETERS: &[Rule] = &[
    sure(&["wheel", "radius"], "wheel.radius"),
    maybe(&["radius"], "wheel.radius"),
    sure(&["wheel", "width"], "wheel.width"),
    maybe(&["width"], "wheel.width"),
    sure(&["cohesion"], "soil.cohesion"),
    sure(&["friction", "angle"], "soil.friction_angle"),
    sure(&["shear", "modulus"], "soil.shear_modulus"),
];

/// What depends on the kind of an experiment where files are read, checked and proposed.
pub(super) trait Format: Sync {
    /// Fewest rows of a run.
    fn least_rows(&self) -> usize;

    /// What a signal or input is measured in; `None` for a name that such an experiment does not have.
    fn signal_unit(&self, name: &str) -> Option<Unit>;

    /// Names that such an experiment may have, `k` for a number.
    fn signal_names(&self) -> Vec<String>;

    /// Columns with their uses and limits; `names` are those that are there, `radius` is the wheel's, m.
    fn columns(&self, names: &[String], radius: f64) -> Vec<Column>;

    /// Columns that must be there, and what may stand in their place.
    fn required(&self) -> &'static [(&'static str, &'static str)];

    /// Fails where commands are missing or contradict each other; `names` are those of all signals, derived ones included.
    fn check_commands(&self, sheet: &Sheet, names: &[String]) -> Result<(), ExperimentError>;

    /// Fills in missing cells of inputs as far as this is safe, and says so.
    ///
    /// # Errors
    /// [`ExperimentError`] where a cell that is needed is missing.
    fn complete(&self, _grid: &mut Grid, _doubts: &mut Doubts) -> Result<(), ExperimentError> {
        Ok(())
    }

    /// Fails where rows cannot be right by the physics; `radius` is the wheel's, m.
    fn check_rows(&self, grid: &Grid, radius: f64) -> Result<(), ExperimentError>;

    /// Fails where rows that are said to repeat each other have unlike inputs.
    fn check_repeats(&self, experiment: &Experiment) -> Result<(), ExperimentError>;

    /// What is unlikely in the rows of a run; `radius` and `width` of the wheel (m) are `None` where they are not stated.
    ///
    /// # Errors
    /// [`ExperimentError`] where it cannot be right at all.
    fn look(&self, grid: &Grid, radius: Option<f64>, width: Option<f64>) -> Result<Vec<String>, ExperimentError>;

    /// What is unlikely in the signs of all rows of a run, before it is cut.
    fn look_at_signs(&self, _grid: &Grid) -> Vec<String> {
        Vec::new()
    }

    /// Whether a run takes its course in time, over a profile.
    fn has_course(&self) -> bool;

    /// What is said of `wheels = [..]` beside a field that no wheel has; `None` where it is merely unknown.
    fn no_wheels(&self) -> Option<&'static str>;

    /// How the rows of a run follow each other where an input takes its course from row to row and its steps are those of a recorder.
    fn course(&self) -> Option<&'static Course> {
        None
    }

    /// Parameters of the rig that an experiment has to state, with an example in SI.
    fn rig(&self) -> &'static [(&'static str, &'static str)] {
        &[("wheel.radius", "0.1"), ("wheel.width", "0.1")]
    }

    /// What words in a column's name mean, where it gives a parameter.
    fn parameter_rules(&self) -> &'static [Rule] {
        WHEEL_PARAMETERS
    }

    /// What words in a column's name mean.
    fn rules(&self) -> &'static [Rule];

    /// Signals that only this kind of experiment has: one such column identifies the kind.
    fn sure_signs(&self) -> &'static [&'static str];

    /// Whether the columns identify the kind; `means` says whether one of them is one of the listed signals.
    fn is_told_by(&self, means: &dyn Fn(&[&str]) -> bool) -> bool {
        means(self.sure_signs())
    }

    /// Signals that identify the kind where no column is a sure sign of another kind.
    fn signs(&self) -> &'static [&'static str];

    /// The likely unit of a field by its largest absolute value; `None` where that value is plausible in SI.
    fn likely_unit(&self, field: &str, largest: f64) -> Option<&'static str>;

    /// Mends the entries of a proposal by what all columns say together.
    fn mend<'s>(&self, survey: &'s Survey, found: &mut Vec<(&'s FoundColumn, Entry)>, plan: &mut Plan);

    /// What no column gives, of what such an experiment needs.
    fn missing(&self, found: &[(&FoundColumn, Entry)]) -> Vec<String>;

    /// Whether columns that are left out may tell rows apart that do not belong together.
    fn mixes_rows(&self) -> bool;

    /// Lines of a proposed `experiment.toml` that the user has to complete.
    fn open_settings(&self) -> &'static [&'static str];
}
