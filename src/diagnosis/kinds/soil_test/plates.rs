//! What plates of several sizes tell of k_c and k_phi, in words.

use crate::diagnosis::calibrate::Calibration;
use crate::diagnosis::linear_algebra::dot;
use crate::diagnosis::noise::Whitening;
use crate::diagnosis::problem::Problem;
use crate::diagnosis::thresholds::{CONTRADICTED, TOLD_APART};
use crate::model::Model;
use bekker_modeldescription::Lookup;

/// Widths that differ by less than this share are one.
const SAME_WIDTH: f64 = 0.01;

/// Bekker's modulus under plates of one width, with its standard error, N/m^(n+2); n is that of the fit.
struct Modulus {
    width: f64,
    value: f64,
    deviation: f64,
}

/// Different widths of contact, m, rising.
pub(super) fn widths(models: &[Model]) -> Vec<f64> {
    let mut all: Vec<f64> = models.iter().map(width).filter(|width| *width > 0.0).collect();
    all.sort_by(f64::total_cmp);
    all.dedup_by(|b, a| *b - *a <= SAME_WIDTH * *a);
    all
}

fn width(model: &Model) -> f64 {
    model.tested_soil().rig.plate.contact_width()
}

/// Whether k_c and k_phi can be told apart, and whether any pair fits; nothing where both are known.
pub(super) fn remarks(problem: &Problem, whitening: &Whitening, fit: &Calibration, modelled: &[f64]) -> Vec<String> {
    let free = |name: &str| fit.parameters.iter().any(|parameter| parameter.variable.name == name);
    if !free("soil.k_phi") {
        return Vec::new();
    }
    let widths = widths(&problem.models);
    let [one] = widths.as_slice() else {
        let moduli = moduli(problem, whitening, fit, modelled, &widths);
        return line_over_widths(&moduli)
            .map(|line| line.words(&moduli, free("soil.k_c")))
            .into_iter()
            .flatten()
            .collect();
    };
    vec![format!(
        "all plates have the contact width b = {}: k_c and k_phi cannot be told apart, only their sum k = k_c/b + k_phi at this width is measured; k_phi stands for it, and plates of two or more clearly different sizes would part them",
        millimetres(*one)
    )]
}

/// The modulus of each width: what the model says there, times the factor that brings it nearest to the measurements.
fn moduli(
    problem: &Problem,
    whitening: &Whitening,
    fit: &Calibration,
    modelled: &[f64],
    widths: &[f64],
) -> Vec<Modulus> {
    let mut soil = problem.known.clone();
    for parameter in &fit.parameters {
        // A parameter of the fit is one of the model.
        let _ = soil.set(&parameter.variable.name, parameter.value);
    }
    let scatter = (fit.chi_square / fit.degrees_of_freedom.max(1) as f64).max(1.0);
    let measured = whitening.apply(&problem.layout.measured);
    let of = |width: &f64| {
        let mut own = vec![0.0; modelled.len()];
        for block in &problem.layout.blocks {
            let here = self::width(&problem.models[block.run]);
            if (here - width).abs() <= 2.0 * SAME_WIDTH * width {
                own[block.range.clone()].copy_from_slice(&modelled[block.range.clone()]);
            }
        }
        let white = whitening.apply(&own);
        let size = dot(&white, &white);
        let modulus = soil.rover.soil.modulus(*width);
        (size > 0.0).then(|| Modulus {
            width: *width,
            value: modulus * dot(&white, &measured) / size,
            deviation: modulus * (scatter / size).sqrt(),
        })
    };
    widths.iter().filter_map(of).collect()
}

/// k = k_phi + k_c/b over the widths, both of any sign, with standard errors.
struct Line {
    k_c: (f64, f64),
    k_phi: (f64, f64),
}

/// The weighted straight line over 1/b; `None` for less than two widths.
fn line_over_widths(moduli: &[Modulus]) -> Option<Line> {
    if moduli.len() < 2 {
        return None;
    }
    let sum = |of: &dyn Fn(&Modulus) -> f64| moduli.iter().map(|m| of(m) / (m.deviation * m.deviation)).sum::<f64>();
    let (one, x, xx) = (sum(&|_| 1.0), sum(&|m| 1.0 / m.width), sum(&|m| (1.0 / m.width).powi(2)));
    let (y, xy) = (sum(&|m| m.value), sum(&|m| m.value / m.width));
    let determinant = one * xx - x * x;
    (determinant > 0.0).then(|| Line {
        k_c: ((one * xy - x * y) / determinant, (one / determinant).sqrt()),
        k_phi: ((xx * y - x * xy) / determinant, (xx / determinant).sqrt()),
    })
}

impl Line {
    fn words(&self, moduli: &[Modulus], k_c_is_free: bool) -> Vec<String> {
        let (Line { k_c, k_phi }, list) = (self, listed(moduli));
        if k_c.0 < -CONTRADICTED * k_c.1 {
            let limit = if k_phi.0 > 0.0 {
                format!(", so that k < 0 for plates narrower than b = {}", millimetres(-k_c.0 / k_phi.0))
            } else {
                String::new()
            };
            return vec![format!(
                "k grows with the plate: {list}; the pair that follows it has k_c = {} +- {} kN/m^(n+1) < 0{limit}: no pair (k_c, k_phi) with k = k_c/b + k_phi >= 0 at every width fits these plates, and what k is under another contact is not known",
                kilo(k_c.0),
                kilo(k_c.1)
            )];
        }
        if k_phi.0 < -CONTRADICTED * k_phi.1 {
            return vec![format!(
                "k falls faster than 1/b: {list}; the pair that follows it has k_phi = {} +- {} kN/m^(n+2) < 0: no pair (k_c, k_phi) with k = k_c/b + k_phi >= 0 at every width fits these plates",
                kilo(k_phi.0),
                kilo(k_phi.1)
            )];
        }
        let middle = &moduli[moduli.len() / 2];
        if k_c_is_free && k_c.1 / middle.width > TOLD_APART * middle.value {
            let (first, last) = (millimetres(moduli[0].width), millimetres(moduli[moduli.len() - 1].width));
            return vec![format!(
                "k_c and k_phi cannot be told apart by contact widths of {first} to {last}: k_c = {} +- {} kN/m^(n+1) means that k_c/b is {:.0} +- {:.0} % of k; only their sum is known: {list}",
                kilo(k_c.0),
                kilo(k_c.1),
                100.0 * k_c.0 / middle.width / middle.value,
                100.0 * k_c.1 / middle.width / middle.value
            )];
        }
        Vec::new()
    }
}

/// Each modulus in words.
fn listed(moduli: &[Modulus]) -> String {
    let one = |m: &Modulus| {
        format!("k = {} +- {} kN/m^(n+2) at b = {}", kilo(m.value), kilo(m.deviation), millimetres(m.width))
    };
    moduli.iter().map(one).collect::<Vec<_>>().join(", ")
}

fn millimetres(length: f64) -> String {
    format!("{} mm", short(1e3 * length))
}

fn kilo(value: f64) -> String {
    short(1e-3 * value)
}

/// Three digits.
fn short(value: f64) -> String {
    format!("{value:.2e}").parse::<f64>().unwrap_or(value).to_string()
}
