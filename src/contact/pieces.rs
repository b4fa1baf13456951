//! Where the quadrature along the rim is cut, and with how many nodes each piece is integrated.
//!
//! The shear stress follows 1 - exp(-|j|/K). Where |j|/K stays small a fixed rule over each zone resolves it. Two
//! things do not suit such a rule: the change of sign of j at negative slip, and a shear that builds up within a
//! small part of the contact (large r/K, or a strong skid). There the contact is cut where j = 0 and where |j|
//! reaches a few K, beyond which the shear stress is the strength.

use super::quadrature::{NODES_8, NODES_12, NODES_16};
use super::rim::{Rim, Shear, Sums};
use crate::scalar::{Mask, Plain, Scalar, lanes};
use num_dual::DualNum;
use num_traits::Signed;

/// Largest change of j/K in a zone for which 8 nodes stay within 1e-6 of N, with one sign of j.
const FEW_NODES: f64 = 3.0;
/// The same where j changes its sign.
const FEW_NODES_BOTH_SIGNS: f64 = 1.5;
/// Largest change of j/K in a zone for which 12 nodes stay within 1e-6 of N without further cuts.
const MORE_NODES: f64 = 8.0;
/// |j|/K at which the rest of the contact is cut off: exp(-12) = 6e-6 is left to decay there.
const BUILT_UP: f64 = 12.0;
/// Half the width of a rounded corner in ln b, over its rounding: beyond it the shear differs from its asymptote by
/// exp(-4) of the corner's height.
const CORNER: f64 = 4.0;
/// Bounds of the change of j/K over a piece that are no bounds.
const ANY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
/// Accuracy of a cut, rad; near a change of sign the error of the integral is of its square.
const CUT: f64 = 1e-10;

/// Sums over the whole contact.
#[inline(never)]
#[lanes(entry)]
pub(super) fn sums<S: Scalar>(rim: &Rim<S>) -> Sums<S> {
    S::wide(|| {
        // A rim that slides fully may carry little load beside its pressure, of which the error is a part: 12 nodes.
        let (Shear::Ratio(ratio) | Shear::OnSurface(ratio)) = rim.shear else { return whole(rim, &NODES_12) };
        let displacement = Displacement::new(rim, ratio.plain());
        let change = displacement.largest_change();
        let signs = displacement.changes_sign();
        let [up_to_few, up_to_few_cut, up_to_more] =
            [FEW_NODES, FEW_NODES_BOTH_SIGNS, MORE_NODES].map(|limit| change.at_most(limit.into()));
        let grips = !rim.grip.under(1.0);
        let (little, some) = (grips & !signs & up_to_few, grips & !signs & up_to_more);
        let (cut, cut_more) = (grips & signs & up_to_few_cut, grips & signs & up_to_more);
        let quick = grips & !(some | cut_more);
        // Where the shear meets what the rim transmits: with a kink, or with a rounded corner.
        let sharp = !grips & rim.rounding.plain().at_most(0.0.into());
        let rounded = !grips & !sharp;
        let mut sums = Sums::zero();
        // Loops over the cases, so that the stresses along a rim are compiled once for all of them.
        for (contacts, nodes) in [(little, &NODES_8[..]), (some & !little, &NODES_12)] {
            if contacts.any() {
                sums.take(contacts, &whole(rim, nodes));
            }
        }
        // Rims with a rounded corner are few: for the others nothing is written to so long an array.
        let of_corners =
            if rounded.any() { Some(displacement.passes::<9, 30>(corner_levels(rim), rounded)) } else { None };
        let of_corners = of_corners.as_ref().map_or(&[][..], |angles| &angles[..]);
        let end = displacement.theta_2;
        let (mut of_signs, mut quick_changes) = ([end; 6], [end; 12]);
        if (cut | cut_more).any() {
            of_signs = displacement.passes([0.0.into()], cut | cut_more);
        }
        if (quick | sharp).any() {
            let mut level = S::Plain::from(BUILT_UP);
            if sharp.any() {
                level = S::Plain::select(sharp, level_of(rim.grip.plain()), level);
            }
            quick_changes = displacement.passes([0.0.into(), level, -level], quick | sharp);
        }
        let cases = [
            (cut, &of_signs[..], &NODES_8[..], ANY),
            (cut_more & !cut, &of_signs[..], &NODES_12[..], ANY),
            (sharp & up_to_more, &quick_changes[..], &NODES_12[..], ANY),
            (quick | (sharp & !up_to_more), &quick_changes[..], &NODES_16[..], ANY),
            // On either side of a rounded corner's middle 8 nodes leave 3e-9 of its height: the corner's nearest singularity is
            // pi w away from a piece of 4 w in ln b, so that the error of n nodes falls as 3.4^(-2 n).
            (rounded, of_corners, &NODES_8[..], [ANY[0], FEW_NODES]),
            (rounded, of_corners, &NODES_12[..], [FEW_NODES, MORE_NODES]),
            (rounded, of_corners, &NODES_16[..], [MORE_NODES, ANY[1]]),
        ];
        for (contacts, angles, nodes, changes) in cases {
            if contacts.any() {
                let part = between(rim, angles, nodes, displacement.steepest, changes);
                if changes == ANY { sums.take(contacts, &part) } else { sums.add(contacts, &part) }
            }
        }
        sums
    })
}

