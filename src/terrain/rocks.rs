//! Rocks on random ground: firm domes with the sizes that rocks have at landing sites on Mars.

use super::curve::Sample;
use crate::scalar::{MapScalar, Scalar, lanes};
use crate::soil::Soil;
use bekker_modeldescription::{Unit, parameters};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Poisson};
use std::sync::{Arc, OnceLock};

/// Stream of the ground's seed from which rocks are drawn; its phases are from stream 0.
const STREAM: u64 = 1;
/// Words of that stream before the first draw: as many as the phases take of theirs.
const FIRST_WORD: u128 = 32;
/// Where rocks lie, m: none where a rover starts.
const FIRST: f64 = 1.0;
const LAST: f64 = 101.0;
/// The largest coverage of the vocabulary, for which rocks are drawn; with a smaller one some of them are absent.
const DENSEST: f64 = 0.3;
/// Diameters of rocks, m: smaller ones belong to the roughness.
const DIAMETERS: [f64; 2] = [0.03, 1.0];
/// Height over diameter: an assumption for rocks that are partly buried.
const HEIGHT: f64 = 0.3;
/// Half the length of a dome at its foot over the diameter, which is the length at half the height: (1 - u^2)^3 = 1/2.
const REACH: f64 = 0.5 / 0.454_202_024_8;
/// Places tried for a rock before it is left out.
const TRIES: usize = 1000;
/// Halvings that find the coverage from which a rock is there, to 1e-9.
const HALVINGS: usize = 28;

/// Bekker's moduli on a rock over those of the soil around it: an assumption. A wheel has one contact, which moves from the soil before
/// a rock to the rock's face at the depth to which it has sunk in the soil; much stiffer rocks would throw it up there.
const STIFFNESS: f64 = 5.0;
/// Coefficient of friction on a rock: the usual one of an obstacle, which is an assumption.
const FRICTION: f64 = 0.7;
/// Shear modulus K on a rock, m: an assumption, small beside that of sand.
const SHEAR_MODULUS: f64 = 0.002;

parameters! {
    /// Rocks on random ground, whose sizes follow Golombek and Rapp 1997: those of diameter D or more cover the share
    /// k exp(-(1.79 + 0.152/k) D) of the way, D in m. A rock is a dome 0.3 times as high as its diameter and, at half its height, as
    /// long as its diameter. Bekker's moduli on it are 5 times those of the soil, its coefficient of friction is 0.7, and it has no cohesion.
    pub struct Rocks {
        /// Share k of the ground that rocks of all sizes would cover; those that are there lie from 1 m to 101 m along x. 0 for none.
        rock_coverage: [Unit::ONE] = 0.0, 0.0..=DENSEST, Fixed, "Golombek et al. 2003: 0.05 to 0.4 on Mars";
        /// Largest diameter of the rocks that are there, the smallest is 0.03 m: as if the path led round larger ones.
        largest_rock: [Unit::METRE] = 0.2, 0.03..=1.0, Fixed, "preset";
    }
}

/// A rock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rock {
    /// Position of its middle, m.
    pub centre: f64,
    /// Half its length at the foot, m.
    pub reach: f64,
    /// Height, m.
    pub height: f64,
    /// Diameter, m.
    pub diameter: f64,
    /// It is there where the coverage is larger than this.
    pub from_coverage: f64,
}

impl Rock {
    /// Centre, 1/reach and height: what [`dome`] reads.
    pub fn numbers(&self) -> [f64; 3] {
        [self.centre, self.reach.recip(), self.height]
    }

    /// Largest side * d2z/dx2 over the part of `from..to` on the rock.
    fn bend(&self, side: f64, from: f64, to: f64) -> f64 {
        let [from, to] = [from, to].map(|x| ((x - self.centre) / self.reach).clamp(-1.0, 1.0));
        let second = |u: f64| side * (1.0 - u * u) * (30.0 * u * u - 6.0);
        // At the ends or where d3z/dx3 is 0.
        let turn = 0.6_f64.sqrt();
        let inside = [0.0, turn, -turn].into_iter().filter(|u| *u > from && *u < to);
        let most = inside.map(second).fold(second(from).max(second(to)), f64::max);
        most * self.height / (self.reach * self.reach)
    }
}

/// A dome z = h (1 - u^2)^3, u = (x - centre)/reach, for |u| <= 1: C2 at its foot.
#[lanes]
pub(super) fn dome<S: Scalar>(x: S, [centre, per_reach, height]: [S; 3]) -> Sample<S> {
    let u = (x - centre) * per_reach;
    let rest = -u * u + 1.0;
    let steepness = height * per_reach;
    Sample {
        height: height * rest * rest * rest,
        slope: -(steepness * u * rest * rest * 6.0),
        curvature: steepness * per_reach * rest * (u * u * 30.0 - 6.0),
    }
}

