//! Stands in for `lanes.rs` without the feature `batch`: a type without values, so that no code is compiled for it.

use super::TerrainError;
use super::curve::{Curve, Sample};
use super::foot::Foot;
use crate::scalar::{Plain, Scalar};
use crate::soil::Soil;

/// No value of this type exists.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum LaneTerrains {}

impl LaneTerrains {
    pub fn shapes(&self) -> bool {
        match *self {}
    }

    pub fn foot<R: Plain>(&self, _: [R; 2]) -> Result<Foot<R>, TerrainError> {
        match *self {}
    }

    pub fn soil<S: Scalar>(&self, _: &Soil<S>, _: S) -> Soil<S> {
        match *self {}
    }
}

impl<R: Plain> Curve<R> for LaneTerrains {
    fn at(&self, _: R) -> Sample<R> {
        match *self {}
    }

    fn bend(&self, _: f64, _: f64, _: f64, _: &Sample<f64>) -> f64 {
        match *self {}
    }
}
