//! Profile by samples: a C1 cubic Hermite curve, monotone where the samples are (Fritsch and Carlson 1980).

use super::curve::{Curve, Sample};
use crate::scalar::{Scalar, lanes};

/// z = z_0 + u (c_1 + u (c_2 + u c_3)) with u = x - x_0, from x_0 to the next piece.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Piece {
    start: f64,
    height: f64,
    c: [f64; 3],
}

/// A sampled profile. Between the samples it never leaves the range of its two neighbours; beyond the first and
/// the last it goes on straight (where [`Terrain::foot`](super::Terrain::foot) reports that the terrain is left).
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    /// The straight piece before the first sample, one piece from each sample to the next, the straight one behind.
    pieces: Vec<Piece>,
    first: f64,
    last: f64,
    /// For equal parts of `first..last`, the piece that holds the part's beginning.
    index: Vec<u32>,
    parts_per_metre: f64,
    /// Least and largest d2z/dx2 of all.
    bend: [f64; 2],
}

/// Why samples do not make a profile.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SamplesError {
    /// x and z differ in length.
    #[error("expected as many values of z as of x, found {z} and {x}")]
    Unequal {
        /// Number of x.
        x: usize,
        /// Number of z.
        z: usize,
    },
    /// Too few samples, or too many for the index.
    #[error("expected at least 2 samples, found {0}")]
    TooFew(usize),
    /// A number that is NaN, infinite or absurd.
    #[error("sample {row}: {column} = {value}; expected a finite number within {limit} m of zero")]
    Value {
        /// Sample, counted from 1.
        row: usize,
        /// `x` or `z`.
        column: &'static str,
        /// The value found.
        value: f64,
        /// Largest allowed magnitude.
        limit: f64,
    },
    /// x does not grow.
    #[error("sample {row}: x = {value} does not come after x = {before}; expected x to grow by at least {least} m")]
    Unsorted {
        /// Sample, counted from 1.
        row: usize,
        /// The value found.
        value: f64,
        /// The value before it.
        before: f64,
        /// Smallest allowed step.
        least: f64,
    },
}

/// Largest magnitude of a coordinate, m.
const LARGEST: f64 = 1e6;
/// Smallest distance between samples, m: finer ones would lose their slopes in rounding.
const FINEST: f64 = 1e-6;

impl Samples {
    /// The curve through (x, z), x growing.
    ///
    /// # Errors
    /// [`SamplesError`] naming the sample and what was expected.
    pub fn new(x: &[f64], z: &[f64]) -> Result<Self, SamplesError> {
        check(x, z)?;
        let slopes = monotone_slopes(x, z);
        let last = x.len() - 1;
        let straight = |i: usize| Piece { start: x[i], height: z[i], c: [slopes[i], 0.0, 0.0] };
        let mut pieces = vec![straight(0)];
        for i in 0..last {
            let h = x[i + 1] - x[i];
            let secant = (z[i + 1] - z[i]) / h;
            let c_2 = (3.0 * secant - 2.0 * slopes[i] - slopes[i + 1]) / h;
            let c_3 = (slopes[i] + slopes[i + 1] - 2.0 * secant) / (h * h);
            pieces.push(Piece { start: x[i], height: z[i], c: [slopes[i], c_2, c_3] });
        }
        pieces.push(straight(last));
        Ok(Self::indexed(pieces, x[0], x[last]))
    }

    fn indexed(pieces: Vec<Piece>, first: f64, last: f64) -> Self {
        let parts = pieces.len() - 2;
        let parts_per_metre = parts as f64 / (last - first);
        let index = (0..parts)
            .map(|part| {
                let x = first + part as f64 / parts_per_metre;
                let behind = pieces[1..=parts].partition_point(|piece| piece.start <= x);
                behind.max(1) as u32
            })
            .collect();
        let mut samples = Self { pieces, first, last, index, parts_per_metre, bend: [0.0; 2] };
        samples.bend = [-samples.bend_within(-1.0, first, last), samples.bend_within(1.0, first, last)];
        samples
    }

    /// First and last position, m.
    #[must_use]
    pub fn range(&self) -> (f64, f64) {
        (self.first, self.last)
    }

    /// The samples (x, z) in order.
    pub fn points(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.pieces[1..].iter().map(|piece| (piece.start, piece.height))
    }

    /// Largest side * d2z/dx2 in `from..to`: linear on each piece, so largest at the ends of the piece's part.
    fn bend_within(&self, side: f64, from: f64, to: f64) -> f64 {
        let mut most = f64::NEG_INFINITY;
        for i in self.locate(from)..self.pieces.len() {
            let piece = &self.pieces[i];
            if i > 0 && piece.start >= to {
                break;
            }
            let end = self.pieces.get(i + 1).map_or(to, |next| next.start.min(to));
            let begin = if i == 0 { from } else { piece.start.max(from) };
            let at = |x: f64| side * (2.0 * piece.c[1] + 6.0 * piece.c[2] * (x - piece.start));
            most = most.max(at(begin)).max(at(end));
        }
        most
    }

