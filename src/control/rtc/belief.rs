//! What one wheel gets out of the soil that a controller believes in: pull, torque and sinkage over load and slip, by the
//! full stress integrals (2.7)-(2.9), and the inverse.

use crate::contact::{Surface, rolling_on};
use crate::soil::Soil;
use crate::wheel::Wheel;

/// Largest slip that is looked at; at 1 the rim turns on the spot.
const LARGEST_SLIP: f64 = 0.99;
/// Largest skid that is looked at, as negative slip.
const LARGEST_SKID: f64 = -0.9;
/// Share of the largest pull that counts as all of it where the pull only grows with slip.
pub const SUFFICIENT: f64 = 0.95;
/// Slips between which the largest pull is bracketed.
const SLIPS: [f64; 9] = [0.0, 0.05, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, LARGEST_SLIP];
/// Golden sections of a bracket of 0.2 to 0.35 in slip: the place of the peak to 0.005, its height to far less.
const SECTIONS: usize = 9;
/// Steps of the search for a slip or a sinkage at most; 4 to 8 are usual.
const MOST_STEPS: usize = 40;
/// The load is met within this share of it.
const LOAD_TOLERANCE: f64 = 1e-9;
/// Miss of the torque (N m) or of the pull (N) at which a slip is found, over 1 + the load: its error in slip is far below that at
/// which slips of the force distribution stay.
const MISS: f64 = 1e-7;
/// A slip is found within this.
const SLIP_TOLERANCE: f64 = 1e-5;

/// A wheel on its soil. Speeds do not enter: the stresses depend on slip alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoilBelief {
    /// The wheel.
    pub wheel: Wheel,
    /// The soil under it.
    pub soil: Soil,
    /// Growth n_1 of the sinkage exponent with slip, n = n_0 + n_1 min(|i|, 1) (Ding et al. 2011).
    pub digging: f64,
    /// How the rim meets the soil: a smooth rim, where nothing else is known.
    pub surface: Surface,
    /// Share of the largest pull that counts as all of it where the pull only grows with slip; [`SUFFICIENT`] for control.
    pub sufficient: f64,
}

/// A steady state of a wheel under a load.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Working {
    /// Load N, N.
    pub load: f64,
    /// Slip i.
    pub slip: f64,
    /// Sinkage, m.
    pub sinkage: f64,
    /// Drawbar pull DP at the axle, N.
    pub pull: f64,
    /// Torque T that the drive balances, N m.
    pub torque: f64,
    /// Whether the soil carries the load; otherwise the wheel stands on its axle and the forces are those there.
    pub carried: bool,
}

impl SoilBelief {
    /// A smooth wheel on soil in which slip does not dig, with the share of the largest pull that is usual for control.
    #[must_use]
    pub fn new(wheel: Wheel, soil: Soil) -> Self {
        Self { wheel, soil, digging: 0.0, surface: Surface::smooth(0.0), sufficient: SUFFICIENT }
    }

    /// The steady state under `load` (N, over 0) at `slip` (over -1), driving forward.
    #[must_use]
    pub fn at(&self, load: f64, slip: f64) -> Working {
        self.from(load, slip, 0.1 * self.wheel.radius)
    }

