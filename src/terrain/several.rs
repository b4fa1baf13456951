//! Several grounds side by side, one under each of several rovers.

use super::curve::{Curve, Sample};
use super::foot::{self, Foot};
use super::samples::cubic;
use super::{Profile, Terrain, TerrainError};
use crate::scalar::{Mask, Plain, Scalar};
use crate::soil::Soil;
use bekker_modeldescription::Parameters;

/// What formulas with a few numbers do not describe: profiles by samples, random ground, tables of soil.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Several {
    grounds: Vec<Terrain>,
    /// Whether all profiles are by samples.
    sampled: bool,
    /// Largest |d2z/dx2| of each.
    bends: Vec<f64>,
    tables: bool,
}

impl Several {
    pub fn new(grounds: Vec<Terrain>) -> Self {
        let bend = |ground: &Terrain| match &ground.profile {
            Profile::Samples(samples) => Some(samples.most_bend()),
            _ => None,
        };
        let bends: Option<Vec<f64>> = grounds.iter().map(bend).collect();
        let tables = grounds.iter().any(|ground| ground.soil.is_some());
        Self { sampled: bends.is_some(), bends: bends.unwrap_or_default(), tables, grounds }
    }

    /// Whether the profiles are only here.
    pub fn shapes(&self) -> bool {
        !matches!(
            self.grounds.first().map(|ground| &ground.profile),
            Some(Profile::Flat | Profile::Slope(_) | Profile::Waves(_) | Profile::Ditch(_) | Profile::Step(_))
        )
    }

    #[cfg_attr(feature = "batch", inline(always))]
    pub fn at<R: Plain>(&self, x: R) -> Sample<R> {
        if self.sampled {
            return Curve::<R>::at(self, x);
        }
        let (mut heights, mut slopes, mut curvatures) = ([0.0; 8], [0.0; 8], [0.0; 8]);
        for k in 0..R::LANES.min(8) {
            let sample = self.grounds[k].at(x.lane(k));
            (heights[k], slopes[k], curvatures[k]) = (sample.height, sample.slope, sample.curvature);
        }
        let several = |numbers: [f64; 8]| R::from_lanes(|k| numbers[k]);
        Sample { height: several(heights), slope: several(slopes), curvature: several(curvatures) }
    }

    #[cfg_attr(feature = "batch", inline(always))]
    pub fn foot<R: Plain>(&self, centre: [R; 2]) -> Result<Foot<R>, TerrainError> {
        let one = |k: usize| self.grounds[k].foot(centre.map(|c| c.lane(k)));
        if !self.sampled {
            let zero = [R::from(0.0); 2];
            let mut feet = Foot { position: zero, angle: zero[0], tangent: zero, normal: zero, distance: zero[0] };
            foot::put_each(&mut feet, Mask::from_lanes(|_| true), one)?;
            return Ok(feet);
        }
        let feet = foot::side_by_side(self, self.most_bend(), one, centre)?;
        for (k, ground) in self.grounds.iter().enumerate() {
            let (x, (from, to)) = (feet.position[0].lane(k), ground.range());
            if x < from || x > to {
                return Err(TerrainError::Left { x, from, to });
            }
        }
        Ok(feet)
    }

    /// The soil at `x` where there are tables.
    #[cfg_attr(feature = "batch", inline(always))]
    pub fn soil<S: Scalar>(&self, base: &Soil<S>, x: S) -> Soil<S> {
        if self.tables { self.soil_of_tables(base, x) } else { *base }
    }

    #[inline(never)]
    fn soil_of_tables<S: Scalar>(&self, base: &Soil<S>, x: S) -> Soil<S> {
        let lane = |x: S, k: usize| x.plain().lane(k);
        let mut numbers = [[0.0; 8]; 16];
        for (k, ground) in self.grounds.iter().enumerate().take(8) {
            let mut rows = numbers.iter_mut();
            ground.soil(&base.map(&|x| lane(x, k)), lane(x, k)).values(&mut |value| {
                if let Some(row) = rows.next() {
                    row[k] = value;
                }
            });
        }
        let next = std::cell::Cell::new(0);
        base.map(&|_| {
            let row = numbers[next.replace(next.get() + 1)];
            S::from_plain(Plain::from_lanes(|k| row[k]))
        })
    }
}

impl<R: Plain> Curve<R> for Several {
    #[cfg_attr(feature = "batch", inline(always))]
    fn at(&self, x: R) -> Sample<R> {
        let mut pieces = [[0.0; 8]; 5];
        for (k, ground) in self.grounds.iter().enumerate().take(8) {
            if let Profile::Samples(samples) = &ground.profile {
                let piece = samples.piece(x.lane(k));
                pieces.iter_mut().zip(piece).for_each(|(row, number)| row[k] = number);
            }
        }
        cubic(x, pieces.map(|row| R::from_lanes(|k| row[k])))
    }

    fn bend(&self, _: f64, _: f64, _: f64, _: &Sample<f64>) -> f64 {
        f64::INFINITY
    }

    #[cfg_attr(feature = "batch", inline(always))]
    fn most_bend(&self) -> R {
        R::from_lanes(|k| self.bends[k])
    }
}
