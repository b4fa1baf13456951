//! Random ground: a sum of sinusoids with a power-law spectrum, and rocks on it.

use super::curve::{Curve, Sample};
use super::preset::bend_nearby;
use super::rocks::{Field, Rocks, View, dome};
#[cfg(feature = "batch")]
use crate::scalar::{MOST_LANES, Plain};
use crate::scalar::{MapScalar, Scalar, lanes};
use bekker_modeldescription::{Parameters, Unit, Variable, parameters};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::{LN_2, TAU};
use std::ops::Mul;
use std::sync::Arc;

/// Octaves of the spectrum below the longest wavelength.
const OCTAVES: usize = 4;
/// Sinusoids in each octave, at equal ratios of wavelength.
const VOICES: usize = 4;
/// Sinusoids altogether.
const WAVES: usize = OCTAVES * VOICES;
/// 2^(v/4): wavenumbers of the first octave over the lowest.
const ROOTS: [f64; VOICES] = [1.0, 1.189_207_115_002_721, std::f64::consts::SQRT_2, 1.681_792_830_507_429];

parameters! {
    /// Spectrum of random ground: four octaves downwards from the longest wavelength with power density
    /// proportional to k^-exponent, k the wavenumber.
    pub struct Spectrum {
        /// Standard deviation of the height.
        roughness: [Unit::METRE] = 0.02, 0.0..=2.0, Fixed, "preset";
        /// Longest wavelength; the shortest is 13.5 times shorter.
        wavelength: [Unit::METRE] = 2.0, 0.2..=1000.0, Fixed, "preset";
        /// Spectral exponent: waviness of the power density of the height.
        exponent: [Unit::ONE] = 2.0, 0.0..=5.0, Fixed, "2 in ISO 8608; 1.5 to 2.5 measured on off-road tracks";
    }
}

/// Random ground of one seed. The same seed gives the same ground everywhere, whatever the spectrum, and the same rocks, of
/// which a smaller coverage shows fewer.
#[derive(Clone, Debug, PartialEq, MapScalar)]
pub struct Random<S = f64> {
    /// Roughness, longest wavelength and spectral exponent.
    pub spectrum: Spectrum<S>,
    pub(super) rocks: Field<S>,
    seed: u32,
    /// (cos, sin) of the phase of each sinusoid.
    phases: Arc<[[f64; 2]; WAVES]>,
}

impl<S: Scalar> Random<S> {
    /// Ground with the given spectrum and phases drawn from `seed`, without rocks.
    #[must_use]
    pub fn new(spectrum: Spectrum<S>, seed: u32) -> Self {
        let mut draw = ChaCha8Rng::seed_from_u64(u64::from(seed));
        let phases = std::array::from_fn(|_| {
            let (sin, cos) = (TAU * draw.random::<f64>()).sin_cos();
            [cos, sin]
        });
        Self { spectrum, rocks: Field::new(seed), seed, phases: Arc::new(phases) }
    }

    /// The same ground with rocks.
    #[must_use]
    pub fn with_rocks(mut self, rocks: Rocks<S>) -> Self {
        self.rocks.shown = rocks;
        self
    }

    /// Which rocks are there.
    #[must_use]
    pub fn rocks(&self) -> &Rocks<S> {
        &self.rocks.shown
    }

    /// The seed of the phases.
    #[must_use]
    pub fn seed(&self) -> u32 {
        self.seed
    }

    /// The sum with its amplitudes worked out, for one or more evaluations.
    pub(super) fn sum<T: Scalar>(&self, f: impl Fn(S) -> T) -> Sum<'_, T> {
        let [roughness, wavelength, exponent] =
            [self.spectrum.roughness, self.spectrum.wavelength, self.spectrum.exponent].map(f);
        Sum { rocks: self.rocks.view(), ..Sum::new(roughness, wavelength, exponent, &self.phases) }
    }
}

impl<S: Copy> Parameters<S> for Random<S> {
    fn visit(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut S)) {
        self.spectrum.visit(prefix, f);
        self.rocks.shown.visit(prefix, f);
    }

    fn values(&self, f: &mut dyn FnMut(S)) {
        self.spectrum.values(f);
        self.rocks.shown.values(f);
    }
}

/// Rocks, and under them the sum over j of a_j cos(k_j x + phase_j) with k_j = k_0 2^(j/4): the wavenumbers of each
/// octave are twice those of the one before, so that four sines and cosines give all others by doubling the angle.
pub(super) struct Sum<'a, S> {
    wavenumber: [S; VOICES],
    amplitude: [S; WAVES],
    /// Bounds on the second and third derivative of the sum.
    bend: [f64; 2],
    /// (cos, sin).
    phases: &'a [[f64; 2]; WAVES],
    rocks: View<'a>,
}