/// j/K at which the share `b` of the strength is built up, [`BUILT_UP`] at most.
fn level_of<R: Plain>(b: R) -> R {
    b.each(|b| if b < 1.0 { (-(1.0 - b).ln()).min(BUILT_UP) } else { BUILT_UP })
}

/// Levels of j/K that bound the smooth parts of a shear that bends into what the rim transmits: the corner's middle and its ends, on
/// either side.
fn corner_levels<S: Scalar>(rim: &Rim<S>) -> [S::Plain; 9] {
    let (grip, rounding) = (rim.grip.plain(), rim.rounding.plain());
    let beside = |side: f64| level_of(grip * (rounding * (side * CORNER)).each(f64::exp));
    let (before, limit, after, built_up) = (beside(-1.0), level_of(grip), beside(1.0), S::Plain::from(BUILT_UP));
    [0.0.into(), before, -before, limit, -limit, after, -after, built_up, -built_up]
}

/// Both zones at once: they share their normal stress.
#[lanes]
fn whole<S: Scalar>(rim: &Rim<S>, nodes: &[(f64, f64)]) -> Sums<S> {
    let mut sums = Sums::zero();
    for &(s, weight) in nodes {
        rim.add(&mut sums, s, weight);
    }
    sums
}

/// Between each of `angles` and the next, which may be the same, where the change of j/K between them is above the first of `changes`
/// and at most the second.
#[lanes]
fn between<S: Scalar>(
    rim: &Rim<S>,
    angles: &[S::Plain],
    nodes: &[(f64, f64)],
    steepest: S::Plain,
    changes: [f64; 2],
) -> Sums<S> {
    let mut sums = Sums::zero();
    for piece in angles.windows(2) {
        let change = steepest * (piece[0] - piece[1]);
        let others = change.at_most(changes[0].into()) | S::Plain::from(changes[1]).below(change);
        // Side by side, a piece of no length adds nothing.
        let below = S::Plain::select(others, piece[0], piece[1]);
        if below.below(piece[0]).any() {
            add_piece(rim, &mut sums, piece[0], below, nodes);
        }
    }
    sums
}

#[lanes]
fn add_piece<S: Scalar>(rim: &Rim<S>, sums: &mut Sums<S>, above: S::Plain, below: S::Plain, nodes: &[(f64, f64)]) {
    let [theta_1, theta_m, theta_2] = [rim.theta_1, rim.theta_m, rim.theta_2].map(S::plain);
    let front = theta_m.at_most(below);
    let choose = |yes: S::Plain, no: S::Plain| S::Plain::select(front, yes, no);
    let (start, length) = (choose(theta_1, theta_2), choose(theta_1 - theta_m, theta_m - theta_2));
    let s = |theta: S::Plain| ((theta - start).abs() / length).smaller(S::Plain::from(1.0)).sqrt();
    let (from, to) = (s(choose(above, below)), s(choose(below, above)));
    for &(node, weight) in nodes {
        rim.add_in(sums, front, from + (to - from) * node, (to - from) * weight);
    }
}

/// Shear displacement along the rim, in plain numbers: a cut moves no integral, so its derivatives do not matter.
struct Displacement<R> {
    /// V/(r omega).
    ratio: R,
    theta_1: R,
    theta_m: R,
    theta_2: R,
    /// Where the shear starts, its sine, and the radius of shear over that of the arc.
    theta_s: R,
    sin_s: R,
    shear_radius: R,
    /// r/K.
    rate: R,
    /// theta_1, the places where dj/dtheta = 0 (or its end again), theta_2: j is monotone between them.
    turns: [R; 4],
    /// Largest |dj/dtheta|/K.
    steepest: R,
}

