//! The prediction of single-wheel experiments: every row is a steady point of its own.

use crate::carriage::{Rig, SteadyError, SteadyPoint, partial, share_not_carried, steady_point};
use crate::diagnosis::halt::Halt;
use crate::diagnosis::layout::Layout;
use crate::diagnosis::prediction::{Predict, PredictionError};
use crate::diagnosis::thresholds::MISSED_BY;
use crate::diagnosis::unanswered::{Answers, Unanswered, all_answered};
use crate::measurement::Experiment;
use crate::scalar::{Dual, Scalar};
use bekker_modeldescription::Parameters;
use std::collections::{BTreeMap, HashMap};

/// Steady points of a wheel on a carriage.
pub(crate) struct SingleWheelPrediction<'a> {
    experiment: &'a Experiment,
    layout: &'a Layout,
    /// One a run, with what is known of that run.
    rigs: Vec<Rig>,
    names: Vec<String>,
    halt: Halt<'a>,
    /// Steady points to be computed; rows that repeat one follow it.
    points: Vec<Point>,
    /// By signal, how far a search takes a value without an answer to be missed.
    missed_by: BTreeMap<String, f64>,
}

/// A set-point and the rows, by run and index, that were measured at it.
struct Point {
    /// Load (N), slip and wheel speed (rad/s).
    inputs: [f64; 3],
    rows: Vec<(usize, usize)>,
}

impl<'a> SingleWheelPrediction<'a> {
    /// `rigs` has one rig a run; `names` are the free parameters. A parameter that a run sets itself stays as it is.
    /// The points end early where `halt` asks for it.
    pub fn new(
        experiment: &'a Experiment,
        layout: &'a Layout,
        rigs: Vec<Rig>,
        names: Vec<String>,
        halt: Halt<'a>,
    ) -> Self {
        let points = points(experiment, &rigs, &names);
        let missed_by = |signal: String| (signal.clone(), MISSED_BY * layout.scatter(&signal));
        let missed_by = experiment.signals().into_iter().map(missed_by).collect();
        Self { experiment, layout, rigs, names, halt, points, missed_by }
    }

    /// Sets the free parameters of a run's rig; `place` gets the index of the parameter and where it goes.
    fn set_free<S: Scalar>(&self, run: usize, rig: &mut Rig<S>, place: &dyn Fn(usize, &mut S)) {
        let own = &self.experiment.runs[run].parameters;
        rig.visit("", &mut |variable, value| {
            if let Some(k) = self.names.iter().position(|name| *name == variable.name)
                && !own.contains_key(&variable.name)
            {
                place(k, value);
            }
        });
    }

    /// Calls `store` with the place of every value that has an answer and what the model says there; where a search goes
    /// `onward` also with what it counts elsewhere. Returns the rows without an answer.
    fn each_value<S: Scalar>(
        &self,
        rig_of: &dyn Fn(usize) -> Rig<S>,
        onward: bool,
        store: &mut dyn FnMut(usize, S),
    ) -> Result<Vec<Unanswered>, PredictionError> {
        let rigs: Vec<Rig<S>> = (0..self.rigs.len()).map(rig_of).collect();
        let mut unanswered = Vec::new();
        for Point { inputs: [load, slip, wheel_speed], rows } in &self.points {
            if self.halt.asked() {
                return Err(PredictionError::Interrupted);
            }
            let rig = &rigs[rows[0].0];
            let places = rows.iter().flat_map(|(run, row)| self.layout.of_run(*run).map(move |block| (block, *row)));
            match steady_point(rig, *load, *slip, *wheel_speed) {
                Ok(steady) => {
                    places.for_each(|(block, row)| store(block.range.start + row, signal(&steady, &block.signal)));
                }
                Err(source) => {
                    let without = |(run, row): &(usize, usize)| self.unanswered(*run, *row, source.clone());
                    if !source.is_of_the_row() {
                        return Err(without(&rows[0]).error);
                    }
                    unanswered.extend(rows.iter().map(without));
                    if onward {
                        let share = share_not_carried(rig, *load, *slip, *wheel_speed) + 1.0;
                        places.for_each(|(block, row)| {
                            let at = block.range.start + row;
                            store(at, share * self.missed_by[&block.signal] + self.layout.recorded[at]);
                        });
                    }
                }
            }
        }
        Ok(unanswered)
    }

