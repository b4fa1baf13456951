//! A set of experiments one of which stands on a soil of its own.

use super::Problem;
use super::joint::{IN, within};
use crate::diagnosis::free::Free;
use crate::measurement::{Prior, Share};

impl Problem<'_> {
    /// The same experiments, of which part number `k` has a soil of its own, as far as it tells of its soil. `None` where no other part tells of the
    /// same.
    pub fn with_own_soil(&self, k: usize) -> Option<Self> {
        let mut apart = self.clone();
        apart.base.clear();
        apart.sensitivities = None;
        let mut own = Vec::new();
        // Without the scatter of its bed, which a soil of its own contains.
        for free in self.base.iter().filter(|free| free.factor_in(k).is_empty()) {
            let Some((here, others)) = self.shared_soil(k, free) else {
                apart.base.push(free.clone());
                continue;
            };
            let (of_own, of_others) = self.priors_apart(k, free, &others);
            own.push(Free {
                prior: of_own,
                shared: None,
                ..within(&here, &[k], &format!("{IN}{}", self.experiment.parts[k].name))
            });
            let variable = free.variable.clone();
            apart.base.push(Free { variable, prior: of_others, ..within(&here, &others, "") });
        }
        let any = !own.is_empty();
        apart.base.extend(own);
        any.then_some(apart)
    }

    /// What part number `k` calls a parameter of the soil that it tells of, and the other parts that tell of it too. A part that presses its
    /// soil with one width tells of k_phi, not of k_c beside it.
    fn shared_soil(&self, k: usize, free: &Free) -> Option<(Free, Vec<usize>)> {
        let here = free.in_part(k)?;
        let name = &here.variable.name;
        let tells =
            |j: usize| free.in_part(j).is_some() && self.parts[j].base.iter().any(|own| own.variable.name == *name);
        let several_widths = || {
            let part = &self.parts[k];
            part.strategy().contact_widths(&part.experiment, &part.models).windows(2).any(|pair| pair[0] != pair[1])
        };
        if Share::of(name) != Some(Share::Soil) || !tells(k) || (name == "soil.k_c" && !several_widths()) {
            return None;
        }
        let others: Vec<usize> = (0..self.parts.len()).filter(|j| *j != k && tells(*j)).collect();
        (!others.is_empty()).then_some((here, others))
    }

    /// What is known beforehand of a parameter of the soil in part number `k`, and in the others: what a folder states stays with its soil.
    fn priors_apart(&self, k: usize, free: &Free, others: &[usize]) -> (Option<Prior>, Option<Prior>) {
        let stated = |j: &usize| {
            let name = &free.in_part(*j)?.variable.name;
            self.experiment.parts[*j].experiment.priors.get(name).copied()
        };
        match (stated(&k), others.iter().find_map(stated)) {
            (None, None) => (free.prior, free.prior),
            (own, None) => (own, None),
            (own, Some(_)) => (own, free.prior),
        }
    }

    /// Values of the baseline of `apart`, which comes from [`Self::with_own_soil`] of part number `k`, that give the same soils as `values` of
    /// the parameters `free` of this problem; a k_c that stays shared is without the factor of this part's bed.
    pub fn as_own_soil(&self, apart: &Self, k: usize, free: &[Free], values: &[f64]) -> Vec<f64> {
        let here = self.values_in_part(k, free, values);
        let same = |name: &str| free.iter().position(|own| own.variable.name == name).map(|at| values[at]);
        let own = |free: &Free| free.within.as_ref().and_then(|within| here.get(&within.name)).copied();
        let value = |free: &Free| same(&free.variable.name).or_else(|| own(free)).unwrap_or(free.start);
        apart.base.iter().map(value).collect()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail by panicking")]
mod tests {
    use crate::diagnosis::given::Given;
    use crate::diagnosis::problem::Problem;
    use crate::measurement::Experiment;
    use std::path::Path;

    /// Rounding of a simulation whose parameters are products in another order.
    const ROUNDING: f64 = 1e-9;

    fn set(folders: &[&str]) -> Experiment {
        let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
        Experiment::joint(folders.iter().map(|name| Experiment::read(examples.join(name)).unwrap()).collect()).unwrap()
    }

    #[test]
    fn property_a_soil_of_its_own_is_what_a_part_and_others_tell_of() {
        let experiment = set(&["sand_plates", "sand_shear", "sand_wheel"]);
        let problem = Problem::new(Given::default(), &experiment, &[]).unwrap();
        for (k, part, own) in [
            (0, "sand_plates", &["k_c", "k_phi", "exponent"][..]),
            (1, "sand_shear", &["cohesion", "friction_angle", "shear_modulus"]),
            // One width does not tell k_c from k_phi; c1 and c2 show in the wheel alone.
            (2, "sand_wheel", &["k_phi", "exponent", "cohesion", "friction_angle", "shear_modulus"]),
        ] {
            let apart = problem.with_own_soil(k).unwrap();
            let names: Vec<&str> = apart.base.iter().map(|free| free.variable.name.as_str()).collect();
            let prefix = format!("soil in {part}.");
            let mut found: Vec<&str> = names.iter().filter_map(|name| name.strip_prefix(&prefix)).collect();
            let mut own = own.to_vec();
            found.sort_unstable();
            own.sort_unstable();
            assert_eq!(found, own, "{part}");
            let beds = |of: &str| names.iter().any(|name| name.starts_with(&format!("soil_scatter in {of}.")));
            assert!(!beds(part) && beds(if k == 2 { "sand_plates" } else { "sand_wheel" }), "{names:?}");
        }
    }

    #[test]
    fn property_parts_that_tell_of_different_parameters_share_no_soil() {
        let experiment = set(&["sand_plates", "sand_shear"]);
        let problem = Problem::new(Given::default(), &experiment, &[]).unwrap();
        assert!(problem.with_own_soil(0).is_none() && problem.with_own_soil(1).is_none());
    }

    #[test]
    fn agreement_the_same_soil_apart_gives_the_same_values() {
        let experiment = set(&["sand_shear", "sand_wheel"]);
        let problem = Problem::new(Given::default(), &experiment, &[]).unwrap();
        let apart = problem.with_own_soil(1).unwrap();
        let bed = |name: &str| if name == "soil_scatter in sand_wheel.cohesion" { 1.2 } else { 1.0 };
        let values: Vec<f64> = problem.base.iter().map(|free| free.start * bed(&free.variable.name)).collect();
        let own = problem.as_own_soil(&apart, 1, &problem.base, &values);
        let together = problem.predict(&problem.base, |predict| predict.values(&values)).unwrap().unwrap();
        let alone = apart.predict(&apart.base, |predict| predict.values(&own)).unwrap().unwrap();
        assert!(
            own.iter().zip(&apart.base).any(|(value, free)| {
                free.variable.name == "soil in sand_wheel.cohesion" && *value > 1.1 * free.start
            })
        );
        for (a, b) in together.iter().zip(&alone) {
            assert!((a - b).abs() <= ROUNDING * a.abs().max(1e-6), "{a} and {b}");
        }
    }
}
