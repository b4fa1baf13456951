//! `bekker experiment`.

use crate::model::ModelArguments;
use crate::output::say;
use crate::progress::Reporter;
use crate::separate;
use anyhow::{Result, bail};
use bekker::diagnosis::{PlatePlan, SeparateOptions, ShearPlan, SingleWheelPlan, TraversePlan};
use bekker::measurement;
use bekker::model::Model;
use std::path::PathBuf;

/// Plan an experiment: write a run list with inputs and empty measured columns, and see what it will be able to tell
/// apart.
#[derive(clap::Args)]
pub struct Experiment {
    /// Folder to make.
    folder: PathBuf,
    #[command(flatten)]
    model: ModelArguments,
    /// What to do: a wheel on a carriage, a rover on a profile, or a test of the soil by plates or by shear.
    #[arg(long, value_enum, default_value_t = Kind::SingleWheel)]
    kind: Kind,
    /// Single wheel: loads in N, separated by commas.
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true, value_name = "N,..")]
    loads: Option<Vec<f64>>,
    /// Single wheel: slips between -1 and 1.
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true, value_name = "SLIP,..")]
    slips: Option<Vec<f64>>,
    /// Wheel speeds in rad/s; negative ones drive backward.
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true, value_name = "RAD/S,..")]
    wheel_speeds: Option<Vec<f64>>,
    /// Traverse: slopes in degrees; each is a hill that is driven up and down again, 0 is level ground.
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true, value_name = "DEG,..")]
    slopes: Option<Vec<f64>>,
    /// Traverse: masses of the rover in kg.
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true, value_name = "KG,..")]
    masses: Option<Vec<f64>>,
    /// Traverse: drive back during the second half of each run.
    #[arg(long)]
    and_back: bool,
    /// Traverse: length of a run in s.
    #[arg(long, value_name = "S")]
    duration: Option<f64>,
    /// Traverse: time between rows in s.
    #[arg(long, value_name = "S")]
    every: Option<f64>,
    /// Plates: diameters in m.
    #[arg(long, value_delimiter = ',', value_name = "M,..")]
    diameters: Option<Vec<f64>>,
    /// Shear: normal stresses in Pa.
    #[arg(long, value_delimiter = ',', value_name = "PA,..")]
    stresses: Option<Vec<f64>>,
    /// Plates: deepest sinkage; shear: longest displacement; in m.
    #[arg(long, value_name = "M")]
    depth: Option<f64>,
    /// How often each run is made.
    #[arg(long, value_name = "N")]
    repeats: Option<usize>,
    /// What is measured, separated by commas.
    #[arg(long, value_delimiter = ',', value_name = "SIGNALS")]
    signals: Option<Vec<String>>,
}

/// Kind of experiment.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Kind {
    #[value(name = "single_wheel", alias = "single-wheel")]
    SingleWheel,
    Traverse,
    #[value(name = "plate_sinkage", alias = "plate-sinkage")]
    PlateSinkage,
    Shear,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::SingleWheel => "single_wheel",
            Self::Traverse => "traverse",
            Self::PlateSinkage => "plate_sinkage",
            Self::Shear => "shear",
        }
    }
}

impl Experiment {
    pub fn run(self) -> Result<()> {
        let model = self.model.load()?;
        self.refuse_others()?;
        let experiment = match self.kind {
            Kind::SingleWheel => self.single_wheel(&model)?,
            Kind::Traverse => self.traverse(&model)?,
            Kind::PlateSinkage => self.plates()?,
            Kind::Shear => self.shear()?,
        };
        experiment.write(&self.folder)?;
        // What the program has written it must be able to read: the reader checks signals and units.
        let experiment = measurement::Experiment::read_plan(&self.folder)?;
        let rows: usize = experiment.runs.iter().map(|run| run.data.rows()).sum();
        say!("wrote {}: {} runs, {rows} rows to be recorded", self.folder.display(), experiment.runs.len());
        let options = SeparateOptions { calibrate: false, ..SeparateOptions::default() };
        let reporter = Reporter::start("looking at what the experiment will tell apart");
        let separation = bekker::diagnosis::separate(&model, &experiment, &options);
        drop(reporter);
        separate::print(&separation?)
    }

    /// Refuses options that are for another kind of experiment.
    fn refuse_others(&self) -> Result<()> {
        use Kind::{PlateSinkage, Shear, SingleWheel, Traverse};
        let options: [(&str, bool, &[Kind]); 11] = [
            ("--loads", self.loads.is_some(), &[SingleWheel]),
            ("--slips", self.slips.is_some(), &[SingleWheel]),
            ("--wheel-speeds", self.wheel_speeds.is_some(), &[SingleWheel, Traverse]),
            ("--slopes", self.slopes.is_some(), &[Traverse]),
            ("--masses", self.masses.is_some(), &[Traverse]),
            ("--and-back", self.and_back, &[Traverse]),
            ("--duration", self.duration.is_some(), &[Traverse]),
            ("--every", self.every.is_some(), &[Traverse]),
            ("--diameters", self.diameters.is_some(), &[PlateSinkage]),
            ("--stresses", self.stresses.is_some(), &[Shear]),
            ("--depth", self.depth.is_some(), &[PlateSinkage, Shear]),
        ];
        match options.iter().find(|(_, given, kinds)| *given && !kinds.contains(&self.kind)) {
            Some((option, _, kinds)) => bail!("{option} is for `--kind {}`", kinds[0].name()),
            None => Ok(()),
        }
    }

    fn plates(&self) -> Result<measurement::Experiment> {
        let mut plan = PlatePlan::default();
        put(&mut plan.diameters, &self.diameters);
        put(&mut plan.sinkage, &self.depth);
        put(&mut plan.repeats, &self.repeats);
        put(&mut plan.signals, &self.signals);
        Ok(plan.experiment()?)
    }

    fn shear(&self) -> Result<measurement::Experiment> {
        let mut plan = ShearPlan::default();
        put(&mut plan.normal_stresses, &self.stresses);
        put(&mut plan.displacement, &self.depth);
        put(&mut plan.repeats, &self.repeats);
        Ok(plan.experiment()?)
    }

    fn single_wheel(&self, model: &Model) -> Result<measurement::Experiment> {
        let mut plan = SingleWheelPlan::of(model);
        put(&mut plan.loads, &self.loads);
        put(&mut plan.slips, &self.slips);
        put(&mut plan.wheel_speeds, &self.wheel_speeds);
        put(&mut plan.signals, &self.signals);
        put(&mut plan.repeats, &self.repeats);
        Ok(plan.experiment()?)
    }

    fn traverse(&self, model: &Model) -> Result<measurement::Experiment> {
        let mut plan = TraversePlan::of(model);
        let speeds = |speeds: &Vec<f64>| speeds.iter().map(|speed| speed * plan.radius).collect();
        let speeds: Option<Vec<f64>> = self.wheel_speeds.as_ref().map(speeds);
        let slopes = self.slopes.as_ref().map(|all| all.iter().map(|slope| slope.to_radians()).collect());
        put(&mut plan.speeds, &speeds);
        put(&mut plan.slopes, &slopes);
        put(&mut plan.masses, &self.masses);
        put(&mut plan.duration, &self.duration);
        put(&mut plan.every, &self.every);
        put(&mut plan.repeats, &self.repeats);
        put(&mut plan.signals, &self.signals);
        plan.and_back = self.and_back;
        Ok(plan.experiment()?)
    }
}

/// Puts what was given in the place of a default.
fn put<T: Clone>(place: &mut T, given: &Option<T>) {
    if let Some(given) = given {
        place.clone_from(given);
    }
}
