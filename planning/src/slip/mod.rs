//! Slip that a slope needs, by the core's wheel on its soil, and how far it moves with what is not known of soil, map and place.
//!
//! A wheel that carries W cos(a)/n up a slope a must pull W sin(a)/n. The slip at which its drawbar pull is that is the one looked for,
//! as in [`SlopeEnergy`](crate::anisotropic::SlopeEnergy); here the slope is tabulated by the slip, which needs fewer steady points, so
//! that many soils can be looked at.

mod spread;

pub use spread::{SoilSpread, UnknownClass};

use bekker::carriage::{Rig, steady_point};
use bekker::effects::Effects;
use bekker::rover::Environment;
use bekker::soil::Soil;
use bekker::wheel::Wheel;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// Slip is looked for up to here: a wheel that slips more digs itself in.
const MOST_SLIP: f64 = 0.95;
/// Entries of a table, an odd number. They are denser around 0, where the pull rises steeply: slip grows with this power of the entry's
/// distance from the middle.
const ENTRIES: usize = 61;
const DENSER: f64 = 1.7;
/// Steps of the slope at a slip; the load changes little with the slope, so that each step leaves a twentieth of the error.
const STEPS: usize = 4;
/// Wheel speed, rad/s. Steady points without effects do not depend on it.
const SPIN: f64 = 1.0;

/// Soils drawn for a band, and seed of the draws.
const DRAWS: usize = 101;
const SEED: u64 = 27;
/// Quantiles of the slip over these soils that a band spans.
pub const BAND: [f64; 2] = [0.05, 0.95];

/// Slip of a rover that drives steadily up or down a slope, by the slope's angle in the direction of travel.
#[derive(Clone, Debug, PartialEq)]
pub struct SlopeSlip {
    /// Slope that is climbed at the slip of each entry, rad; NaN where the soil does not carry the wheel.
    slopes: Vec<f64>,
}

impl SlopeSlip {
    /// The table of a rover of this weight (N) on `wheels` equal wheels, each with its share of the load.
    #[must_use]
    pub fn new(soil: &Soil, wheel: &Wheel, weight: f64, wheels: usize) -> Self {
        let rig = Rig { environment: Environment::default(), wheel: *wheel, soil: *soil, effects: Effects::default() };
        let share = weight / wheels as f64;
        let mut near = 0.0;
        let slopes = (0..ENTRIES).map(|entry| {
            let slope = climbed(&rig, share, slip_of(entry), near);
            near = if slope.is_finite() { slope } else { 0.0 };
            slope
        });
        Self { slopes: slopes.collect() }
    }

    /// The smallest slip at which the wheels pull what a slope (rad, uphill positive) needs; infinite where none pulls enough, minus
    /// infinity where the ground falls so steeply that braking does not hold the rover.
    #[must_use]
    pub fn at(&self, slope: f64) -> f64 {
        let Some(above) = self.slopes.iter().position(|climbed| *climbed >= slope) else { return f64::INFINITY };
        let Some(below) = above.checked_sub(1).filter(|below| self.slopes[*below].is_finite()) else {
            return if self.slopes[above] == slope { slip_of(above) } else { f64::NEG_INFINITY };
        };
        let share = (slope - self.slopes[below]) / (self.slopes[above] - self.slopes[below]);
        (1.0 - share) * slip_of(below) + share * slip_of(above)
    }
}

/// Slip of an entry of the table.
fn slip_of(entry: usize) -> f64 {
    let place = 2.0 * entry as f64 / (ENTRIES - 1) as f64 - 1.0;
    MOST_SLIP * place.signum() * place.abs().powf(DENSER)
}