#[lanes]
impl<S: Scalar> Sample<S> {
    /// The sum of two profiles.
    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            height: self.height + other.height,
            slope: self.slope + other.slope,
            curvature: self.curvature + other.curvature,
        }
    }
}

/// The rocks of a seed.
#[derive(Clone, Debug, MapScalar)]
pub(super) struct Field<S = f64> {
    /// Which of them are there.
    pub shown: Rocks<S>,
    seed: u32,
    drawn: Arc<OnceLock<Vec<Rock>>>,
}

impl<S: PartialEq> PartialEq for Field<S> {
    /// Rocks that are drawn already are those that the other draws later.
    fn eq(&self, other: &Self) -> bool {
        self.shown == other.shown && self.seed == other.seed
    }
}

impl<S: Scalar> Field<S> {
    /// The rocks of `seed`, none of which is shown.
    pub fn new(seed: u32) -> Self {
        Self { shown: Rocks::default().map(&|x| S::from(x)), seed, drawn: Arc::default() }
    }

    /// All rocks in the order of their places; their feet do not overlap. They are drawn when first asked for, since the draw took a
    /// fifth of the time of a reset of EnergyTraverse, whose ground shows none.
    fn all(&self) -> &[Rock] {
        self.drawn.get_or_init(|| {
            let mut draw = ChaCha8Rng::seed_from_u64(u64::from(self.seed));
            draw.set_stream(STREAM);
            draw.set_word_pos(FIRST_WORD);
            placed(&sizes(&mut draw), &mut draw)
        })
    }

    /// Those that are there.
    pub fn view(&self) -> View<'_> {
        let [coverage, largest] = [self.shown.rock_coverage.value(), self.shown.largest_rock.value()];
        View { all: if coverage > 0.0 { self.all() } else { &[] }, coverage, largest }
    }

    /// The soil at `x`, on a rock or, as it is, beside one.
    #[lanes]
    pub fn firm(&self, mut soil: Soil<S>, x: S) -> Soil<S> {
        let Some(rock) = self.view().at(x.value()) else { return soil };
        // All rock where the dome is at least half as high as in its middle.
        let raised = dome(x, rock.numbers().map(S::from)).height / S::from(rock.height);
        let share = (raised * 2.0).smaller(S::from(1.0));
        soil.scale_moduli(share * (STIFFNESS - 1.0) + 1.0);
        soil.cohesion *= -share + 1.0;
        soil.friction_angle += (-soil.friction_angle + FRICTION.atan()) * share;
        soil.shear_modulus += (-soil.shear_modulus + SHEAR_MODULUS) * share;
        soil
    }
}

/// The rocks that are there.
#[derive(Clone, Copy, Default)]
pub(super) struct View<'a> {
    all: &'a [Rock],
    coverage: f64,
    largest: f64,
}

impl<'a> View<'a> {
    /// Whether the coverage is 0, so that no rock is there.
    pub fn is_bare(&self) -> bool {
        self.coverage <= 0.0
    }

    fn shows(&self, rock: &Rock) -> bool {
        rock.from_coverage < self.coverage && rock.diameter <= self.largest
    }

    /// The rock on which `x` lies.
    pub fn at(&self, x: f64) -> Option<&'a Rock> {
        if self.is_bare() {
            return None;
        }
        let behind = self.all.partition_point(|rock| rock.centre - rock.reach <= x);
        let rock = self.all[..behind].last()?;
        (x < rock.centre + rock.reach && self.shows(rock)).then_some(rock)
    }

    /// Largest side * d2z/dx2 of rocks and level ground over `from..to`.
    pub fn bend(&self, side: f64, from: f64, to: f64) -> f64 {
        if self.is_bare() {
            return 0.0;
        }
        let first = self.all.partition_point(|rock| rock.centre + rock.reach <= from);
        let near = self.all[first..].iter().take_while(|rock| rock.centre - rock.reach < to);
        let on_one = |rock: &Rock| from >= rock.centre - rock.reach && to <= rock.centre + rock.reach;
        let mut most = f64::NEG_INFINITY;
        let mut level = true;
        for rock in near.filter(|rock| self.shows(rock)) {
            most = most.max(rock.bend(side, from, to));
            level &= !on_one(rock);
        }
        if level { most.max(0.0) } else { most }
    }
}

/// Density per metre of the way of rocks of `diameter`, at a coverage k: -F'(D)/D, since a rock takes D of the way. The published share
/// is that of an area. Of a straight line it is the same, but a line crosses rocks along chords of pi D/4 on average; here every rock
/// is crossed through its middle, so that there are pi/4 times as many.
fn density(coverage: f64, diameter: f64) -> f64 {
    let decay = 1.79 + 0.152 / coverage;
    coverage * decay * (-decay * diameter).exp() / diameter
}

