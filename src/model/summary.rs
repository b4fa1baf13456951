//! Figures of a drive: averages over its time.

use super::Run;

/// Averages over a drive so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Summary {
    /// Time driven, s.
    pub time: f64,
    /// Way along x, m.
    pub distance: f64,
    /// Mean speed, m/s.
    pub speed: f64,
    /// Mean power dissipated in the windings, the thesis's measure (4.6), W.
    pub power: f64,
    /// Mean electrical power, W.
    pub electrical_power: f64,
    /// Electrical energy a metre of way, J/m; infinite where there was no way.
    pub energy_per_metre: f64,
    /// Mean slip over time and wheels (a plain mean of the signal).
    pub slip: f64,
    /// Largest rim speed relative to the carrying body, m/s.
    pub largest_rim_speed: f64,
    /// Largest pitch up or down, rad.
    pub largest_pitch: f64,
}

/// Collects a [`Summary`] from samples of the signals, evenly spaced in time.
#[derive(Clone, Debug, Default)]
pub struct SummaryBuilder {
    start_x: Option<f64>,
    samples: usize,
    slip: f64,
    rim_speed: f64,
    largest_pitch: f64,
}

impl SummaryBuilder {
    /// Takes one sample of a run; the first is the start.
    pub fn push(&mut self, run: &Run) {
        let (signals, radius) = (run.signals(), run.simulation().rover().wheel.radius);
        if self.start_x.is_none() {
            self.start_x = Some(signals.body.x);
            return;
        }
        self.samples += 1;
        self.slip += signals.wheels.iter().map(|wheel| wheel.slip).sum::<f64>() / signals.wheels.len() as f64;
        let fastest = signals.wheels.iter().map(|wheel| wheel.speed.abs()).fold(0.0, f64::max);
        self.rim_speed = self.rim_speed.max(radius * fastest);
        self.largest_pitch = self.largest_pitch.max(signals.body.pitch.abs());
    }

    /// The averages up to now.
    #[must_use]
    pub fn summary(&self, run: &Run) -> Summary {
        let (time, body) = (run.time(), &run.signals().body);
        let distance = body.x - self.start_x.unwrap_or(body.x);
        let mean = |sum: f64| if time > 0.0 { sum / time } else { 0.0 };
        Summary {
            time,
            distance,
            speed: mean(distance),
            power: mean(body.dissipated_energy),
            electrical_power: mean(body.electrical_energy),
            energy_per_metre: body.electrical_energy / distance.abs(),
            slip: self.slip / self.samples.max(1) as f64,
            largest_rim_speed: self.rim_speed,
            largest_pitch: self.largest_pitch,
        }
    }
}
