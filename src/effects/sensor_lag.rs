//! Lag and dead time between the signals and their record, with the memory that this takes.
//!
//! Each inner step filters every signal but the energies by the exact solution of T y' = u - y for an input that
//! runs straight over the step, and keeps the result in a ring. A record is read off the ring, the dead time ago, by
//! a monotone cubic: continuous, with a continuous derivative in the dead time, and without overshoot at jumps.

use super::{Advice, Effect, Facts};
use crate::scalar::{Scalar, lanes};
use crate::signals::{BodySignals, LinkSignals, Signals, WheelSignals};
use crate::snapshot::{Moving, Reader, SnapshotError, Writer};
use bekker_modeldescription::{Over, Unit, parameters};

/// Signals of the body's motion, of the body in all, of a wheel and of a link that are lagged.
const MOTION: usize = 5;
const BODY: usize = 7;
const WHEEL: usize = 8;
const LINK: usize = 2;

/// Time constants under this share of a step have no past: exp(-40) is below rounding.
const NO_PAST: f64 = 1.0 / 40.0;

parameters! {
    /// What is recorded follows the truth with a first-order lag and a dead time; energies are not lagged.
    pub struct SensorLag {
        /// Time constant of the first-order lag.
        time_constant: [Unit::SECOND] = 0.0, 0.0..=1.0, Effect, "filters of sensors and drives: 20-200 ms";
        /// Dead time.
        dead_time: [Unit::SECOND] = 0.0, 0.0..=0.5, Effect, "sampling and transmission: 20-200 ms";
    }
}

/// Which signals are late.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Delayed {
    /// All but the energies, which nothing measures.
    All,
    /// Where the body is and how it moves.
    Body,
}

/// Lag and dead time of a record, s.
#[derive(Clone, Copy, Debug)]
pub struct RecordingLag<S = f64> {
    /// Time constant of a first-order lag.
    pub time_constant: S,
    /// Dead time.
    pub dead_time: S,
    /// What is late.
    pub of: Delayed,
}

impl<S: Copy, T: Copy> Over<S, T> for RecordingLag<S> {
    type Output = RecordingLag<T>;

    fn over(&self, f: &dyn Fn(S) -> T) -> RecordingLag<T> {
        RecordingLag { time_constant: f(self.time_constant), dead_time: f(self.dead_time), of: self.of }
    }

    fn merge(&mut self, part: &RecordingLag<T>, put: &dyn Fn(S, T) -> S) {
        self.time_constant = put(self.time_constant, part.time_constant);
        self.dead_time = put(self.dead_time, part.dead_time);
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for SensorLag<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_rover: &["velocity"],
            smooth_at_neutral: &["time_constant", "dead_time"],
            advice: const { &[Advice::rover("start and stop in steps: a lag shows in transients only")] },
            tunable: false,
            ..Facts::USUAL
        }
    }

    fn lag(&self) -> Option<RecordingLag<S>> {
        let Self { time_constant, dead_time } = *self;
        let acts = !(time_constant.is_exactly(0.0) && dead_time.is_exactly(0.0));
        acts.then_some(RecordingLag { time_constant, dead_time, of: Delayed::All })
    }
}

/// The memory of a lag: what the signals were.
#[derive(Clone, Debug)]
pub(crate) struct Lagged<S> {
    of: Delayed,
    /// Share of the filtered value that a step keeps, exp(-h/T).
    decay: S,
    /// Mean of the same over the step: the weight that is not yet the input's end.
    mean: S,
    /// Dead time in steps.
    delay: S,
    /// Signals at the start of the present step.
    input: Vec<S>,
    /// Filtered signals, one row a step.
    ring: Vec<S>,
    /// Row of the newest.
    newest: usize,
    /// Whether there is a past at all.
    started: bool,
}

impl Moving for Lagged<f64> {
    fn save(&self, to: &mut Writer) {
        let Self { input, ring, newest, started, of: _, decay: _, mean: _, delay: _ } = self;
        input.save(to);
        ring.save(to);
        newest.save(to);
        started.save(to);
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        let Self { input, ring, newest, started, .. } = self;
        input.load(from)?;
        ring.load(from)?;
        newest.load(from)?;
        if *newest * input.len() >= ring.len() {
            return Err(SnapshotError::Code { what: "a row of the recorder", code: *newest as u64 });
        }
        started.load(from)
    }
}

impl<S: Scalar> Lagged<S> {
    /// The memory for such signals and inner steps of `step_size` seconds.
    pub fn new(lag: &RecordingLag<S>, signals: &Signals<S>, step_size: f64) -> Self {
        let channels = match lag.of {
            Delayed::All => BODY + WHEEL * signals.wheels.len() + LINK * signals.links.len(),
            Delayed::Body => MOTION,
        };
        let zero = S::from(0.0);
        let constant = lag.time_constant / step_size;
        let decay = if constant.value() > NO_PAST { (-constant.recip()).exp() } else { zero };
        let delay = lag.dead_time / step_size;
        // Two rows to interpolate between, one older for the slope.
        let rows = delay.value().floor() as usize + 3;
        Self {
            of: lag.of,
            decay,
            mean: (S::from(1.0) - decay) * constant,
            delay,
            input: vec![zero; channels],
            ring: vec![zero; rows * channels],
            newest: 0,
            started: false,
        }
    }

