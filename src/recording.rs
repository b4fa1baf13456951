//! What is recorded of the signals, with the memory of the lags between them and their record.

use crate::effects::{Effects, Lagged};
use crate::scalar::Scalar;
use crate::signals::Signals;
use crate::snapshot::{Moving, Reader, SnapshotError, Writer};

/// What records the signals; without a lag among the effects it costs nothing and changes nothing.
#[derive(Clone, Debug)]
pub(crate) struct Recorder<S = f64> {
    /// One behind the other.
    lags: Vec<Lagged<S>>,
}

// How many there are follows from the effects.
impl Moving for Recorder {
    fn save(&self, to: &mut Writer) {
        self.lags.iter().for_each(|lag| lag.save(to));
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        self.lags.iter_mut().try_for_each(|lag| lag.load(from))
    }
}

impl<S: Scalar> Recorder<S> {
    /// A recorder for such signals and inner steps of `step_size` seconds.
    pub fn new(effects: &Effects<S>, signals: &Signals<S>, step_size: f64) -> Self {
        Self { lags: effects.lags().iter().map(|lag| Lagged::new(lag, signals, step_size)).collect() }
    }

    /// Whether it has to see every step.
    pub fn lags(&self) -> bool {
        !self.lags.is_empty()
    }

    /// Takes in the signals at the end of an inner step.
    pub fn step(&mut self, signals: &mut Signals<S>) {
        self.pass_on(signals, Lagged::step);
    }

    /// Takes in signals that have jumped between two steps, as torques do with a new command.
    pub fn jump(&mut self, signals: &mut Signals<S>) {
        self.pass_on(signals, Lagged::jump);
    }

    /// Each lag takes in what the one before it gives.
    fn pass_on(&mut self, signals: &mut Signals<S>, take: fn(&mut Lagged<S>, &mut Signals<S>)) {
        if let Some((last, before)) = self.lags.split_last_mut() {
            for lag in before {
                take(lag, signals);
                lag.record(signals);
            }
            take(last, signals);
        }
    }

    /// Replaces the signals by what is recorded at their instant.
    pub fn record(&self, signals: &mut Signals<S>) {
        // Each from its own memory: what two of them delay is as the later one, behind the other, gives it.
        self.lags.iter().for_each(|lag| lag.record(signals));
    }
}
