//! What sensors record of modelled signals: late, in proportion, and from another zero, as far as the experiment says that
//! they may ([`Sensor`](crate::measurement::Sensor)).
//!
//! Errors of sensors are free parameters of every fit, with their priors. They act on the modelled values, after the
//! simulation, so that one simulation serves all of their derivatives. A delay is met by interpolation between the rows of a
//! stretch that is simulated as a whole (a run, a window).

use super::free::Free;
use super::layout::Layout;
use super::prediction::{Derivatives, Predict, PredictionError};
use super::problem::Problem;
use super::shift::Shift;
use super::unanswered::Answers;
use super::windows::free::FreeStart;
use crate::measurement::{Experiment, SensorError};
use std::ops::Range;

/// Where the value of an error stands: among the free parameters, or it is held.
#[derive(Clone, Copy, Debug)]
enum Place {
    Free(usize),
    Held(f64),
}

impl Place {
    fn value(self, free: &[f64]) -> f64 {
        match self {
            Self::Free(at) => free[at],
            Self::Held(value) => value,
        }
    }
}

/// One measured signal of one run whose sensor has errors.
#[derive(Debug)]
struct Channel<'p> {
    run: usize,
    /// Place of the signal among those of its run.
    signal: usize,
    /// Where its values stand in the layout.
    range: Range<usize>,
    /// Times of the rows, s.
    time: &'p [f64],
    /// Rows that are simulated together.
    stretches: Vec<Range<usize>>,
    delay: Place,
    gain: Place,
    bias: Place,
}

/// The sensors of an experiment, with some of their errors free.
#[derive(Debug)]
pub(super) struct Sensors<'p> {
    channels: Vec<Channel<'p>>,
    /// Which of the free parameters are the model's.
    of_model: Vec<usize>,
}

impl<'p> Sensors<'p> {
    /// Of a problem whose parameters `free` are free; an error that is not among them has the mean of its prior.
    pub fn of(problem: &'p Problem, free: &[Free]) -> Self {
        let experiment: &Experiment = &problem.experiment;
        let channels = problem.layout.blocks.iter().filter_map(|block| {
            let sensor = experiment.sensors.get(&block.signal)?;
            let place = |error: SensorError| {
                let name = error.parameter(&block.signal);
                let held = || sensor.prior(error).map_or(error.neutral(), |prior| prior.mean);
                free.iter().position(|free| free.variable.name == name).map_or_else(|| Place::Held(held()), Place::Free)
            };
            let whole = 0..block.range.len();
            let windows = problem.windows.get(block.run).map_or(&[][..], Vec::as_slice);
            let stretches = match windows {
                [] => vec![whole],
                _ => windows.iter().map(|window| window.rows.clone()).collect(),
            };
            Some(Channel {
                run: block.run,
                signal: problem.layout.of_run(block.run).position(|own| own.signal == block.signal)?,
                range: block.range.clone(),
                time: experiment.runs[block.run].data.column("time")?,
                stretches,
                delay: place(SensorError::Delay),
                gain: place(SensorError::Gain),
                bias: place(SensorError::Bias),
            })
        });
        let of_model = (0..free.len()).filter(|at| !free[*at].is_of_a_sensor()).collect();
        Self { channels: channels.collect(), of_model }
    }

    /// Those of `all` (free parameters, or one value each) that are the model's.
    pub fn model_part<T: Clone>(&self, all: &[T]) -> Vec<T> {
        self.of_model.iter().map(|at| all[*at].clone()).collect()
    }

    /// Turns modelled values into what the sensors record of them.
    fn record(&self, values: &mut [f64], free: &[f64]) {
        for channel in &self.channels {
            let (gain, bias) = (channel.gain.value(free), channel.bias.value(free));
            let own = &mut values[channel.range.clone()];
            for shift in channel.shifts(own, free) {
                let late = shift.late(own);
                own[shift.rows()].iter_mut().zip(late).for_each(|(place, late)| *place = gain * late + bias);
            }
        }
    }

