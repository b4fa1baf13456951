//! Section 2.3 again: stress distributions and drawbar pull (figures 2.5 and 2.7).
//!
//! Section 2.4 is in [`soil_testbed`](super::soil_testbed) and [`soil_on_board`](super::soil_on_board).

use super::instruments::{CarriagePoint, NormalNoise};
use super::soil_testbed::testbed;
use super::stresses::Contact;
use super::{Finding, LinePlot, Row, Series, Spread};
use bekker::contact::rolling;
use bekker::diagnosis::SteadyError;
use bekker::estimation::EstimationError;
use bekker::estimation::soil::{Deviations, Reading, drawbar_pull};
use bekker::linear_stress::{LinearStress, OutsideClosedForms};
use bekker::parallel::map_in_order;
use bekker::simulation::StepError;
use bekker::soil::Soil;
use bekker::wheel::Wheel;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Draws over the ranges of 2.3.1.
const DRAWS: u64 = 15_000;

/// Readings as they are.
pub(super) const NO_NOISE: Deviations = Deviations { load: 0.0, torque: 0.0, sinkage: 0.0, slip: 0.0 };

/// Why a result of chapter 2 could not be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SoilFindingError {
    /// An estimator gave no answer.
    #[error(transparent)]
    Estimation(#[from] EstimationError),
    /// The test wheel found no steady point.
    #[error(transparent)]
    Steady(#[from] SteadyError),
    /// The rover's simulation failed.
    #[error(transparent)]
    Step(#[from] StepError),
}

impl From<OutsideClosedForms> for SoilFindingError {
    fn from(error: OutsideClosedForms) -> Self {
        Self::Estimation(error.into())
    }
}

/// The test wheel of 2.4.
#[must_use]
pub fn test_wheel() -> Wheel {
    Wheel { radius: 0.073, width: 0.06, ..Wheel::default() }
}

/// The bevameter's sand of 2.4: its strength; moduli and K of a dry sand.
#[must_use]
pub fn testbed_sand() -> Soil {
    Soil {
        cohesion: 180.0,
        friction_angle: 29.2_f64.to_radians(),
        k_c: 990.0,
        k_phi: 1_528_430.0,
        exponent: 1.1,
        shear_modulus: 0.01,
        ..Soil::default()
    }
}

pub(super) fn sand_assumption() -> String {
    "The sand has the bevameter's c = 0.18 kPa and phi = 29.2 deg; moduli, n = 1.1 (dry sand, Wong 2008) and K = 10 mm \
     are not in the thesis."
        .to_owned()
}

/// A row over trials; NaN with no trials where none gave a number.
pub(super) fn row(quantity: &str, thesis: Option<f64>, ours: impl IntoIterator<Item = f64>, reason: &str) -> Row {
    let none = Spread { trials: 0, ..Spread::exact(f64::NAN) };
    let ours = Spread::of(ours).unwrap_or(none);
    Row { quantity: quantity.to_owned(), thesis, ours, reason: reason.to_owned() }
}

pub(super) fn series(name: &str, points: impl IntoIterator<Item = [f64; 2]>) -> Series {
    let (x, y) = points.into_iter().map(|[x, y]| (x, y)).unzip();
    Series { name: name.to_owned(), x, y }
}

/// One draw over the ranges of 2.3.1; r and k are read as centimetres.
fn draw(seed: u64) -> Contact {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let radius = random.random_range(0.03..0.15);
    let soil = Soil {
        cohesion: 180.0,
        friction_angle: random.random_range(20.0_f64..32.0).to_radians(),
        exponent: random.random_range(0.2..1.5),
        shear_modulus: random.random_range(0.001..0.01),
        c1: 0.200,
        c2: 0.309,
        ..Soil::default()
    };
    let theta_1 = random.random_range(25.0_f64..55.0).to_radians();
    Contact { wheel: Wheel { radius, ..Wheel::default() }, soil, theta_1, slip: random.random_range(0.0..1.0) }
}

/// Mean distance of two curves along the rim, % of the first one's peak.
fn distance(contact: &Contact, full: impl Fn(f64) -> f64, linear: impl Fn(f64) -> f64) -> f64 {
    let points = 100;
    let (mut sum, mut peak) = (0.0, 0.0_f64);
    for i in 0..points {
        let theta = contact.theta_1 * (f64::from(i) + 0.5) / f64::from(points);
        sum += (full(theta) - linear(theta)).abs();
        peak = peak.max(full(theta));
    }
    100.0 * sum / f64::from(points) / peak
}

/// Errors of the linear stresses for one draw.
struct LinearError {
    sigma: f64,
    tau: f64,
    drawbar_of_load: f64,
    drawbar_of_itself: f64,
    friction_angle: f64,
}

fn linear_error(contact: &Contact) -> Result<LinearError, SoilFindingError> {
    let Contact { wheel, soil, slip, .. } = contact;
    let linear = LinearStress::of_soil(wheel, soil, contact.sinkage(), *slip)?;
    let full = rolling(wheel, soil, 0.0, contact.sinkage(), 1.0 - slip, 1.0 / wheel.radius);
    let reading = Reading { load: full.normal, torque: full.torque, sinkage: contact.sinkage(), slip: *slip };
    let pull = drawbar_pull(wheel, soil, &reading)?[1];
    let phi = linear.wheel().tan_phi(full.normal, full.torque, soil.cohesion).atan();
    Ok(LinearError {
        sigma: distance(contact, |theta| contact.sigma(theta), |theta| linear.sigma(theta)),
        tau: distance(contact, |theta| contact.tau(theta), |theta| linear.triangular_tau(theta)),
        drawbar_of_load: 100.0 * (pull - full.drawbar).abs() / full.normal,
        drawbar_of_itself: 100.0 * (pull - full.drawbar).abs() / full.drawbar.abs(),
        friction_angle: (phi - soil.friction_angle).to_degrees(),
    })
}

fn linear_errors() -> Result<Vec<LinearError>, SoilFindingError> {
    let seeds: Vec<u64> = (0..DRAWS).collect();
    map_in_order(&seeds, |&seed| linear_error(&draw(seed))).into_iter().collect()
}

fn mean(values: impl Iterator<Item = f64> + Clone) -> f64 {
    values.clone().sum::<f64>() / values.count() as f64
}

fn mean_row(quantity: &str, thesis: Option<f64>, values: &[f64], reason: &str) -> Row {
    let spread = Spread::of(values.iter().copied());
    let single = spread.map_or_else(String::new, |s| {
        format!(" Of single draws: median {:.1}, 10..90 % {:.1}..{:.1}.", s.median, s.low, s.high)
    });
    let ours = Spread { trials: values.len(), ..Spread::exact(mean(values.iter().copied())) };
    Row { quantity: quantity.to_owned(), thesis, ours, reason: format!("{reason}{single}") }
}

/// Figure 2.5 and the 15,000 simulations of 2.3.1: how triangular the stresses are.
///
/// # Errors
/// [`SoilFindingError`] where a closed form does not apply.
pub fn stress_distributions() -> Result<Finding, SoilFindingError> {
    let errors = linear_errors()?;
    let of = |f: fn(&LinearError) -> f64| errors.iter().map(f).collect::<Vec<_>>();
    let ranges = "The thesis gives neither c, moduli, theta_m nor units; ours: c 0.18 kPa, theta_m = (0.200 + 0.309 i) \
                  theta_1 (which its h_1 and h_3 contain), r and k in cm, theta_1 in deg.";
    let exponents = [0.5, 0.8, 1.0, 1.2, 1.5];
    let lines = exponents.into_iter().flat_map(|n| {
        let contact = carrying(n);
        let at = move |f: fn(&Contact, f64) -> f64| {
            (0..=80).map(move |i| {
                let theta = contact.theta_1 * f64::from(i) / 80.0;
                [theta.to_degrees(), f(&contact, theta) / 1e3]
            })
        };
        [series(&format!("sigma, n = {n}"), at(Contact::sigma)), series(&format!("tau, n = {n}"), at(Contact::tau))]
    });
    Ok(Finding {
        id: "stress_distributions".to_owned(),
        section: "2.3.1, figure 2.5".to_owned(),
        title: "Stresses along the rim for several exponents, and how far triangles are from them".to_owned(),
        rows: vec![
            mean_row(
                "average difference of the normal stress curve, % of its peak",
                Some(9.6),
                &of(|e| e.sigma),
                ranges,
            ),
            mean_row("average difference of the shear stress curve, % of its peak", Some(10.4), &of(|e| e.tau), ranges),
            mean_row(
                "bias of phi by (2.24) with c known and no noise, deg",
                None,
                &of(|e| e.friction_angle),
                "The price of linear stresses; not in the thesis.",
            ),
        ],
        plots: vec![LinePlot {
            id: "figure_2_5".to_owned(),
            title: "Normal and shear stress around the rim".to_owned(),
            x_label: "theta, deg".to_owned(),
            y_label: "stress, kPa".to_owned(),
            series: lines.collect(),
        }],
        assumptions: vec![
            "Figure: the test wheel under 30 N with theta_1 = 35 deg and i = 0.2 at each n; the modulus is what then \
             carries the load."
                .to_owned(),
            sand_assumption(),
        ],
    })
}

/// The test wheel with exponent `n` and the modulus that carries 30 N at theta_1 = 35 degrees and i = 0.2.
fn carrying(n: f64) -> Contact {
    let (load, slip) = (30.0, 0.2);
    let soil = Soil { exponent: n, k_c: 0.0, ..testbed_sand() };
    let mut contact = Contact { wheel: test_wheel(), soil, theta_1: 35.0_f64.to_radians(), slip };
    let normal = |k_phi: f64| {
        let soil = Soil { k_phi, ..contact.soil };
        rolling(&contact.wheel, &soil, 0.0, contact.sinkage(), 1.0 - slip, 1.0 / contact.wheel.radius).normal
    };
    // The load is affine in the modulus.
    let (none, some) = (normal(0.0), normal(1e6));
    contact.soil.k_phi = 1e6 * (load - none) / (some - none);
    contact
}

/// Figure 2.7: drawbar pull by the full integrals, by the linear stresses and by the simplified groups.
///
/// # Errors
/// [`SoilFindingError`] where a closed form or a steady point does not exist.
pub fn drawbar_pull_of_models() -> Result<Finding, SoilFindingError> {
    let soil = testbed_sand();
    let carriage = testbed(soil, NO_NOISE);
    let mut lines: [Vec<[f64; 2]>; 3] = Default::default();
    for i in 0..=60 {
        let slip = 0.01 + 0.88 * f64::from(i) / 60.0;
        let CarriagePoint { truth, drawbar_pull: full, .. } = carriage.read(30.0, slip, &mut NormalNoise::new(0))?;
        let [simplified, modified] = drawbar_pull(&test_wheel(), &soil, &truth)?;
        for (line, pull) in lines.iter_mut().zip([full, simplified, modified]) {
            line.push([100.0 * slip, pull]);
        }
    }
    let errors = linear_errors()?;
    let within = |limit: f64, of: fn(&LinearError) -> f64| {
        100.0 * errors.iter().filter(|e| of(e) < limit).count() as f64 / errors.len() as f64
    };
    let of = |f: fn(&LinearError) -> f64| errors.iter().map(f).collect::<Vec<_>>();
    let share = |quantity: &str, share: f64, reason: &str| Row {
        quantity: quantity.to_owned(),
        thesis: None,
        ours: Spread { trials: errors.len(), ..Spread::exact(share) },
        reason: reason.to_owned(),
    };
    let names = ["Wong and Reece", "simplified (B.2), (B.3)", "modified simplified (2.22)"];
    Ok(Finding {
        id: "drawbar_pull_of_models".to_owned(),
        section: "2.3.1, figure 2.7".to_owned(),
        title: "Drawbar pull by the full integrals and by the closed forms, at the same load and torque inputs"
            .to_owned(),
        rows: vec![
            mean_row(
                "difference of the drawbar pull, % of the load",
                None,
                &of(|e| e.drawbar_of_load),
                "Where the pull crosses zero a difference in % of itself means nothing, so ours is of the load.",
            ),
            share(
                "share of draws with the pull within 10 % of the load, %",
                within(10.0, |e| e.drawbar_of_load),
                "The thesis: \"agreement within 10 % over a wide range\", without saying of what.",
            ),
            share(
                "share of draws with the pull within 10 % of itself, %",
                within(10.0, |e| e.drawbar_of_itself),
                "The same with 10 % of the pull.",
            ),
        ],
        plots: vec![LinePlot {
            id: "figure_2_7".to_owned(),
            title: "Drawbar pull of a driven rigid wheel under 30 N".to_owned(),
            x_label: "slip, %".to_owned(),
            y_label: "drawbar pull, N".to_owned(),
            series: names.into_iter().zip(lines).map(|(name, line)| series(name, line)).collect(),
        }],
        assumptions: vec![
            "The closed forms take their peak stress from the load and sinkage of the full integrals at each slip; the \
             thesis's load, torque and abscissa are not given."
                .to_owned(),
            sand_assumption(),
        ],
    })
}
