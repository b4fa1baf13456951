//! The ground: its profile z = h(x), its soil along x, and the foot at which a wheel touches it.

mod course;
mod curve;
mod error;
mod foot;
#[cfg(feature = "batch")]
mod lanes;
#[cfg(not(feature = "batch"))]
#[path = "no_lanes.rs"]
mod lanes;
mod preset;
mod profile_file;
mod random;
mod rocks;
mod samples;
mod soil_table;
mod spec;

pub use course::{Incline, LooseDitch, Rough};
pub use curve::Sample;
pub use error::TerrainError;
pub use foot::Foot;
pub use preset::{Ditch, Slope, Step, Waves};
pub use random::{Random, Spectrum};
pub use rocks::Rocks;
pub use samples::{Samples, SamplesError};
pub use soil_table::{SoilColumn, SoilTable, SoilTableError};
pub use spec::{Preset, SoilSpec, TerrainSpec, TerrainSpecError};

use crate::scalar::{Plain, Scalar, lanes};
use crate::soil::Soil;
use bekker_modeldescription::{Parameters, Variable};
use curve::Curve;
use lanes::LaneTerrains;
use std::sync::Arc;

/// Shape of the ground.
#[derive(Clone, Debug, PartialEq)]
pub enum Profile<S = f64> {
    /// The level z = 0.
    Flat,
    /// An inclined plane.
    Slope(Slope<S>),
    /// Waves behind a level run-in.
    Waves(Waves<S>),
    /// A ditch or a mound.
    Ditch(Ditch<S>),
    /// A step of finite slope.
    Step(Step<S>),
    /// Random ground, with rocks or without.
    Random(Random<S>),
    /// A profile by samples.
    Samples(Arc<Samples>),
}

/// Reads one number of a ground.
type Read<'a> = dyn Fn(&Terrain) -> f64 + 'a;

/// The ground: a profile and, where it is described, soil that varies along x.
///
/// Cloning is cheap (samples are shared). As [`Parameters`] it visits those of the active profile only.
/// ```
/// use bekker::terrain::{Slope, Terrain, Profile};
/// let hill = Terrain::new(Profile::Slope(Slope { slope: 0.1 }));
/// let foot = hill.foot([2.0, 1.0])?;
/// assert!((foot.angle - 0.1).abs() < 1e-12);
/// # Ok::<(), bekker::terrain::TerrainError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Terrain<S = f64> {
    /// Shape of the ground.
    pub profile: Profile<S>,
    soil: Option<Arc<SoilTable>>,
    /// The terrains of several rovers in SIMD lanes, where a formula does not describe them.
    several: Option<Arc<LaneTerrains>>,
}

impl<S> Default for Terrain<S> {
    fn default() -> Self {
        Self { profile: Profile::Flat, soil: None, several: None }
    }
}

impl<S: Scalar> Terrain<S> {
    /// Ground of the given shape with the same soil everywhere.
    #[must_use]
    pub fn new(profile: Profile<S>) -> Self {
        Self { profile, soil: None, several: None }
    }

    /// The same ground with soil that varies along x.
    #[must_use]
    pub fn with_soil(self, table: SoilTable) -> Self {
        Self { soil: Some(Arc::new(table)), ..self }
    }

    /// How the soil varies along x, where it does.
    #[must_use]
    pub fn soil_table(&self) -> Option<&SoilTable> {
        self.soil.as_deref()
    }

    /// Height, slope and curvature at `x`. Beyond the samples of a sampled profile it goes on straight.
    #[must_use]
    #[lanes]
    pub fn at(&self, x: S) -> Sample<S> {
        if let Some(several) = self.several.as_ref().filter(|several| several.shapes()) {
            let Sample { height, slope, curvature } = Curve::at(&**several, x.plain());
            let [height, slope, curvature] = [height, slope, curvature].map(S::from_plain);
            return Sample { height, slope, curvature };
        }
        match &self.profile {
            Profile::Flat => Sample { height: S::from(0.0), slope: S::from(0.0), curvature: S::from(0.0) },
            Profile::Slope(curve) => curve.at(x),
            Profile::Waves(curve) => curve.at(x),
            Profile::Ditch(curve) => curve.at(x),
            Profile::Step(curve) => curve.at(x),
            Profile::Random(random) => random.sum(|s| s).at(x),
            Profile::Samples(curve) => curve.at(x),
        }
    }