    /// The same, and derivatives in the model's parameters turned into those of what is recorded in all free ones.
    fn record_slopes(&self, values: &mut [f64], of_model: Vec<Vec<f64>>, free: &[f64]) -> Vec<Vec<f64>> {
        let mut slopes = vec![vec![0.0; values.len()]; free.len()];
        self.of_model.iter().zip(of_model).for_each(|(at, slope)| slopes[*at] = slope);
        for channel in &self.channels {
            let (gain, bias) = (channel.gain.value(free), channel.bias.value(free));
            let own = &mut values[channel.range.clone()];
            for shift in channel.shifts(own, free) {
                let rows = channel.range.start + shift.rows().start..channel.range.start + shift.rows().end;
                for at in &self.of_model {
                    let late = shift.late(&slopes[*at][channel.range.clone()]);
                    slopes[*at][rows.clone()].iter_mut().zip(late).for_each(|(place, late)| *place = gain * late);
                }
                let (late, rate) = (shift.late(own), shift.rate(own));
                if let Place::Free(at) = channel.delay {
                    slopes[at][rows.clone()].iter_mut().zip(rate).for_each(|(place, rate)| *place = -gain * rate);
                }
                if let Place::Free(at) = channel.gain {
                    slopes[at][rows.clone()].copy_from_slice(&late);
                }
                if let Place::Free(at) = channel.bias {
                    slopes[at][rows.clone()].fill(1.0);
                }
                own[shift.rows()].iter_mut().zip(late).for_each(|(place, late)| *place = gain * late + bias);
            }
        }
        slopes
    }

    /// Turns what modelled values depend on at the starts of windows into what the records depend on.
    pub fn record_starts(&self, starts: &mut [FreeStart], free: &[f64]) {
        for start in starts {
            for channel in self.channels.iter().filter(|channel| channel.run == start.run) {
                let Some(slopes) = start.slopes.get_mut(channel.signal) else { continue };
                let shift = Shift::new(&channel.time[start.rows.clone()], 0..slopes.len(), channel.delay.value(free));
                let (gain, late) = (channel.gain.value(free), shift.late(slopes));
                slopes.iter_mut().zip(late).for_each(|(slope, late)| *slope = gain * late);
            }
        }
    }
}

impl Channel<'_> {
    /// The delay over each stretch of rows that have an answer.
    fn shifts(&self, values: &[f64], free: &[f64]) -> Vec<Shift> {
        let delay = self.delay.value(free);
        let mut shifts = Vec::new();
        for stretch in &self.stretches {
            let mut from = stretch.start;
            for row in stretch.clone().chain([stretch.end]) {
                if row == stretch.end || values[row].is_nan() {
                    if from < row {
                        shifts.push(Shift::new(self.time, from..row, delay));
                    }
                    from = row + 1;
                }
            }
        }
        shifts
    }
}

/// What sensors record of what the model predicts.
pub(super) struct Readings<'a> {
    pub signals: &'a dyn Predict,
    pub sensors: &'a Sensors<'a>,
}

impl Predict for Readings<'_> {
    fn layout(&self) -> &Layout {
        self.signals.layout()
    }

    fn tolerance(&self) -> f64 {
        self.signals.tolerance()
    }

    fn derivatives(&self) -> Derivatives {
        self.signals.derivatives()
    }

    fn answers(&self, free: &[f64]) -> Result<Answers, PredictionError> {
        let mut answers = self.signals.answers(&self.sensors.model_part(free))?;
        self.sensors.record(&mut answers.values, free);
        Ok(answers)
    }

    fn slopes(&self, free: &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError> {
        let (mut values, slopes) = self.signals.slopes(&self.sensors.model_part(free))?;
        let slopes = self.sensors.record_slopes(&mut values, slopes, free);
        Ok((values, slopes))
    }

    fn values_onward(&self, free: &[f64]) -> Result<Vec<f64>, PredictionError> {
        let mut values = self.signals.values_onward(&self.sensors.model_part(free))?;
        self.sensors.record(&mut values, free);
        Ok(values)
    }

    fn slopes_onward(&self, free: &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError> {
        let (mut values, slopes) = self.signals.slopes_onward(&self.sensors.model_part(free))?;
        let slopes = self.sensors.record_slopes(&mut values, slopes, free);
        Ok((values, slopes))
    }
}