    /// The same, with the sinkage searched for from `guess` (m).
    fn from(&self, load: f64, slip: f64, guess: f64) -> Working {
        let radius = self.wheel.radius;
        let soil = Soil { exponent: self.soil.exponent + self.digging * slip.abs().min(1.0), ..self.soil };
        let travel = if slip >= 0.0 { radius * (1.0 - slip) } else { radius / (1.0 + slip) };
        let forces = |z: f64| rolling_on(&self.wheel, &soil, &self.surface, z, travel, 1.0);
        let (mut low, mut high) = (0.0, radius);
        let mut z = guess.clamp(1e-4 * radius, radius);
        // N is about proportional to z^(n + 1/2) (4.18).
        let power = (soil.exponent + 0.5).recip();
        let mut before: Option<(f64, f64)> = None;
        for _ in 0..MOST_STEPS {
            let here = forces(z);
            let working =
                |carried| Working { load, slip, sinkage: z, pull: here.drawbar, torque: here.torque, carried };
            if (here.normal - load).abs() <= LOAD_TOLERANCE * load || high - low <= f64::EPSILON * high {
                return working(true);
            }
            if here.normal < load {
                if z >= radius {
                    return working(false);
                }
                low = z;
            } else {
                high = z;
            }
            let error = (here.normal.max(f64::MIN_POSITIVE) / load).ln();
            // Secant in logarithms, from the second step on.
            let slope = match before {
                Some((at, other)) if (z / at).ln().abs() > 1e-12 => (error - other) / (z / at).ln(),
                _ => power.recip(),
            };
            before = Some((z, error));
            let next = z * (-error / slope.max(0.1)).exp();
            z = if next > low && next < high {
                next
            } else if next >= radius && high >= radius {
                radius
            } else {
                0.5 * (low + high)
            };
        }
        let here = forces(z);
        Working { load, slip, sinkage: z, pull: here.drawbar, torque: here.torque, carried: true }
    }

    /// The state of the best slip i* under `load` (N): that of the largest pull, or where the pull only grows with slip
    /// the one at which the share `sufficient` of the largest pull is reached.
    #[must_use]
    pub fn best(&self, load: f64) -> Working {
        let mut states = [Working::default(); SLIPS.len()];
        let mut guess = 0.1 * self.wheel.radius;
        for (state, slip) in states.iter_mut().zip(SLIPS) {
            *state = self.from(load, slip, guess);
            guess = state.sinkage;
        }
        // A wheel on its axle pulls nothing.
        let pull = |state: &Working| if state.carried { state.pull } else { f64::NEG_INFINITY };
        let most = (0..SLIPS.len()).fold(0, |best, k| if pull(&states[k]) > pull(&states[best]) { k } else { best });
        if most + 1 == SLIPS.len() {
            return self.sufficient(load, &states);
        }
        self.peak(load, SLIPS[most.saturating_sub(1)], SLIPS[most + 1], states[most])
    }

    /// The largest pull between two slips, `best` being one of those between, by golden sections.
    fn peak(&self, load: f64, mut low: f64, mut high: f64, mut best: Working) -> Working {
        const GOLDEN: f64 = 0.618_033_988_749_895;
        let at = |slip| self.from(load, slip, best.sinkage);
        let (mut left, mut right) = (at(high - GOLDEN * (high - low)), at(low + GOLDEN * (high - low)));
        for _ in 0..SECTIONS {
            if !right.carried || left.pull >= right.pull {
                high = right.slip;
                (right, left) = (left, at(high - GOLDEN * (high - low)));
            } else {
                low = left.slip;
                (left, right) = (right, at(low + GOLDEN * (high - low)));
            }
        }
        for state in [left, right] {
            if state.carried && state.pull > best.pull {
                best = state;
            }
        }
        best
    }

    /// The least slip at which the sufficient share of the pull at the largest slip is reached; that slip where no wheel pulls.
    fn sufficient(&self, load: f64, states: &[Working; SLIPS.len()]) -> Working {
        let last = states[SLIPS.len() - 1];
        let wanted = self.sufficient * last.pull;
        if last.pull <= 0.0 {
            return last;
        }
        let reached = states.iter().position(|state| state.pull >= wanted).unwrap_or(SLIPS.len() - 1);
        let Some(below) = reached.checked_sub(1).map(|k| states[k]) else { return states[0] };
        self.search(load, below, states[reached], |state| state.pull - wanted)
    }

    /// The state under `load` (N) whose torque is `torque` (N m), between the largest skid and `most`; the nearer end where
    /// there is none.
    #[must_use]
    pub fn with_torque(&self, load: f64, torque: f64, most: &Working) -> Working {
        if torque >= most.torque {
            return *most;
        }
        let rolling = self.from(load, 0.0, most.sinkage);
        if torque >= rolling.torque {
            return self.search(load, rolling, *most, |state| state.torque - torque);
        }
        let skid = self.from(load, LARGEST_SKID, rolling.sinkage);
        if torque <= skid.torque {
            return skid;
        }
        self.search(load, skid, rolling, |state| state.torque - torque)
    }

