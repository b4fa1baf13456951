//! Residuals and the conditions against which they are drawn.

use crate::diagnosis::{Fit, Level, Motion, levels_of};
use crate::measurement::{Experiment, Run};
use crate::report::kinds::of;
use crate::report::units::{Shown, of_column, spoken, wheel_and_field};

/// Below this speed of the rim, m/s, an apparent slip is mostly noise.
const SLOW: f64 = 0.02;

/// What a residual is held against.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::report) enum Condition {
    /// A recorded column.
    Column(String),
    /// Slip of a wheel from the velocity and the wheel's speed: 1 - v/(r omega).
    Slip { wheel: usize, radius: f64 },
    /// Slope of the ground under the rover, rising along x positive.
    Slope,
    /// Force of the soil on a wheel along the ground's normal, as the model has it.
    Load { wheel: usize },
    /// The number of the run, in the order of the experiment: something may have drifted.
    Run,
    /// The number of the wheel; the signal is then the same quantity of every wheel.
    Wheel,
}

impl Condition {
    /// A recorded column.
    pub fn column(name: &str) -> Self {
        Self::Column(name.to_owned())
    }

    /// Name for people.
    pub fn name(&self) -> String {
        match self {
            Self::Column(name) => spoken(name),
            Self::Slip { wheel, .. } => format!("slip of wheel {wheel}"),
            Self::Slope => "slope of the ground".to_owned(),
            Self::Load { wheel } => format!("load on wheel {wheel} (model)"),
            Self::Run => "run number".to_owned(),
            Self::Wheel => "wheel number".to_owned(),
        }
    }

    /// Unit and factor for display.
    pub fn shown(&self) -> Shown {
        match self {
            Self::Column(name) => of_column(name),
            Self::Slope => of_column("pitch"),
            Self::Load { .. } => of_column("load"),
            _ => Shown { symbol: "", factor: 1.0 },
        }
    }

    /// Whether it is counted rather than measured.
    pub fn counts(&self) -> bool {
        matches!(self, Self::Run | Self::Wheel)
    }

    /// The value at a row of a run, which the model drives like this.
    fn value(&self, number: usize, run: &Run, motion: Option<&Motion>, row: usize) -> Option<f64> {
        match self {
            Self::Column(name) => run.data.value(name, row),
            Self::Slip { wheel, radius } => {
                let speed =
                    ["speed", "speed_command"].map(|field| run.data.value(&format!("wheel[{wheel}].{field}"), row));
                let rim = radius * speed.into_iter().flatten().next()?;
                let slip = 1.0 - run.data.value("velocity", row)? / rim;
                (rim.abs() > SLOW).then(|| slip.clamp(-1.0, 1.0))
            }
            Self::Slope => motion?.slope.get(row).copied(),
            Self::Load { wheel } => motion?.load.get(wheel - 1)?.get(row).copied(),
            Self::Run => Some((number + 1) as f64),
            Self::Wheel => None,
        }
    }
}

/// Residuals of a signal with the values of a condition, both in SI units.
pub(in crate::report) struct Samples {
    pub signal: String,
    pub condition: Condition,
    pub values: Vec<(f64, f64)>,
    /// The group of repeats of each sample, and the names of the groups.
    pub groups: Vec<usize>,
    pub group_names: Vec<String>,
    pub levels: Vec<Level>,
}

impl Samples {
    /// `None` where the condition was not recorded or did not vary. For [`Condition::Wheel`] `signal` is the wheels'
    /// quantity, `torque` for `wheel[1].torque` and so on.
    pub fn new(experiment: &Experiment, fit: &Fit, signal: &str, condition: &Condition) -> Option<Self> {
        let (mut values, mut of_samples) = (Vec::new(), Vec::new());
        let sets = groups(experiment);
        let motions = &fit.motion;
        let group_of = |run: usize| sets.iter().position(|(_, runs)| runs.contains(&run)).unwrap_or(0);
        for (number, (run, fit)) in experiment.runs.iter().zip(&fit.runs).enumerate() {
            let group = group_of(number);
            let motion = motions.get(number);
            for own in &fit.signals {
                let wheel = wheel_and_field(&own.signal).filter(|(_, field)| *field == signal);
                if own.signal != signal && (*condition != Condition::Wheel || wheel.is_none()) {
                    continue;
                }
                for (row, residual) in own.residual.iter().enumerate().filter(|(_, residual)| !residual.is_nan()) {
                    let at = match (condition, wheel) {
                        (Condition::Wheel, Some((wheel, _))) => Some(wheel as f64),
                        _ => condition.value(number, run, motion, row).filter(|at| !at.is_nan()),
                    };
                    if let Some(at) = at {
                        values.push((at, *residual));
                        of_samples.push(group);
                    }
                }
            }
        }
        let group_names = sets.into_iter().map(|(name, _)| name).collect();
        let levels = levels_of(values.clone());
        let samples = Self {
            signal: signal.to_owned(),
            condition: condition.clone(),
            values,
            groups: of_samples,
            group_names,
            levels,
        };
        (!samples.levels.is_empty()).then_some(samples)
    }

    /// The largest mean residual over the levels, in the signal's unit.
    pub fn worst(&self) -> f64 {
        self.worst_level().map_or(0.0, |level| level.mean.abs())
    }

    /// The level with the largest mean residual.
    pub fn worst_level(&self) -> Option<&Level> {
        self.levels.iter().max_by(|a, b| a.mean.abs().total_cmp(&b.mean.abs()))
    }
}

/// Every signal with every condition of an experiment; `radius` is that of the wheels, m.
pub(in crate::report) fn conditions(experiment: &Experiment, radius: f64) -> Vec<(String, Condition)> {
    let mut all = Vec::new();
    let mut fields: Vec<(String, usize)> = Vec::new();
    for signal in experiment.signals() {
        let wheel = wheel_and_field(&signal).map(|(wheel, field)| (wheel, field.to_owned()));
        let number = wheel.as_ref().map_or(1, |(number, _)| *number);
        let mut own = of(experiment).conditions(experiment, number, radius);
        own.push(Condition::Run);
        own.retain(|condition| *condition != Condition::column(&signal));
        all.extend(own.into_iter().map(|condition| (signal.clone(), condition)));
        if let Some((_, field)) = wheel {
            match fields.iter_mut().find(|(known, _)| *known == field) {
                Some((_, count)) => *count += 1,
                None => fields.push((field, 1)),
            }
        }
    }
    let several = fields.into_iter().filter(|(_, wheels)| *wheels > 1);
    all.extend(several.map(|(field, _)| (field, Condition::Wheel)));
    all
}

/// Names of the groups of repeats, a single run being a group of its own, and the runs of each.
fn groups(experiment: &Experiment) -> Vec<(String, Vec<usize>)> {
    let mut groups: Vec<(String, Vec<usize>)> = Vec::new();
    for (k, run) in experiment.runs.iter().enumerate() {
        let known =
            groups.iter_mut().find(|(_, runs)| run.group.is_some() && experiment.runs[runs[0]].group == run.group);
        match known {
            Some((_, runs)) => runs.push(k),
            None => groups.push((run.group.clone().unwrap_or_else(|| run.name.clone()), vec![k])),
        }
    }
    groups
}