/// Slope (rad) that a wheel with this share of the weight (N) climbs at a slip: tan(a) is pull over load, W sin(a)/n over W cos(a)/n.
fn climbed(rig: &Rig, share: f64, slip: f64, near: f64) -> f64 {
    let mut slope: f64 = near;
    for _ in 0..STEPS {
        let load = share * slope.cos();
        let Ok(point) = steady_point(rig, load, slip, SPIN) else { return f64::NAN };
        slope = (point.drawbar_pull / load).atan();
    }
    slope
}

/// Sinkage (m) of a wheel under a load (N) at 20 % slip, that of half a radius where the soil does not carry it.
fn sinkage(soil: &Soil, wheel: &Wheel, load: f64) -> f64 {
    let rig = Rig { environment: Environment::default(), wheel: *wheel, soil: *soil, effects: Effects::default() };
    steady_point(&rig, load, 0.2, SPIN).map_or(0.5 * wheel.radius, |point| point.sinkage)
}

/// Slip at a point of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slip {
    /// On the soil as it is stated and the slope as the map has it.
    pub slip: f64,
    /// Lower end of the band.
    pub low: f64,
    /// Upper end of the band.
    pub high: f64,
    /// Share of the soils drawn on which no slip is enough in the worst case of the slope.
    pub none: f64,
}

/// Slip by slope on a soil and on soils drawn from what is known of it.
#[derive(Clone, Debug)]
pub struct SlipBand {
    stated: SlopeSlip,
    drawn: Vec<SlopeSlip>,
    spread: SoilSpread,
}

impl SlipBand {
    /// The band of a rover of this weight (N) on `wheels` equal wheels. Tables are made on all threads; the draws are the same on any
    /// number of them.
    #[must_use]
    pub fn new(soil: &Soil, spread: SoilSpread, wheel: &Wheel, weight: f64, wheels: usize) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(SEED);
        let depth = sinkage(soil, wheel, weight / wheels as f64);
        let soils: Vec<Soil> = (0..DRAWS).map(|_| spread.drawn(soil, depth, &mut random)).collect();
        let table = |soil: &Soil| SlopeSlip::new(soil, wheel, weight, wheels);
        Self { stated: table(soil), drawn: soils.par_iter().map(table).collect(), spread }
    }

    /// Slip at a slope of the direction of travel (rad) that is known to lie between two others: the band runs from the lower quantile of
    /// [`BAND`] at the smallest of the slopes to the upper one at the largest.
    #[must_use]
    pub fn at(&self, slope: f64, [least, most]: [f64; 2]) -> Slip {
        let sorted = |slope: f64| {
            let mut slips: Vec<f64> = self.drawn.iter().map(|table| table.at(slope)).collect();
            slips.sort_by(f64::total_cmp);
            slips
        };
        let (low, high) = (sorted(least), sorted(most));
        let place = |share: f64| (share * (DRAWS - 1) as f64).round() as usize;
        let stuck = high.iter().filter(|slip| **slip == f64::INFINITY).count();
        let slides = low.iter().filter(|slip| **slip == f64::NEG_INFINITY).count();
        Slip {
            slip: self.stated.at(slope),
            low: low[place(BAND[0])],
            high: high[place(BAND[1])],
            none: stuck.max(slides) as f64 / DRAWS as f64,
        }
    }

    /// Slip at a slope (rad) on the soil as it is stated, as [`SlopeSlip::at`].
    #[must_use]
    pub fn stated(&self, slope: f64) -> f64 {
        self.stated.at(slope)
    }

    /// How the band was made, in a sentence each for the soil and for map and place.
    #[must_use]
    pub fn told(&self, uncertain_slope: bool) -> String {
        let slopes = if uncertain_slope {
            " Its lower end is taken at the smallest and its upper end at the largest slope over the cases of the map's error and the \
             places within the error of dead reckoning."
        } else {
            ""
        };
        format!(
            "Slip that the wheels need for the slope of the rover's direction of travel, each with an equal share of the load. Band: 5 to \
             95 % of {DRAWS} soils drawn at random. {}{slopes}",
            self.spread.told()
        )
    }
}