    /// Zero of `miss`, which grows with slip, between two states (Illinois).
    fn search(&self, load: f64, mut low: Working, mut high: Working, miss: impl Fn(&Working) -> f64) -> Working {
        let (mut at_low, mut at_high) = (miss(&low), miss(&high));
        let mut side = 0;
        for _ in 0..MOST_STEPS {
            if high.slip - low.slip <= SLIP_TOLERANCE || at_high <= at_low {
                break;
            }
            let share = (at_low / (at_low - at_high)).clamp(0.0, 1.0);
            let state = self.from(load, low.slip + share * (high.slip - low.slip), high.sinkage);
            let here = miss(&state);
            if here.abs() <= MISS * (1.0 + load) {
                return state;
            }
            if here < 0.0 {
                (low, at_low) = (state, here);
                at_high *= if side == -1 { 0.5 } else { 1.0 };
                side = -1;
            } else {
                (high, at_high) = (state, here);
                at_low *= if side == 1 { 0.5 } else { 1.0 };
                side = 1;
            }
        }
        if at_low.abs() < at_high.abs() { low } else { high }
    }

    /// Whether slip beyond `best` costs pull: whether the soil digs.
    #[must_use]
    pub fn digs(&self, load: f64, best: &Working) -> bool {
        let spinning = self.from(load, LARGEST_SLIP, best.sinkage);
        !spinning.carried || spinning.pull < SUFFICIENT * best.pull
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::rolling;

    fn belief(digging: f64) -> SoilBelief {
        // On the thesis's sand pull grows up to full slip; with a third of its K it is all but reached at little slip.
        let shear_modulus = if digging > 0.0 { 0.01 } else { Soil::<f64>::default().shear_modulus };
        SoilBelief { digging, ..SoilBelief::new(Wheel::default(), Soil { shear_modulus, ..Soil::default() }) }
    }

    #[test]
    fn analytic_states_carry_their_load() {
        for (load, slip) in [(10.0, 0.0), (49.0, 0.3), (49.0, 0.99), (80.0, -0.5)] {
            let state = belief(0.0).at(load, slip);
            let travel = if slip >= 0.0 { 0.1 * (1.0 - slip) } else { 0.1 / (1.0 + slip) };
            let forces = rolling(&Wheel::default(), &Soil::default(), 0.0, state.sinkage, travel, 1.0);
            assert!((forces.normal / load - 1.0).abs() < 1e-8, "{load} N at {slip}: {}", forces.normal);
        }
    }

    #[test]
    fn property_the_best_slip_is_the_peak_or_reaches_the_stated_share() {
        let grows = belief(0.0);
        let best = grows.best(49.0);
        let most = grows.at(49.0, LARGEST_SLIP).pull;
        assert!((best.pull / most - SUFFICIENT).abs() < 1e-3 && !grows.digs(49.0, &best), "{best:?}, {most} N");
        let digs = belief(0.4);
        let best = digs.best(49.0);
        assert!(digs.digs(49.0, &best), "{best:?}, {:?}", digs.from(49.0, LARGEST_SLIP, best.sinkage));
        for k in 0..99 {
            let other = digs.at(49.0, 0.01 * f64::from(k));
            assert!(!other.carried || other.pull <= best.pull + 1e-3, "{other:?} against {best:?}");
        }
    }

    #[test]
    fn analytic_torques_and_slips_are_inverse() {
        for digging in [0.0, 0.3] {
            let belief = belief(digging);
            let most = belief.best(49.0);
            for slip in [-0.7, -0.2, -0.01, 0.0, 0.05, 0.1, 0.15] {
                let state = belief.at(49.0, slip);
                let found = belief.with_torque(49.0, state.torque, &most);
                let expected = slip.min(most.slip);
                assert!((found.slip - expected).abs() < 1e-4, "{} for {slip}", found.slip);
            }
        }
    }
}