    /// Takes in the signals at the end of an inner step.
    pub fn step(&mut self, signals: &mut Signals<S>) {
        let channels = self.input.len();
        let rows = self.ring.len() / channels;
        let (old, new) = (self.newest, (self.newest + 1) % rows);
        let mut channel = 0;
        each(self.of, signals, |signal| {
            let now = *signal;
            if self.started {
                let before = self.input[channel];
                let kept = self.decay * self.ring[old * channels + channel];
                let filtered = kept + (self.mean - self.decay) * before + (S::from(1.0) - self.mean) * now;
                self.ring[new * channels + channel] = filtered;
            } else {
                // Before the start everything was as it is at the start.
                self.ring.iter_mut().skip(channel).step_by(channels).for_each(|place| *place = now);
            }
            self.input[channel] = now;
            channel += 1;
        });
        self.newest = new;
        self.started = true;
    }

    /// Takes in signals that have jumped between two steps, as torques do with a new command.
    pub fn jump(&mut self, signals: &mut Signals<S>) {
        let mut input = self.input.iter_mut();
        each(self.of, signals, |signal| input.next().into_iter().for_each(|place| *place = *signal));
    }

    /// Replaces the signals by what is recorded at their instant.
    pub fn record(&self, signals: &mut Signals<S>) {
        let mut channel = 0;
        each(self.of, signals, |signal| {
            *signal = self.delayed(channel);
            channel += 1;
        });
    }

    /// The filtered signal `age` steps ago.
    fn at(&self, channel: usize, age: usize) -> S {
        let channels = self.input.len();
        let rows = self.ring.len() / channels;
        self.ring[(self.newest + rows - age) % rows * channels + channel]
    }

    /// The filtered signal the dead time ago.
    fn delayed(&self, channel: usize) -> S {
        let whole = self.delay.value().floor();
        let (k, share) = (whole as usize, self.delay - whole);
        let (newer, older) = (self.at(channel, k), self.at(channel, k + 1));
        let rise = older - newer;
        let beyond = self.at(channel, k + 2) - older;
        let start = if k == 0 { rise } else { slope(newer - self.at(channel, k - 1), rise) };
        let end = slope(rise, beyond);
        newer + share * (start + share * (rise * 3.0 - start * 2.0 - end + share * (start + end - rise * 2.0)))
    }
}

/// Slope at a sample between two rises: their harmonic mean, 0 at an extremum (Fritsch and Butland 1984).
fn slope<S: Scalar>(before: S, after: S) -> S {
    if before.value() * after.value() > 0.0 { before * after * 2.0 / (before + after) } else { S::from(0.0) }
}

/// Calls `f` with every signal that is lagged, in a fixed order.
fn each<S>(of: Delayed, signals: &mut Signals<S>, mut f: impl FnMut(&mut S)) {
    let BodySignals { x, z, velocity, pitch, pitch_rate, power, electrical_power, .. } = &mut signals.body;
    [x, z, velocity, pitch, pitch_rate].into_iter().for_each(&mut f);
    if of == Delayed::Body {
        return;
    }
    [power, electrical_power].into_iter().for_each(&mut f);
    for wheel in &mut signals.wheels {
        let WheelSignals { speed, slip, sinkage, normal_force, drawbar_pull, torque, current, contact_angle } = wheel;
        [speed, slip, sinkage, normal_force, drawbar_pull, torque, current, contact_angle].into_iter().for_each(&mut f);
    }
    for LinkSignals { angle, rate } in &mut signals.links {
        [angle, rate].into_iter().for_each(&mut f);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual;

    const STEP: f64 = 0.01;
    /// Central differences over 1e-6 s; at a whole number of steps the second derivative jumps.
    const DIFFERENCES: f64 = 1e-5;

    /// The record of x(t) = sin 3t + t^2 after one second.
    fn record<S: Scalar>(time_constant: S, dead_time: S) -> S {
        let mut signals = Signals::of(1, 0);
        let mut lagged = Lagged::new(&RecordingLag { time_constant, dead_time, of: Delayed::All }, &signals, STEP);
        for k in 0..=100 {
            let t = f64::from(k) * STEP;
            signals.body.x = S::from((3.0 * t).sin() + t * t);
            lagged.step(&mut signals);
        }
        lagged.record(&mut signals);
        signals.body.x
    }

    #[test]
    fn property_derivatives_of_the_record_agree_with_differences() {
        let h = 1e-6;
        // Between steps, at a whole number of steps, and nearly neutral.
        for (lag, dead) in [(0.05, 0.033), (0.2, 0.03), (1e-4, 0.004), (0.01, 1e-5)] {
            let exact = |k: usize| {
                let seed = |j: usize, value: f64| {
                    let value = Dual::<1>::from(value);
                    if j == k { value.derivative(0) } else { value }
                };
                record(seed(0, lag), seed(1, dead)).eps.0.map_or(0.0, |eps| eps[0])
            };
            let differences = [
                (record(lag + h, dead) - record(lag - h, dead)) / (2.0 * h),
                (record(lag, dead + h) - record(lag, dead - h)) / (2.0 * h),
            ];
            for (k, difference) in differences.into_iter().enumerate() {
                let exact = exact(k);
                assert!(
                    (exact - difference).abs() < DIFFERENCES * (1.0 + exact.abs()),
                    "{lag}, {dead}: {exact}, {difference}"
                );
            }
        }
    }

    #[test]
    fn analytic_at_the_neutral_value_both_derivatives_are_minus_the_slope() {
        // x' at t = 1, to the first order of the step.
        let slope = 3.0 * 3.0_f64.cos() + 2.0;
        for (lag, dead) in [
            (Dual::<1>::from(0.0).derivative(0), Dual::from(0.0)),
            (Dual::from(0.0), Dual::<1>::from(0.0).derivative(0)),
        ] {
            let x = record(lag, dead);
            assert!((x.re - (3.0_f64.sin() + 1.0)).abs() < 1e-15);
            let derivative = x.eps.0.map_or(0.0, |eps| eps[0]);
            assert!((derivative + slope).abs() < 0.06, "{derivative}, expected {}", -slope);
        }
    }
}