/// Diameters and [`from_coverage`](Rock::from_coverage) of the rocks, largest first.
fn sizes(draw: &mut ChaCha8Rng) -> Vec<[f64; 2]> {
    let [smallest, largest] = DIAMETERS;
    // Rocks with density C/D, of which some are there: more than there are of any diameter at the largest coverage.
    let most = smallest * density(DENSEST, smallest);
    let mean = most * (largest / smallest).ln() * (LAST - FIRST);
    let count = Poisson::new(mean).expect("the mean is a positive constant").sample(draw) as usize;
    let mut sizes: Vec<[f64; 2]> = (0..count)
        .filter_map(|_| {
            let diameter = smallest * (largest / smallest).powf(draw.random::<f64>());
            let mark = most * draw.random::<f64>() / diameter;
            from_coverage(diameter, mark).map(|coverage| [diameter, coverage])
        })
        .collect();
    sizes.sort_by(|a, b| b[0].total_cmp(&a[0]));
    sizes
}

/// The coverage at which the density of rocks of `diameter` reaches `mark`, where it does.
fn from_coverage(diameter: f64, mark: f64) -> Option<f64> {
    if density(DENSEST, diameter) <= mark {
        return None;
    }
    let (mut from, mut to) = (0.0, DENSEST);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (from + to);
        if density(middle, diameter) > mark { to = middle } else { from = middle }
    }
    Some(to)
}

/// The rocks at drawn places where none lies yet.
fn placed(sizes: &[[f64; 2]], draw: &mut ChaCha8Rng) -> Vec<Rock> {
    let mut all: Vec<Rock> = Vec::new();
    for &[diameter, from_coverage] in sizes {
        let reach = REACH * diameter;
        let place = (0..TRIES).find_map(|_| {
            let centre = draw.random_range(FIRST + reach..LAST - reach);
            let behind = all.partition_point(|rock| rock.centre < centre);
            let free = |rock: Option<&Rock>| rock.is_none_or(|rock| (rock.centre - centre).abs() >= rock.reach + reach);
            let before = behind.checked_sub(1).and_then(|k| all.get(k));
            (free(before) && free(all.get(behind))).then_some((behind, centre))
        });
        if let Some((k, centre)) = place {
            all.insert(k, Rock { centre, reach, height: HEIGHT * diameter, diameter, from_coverage });
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    const SEEDS: u32 = 200;

    /// Four standard deviations of a share that is a sum over rocks: each adds D/L to it, so its variance is the mean of D/L
    /// over the covered length.
    fn deviation(coverage: f64, largest: f64, length: f64) -> f64 {
        4.0 * (coverage * largest / length).sqrt()
    }

    #[test]
    fn published_rocks_cover_the_share_of_golombek_and_rapp() {
        let length = f64::from(SEEDS) * (LAST - FIRST);
        let fields: Vec<Field> = (0..SEEDS).map(Field::new).collect();
        let all = || fields.iter().flat_map(Field::all);
        for coverage in [0.05, 0.19, 0.3] {
            let decay: f64 = 1.79 + 0.152 / coverage;
            let share = |diameter: f64| coverage * (-decay * diameter).exp();
            for pair in [0.03, 0.05, 0.1, 0.2, 0.4, 1.0].windows(2) {
                let (from, to) = (pair[0], pair[1]);
                let there = all().filter(|r| r.from_coverage < coverage && r.diameter >= from && r.diameter < to);
                let found = there.map(|rock| rock.diameter).sum::<f64>() / length;
                let expected = share(from) - share(to);
                assert!(
                    (found - expected).abs() < deviation(expected, to, length),
                    "coverage {coverage}, {from} to {to} m: {found}, {expected} expected"
                );
            }
        }
    }

    #[test]
    fn property_every_rock_finds_a_place_of_its_own() {
        for seed in 0..SEEDS {
            let draw = &mut ChaCha8Rng::seed_from_u64(u64::from(seed));
            let sizes = sizes(draw);
            let rocks = placed(&sizes, draw);
            assert_eq!(rocks.len(), sizes.len(), "seed {seed}: rocks without a place");
            for pair in rocks.windows(2) {
                assert!(pair[0].centre + pair[0].reach <= pair[1].centre - pair[1].reach, "seed {seed}: {pair:?}");
            }
            assert!(rocks.first().is_none_or(|rock| rock.centre - rock.reach >= FIRST));
        }
    }

    #[test]
    fn property_more_coverage_adds_rocks_and_takes_none() {
        let mut field = Field::<f64>::new(3);
        field.shown.largest_rock = 1.0;
        let mut shown = |coverage: f64| {
            field.shown.rock_coverage = coverage;
            let view = field.view();
            field.all().iter().map(|rock| view.at(rock.centre).is_some()).collect::<Vec<_>>()
        };
        let few = shown(0.05);
        let many = shown(0.2);
        assert!(few.iter().zip(&many).all(|(few, many)| !few || *many));
        let count = |list: &[bool]| list.iter().filter(|there| **there).count();
        assert!(count(&few) > 0 && count(&many) > 2 * count(&few));
        assert!(shown(0.0).iter().all(|there| !there));
    }
}
