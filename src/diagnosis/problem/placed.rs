//! The free parameters of a joint problem as one of its parts knows them.

use super::Problem;
use crate::diagnosis::free::Free;

/// Free parameters of a part, and what of the whole moves each.
#[derive(Clone, Debug)]
pub(crate) struct Placed {
    /// Under the names of the part's own model.
    pub free: Vec<Free>,
    moves: Vec<Moves>,
}

/// Numbers of the free parameters of the whole that move one of a part.
#[derive(Clone, Debug, Default)]
struct Moves {
    /// Whose value it has. Where an effect acts in all parts and in this one besides, its strength here is the sum of both; where there
    /// is none, the parameter is held at its start.
    by_value: Vec<usize>,
    /// By which it is multiplied: the scatter of the soil.
    by_factor: Vec<usize>,
}

impl Placed {
    /// Of part number `k`, posed as `part`, among `free` parameters of the whole.
    pub fn of(free: &[Free], part: &Problem, k: usize) -> Self {
        let mut placed = Self { free: Vec::new(), moves: Vec::new() };
        for (at, here) in free.iter().enumerate().filter_map(|(at, free)| Some((at, free.in_part(k)?))) {
            let own = placed.place(here);
            placed.moves[own].by_value.push(at);
        }
        for (at, factor) in free.iter().enumerate() {
            for name in factor.factor_in(k) {
                // A parameter that is held while its scatter is free stays at its value.
                let known = placed.free.iter().any(|own| own.variable.name == *name);
                let Some(held) = part.base.iter().find(|own| own.variable.name == *name) else { continue };
                let start = if known { held.start } else { part.value_of(name) };
                let own = placed.place(Free { start, ..held.clone() });
                placed.moves[own].by_factor.push(at);
            }
        }
        placed
    }

    /// Where a parameter stands; it is added where it is new.
    fn place(&mut self, free: Free) -> usize {
        if let Some(known) = self.free.iter().position(|own| own.variable.name == free.variable.name) {
            return known;
        }
        self.free.push(free);
        self.moves.push(Moves::default());
        self.free.len() - 1
    }

    /// Values of the part's parameters for those of the whole, which `free` describes.
    pub fn values(&self, whole: &[f64], free: &[Free]) -> Vec<f64> {
        (0..self.free.len()).map(|own| self.unscaled(own, whole, free) * self.factor(own, whole)).collect()
    }

    fn unscaled(&self, own: usize, whole: &[f64], free: &[Free]) -> f64 {
        let Free { start, variable, .. } = &self.free[own];
        match self.moves[own].by_value.as_slice() {
            [] => *start,
            [one] => whole[*one],
            several => {
                let sum = start + several.iter().map(|k| whole[*k] - free[*k].start).sum::<f64>();
                sum.clamp(variable.min, variable.max)
            }
        }
    }

    /// Whether a sum of strengths is beyond a bound, where it does not follow them.
    fn is_clamped(&self, own: usize, whole: &[f64], free: &[Free]) -> bool {
        let Free { start, variable, .. } = &self.free[own];
        let by_value = &self.moves[own].by_value;
        let sum = start + by_value.iter().map(|k| whole[*k] - free[*k].start).sum::<f64>();
        by_value.len() > 1 && (sum < variable.min || sum > variable.max)
    }

    fn factor(&self, own: usize, whole: &[f64]) -> f64 {
        self.moves[own].by_factor.iter().map(|k| whole[*k]).product()
    }

    /// Calls `f(k, own, rate)` for each parameter `k` of the whole that moves parameter `own` of the part, with the derivative `rate` of the
    /// second in the first.
    pub fn each_slope(&self, whole: &[f64], free: &[Free], mut f: impl FnMut(usize, usize, f64)) {
        for (own, moves) in self.moves.iter().enumerate() {
            let factor = self.factor(own, whole);
            let rate = if self.is_clamped(own, whole, free) { 0.0 } else { factor };
            moves.by_value.iter().for_each(|k| f(*k, own, rate));
            let value = self.unscaled(own, whole, free) * factor;
            moves.by_factor.iter().for_each(|k| f(*k, own, value / whole[*k]));
        }
    }
}