impl<'a, S: Scalar> Sum<'a, S> {
    fn new(roughness: S, wavelength: S, exponent: S, phases: &'a [[f64; 2]; WAVES]) -> Self {
        // Power density k^-e over a band as wide as k itself: a_j^2 in proportion to k_j^(1-e).
        let ratio = ((-exponent + 1.0) * (0.5 * LN_2 / VOICES as f64)).exp();
        let mut amplitude = [S::from(1.0); WAVES];
        let mut squares = S::from(1.0);
        for j in 1..WAVES {
            amplitude[j] = amplitude[j - 1] * ratio;
            squares += amplitude[j] * amplitude[j];
        }
        // Half the sum of the squares is the variance.
        let scale = roughness * (squares * 0.5).sqrt().recip();
        amplitude.iter_mut().for_each(|a| *a *= scale);
        let lowest = S::from(TAU) / wavelength;
        let wavenumber: [S; VOICES] = std::array::from_fn(|v| lowest * ROOTS[v]);
        let mut bend = [0.0, 0.0];
        for (j, a) in amplitude.iter().enumerate() {
            let k = wavenumber[j % VOICES].value() * f64::from(1u32 << (j / VOICES));
            let second = a.value() * k * k;
            bend = [bend[0] + second, bend[1] + second * k];
        }
        Self { wavenumber, amplitude, bend, phases, rocks: View::default() }
    }
}

/// Height, slope and curvature of a sum at `x`; `P` is what its phases are given in.
#[lanes]
fn sample<S: Scalar + Mul<P, Output = S>, P: Copy>(
    x: S,
    wavenumber: impl Fn(usize) -> S,
    amplitude: impl Fn(usize) -> S,
    phases: impl Fn(usize) -> [P; 2],
) -> Sample<S> {
    let zero = S::from(0.0);
    let mut sample = Sample { height: zero, slope: zero, curvature: zero };
    for voice in 0..VOICES {
        let mut k = wavenumber(voice);
        let (mut sin, mut cos) = (k * x).sine_cosine();
        for octave in 0..OCTAVES {
            let j = octave * VOICES + voice;
            let [cos_phase, sin_phase] = phases(j);
            let a = amplitude(j);
            let wave = a * (cos * cos_phase - sin * sin_phase);
            sample.height += wave;
            sample.slope -= a * k * (sin * cos_phase + cos * sin_phase);
            sample.curvature -= k * k * wave;
            (sin, cos) = (sin * cos * 2.0, cos * cos - sin * sin);
            k *= 2.0;
        }
    }
    sample
}

#[lanes]
impl<S: Scalar> Curve<S> for Sum<'_, S> {
    fn at(&self, x: S) -> Sample<S> {
        let ground = sample(x, |v| self.wavenumber[v], |j| self.amplitude[j], |j| self.phases[j]);
        match self.rocks.at(x.value()) {
            Some(rock) => ground.plus(dome(x, rock.numbers().map(S::from))),
            None => ground,
        }
    }

    fn bend(&self, side: f64, from: f64, to: f64, middle: &Sample<f64>) -> f64 {
        let [second, third] = self.bend;
        let at = 0.5 * (from + to);
        let of_rock = self.rocks.at(at).map_or(0.0, |rock| dome(at, rock.numbers()).curvature);
        let sum = bend_nearby(side * (middle.curvature - of_rock), third, 0.5 * (to - from), second);
        sum + self.rocks.bend(side, from, to)
    }
}

/// The sums of several grounds side by side, without their rocks: number k of each row is that of ground k.
#[cfg(feature = "batch")]
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Sums {
    wavenumber: [Row; VOICES],
    amplitude: [Row; WAVES],
    phases: [[Row; 2]; WAVES],
    most_bend: Row,
}

#[cfg(feature = "batch")]
type Row = [f64; MOST_LANES];

#[cfg(feature = "batch")]
impl Sums {
    /// Puts ground `k`.
    pub fn put(&mut self, k: usize, ground: &Random) {
        let sum = ground.sum(|number| number);
        self.wavenumber.iter_mut().zip(sum.wavenumber).for_each(|(row, number)| row[k] = number);
        self.amplitude.iter_mut().zip(sum.amplitude).for_each(|(row, number)| row[k] = number);
        let phases = self.phases.iter_mut().flatten().zip(sum.phases.iter().flatten());
        phases.for_each(|(row, number)| row[k] = *number);
        self.most_bend[k] = sum.bend[0];
    }
}

#[cfg(feature = "batch")]
#[lanes]
impl<R: Plain> Curve<R> for Sums {
    fn at(&self, x: R) -> Sample<R> {
        let several = |row: &Row| R::from_lanes(|k| row[k]);
        sample(
            x,
            |v| several(&self.wavenumber[v]),
            |j| several(&self.amplitude[j]),
            |j| [several(&self.phases[j][0]), several(&self.phases[j][1])],
        )
    }

    /// Asked for by the search of a single ground alone.
    fn bend(&self, _: f64, _: f64, _: f64, _: &Sample<f64>) -> f64 {
        f64::INFINITY
    }

    fn most_bend(&self, _: R, _: R) -> R {
        R::from_lanes(|k| self.most_bend[k])
    }
}