    /// The piece that holds `x`: [x_0, z_0, c_1, c_2, c_3].
    #[lanes]
    pub(super) fn piece(&self, x: f64) -> [f64; 5] {
        let Piece { start, height, c } = self.pieces[self.locate(x)];
        [start, height, c[0], c[1], c[2]]
    }

    /// Largest |d2z/dx2|.
    pub(super) fn most_bend(&self) -> f64 {
        self.bend[0].abs().max(self.bend[1].abs())
    }

    /// Number of the piece that holds `x`.
    #[inline]
    fn locate(&self, x: f64) -> usize {
        if x < self.first {
            return 0;
        }
        if x >= self.last {
            return self.pieces.len() - 1;
        }
        let part = ((x - self.first) * self.parts_per_metre) as usize;
        let mut i = self.index[part.min(self.index.len() - 1)] as usize;
        // The part begins in piece i, give or take rounding; x lies there or a little behind.
        while x < self.pieces[i].start {
            i -= 1;
        }
        while x >= self.pieces[i + 1].start {
            i += 1;
        }
        i
    }
}

impl<S: Scalar> Curve<S> for Samples {
    #[inline]
    fn at(&self, x: S) -> Sample<S> {
        cubic(x, self.piece(x.value()).map(S::from))
    }

    fn bend(&self, side: f64, from: f64, to: f64, _: &Sample<f64>) -> f64 {
        self.bend_within(side, from, to)
    }

    fn bend_anywhere(&self, side: f64) -> f64 {
        // The straight extensions have none.
        (side * self.bend[0]).max(side * self.bend[1]).max(0.0)
    }

    fn cut(&self, from: f64, to: f64) -> f64 {
        let (left, right) = (self.locate(from), self.locate(to));
        // At the middle knot, unless it is an end of the interval itself.
        let knot = self.pieces[(left + right).div_ceil(2)].start;
        if knot > from && knot < to { knot } else { 0.5 * (from + to) }
    }
}

/// A piece at `x`, as [`Samples::piece`] gives it.
#[lanes]
pub(super) fn cubic<S: Scalar>(x: S, [start, height, c_1, c_2, c_3]: [S; 5]) -> Sample<S> {
    let u = x - start;
    Sample {
        height: u * (u * (u * c_3 + c_2) + c_1) + height,
        slope: u * (u * (c_3 * 3.0) + c_2 * 2.0) + c_1,
        curvature: u * (c_3 * 6.0) + c_2 * 2.0,
    }
}

fn check(x: &[f64], z: &[f64]) -> Result<(), SamplesError> {
    if x.len() != z.len() {
        return Err(SamplesError::Unequal { x: x.len(), z: z.len() });
    }
    if x.len() < 2 {
        return Err(SamplesError::TooFew(x.len()));
    }
    for (column, values) in [("x", x), ("z", z)] {
        if let Some((i, &value)) = values.iter().enumerate().find(|(_, v)| !v.is_finite() || v.abs() > LARGEST) {
            return Err(SamplesError::Value { row: i + 1, column, value, limit: LARGEST });
        }
    }
    match x.windows(2).position(|pair| pair[1] - pair[0] < FINEST) {
        Some(i) => Err(SamplesError::Unsorted { row: i + 2, value: x[i + 1], before: x[i], least: FINEST }),
        None => Ok(()),
    }
}

/// Slopes at the samples: the parabola through three neighbours, then limited so that each piece is monotone.
fn monotone_slopes(x: &[f64], z: &[f64]) -> Vec<f64> {
    let width: Vec<f64> = x.windows(2).map(|p| p[1] - p[0]).collect();
    let secant: Vec<f64> = z.windows(2).zip(&width).map(|(p, h)| (p[1] - p[0]) / h).collect();
    let last = secant.len() - 1;
    let mut slope = vec![secant[0]];
    for i in 1..=last {
        let (left, right) = (secant[i - 1], secant[i]);
        // An extreme of the samples is one of the curve.
        let extreme = left * right <= 0.0;
        slope.push(if extreme { 0.0 } else { (width[i] * left + width[i - 1] * right) / (width[i - 1] + width[i]) });
    }
    slope.push(secant[last]);
    // Both slopes over the secant must lie in the disc of radius 3. All limits are worked out before any is
    // applied, so that the mirrored samples give the mirrored curve.
    let limit: Vec<f64> = secant
        .iter()
        .zip(slope.windows(2))
        .map(|(&secant, ends)| {
            if secant == 0.0 {
                return 0.0;
            }
            let size = (ends[0] / secant).hypot(ends[1] / secant);
            if size > 3.0 { 3.0 / size } else { 1.0 }
        })
        .collect();
    for (i, slope) in slope.iter_mut().enumerate() {
        let left = if i > 0 { limit[i - 1] } else { 1.0 };
        let right = limit.get(i).copied().unwrap_or(1.0);
        *slope *= left.min(right);
    }
    slope
}
