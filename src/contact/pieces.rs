//! Where the quadrature along the rim is cut, and with how many nodes each piece is integrated.
//!
//! The shear stress follows 1 - exp(-|j|/K). Where |j|/K stays small a fixed rule over each zone resolves it. Two
//! things do not suit such a rule: the change of sign of j at negative slip, and a shear that builds up within a
//! small part of the contact (large r/K, or a strong skid). There the contact is cut where j = 0 and where |j|
//! reaches a few K, beyond which the shear stress is the strength.

use super::quadrature::{NODES_8, NODES_12, NODES_16};
use super::rim::{Rim, Shear, Sums};
use crate::scalar::Scalar;

/// Largest change of j/K in a zone for which 8 nodes stay within 1e-6 of N, with one sign of j.
const FEW_NODES: f64 = 3.0;
/// The same where j changes its sign.
const FEW_NODES_BOTH_SIGNS: f64 = 1.5;
/// Largest change of j/K in a zone for which 12 nodes stay within 1e-6 of N without further cuts.
const MORE_NODES: f64 = 8.0;
/// |j|/K at which the rest of the contact is cut off: exp(-12) = 6e-6 is left to decay there.
const BUILT_UP: f64 = 12.0;
/// Pieces at most: j has three monotone parts, each with at most three cuts, and the zones' three ends.
const MOST_CUTS: usize = 12;
/// Accuracy of a cut, rad; near a change of sign the error of the integral is of its square.
const CUT: f64 = 1e-10;

/// Angles at which the contact is cut, from theta_1 down to theta_2.
struct Cuts {
    angles: [f64; MOST_CUTS],
    len: usize,
}

impl Cuts {
    /// Puts `theta` in its place. No more than [`MOST_CUTS`] ever come.
    fn insert(&mut self, theta: f64) {
        let place = self.angles[..self.len].partition_point(|angle| *angle >= theta);
        self.angles.copy_within(place..self.len, place + 1);
        self.angles[place] = theta;
        self.len += 1;
    }
}

/// Sums over the whole contact.
pub(super) fn sums<S: Scalar>(rim: &Rim<S>) -> Sums<S> {
    // A rim that slides fully may carry little load beside its pressure, of which the error is a part: 12 nodes.
    let (Shear::Ratio(ratio) | Shear::OnSurface(ratio)) = rim.shear else { return whole(rim, &NODES_12) };
    let displacement = Displacement::new(rim, ratio.value());
    let change = displacement.largest_change();
    if rim.grip.value() < 1.0 {
        // The shear has a kink where it meets what the rim transmits: 1 - exp(-|j|/K) = grip.
        let limit = -(1.0 - rim.grip.value()).ln();
        let limit = limit.min(BUILT_UP);
        let nodes: &[(f64, f64)] = if change <= MORE_NODES { &NODES_12 } else { &NODES_16 };
        return pieces(rim, &displacement.cuts(&[0.0, limit, -limit]), nodes);
    }
    if displacement.changes_sign() {
        return match change {
            ..=FEW_NODES_BOTH_SIGNS => pieces(rim, &displacement.cuts(&[0.0]), &NODES_8),
            ..=MORE_NODES => pieces(rim, &displacement.cuts(&[0.0]), &NODES_12),
            _ => pieces(rim, &displacement.cuts(&[0.0, BUILT_UP, -BUILT_UP]), &NODES_16),
        };
    }
    match change {
        ..=FEW_NODES => whole(rim, &NODES_8),
        ..=MORE_NODES => whole(rim, &NODES_12),
        _ => pieces(rim, &displacement.cuts(&[BUILT_UP, -BUILT_UP]), &NODES_16),
    }
}

/// Both zones at once: they share their normal stress.
fn whole<S: Scalar>(rim: &Rim<S>, nodes: &[(f64, f64)]) -> Sums<S> {
    let mut sums = Sums::zero();
    nodes.iter().for_each(|&(s, weight)| rim.add(&mut sums, s, weight, weight));
    sums
}

/// Piece by piece, in the zones' own variable s.
fn pieces<S: Scalar>(rim: &Rim<S>, cuts: &Cuts, nodes: &[(f64, f64)]) -> Sums<S> {
    let (theta_1, theta_m, theta_2) = (rim.theta_1.value(), rim.theta_m.value(), rim.theta_2.value());
    let mut sums = Sums::zero();
    for piece in cuts.angles[..cuts.len].windows(2) {
        let front = piece[1] >= theta_m;
        let (start, length) = if front { (theta_1, theta_1 - theta_m) } else { (theta_2, theta_m - theta_2) };
        let s = |theta: f64| ((theta - start).abs() / length).min(1.0).sqrt();
        let (from, to) = if front { (s(piece[0]), s(piece[1])) } else { (s(piece[1]), s(piece[0])) };
        for &(node, weight) in nodes {
            let (at, weight) = (from + (to - from) * node, weight * (to - from));
            if front { rim.add(&mut sums, at, weight, 0.0) } else { rim.add(&mut sums, at, 0.0, weight) }
        }
    }
    sums
}

