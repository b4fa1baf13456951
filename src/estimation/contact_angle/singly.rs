//! Contact angles of a rover some of whose wheels may hang in the air: every pair by itself.

use super::filter::{Innovation, PairFilter, PairModel, PairReading};
use super::pairs::{Pair, Point};
use super::parameters::ContactAngleEstimation;
use crate::snapshot::{Moving, Reader, SnapshotError, Writer, loaded};

/// A [`PairFilter`] for every pair. Errors that pairs share are not modelled across them: where several see one wheel, the estimate
/// is their mean weighted by inverse variance, and its deviation the one that fully correlated errors give.
#[derive(Clone, Debug)]
pub(super) struct PairFilters {
    pairs: Vec<Pair>,
    models: Vec<PairModel>,
    filters: Vec<Option<PairFilter>>,
    slip: f64,
}

impl Moving for PairFilters {
    fn save(&self, to: &mut Writer) {
        for filter in &self.filters {
            filter.is_some().save(to);
            filter.iter().for_each(|filter| filter.save(to));
        }
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        for k in 0..self.filters.len() {
            self.filters[k] = match loaded(from)? {
                false => None,
                true => {
                    // Any reading will do: all that it leaves is overwritten.
                    let reading = PairReading { inclination: [0.0; 2], rate: None, speeds: [[0.0; 2]; 2] };
                    let mut filter = PairFilter::new(self.models[k], &reading);
                    filter.load(from)?;
                    Some(filter)
                }
            };
        }
        Ok(())
    }
}

impl PairFilters {
    pub fn new(pairs: Vec<Pair>, parameters: &ContactAngleEstimation) -> Self {
        let ContactAngleEstimation { rate_drift, speed_drift, angle_deviation, correlation_length, slip, .. } =
            *parameters;
        let kinematic_error = parameters.kinematic_error.hypot(parameters.slip_deviation);
        let model = |pair: &Pair| {
            // Ground under two wheels is parallel to their line on the average; a line to a joint is inclined to it.
            let wheels = pair.points.iter().all(|point| matches!(point, Point::Wheel(_)));
            let offset = if wheels { 0.0 } else { pair.inclination };
            let distance = pair.distance;
            PairModel {
                distance,
                rate_drift,
                speed_drift,
                offset,
                angle_deviation,
                correlation_length,
                kinematic_error,
            }
        };
        Self { models: pairs.iter().map(model).collect(), filters: vec![None; pairs.len()], pairs, slip }
    }

    /// Takes a reading in: of every pair inclination and rate, of every wheel the speed of the rim past its centre, each with its variance.
    pub fn step(
        &mut self,
        dt: f64,
        inclinations: &[[f64; 2]],
        rates: Option<&[[f64; 2]]>,
        rims: &[[f64; 2]],
    ) -> Innovation {
        let mut innovation = Innovation::default();
        for k in 0..self.pairs.len() {
            let speeds = self.pairs[k].points.map(|point| match point {
                Point::Wheel(wheel) => {
                    let grip = 1.0 - self.slip;
                    [grip * rims[wheel][0], grip * grip * rims[wheel][1]]
                }
                Point::Pivot { pair, place } => self.joint_speed(pair, place),
            });
            let reading = PairReading { inclination: inclinations[k], rate: rates.map(|rates| rates[k]), speeds };
            if let Some(filter) = &mut self.filters[k] {
                let Innovation { nis, count } = filter.step(dt, &reading);
                innovation.nis += nis;
                innovation.count += count;
            } else {
                self.filters[k] = Some(PairFilter::new(self.models[k], &reading));
            }
        }
        innovation
    }

    /// Rate of a pair's line and its variance, as far as known.
    pub fn rate(&self, pair: usize) -> [f64; 2] {
        self.filters[pair].map(|filter| filter.rate()).unwrap_or_default()
    }

    /// Contact angle of a wheel and its deviation, of all pairs that it is in.
    pub fn angle(&self, wheel: usize) -> [f64; 2] {
        let (mut weights, mut sum, mut spread) = (0.0, 0.0, 0.0);
        for (pair, filter) in self.pairs.iter().zip(&self.filters) {
            let place = pair.points.iter().position(|point| *point == Point::Wheel(wheel));
            let (Some(place), Some(filter)) = (place, filter) else { continue };
            let [angle, deviation] = filter.angle(place);
            let weight = (deviation * deviation).max(f64::MIN_POSITIVE).recip();
            weights += weight;
            sum += weight * angle;
            spread += weight * deviation;
        }
        [sum / weights, spread / weights]
    }

    pub fn restarts(&self) -> u32 {
        self.filters.iter().flatten().map(PairFilter::restarts).sum()
    }

    pub fn reset(&mut self) {
        self.filters.fill(None);
    }

    /// Speed of a joint and its variance from the filter of a pair on one of its bodies.
    fn joint_speed(&self, pair: usize, place: [f64; 2]) -> [f64; 2] {
        let inclination = self.pairs[pair].inclination;
        self.filters[pair].map_or([0.0; 2], |filter| filter.speed_of(place, inclination))
    }
}