    fn unanswered(&self, run: usize, row: usize, source: SteadyError) -> Unanswered {
        let name = self.experiment.runs[run].name.clone();
        Unanswered { run, rows: row..row + 1, error: PredictionError::Steady { run: name, row: row + 1, source } }
    }

    /// Values, NaN where there is no answer, unless the search goes `onward`; and the rows without one.
    fn values_by(&self, free: &[f64], onward: bool) -> Result<Answers, PredictionError> {
        let mut values = vec![f64::NAN; self.layout.len()];
        let rig_of = |run: usize| {
            let mut rig = self.rigs[run].clone();
            self.set_free(run, &mut rig, &|k, place| *place = free[k]);
            rig
        };
        let unanswered = self.each_value(&rig_of, onward, &mut |at, value| values[at] = value)?;
        Ok(Answers { values, unanswered })
    }

    fn slopes_by<const N: usize>(
        &self,
        free: &[f64],
        onward: bool,
    ) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError> {
        let mut values = vec![f64::NAN; self.layout.len()];
        let mut slopes = vec![vec![0.0; self.layout.len()]; free.len()];
        for first in (0..free.len().max(1)).step_by(N) {
            let rig_of = |run: usize| {
                let mut rig = self.rigs[run].map(&|value| Dual::<N>::from(value));
                self.set_free(run, &mut rig, &|k, place| {
                    let value = Dual::from(free[k]);
                    *place = if (first..first + N).contains(&k) { value.derivative(k - first) } else { value };
                });
                rig
            };
            let unanswered = self.each_value(&rig_of, onward, &mut |at, value| {
                values[at] = value.re;
                for (k, slope) in slopes[first..].iter_mut().take(N).enumerate() {
                    slope[at] = partial(&value, k);
                }
            })?;
            if !onward {
                all_answered(&unanswered, self.layout)?;
            }
        }
        Ok((values, slopes))
    }

    fn all_slopes(&self, free: &[f64], onward: bool) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError> {
        // Derivatives that travel together. Two widths only: each is one more copy of the physics to compile.
        match free.len() {
            0..=8 => self.slopes_by::<8>(free, onward),
            _ => self.slopes_by::<12>(free, onward),
        }
    }
}

/// Set-points of an experiment. Runs share them where their rigs and what they leave free are the same.
fn points(experiment: &Experiment, rigs: &[Rig], names: &[String]) -> Vec<Point> {
    let own = |run: usize| names.iter().map(move |name| experiment.runs[run].parameters.contains_key(name));
    let alike = |a: usize, b: usize| rigs[a] == rigs[b] && own(a).eq(own(b));
    let first_alike: Vec<usize> = (0..rigs.len()).map(|k| (0..k).find(|j| alike(*j, k)).unwrap_or(k)).collect();
    let mut points: Vec<Point> = Vec::new();
    let mut known: HashMap<(usize, [u64; 3]), usize> = HashMap::new();
    for (k, run) in experiment.runs.iter().enumerate() {
        for row in 0..run.data.rows() {
            let inputs = ["load", "slip", "wheel_speed"].map(|name| run.data.value(name, row).unwrap_or(f64::NAN));
            let at = *known.entry((first_alike[k], inputs.map(f64::to_bits))).or_insert(points.len());
            match points.get_mut(at) {
                Some(point) => point.rows.push((k, row)),
                None => points.push(Point { inputs, rows: vec![(k, row)] }),
            }
        }
    }
    points
}

/// The signals that a single wheel can measure, see `measurement`.
pub(crate) fn signal<S: Copy>(point: &SteadyPoint<S>, name: &str) -> S {
    match name {
        "drawbar_pull" => point.drawbar_pull,
        "torque" => point.torque,
        _ => point.sinkage,
    }
}

impl Predict for SingleWheelPrediction<'_> {
    fn layout(&self) -> &Layout {
        self.layout
    }

    fn answers(&self, free: &[f64]) -> Result<Answers, PredictionError> {
        self.values_by(free, false)
    }

    fn slopes(&self, free: &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError> {
        self.all_slopes(free, false)
    }

    fn values_onward(&self, free: &[f64]) -> Result<Vec<f64>, PredictionError> {
        Ok(self.values_by(free, true)?.values)
    }

    fn slopes_onward(&self, free: &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError> {
        self.all_slopes(free, true)
    }
}
