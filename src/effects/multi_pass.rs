//! Ground that wheels have passed.

use super::{Advice, Effect, Facts, Local, Place};
use crate::scalar::{LaneAccess, MapScalar, Mask, Scalar, lanes, smooth_step};
use crate::snapshot::Moving;
use bekker_modeldescription::{Unit, parameters};

/// Distance over which the ground at the end of a track turns from fresh to passed, m: about the length of a small wheel's contact.
const EDGE: f64 = 0.05;

parameters! {
    /// A wheel compacts the ground for the next: k_c, k_phi and c grow by the factor 1 + g p with the number p of wheels
    /// that have passed. Holm 1969 measured the gain of repeated passes; Senatore and Sandu 2011 take density, c and
    /// K linear in their number.
    pub struct MultiPass {
        /// Growth g of the soil's moduli and cohesion with each pass.
        growth: [Unit::ONE] = 0.0, 0.0..=1.0, Effect, "Holm 1969, J. Terramechanics 6; Senatore and Sandu 2011: 0.1-0.5";
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for MultiPass<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_rover: &["wheel[1].torque", "wheel[1].sinkage"],
            advice: const { &[Advice::rover("drive the same rut twice and compare the passes")] },
            ..Facts::USUAL
        }
    }

    fn counts_passes(&self) -> bool {
        !self.growth.is_exactly(0.0)
    }

    fn contact(&self, place: &Place<S>, local: &mut Local<S>) {
        if self.growth.is_exactly(0.0) {
            return;
        }
        let factor = self.growth * place.passes + 1.0;
        local.soil.scale_moduli(factor);
        local.soil.cohesion *= factor;
    }
}

/// The stretch along x that a wheel's foot has covered in contact since the start.
#[derive(Clone, Copy, Debug, PartialEq, Moving, LaneAccess, MapScalar)]
pub struct Track<S = f64> {
    /// Its end towards the rear, m; above `high` where nothing is covered yet.
    pub low: S,
    /// Its end towards the front, m.
    pub high: S,
}

impl<S: From<f64>> Default for Track<S> {
    fn default() -> Self {
        Self { low: S::from(f64::INFINITY), high: S::from(f64::NEG_INFINITY) }
    }
}

#[lanes]
impl<S: Scalar> Track<S> {
    /// Takes the foot's place over where it is in contact.
    pub(crate) fn extend(&mut self, x: S, covers: S::Mask) {
        self.low = S::select(covers, self.low.smaller(x), self.low);
        self.high = S::select(covers, self.high.larger(x), self.high);
    }

    /// How far the ground at `x` counts as passed by another wheel: half at the ends, since half of a contact that stands there is
    /// on passed ground.
    fn covers(&self, x: S) -> S {
        self.widened(EDGE / 2.0).inside(x)
    }

    /// The same on a wheel's own track: none at the ends. While the wheel goes on, it stands at its track's end, and ground that
    /// bears it is not yet ground that it has passed.
    fn covers_itself(&self, x: S) -> S {
        self.inside(x)
    }

    fn widened(&self, by: f64) -> Self {
        Self { low: self.low - by, high: self.high + by }
    }

    /// 0 at the ends and outside, 1 well inside.
    fn inside(&self, x: S) -> S {
        let inside = self.low.below(x) & x.below(self.high);
        if !inside.any() {
            return S::from(0.0);
        }
        S::select(inside, smooth_step((x - self.low) / EDGE) * smooth_step((self.high - x) / EDGE), S::from(0.0))
    }

    /// Number of wheels that have passed the ground at the foot `x` of wheel `own`, from the tracks of all. Each counts once, however
    /// often it came; a wheel counts on its own track once it has reversed by the length of a contact.
    pub(crate) fn passes<'a>(tracks: impl Iterator<Item = &'a Self>, own: usize, x: S) -> S
    where
        S: 'a,
    {
        let covers = |(k, track): (usize, &Self)| if k == own { track.covers_itself(x) } else { track.covers(x) };
        tracks.enumerate().map(covers).fold(S::from(0.0), |sum, share| sum + share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of the distance to an end, by a transition of 5 cm.
    const ROUNDING: f64 = 1e-12;

    #[test]
    fn property_a_track_end_counts_half_for_another_wheel_and_not_for_its_own() {
        let track = Track { low: 0.0, high: 1.0 };
        let passes = |own, x| Track::passes([track, Track::default()].iter(), own, x);
        for end in [track.low, track.high] {
            assert!((passes(1, end) - 0.5).abs() < ROUNDING);
            assert_eq!(passes(0, end), 0.0);
        }
        for own in [0, 1] {
            assert_eq!(passes(own, 0.5), 1.0);
            assert_eq!(passes(own, -EDGE), 0.0);
            assert_eq!(passes(own, 1.0 + EDGE), 0.0);
        }
    }
}