/// Shear displacement along the rim, in plain numbers: a cut moves no integral, so its derivatives do not matter.
struct Displacement {
    /// V/(r omega).
    ratio: f64,
    theta_1: f64,
    theta_m: f64,
    theta_2: f64,
    /// Where the shear starts, its sine, and the radius of shear over that of the arc.
    theta_s: f64,
    sin_s: f64,
    shear_radius: f64,
    /// r/K.
    rate: f64,
    /// theta_1, the places where dj/dtheta = 0, theta_2: j is monotone between them.
    turns: [f64; 4],
    turns_len: usize,
    /// Largest |dj/dtheta|/K.
    steepest: f64,
}

impl Displacement {
    fn new<S: Scalar>(rim: &Rim<S>, ratio: f64) -> Self {
        let [theta_1, theta_m, theta_2, cos_1] = [rim.theta_1, rim.theta_m, rim.theta_2, rim.cos_1].map(|a| a.value());
        let (rate, shear_radius) = (rim.shear_rate.value(), rim.shear_radius.value());
        let (mut turns, mut turns_len) = ([theta_1; 4], 1);
        // dj/dtheta = -(r_s - r ratio cos theta) vanishes at +-acos(r_s/(r ratio)).
        if ratio > shear_radius {
            let turn = (shear_radius / ratio).acos();
            for angle in [turn, -turn] {
                if angle < theta_1 && angle > theta_2 {
                    turns[turns_len] = angle;
                    turns_len += 1;
                }
            }
        }
        turns[turns_len] = theta_2;
        let slope = |cos: f64| (shear_radius - ratio * cos).abs();
        let steepest = rate * slope(cos_1).max(slope(1.0)).max(slope(theta_2.cos()));
        let (theta_s, sin_s) = (rim.theta_s.value(), rim.sin_s.value());
        let turns_len = turns_len + 1;
        Self { ratio, theta_1, theta_m, theta_2, theta_s, sin_s, shear_radius, rate, turns, turns_len, steepest }
    }

    /// j/K.
    fn at(&self, theta: f64) -> f64 {
        self.rate * (self.shear_radius * (self.theta_s - theta) - self.ratio * (self.sin_s - theta.sin()))
    }

    /// A bound on the change of j/K over either zone.
    fn largest_change(&self) -> f64 {
        self.steepest * (self.theta_1 - self.theta_m).max(self.theta_m - self.theta_2)
    }

    /// Whether j may change its sign: it does not where it is monotone from zero on. Lugs have begun to shear before
    /// theta_1, so that j is not zero there.
    fn changes_sign(&self) -> bool {
        self.turns_len > 2 || (self.shear_radius != 1.0 && self.at(self.theta_1) * self.at(self.theta_2) < 0.0)
    }

    /// The ends of the zones and the places where j/K passes one of the `levels`.
    fn cuts(&self, levels: &[f64]) -> Cuts {
        let mut cuts = Cuts { angles: [0.0; MOST_CUTS], len: 0 };
        [self.theta_1, self.theta_m, self.theta_2].into_iter().for_each(|theta| cuts.insert(theta));
        for part in self.turns[..self.turns_len].windows(2) {
            let ends = [self.at(part[0]), self.at(part[1])];
            for level in levels {
                if (ends[0] - level) * (ends[1] - level) < 0.0 {
                    cuts.insert(self.pass(*level, part[0], part[1], ends[1] > ends[0]));
                }
            }
        }
        cuts
    }

    /// Where j/K passes `level` between `above` and `below`, `rising` on the way down: Newton's method within a
    /// shrinking bracket.
    fn pass(&self, level: f64, above: f64, below: f64, rising: bool) -> f64 {
        let (mut low, mut high) = (below, above);
        let mut theta = 0.5 * (low + high);
        for _ in 0..50 {
            let value = self.at(theta) - level;
            if (value > 0.0) == rising {
                low = theta
            } else {
                high = theta
            }
            let next = theta - value / (self.rate * (self.ratio * theta.cos() - self.shear_radius));
            let next = if next > low && next < high { next } else { 0.5 * (low + high) };
            if (next - theta).abs() < CUT {
                return next;
            }
            theta = next;
        }
        theta
    }
}