    /// The point of the profile nearest to a wheel's centre [x, z]. A function of its arguments alone. Where two
    /// points are equally near (a wheel over a narrow ditch) it is one of them, always the same.
    ///
    /// # Errors
    /// [`TerrainError`]: beyond the samples, too far from the ground, or not finite.
    #[lanes]
    pub fn foot(&self, centre: [S; 2]) -> Result<Foot<S>, TerrainError> {
        if let Some(several) = self.several.as_ref().filter(|several| several.shapes()) {
            return foot::on_several(several, centre);
        }
        let (sides, value) = (&|s: S| s.plain(), &|s: S| s.value());
        let lane = |k: usize| move |s: S| s.plain().lane(k);
        match &self.profile {
            Profile::Flat => foot::on_plane(S::from(0.0), centre),
            Profile::Slope(plane) => foot::on_plane(plane.slope, centre),
            Profile::Waves(curve) => foot::on_formula(curve, &curve.map(sides), |k| curve.map(&lane(k)), centre),
            Profile::Ditch(curve) => foot::on_formula(curve, &curve.map(sides), |k| curve.map(&lane(k)), centre),
            Profile::Step(curve) => foot::on_formula(curve, &curve.map(sides), |k| curve.map(&lane(k)), centre),
            Profile::Random(random) => foot::foot(&random.sum(|s| s), &random.sum(value), centre),
            Profile::Samples(curve) => {
                let foot = foot::foot(&**curve, &**curve, centre)?;
                let (x, (from, to)) = (foot.position[0].value(), curve.range());
                if x < from || x > to { Err(TerrainError::Left { x, from, to }) } else { Ok(foot) }
            }
        }
    }

    /// The soil at `x`: `base` with what the table says there, firmer on a rock; `base` itself, bit for bit, without either.
    #[lanes]
    #[must_use]
    pub fn soil(&self, base: &Soil<S>, x: S) -> Soil<S> {
        if let Some(several) = &self.several {
            return several.soil(base, x);
        }
        let soil = self.soil.as_ref().map_or(*base, |table| table.apply(base, x));
        match &self.profile {
            Profile::Random(random) => random.rocks.firm(soil, x),
            _ => soil,
        }
    }

    /// Whether the soil differs from place to place.
    fn varies(&self) -> bool {
        self.soil.is_some() || matches!(&self.profile, Profile::Random(random) if !random.rocks.view().is_bare())
    }

    /// The grounds of several rovers side by side, whose profiles are of one kind; `parameter` gives the numbers of a
    /// formula, in the order in which it visits them.
    #[cfg(feature = "batch")]
    pub(crate) fn side_by_side(grounds: Vec<Terrain>, parameter: &dyn Fn(&Read) -> S) -> Self {
        let number = |read: &dyn Fn(&Profile) -> f64| parameter(&|ground| read(&ground.profile));
        macro_rules! formula {
            ($kind:ident { $($field:ident),* }) => {
                Profile::$kind($kind {
                    $($field: number(&|profile| if let Profile::$kind(group) = profile { group.$field } else { 0.0 }),)*
                })
            };
        }
        let profile = match grounds.first().map(|ground| &ground.profile) {
            Some(Profile::Slope(_)) => formula!(Slope { slope }),
            Some(Profile::Waves(_)) => formula!(Waves { amplitude, wavelength, start }),
            Some(Profile::Ditch(_)) => formula!(Ditch { depth, width, position }),
            Some(Profile::Step(_)) => formula!(Step { height, length, position }),
            _ => Profile::Flat,
        };
        Self { profile, soil: None, several: Some(Arc::new(LaneTerrains::new(grounds))) }
    }

    /// By how much a rock at `x` rises above the ground around it, m; 0 where none lies.
    #[must_use]
    pub fn rock_height(&self, x: f64) -> f64 {
        match &self.profile {
            Profile::Random(random) => {
                random.rocks.view().at(x).map_or(0.0, |rock| rocks::dome(x, rock.numbers()).height)
            }
            _ => 0.0,
        }
    }

    /// First and last position at which the ground is described, m; infinite for formulas.
    #[must_use]
    pub fn range(&self) -> (f64, f64) {
        match &self.profile {
            Profile::Samples(samples) => samples.range(),
            _ => (f64::NEG_INFINITY, f64::INFINITY),
        }
    }
}

impl<S: Copy> Terrain<S> {
    /// The same ground over another scalar.
    #[must_use]
    pub fn map<T>(&self, f: &dyn Fn(S) -> T) -> Terrain<T> {
        let profile = match &self.profile {
            Profile::Flat => Profile::Flat,
            Profile::Slope(plane) => Profile::Slope(plane.map(f)),
            Profile::Waves(waves) => Profile::Waves(waves.map(f)),
            Profile::Ditch(ditch) => Profile::Ditch(ditch.map(f)),
            Profile::Step(step) => Profile::Step(step.map(f)),
            Profile::Random(random) => Profile::Random(random.map(f)),
            Profile::Samples(samples) => Profile::Samples(Arc::clone(samples)),
        };
        Terrain { profile, soil: self.soil.clone(), several: None }
    }
}

impl<S: Copy> Parameters<S> for Terrain<S> {
    fn visit(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut S)) {
        match &mut self.profile {
            Profile::Flat | Profile::Samples(_) => {}
            Profile::Slope(group) => group.visit(prefix, f),
            Profile::Waves(group) => group.visit(prefix, f),
            Profile::Ditch(group) => group.visit(prefix, f),
            Profile::Step(group) => group.visit(prefix, f),
            Profile::Random(random) => random.visit(prefix, f),
        }
    }

    fn values(&self, f: &mut dyn FnMut(S)) {
        match &self.profile {
            Profile::Flat | Profile::Samples(_) => {}
            Profile::Slope(group) => group.values(f),
            Profile::Waves(group) => group.values(f),
            Profile::Ditch(group) => group.values(f),
            Profile::Step(group) => group.values(f),
            Profile::Random(random) => random.values(f),
        }
    }
}
