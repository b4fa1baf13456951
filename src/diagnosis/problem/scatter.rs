//! Scatter of the soil from one experiment to the next: beds are prepared anew, and no two are alike.
//!
//! Each experiment has factors of its own on what varies with density, near one: a variance component of a stated size. A
//! few experiments do not determine that size.

use super::sharing::Sharing;
use crate::diagnosis::free::{Free, Within};
use crate::measurement::Prior;
use bekker_modeldescription::{Role, Unit, Variable};

/// Relative standard deviation between experiments where nothing else is said. Repeated plate tests in one laboratory scatter by 10 to 20 %
/// (Wong 2008, 2.4), means of a whole experiment by less: an assumption.
pub(crate) const USUAL: f64 = 0.05;
/// Largest that may be stated.
pub(crate) const LARGEST: f64 = 0.5;

/// Factors: their names, what each multiplies, and its deviation as a share of the stated one. The angle of friction of a sand prepared
/// anew varies by a degree or less where its stiffness varies by a tenth.
const FACTORS: [(&str, &[&str], f64); 4] = [
    ("stiffness", &["soil.k_c", "soil.k_phi"], 1.0),
    ("cohesion", &["soil.cohesion"], 1.0),
    ("friction_angle", &["soil.friction_angle"], 0.2),
    ("shear_modulus", &["soil.shear_modulus"], 1.0),
];

/// Bounds of a factor.
const RANGE: [f64; 2] = [0.5, 2.0];

/// Name of what the factors belong to.
pub(crate) const NAME: &str = "soil_scatter";

/// The factors on what is free of the soil in `base`, for every part that tells of it, where several on one soil do; `parts` has the names
/// of the parts and what each of them would free by itself.
pub(super) fn factors(base: &[Free], parts: &[(&str, &[Free])], sharing: &Sharing, deviation: f64) -> Vec<Free> {
    let tells = |k: usize, targets: &[&str]| {
        let has = |name: &str| targets.contains(&name);
        let own = parts[k].1.iter().any(|free| has(&free.variable.name));
        own && base.iter().any(|free| free.in_part(k).is_some_and(|own| has(&own.variable.name)))
    };
    let mut all = Vec::new();
    for (k, (part, _)) in parts.iter().enumerate().filter(|_| deviation > 0.0) {
        for (name, targets, share) in FACTORS {
            let several = sharing.with("soil.", k).into_iter().filter(|other| tells(*other, targets)).count() > 1;
            if several && tells(k, targets) {
                all.push(factor(k, part, name, targets, deviation * share));
            }
        }
    }
    all
}

/// The factor `name` on `targets` in part `k`.
fn factor(k: usize, part: &str, name: &str, targets: &[&str], deviation: f64) -> Free {
    let within = Within {
        parts: vec![k],
        name: format!("{NAME}.{name}"),
        factor_of: targets.iter().map(|target| (*target).to_owned()).collect(),
    };
    let variable = Variable {
        name: format!("{NAME} in {part}.{name}"),
        doc: "Factor on the soil of one experiment over that of all".into(),
        unit: Unit::ONE,
        default: 1.0,
        min: RANGE[0],
        max: RANGE[1],
        role: Role::Calibrated,
        source: "assumption".into(),
    };
    Free { variable, start: 1.0, prior: Some(Prior { mean: 1.0, deviation }), shared: None, within: Some(within) }
}
