//! Terrains of several rovers that are stepped together, one in each SIMD lane.

use super::curve::{Curve, Sample};
use super::foot::{self, Foot};
use super::random::Sums;
use super::rocks::{Rock, View, dome};
use super::samples::cubic;
use super::{Profile, Terrain, TerrainError};
use crate::scalar::{MOST_LANES, Mask, Plain, Scalar, lanes};
use crate::soil::Soil;
use bekker_modeldescription::Parameters;

/// Terrains that a formula with a few numbers does not describe: sampled profiles, random ground, soil that varies.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LaneTerrains {
    grounds: Vec<Terrain>,
    shape: Shape,
    varies: bool,
}

/// How the heights of all lanes are computed.
#[derive(Clone, Debug, PartialEq)]
enum Shape {
    /// By the formula of [`Profile`](super::Profile).
    Elsewhere,
    /// Pieces of samples, with the largest |d2z/dx2| of each ground.
    Pieces([f64; MOST_LANES]),
    Random(Box<Sums>),
    /// Random ground, some of it with rocks.
    Rocky(Box<Sums>),
}

impl Shape {
    fn of(grounds: &[Terrain]) -> Self {
        match grounds.first().map(|ground| &ground.profile) {
            Some(Profile::Samples(_)) => {
                let mut bends = [f64::INFINITY; MOST_LANES];
                for (bend, ground) in bends.iter_mut().zip(grounds) {
                    if let Profile::Samples(samples) = &ground.profile {
                        *bend = samples.most_bend();
                    }
                }
                Self::Pieces(bends)
            }
            Some(Profile::Random(_)) => {
                let mut sums = Sums::default();
                for (k, ground) in grounds.iter().enumerate().take(MOST_LANES) {
                    if let Profile::Random(random) = &ground.profile {
                        sums.put(k, random);
                    }
                }
                let bare = |ground: &Terrain| matches!(&ground.profile, Profile::Random(r) if r.rocks.view().is_bare());
                if grounds.iter().all(bare) { Self::Random(Box::new(sums)) } else { Self::Rocky(Box::new(sums)) }
            }
            _ => Self::Elsewhere,
        }
    }
}

impl LaneTerrains {
    /// Grounds whose profiles are of one kind.
    pub fn new(grounds: Vec<Terrain>) -> Self {
        let varies = grounds.iter().any(Terrain::varies);
        Self { shape: Shape::of(&grounds), varies, grounds }
    }

    /// Whether the profiles are only here.
    pub fn shapes(&self) -> bool {
        !matches!(self.shape, Shape::Elsewhere)
    }

    #[lanes]
    pub fn foot<R: Plain>(&self, centre: [R; 2]) -> Result<Foot<R>, TerrainError> {
        let one = |k: usize| self.grounds[k].foot(centre.map(|c| c.lane(k)));
        let feet = foot::side_by_side(self, one, centre)?;
        for (k, ground) in self.grounds.iter().enumerate() {
            let (x, (from, to)) = (feet.position[0].lane(k), ground.range());
            if x < from || x > to {
                return Err(TerrainError::Left { x, from, to });
            }
        }
        Ok(feet)
    }

    /// The soil at `x`.
    #[lanes]
    pub fn soil<S: Scalar>(&self, base: &Soil<S>, x: S) -> Soil<S> {
        if self.varies { self.soil_of_each(base, x) } else { *base }
    }

    /// The rocks of ground `k`.
    fn rocks(&self, k: usize) -> Option<View<'_>> {
        match &self.grounds.get(k)?.profile {
            Profile::Random(random) => Some(random.rocks.view()),
            _ => None,
        }
    }

    /// The sums at `x` with the rocks that lie there.
    #[lanes]
    fn with_rocks<R: Plain>(&self, sum: Sample<R>, x: R) -> Sample<R> {
        let mut numbers = [[0.0; MOST_LANES]; 3];
        let on_rock = R::Mask::from_lanes(|k| {
            let rock = self.rocks(k).and_then(|rocks| rocks.at(x.lane(k)));
            let found = rock.map_or([0.0; 3], Rock::numbers);
            numbers.iter_mut().zip(found).for_each(|(row, number)| row[k] = number);
            rock.is_some()
        });
        if !on_rock.any() {
            return sum;
        }
        let both = sum.plus(dome(x, numbers.map(|row| R::from_lanes(|k| row[k]))));
        Sample {
            height: R::select(on_rock, both.height, sum.height),
            slope: R::select(on_rock, both.slope, sum.slope),
            curvature: R::select(on_rock, both.curvature, sum.curvature),
        }
    }

    /// A bound on |d2z/dx2| of the rocks within `reach` of `x`.
    fn bend_of_rocks<R: Plain>(&self, x: R, reach: R) -> R {
        R::from_lanes(|k| {
            let (x, reach) = (x.lane(k), reach.lane(k));
            let bend = |rocks: View<'_>, side: f64| rocks.bend(side, x - reach, x + reach);
            self.rocks(k).map_or(0.0, |rocks| bend(rocks, 1.0).max(bend(rocks, -1.0)))
        })
    }

    #[inline(never)]
    fn soil_of_each<S: Scalar>(&self, base: &Soil<S>, x: S) -> Soil<S> {
        let lane = |x: S, k: usize| x.plain().lane(k);
        let mut numbers = [[0.0; MOST_LANES]; 16];
        for (k, ground) in self.grounds.iter().enumerate().take(MOST_LANES) {
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

#[lanes]
impl<R: Plain> Curve<R> for LaneTerrains {
    fn at(&self, x: R) -> Sample<R> {
        match &self.shape {
            Shape::Random(sums) => return sums.at(x),
            Shape::Rocky(sums) => return self.with_rocks(sums.at(x), x),
            _ => {}
        }
        let mut pieces = [[0.0; MOST_LANES]; 5];
        for (k, ground) in self.grounds.iter().enumerate().take(MOST_LANES) {
            if let Profile::Samples(samples) = &ground.profile {
                let piece = samples.piece(x.lane(k));
                pieces.iter_mut().zip(piece).for_each(|(row, number)| row[k] = number);
            }
        }
        cubic(x, pieces.map(|row| R::from_lanes(|k| row[k])))
    }

    /// Asked for by the search of a single ground alone.
    fn bend(&self, _: f64, _: f64, _: f64, _: &Sample<f64>) -> f64 {
        f64::INFINITY
    }

    fn most_bend(&self, x: R, reach: R) -> R {
        match &self.shape {
            Shape::Elsewhere => R::from(f64::INFINITY),
            Shape::Pieces(bends) => R::from_lanes(|k| bends[k]),
            Shape::Random(sums) => sums.most_bend(x, reach),
            Shape::Rocky(sums) => sums.most_bend(x, reach) + self.bend_of_rocks(x, reach),
        }
    }
}