#[lanes]
impl<R: Plain> Displacement<R> {
    fn new<S: Scalar<Plain = R, Mask = R::Mask>>(rim: &Rim<S>, ratio: R) -> Self {
        let [theta_1, theta_m, theta_2, cos_1] = [rim.theta_1, rim.theta_m, rim.theta_2, rim.cos_1].map(S::plain);
        let (rate, shear_radius) = (rim.shear_rate.plain(), rim.shear_radius.plain());
        // dj/dtheta = -(r_s - r ratio cos theta) vanishes at +-acos(r_s/(r ratio)).
        let turns_back = shear_radius.below(ratio);
        let mut turns = [theta_1, theta_1, theta_2, theta_2];
        if turns_back.any() {
            let turn = (shear_radius / ratio).arc_cosine();
            let inside = |angle: R| turns_back & angle.below(theta_1) & theta_2.below(angle);
            turns[1] = R::select(inside(turn), turn, theta_1);
            turns[2] = R::select(inside(-turn), -turn, theta_2);
        }
        let slope = |cos: R| (shear_radius - ratio * cos).abs();
        let cos_2 = if theta_2.is_exactly(0.0) { R::from(1.0) } else { theta_2.sine_cosine().1 };
        let steepest = rate * slope(cos_1).larger(slope(R::from(1.0))).larger(slope(cos_2));
        let (theta_s, sin_s) = (rim.theta_s.plain(), rim.sin_s.plain());
        Self { ratio, theta_1, theta_m, theta_2, theta_s, sin_s, shear_radius, rate, turns, steepest }
    }

    /// j/K at an angle and its sine.
    fn at(&self, theta: R, sin: R) -> R {
        self.rate * (self.shear_radius * (self.theta_s - theta) - self.ratio * (self.sin_s - sin))
    }

    /// j/K at an angle.
    fn of(&self, theta: R) -> R {
        self.at(theta, theta.sine_cosine().0)
    }

    /// A bound on the change of j/K over either zone.
    fn largest_change(&self) -> R {
        self.steepest * (self.theta_1 - self.theta_m).larger(self.theta_m - self.theta_2)
    }

    /// Whether j may change its sign: it does not where it is monotone from zero on. Lugs have begun to shear before
    /// theta_1, so that j is not zero there.
    fn changes_sign(&self) -> R::Mask {
        let turns = self.turns[1].below(self.theta_1) | self.theta_2.below(self.turns[2]);
        if self.shear_radius.is_exactly(1.0) {
            return turns;
        }
        let passes = (self.of(self.theta_1) * self.of(self.theta_2)).under(0.0);
        turns | (!self.shear_radius.same(R::from(1.0)) & passes)
    }

    /// The ends of the zones and the places where j/K passes one of the levels, from theta_1 down to theta_2, which stands for those
    /// that are not there. Of no meaning outside the mask. j has three monotone parts, so `N` is 3 + 3 `LEVELS`.
    fn passes<const LEVELS: usize, const N: usize>(&self, levels: [R; LEVELS], mask: R::Mask) -> [R; N] {
        const { assert!(N == 3 + 3 * LEVELS, "a place for every pass") };
        let turns = &self.turns;
        let ends = [self.of(turns[0]), self.of(turns[1]), self.of(turns[2]), self.of(turns[3])];
        let mut angles = [self.theta_2; N];
        (angles[0], angles[1]) = (self.theta_1, self.theta_m);
        for part in 0..3 {
            let [from, to] = [ends[part], ends[part + 1]];
            for level in levels {
                let passes = mask & ((from - level) * (to - level)).under(0.0);
                if !passes.any() {
                    continue;
                }
                let within = [self.turns[part], self.turns[part + 1]];
                let place = self.pass(level, within, from.below(to), passes);
                let mut next = R::select(passes, place, self.theta_2);
                for angle in &mut angles[1..N - 1] {
                    (*angle, next) = (angle.larger(next), angle.smaller(next));
                }
            }
        }
        angles
    }

    /// Where j/K passes `level` between the two angles, above and below, `rising` on the way down: Newton's method
    /// within a shrinking bracket, where the mask says so.
    fn pass(&self, level: R, [above, below]: [R; 2], rising: R::Mask, mask: R::Mask) -> R {
        let (mut low, mut high) = (below, above);
        let mut theta = (low + high) * 0.5;
        let mut active = mask;
        for _ in 0..50 {
            let (sin, cos) = theta.sine_cosine();
            let value = self.at(theta, sin) - level;
            let over = value.over(0.0);
            let lower = (over & rising) | (!over & !rising);
            low = R::select(lower, theta, low);
            high = R::select(lower, high, theta);
            let next = theta - value / (self.rate * (self.ratio * cos - self.shear_radius));
            let inside = low.below(next) & next.below(high);
            let next = R::select(inside, next, (low + high) * 0.5);
            let arrived = (next - theta).abs().under(CUT);
            theta = R::select(active, next, theta);
            active = active & !arrived;
            if !active.any() {
                break;
            }
        }
        theta
    }
}
