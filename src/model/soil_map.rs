//! A map of the soil along x, for a controller that has one.

use super::Model;
use crate::control::{ControlError, Nominal};
use crate::signals::Measurement;
use crate::snapshot::Moving;
use crate::soil::Soil;
use crate::terrain::Terrain;
use bekker_modeldescription::Over;

/// The ground's soil along x as a controller knows it, and where the controller holds itself to be.
///
/// What the controller believes of the soil may differ from the truth (lugs that make it stronger, an estimate that is off):
/// the map tells how many times as much of each parameter there is as elsewhere.
#[derive(Clone, Moving)]
pub(super) struct SoilMap {
    #[not_moving]
    terrain: Terrain,
    /// The ground's soil where its table says nothing.
    #[not_moving]
    base: Soil,
    /// What the controller believes of that soil.
    #[not_moving]
    believed: Soil,
    /// Place of the chassis reference point by dead reckoning, m.
    x: f64,
    /// Time of the reading before, s.
    time: Option<f64>,
}

impl SoilMap {
    pub fn new(model: &Model, nominal: &Nominal) -> Self {
        let rover = &model.rover;
        let (terrain, x) = (rover.terrain.clone(), model.start.x0);
        Self { terrain, base: rover.soil, believed: nominal.soil, x, time: None }
    }

    /// The soil that is believed to be `along` (m) ahead of the reference point.
    pub fn at(&self, along: f64) -> Soil {
        let there = self.terrain.soil(&self.base, self.x + along);
        let mut soil = self.believed;
        // Believed over base, or nothing where the base has nothing of it; then times what is there.
        soil.merge(&self.base, &|believed, base| if base == 0.0 { f64::NAN } else { believed / base });
        soil.merge(&there, &|ratio: f64, there| if ratio.is_nan() { there } else { ratio * there });
        soil
    }

    /// The mean over places, m ahead of the reference point; the belief itself without any.
    pub fn mean(&self, along: impl Iterator<Item = f64>) -> Soil {
        let (mut sum, mut count) = (None::<Soil>, 0.0);
        for place in along {
            let soil = self.at(place);
            match &mut sum {
                None => sum = Some(soil),
                Some(sum) => sum.merge(&soil, &|sum, one| sum + one),
            }
            count += 1.0;
        }
        sum.map_or(self.believed, |sum| sum.map(&|value| value / count))
    }

    /// Moves on by what is measured: the speed along the chassis.
    ///
    /// # Errors
    /// [`ControlError::NotFinite`].
    pub fn travel(&mut self, measured: &Measurement) -> Result<(), ControlError> {
        let step = measured.time - self.time.unwrap_or(measured.time);
        let x = self.x + step * measured.velocity * measured.pitch.cos();
        if !x.is_finite() {
            return Err(ControlError::NotFinite { quantity: "dead-reckoned place", wheel: None, value: x });
        }
        (self.x, self.time) = (x, Some(measured.time));
        Ok(())
    }
}
