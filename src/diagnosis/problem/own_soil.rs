//! A set of experiments one of which stands on a soil of its own.

use super::Problem;
use super::joint::{IN, within};
use crate::diagnosis::free::Free;
use crate::measurement::Share;

impl Problem<'_> {
    /// The same experiments, of which part number `k` has a soil of its own; `None` where it shares nothing that is free of the soil.
    pub fn with_own_soil(&self, k: usize) -> Option<Self> {
        let others = |free: &Free| (0..self.parts.len()).filter(|j| *j != k && free.in_part(*j).is_some()).collect();
        let mut apart = self.clone();
        apart.base.clear();
        apart.sensitivities = None;
        let mut own = Vec::new();
        // Without the scatter of its bed, which a soil of its own contains.
        for free in self.base.iter().filter(|free| free.factor_in(k).is_empty()) {
            let here = free.in_part(k).filter(|here| Share::of(&here.variable.name) == Some(Share::Soil));
            let others: Vec<usize> = others(free);
            let (Some(here), false) = (here, others.is_empty()) else {
                apart.base.push(free.clone());
                continue;
            };
            own.push(within(&here, &[k], &format!("{IN}{}", self.experiment.parts[k].name)));
            let name = free.variable.name.clone();
            let mut shared = within(&here, &others, "");
            shared.variable.name = name;
            apart.base.push(shared);
        }
        let any = !own.is_empty();
        apart.base.extend(own);
        any.then_some(apart)
    }

    /// Values of `apart`'s baseline, which comes from [`Self::with_own_soil`] of part number `k`, that give the same soils as `values` of the
    /// parameters `free` of this problem.
    pub fn as_own_soil(&self, apart: &Self, k: usize, free: &[Free], values: &[f64]) -> Vec<f64> {
        let here = self.values_in_part(k, free, values);
        let same = |name: &str| free.iter().position(|own| own.variable.name == name).map(|at| values[at]);
        let own = |free: &Free| free.within.as_ref().and_then(|within| here.get(&within.name)).copied();
        apart.base.iter().map(|free| same(&free.variable.name).or_else(|| own(free)).unwrap_or(free.start)).collect()
    }
}
