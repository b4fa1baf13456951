//! Sections 2.3 and 2.4 again: stress distributions, drawbar pull, bevameter, wheel testbed.
//!
//! The rover's own experiment is in [`soil_on_board`](super::soil_on_board).

use super::instruments::{Bevameter, Carriage, CarriagePoint, Noise};
use super::stresses::Contact;
use super::{Finding, Plot, Row, Series, Spread};
use crate::contact::rolling;
use crate::diagnosis::{Rig, SteadyError};
use crate::estimation::EstimationError;
use crate::estimation::soil::{
    ClosedForm, Deviations, Reading, SoilIdentification, Strength, StrengthFilter, drawbar_pull, pressure_sinkage,
    reduce_annulus, strength_line,
};
use crate::linear_stress::{LinearStress, OutsideClosedForms};
use crate::parallel::map_in_order;
use crate::rover::Rover;
use crate::simulation::StepError;
use crate::soil::Soil;
use crate::wheel::Wheel;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Draws over the ranges of 2.3.1.
const DRAWS: u64 = 15_000;

/// Readings noise of the testbed: no figure is in the thesis.
const CARRIAGE_NOISE: Deviations = Deviations { load: 0.2, torque: 0.01, sinkage: 0.0005, slip: 0.01 };

/// Loads (N) and slips of a testbed experiment: not in the thesis.
const LOADS: [f64; 4] = [10.0, 20.0, 35.0, 50.0];
const SLIPS: [f64; 5] = [0.1, 0.2, 0.35, 0.5, 0.7];

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
    /// No trial gave a finite number.
    #[error("no trial gave a value of {0}")]
    Nothing(String),
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

fn sand_assumption() -> String {
    "The sand has the bevameter's c = 0.18 kPa and phi = 29.2 deg; moduli, n = 1.1 (dry sand, Wong 2008) and K = 10 mm \
     are not in the thesis."
        .to_owned()
}

pub(super) fn row(
    quantity: &str,
    thesis: Option<f64>,
    ours: impl IntoIterator<Item = f64>,
    reason: &str,
) -> Result<Row, SoilFindingError> {
    let ours = Spread::of(ours).ok_or_else(|| SoilFindingError::Nothing(quantity.to_owned()))?;
    Ok(Row { quantity: quantity.to_owned(), thesis, ours, reason: reason.to_owned() })
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
        plots: vec![Plot {
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
    let carriage = testbed(soil, CARRIAGE_NOISE);
    let mut lines: [Vec<[f64; 2]>; 3] = Default::default();
    for i in 0..=60 {
        let slip = 0.01 + 0.88 * f64::from(i) / 60.0;
        let CarriagePoint { truth, drawbar_pull: full, .. } = carriage.read(30.0, slip, &mut Noise::new(0))?;
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
        plots: vec![Plot {
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

fn testbed(soil: Soil, noise: Deviations) -> Carriage {
    let rover = Rover { wheel: test_wheel(), soil, ..Rover::two_wheeled() };
    Carriage { rig: Rig::of(&rover), noise, wheel_speed: 1.0 }
}

/// What one virtual bevameter session gives: c (kPa), phi (deg), K (mm), k of a plate 6 cm wide (MN/m^(n+2)), n.
fn bevameter_session(seed: u64) -> Result<[f64; 5], SoilFindingError> {
    let bevameter = Bevameter { soil: testbed_sand(), relative_noise: 0.03, noise: 50.0 };
    let mut noise = Noise::new(seed);
    let plates = [0.04, 0.08].map(|width| bevameter.press(width, 0.05, 50, &mut noise));
    let annuli = PRESSURES.map(|pressure| reduce_annulus(&bevameter.shear(pressure, 0.06, 60, &mut noise)));
    let annuli = annuli.into_iter().collect::<Result<Vec<_>, _>>()?;
    let (curve, line) = (pressure_sinkage(&plates)?, strength_line(&annuli)?);
    let modulus = curve.k_c / 0.06 + curve.k_phi;
    Ok([line.cohesion / 1e3, line.friction_angle.to_degrees(), 1e3 * line.shear_modulus, modulus / 1e6, curve.exponent])
}

/// Pressures of the annulus, Pa.
const PRESSURES: [f64; 5] = [2e3, 4e3, 7e3, 10e3, 14e3];

/// Figure 2.12: the bevameter, over `trials` sessions with different noise.
///
/// # Errors
/// [`SoilFindingError`] where a session determines nothing.
pub fn bevameter(trials: u64) -> Result<Finding, SoilFindingError> {
    let seeds: Vec<u64> = (0..trials).collect();
    let sessions = map_in_order(&seeds, |&seed| bevameter_session(seed)).into_iter().collect::<Result<Vec<_>, _>>()?;
    let of = |k: usize| sessions.iter().map(move |session| session[k]);
    let truth = "The thesis's result is the truth of the virtual sand; ours scatters with the assumed noise of 3 % and \
                 50 Pa of each stress.";
    let session = Bevameter { soil: testbed_sand(), relative_noise: 0.03, noise: 50.0 };
    let mut noise = Noise::new(0);
    let strengths = PRESSURES
        .map(|pressure| reduce_annulus(&session.shear(pressure, 0.06, 60, &mut noise)))
        .into_iter()
        .collect::<Result<Vec<_>, _>>()?;
    let line = strength_line(&strengths)?;
    let along = |p: f64| [p / 1e3, (line.cohesion + p * line.friction_angle.tan()) / 1e3];
    Ok(Finding {
        id: "bevameter".to_owned(),
        section: "2.4, figure 2.12".to_owned(),
        title: "Virtual bevameter: shear annulus and plates, reduced the standard way".to_owned(),
        rows: vec![
            row("cohesion, kPa", Some(0.18), of(0), truth)?,
            row("friction angle, deg", Some(29.2), of(1), truth)?,
            row("shear modulus K, mm", None, of(2), "Truth 10 mm.")?,
            row("modulus k_c/b + k_phi for b = 6 cm, MN/m^(n+2)", None, of(3), "Truth 1.545; tied to n.")?,
            row("exponent n", None, of(4), "Truth 1.1.")?,
        ],
        plots: vec![Plot {
            id: "figure_2_12".to_owned(),
            title: "Shear strength over pressure".to_owned(),
            x_label: "normal pressure, kPa".to_owned(),
            y_label: "shear strength, kPa".to_owned(),
            series: vec![
                series("tests", strengths.iter().map(|test| [test.pressure / 1e3, test.strength / 1e3])),
                series("line", [0.0, 15e3].map(along)),
            ],
        }],
        assumptions: vec![
            "Five pressures of 2..14 kPa over 6 cm of shear, plates of 4 and 8 cm pressed 5 cm deep.".to_owned(),
            sand_assumption(),
        ],
    })
}

/// c (kPa) and phi (deg) of one testbed experiment by each method.
struct Identified {
    /// (2.25), (2.26); NaN where no pair has a root.
    pairs: [f64; 2],
    /// All equations of (2.24) by least squares.
    least_squares: [f64; 2],
    /// (2.26) with the true cohesion.
    cohesion_known: f64,
    /// The filter on the full integrals, K uncertain by half.
    filter: [f64; 2],
    /// Its standard deviations.
    deviations: [f64; 2],
    /// The closed form where K is taken 1.5 times too large.
    wrong_modulus: [f64; 2],
    /// Root-mean-square errors of the predicted drawbar pull, N: modified simplified with the closed form's strength,
    /// full integrals with the filter's.
    drawbar: [f64; 2],
}

fn believed() -> (Soil, SoilIdentification) {
    // The prior knows dry sand, not this one.
    let soil = Soil { cohesion: 500.0, friction_angle: 32.0_f64.to_radians(), shear_modulus: 0.014, ..testbed_sand() };
    (soil, SoilIdentification { shear_modulus_gain: 1.0, cohesion_deviation: 500.0, ..SoilIdentification::default() })
}

fn in_display_units(cohesion: f64, friction_angle: f64) -> [f64; 2] {
    [cohesion / 1e3, friction_angle.to_degrees()]
}

fn identify(seed: u64, noise: Deviations) -> Result<Identified, SoilFindingError> {
    let (wheel, sand) = (test_wheel(), testbed_sand());
    let (carriage, mut stream) = (testbed(sand, noise), Noise::new(seed));
    let grid = LOADS.into_iter().flat_map(|load| SLIPS.map(|slip| (load, slip)));
    let points = grid.map(|(load, slip)| carriage.read(load, slip, &mut stream)).collect::<Result<Vec<_>, _>>()?;
    let readings: Vec<Reading> = points.iter().map(|point| point.reading).collect();
    let closed = ClosedForm::new(&wheel, sand.shear_modulus, &readings)?;
    let pairs = closed.by_pairs().map(|found| found.strength);
    let squares = closed.least_squares()?;
    let wrong = ClosedForm::new(&wheel, 1.5 * sand.shear_modulus, &readings)?.least_squares()?;
    let (prior, parameters) = believed();
    let mut filter = StrengthFilter::new(&wheel, &prior, parameters)?;
    for reading in &readings {
        filter.update(reading, &CARRIAGE_NOISE)?;
    }
    let strength = filter.strength();
    let covariance = filter.covariance();
    let by_closed = Soil { cohesion: squares.cohesion, friction_angle: squares.friction_angle, ..sand };
    Ok(Identified {
        pairs: pairs.map_or([f64::NAN; 2], |found| in_display_units(found.cohesion, found.friction_angle)),
        least_squares: in_display_units(squares.cohesion, squares.friction_angle),
        cohesion_known: closed.friction_angle(sand.cohesion).to_degrees(),
        filter: in_display_units(strength.cohesion, strength.friction_angle),
        deviations: in_display_units(covariance[0][0].sqrt(), covariance[1][1].sqrt()),
        wrong_modulus: in_display_units(wrong.cohesion, wrong.friction_angle),
        drawbar: drawbar_errors(&points, &by_closed, &strength)?,
    })
}

/// Drawbar pull (N) that the full integrals predict for a reading: of the load's modulus, as the torque's equation.
fn full_drawbar_pull(wheel: &Wheel, soil: &Soil, reading: &Reading) -> f64 {
    let at = |k_phi: f64| {
        let soil = Soil { k_c: 0.0, k_phi, ..*soil };
        rolling(wheel, &soil, 0.0, reading.sinkage, 1.0 - reading.slip, 1.0 / wheel.radius)
    };
    let (none, some) = (at(0.0), at(1e6));
    none.drawbar + (reading.load - none.normal) / (some.normal - none.normal) * (some.drawbar - none.drawbar)
}

fn drawbar_errors(
    points: &[CarriagePoint],
    by_closed: &Soil,
    strength: &Strength,
) -> Result<[f64; 2], SoilFindingError> {
    let wheel = test_wheel();
    let mut sums = [0.0; 2];
    for point in points {
        let modified = drawbar_pull(&wheel, by_closed, &point.reading)?[1];
        let full = full_drawbar_pull(&wheel, &strength.on(by_closed), &point.reading);
        sums[0] += (modified - point.drawbar_pull).powi(2);
        sums[1] += (full - point.drawbar_pull).powi(2);
    }
    Ok(sums.map(|sum| (sum / points.len() as f64).sqrt()))
}

/// The wheel testbed of 2.4 and figure 2.13, over `trials` experiments with different noise.
///
/// # Errors
/// [`SoilFindingError`] where an experiment determines nothing.
pub fn wheel_testbed(trials: u64) -> Result<Finding, SoilFindingError> {
    let seeds: Vec<u64> = (0..trials).collect();
    let all =
        map_in_order(&seeds, |&seed| identify(seed, CARRIAGE_NOISE)).into_iter().collect::<Result<Vec<_>, _>>()?;
    let of = |f: fn(&Identified) -> f64| all.iter().map(f);
    let exact = identify(0, Deviations { load: 0.0, torque: 0.0, sinkage: 0.0, slip: 0.0 })?;
    let known = "One number a method at 20 points: four loads at five slips.";
    let noiseless = |quantity: &str, value: f64, reason: &str| row(quantity, None, [value], reason);
    Ok(Finding {
        id: "wheel_testbed".to_owned(),
        section: "2.4, figure 2.13".to_owned(),
        title: "On-line identification on the wheel testbed".to_owned(),
        rows: vec![
            row("cohesion by (2.25), kPa", Some(0.08), of(|e| e.pairs[0]), "The thesis: 0.06 to 0.10 kPa over its experiments, against 0.18 by the bevameter. The roots of single pairs scatter with the noise, and negative ones are dropped, which lifts the mean.")?,
            row("friction angle by (2.26), deg", Some(26.0), of(|e| e.pairs[1]), "The thesis: 23 to 29 deg over its experiments, against 29.2 by the bevameter. A cohesion too high pulls phi down, the linear stresses push it up.")?,
            row("cohesion by least squares on (2.24), kPa", None, of(|e| e.least_squares[0]), known)?,
            row("friction angle by least squares on (2.24), deg", None, of(|e| e.least_squares[1]), known)?,
            row("friction angle by (2.26) with c known, deg", None, of(|e| e.cohesion_known), "Truth 29.2.")?,
            row("cohesion by the filter on the full integrals, kPa", None, of(|e| e.filter[0]), "Truth 0.18; K is estimated too, from a prior of 14 mm within half (truth 10 mm).")?,
            row("friction angle by the filter on the full integrals, deg", None, of(|e| e.filter[1]), "Truth 29.2.")?,
            row("standard deviation that the filter states for c, kPa", None, of(|e| e.deviations[0]), "To be compared with the scatter above.")?,
            row("standard deviation that the filter states for phi, deg", None, of(|e| e.deviations[1]), "To be compared with the scatter above.")?,
            noiseless("cohesion by least squares on (2.24) without noise, kPa", exact.least_squares[0], "What the linear stresses alone do; truth 0.18.")?,
            noiseless("friction angle by least squares on (2.24) without noise, deg", exact.least_squares[1], "Truth 29.2.")?,
            noiseless("friction angle by (2.26) with c known and without noise, deg", exact.cohesion_known, "Truth 29.2.")?,
            row("friction angle by least squares with K 1.5 times too large, deg", None, of(|e| e.wrong_modulus[1]), "The thesis takes K for known and does not state it.")?,
            row("cohesion by least squares with K 1.5 times too large, kPa", None, of(|e| e.wrong_modulus[0]), "The same.")?,
            row("RMS error of the drawbar pull by (2.22) with the identified soil, N", None, of(|e| e.drawbar[0]), "The thesis shows one curve and says \"closely\".")?,
            row("RMS error of the drawbar pull by the full integrals with the filter's soil, N", None, of(|e| e.drawbar[1]), "The same readings.")?,
        ],
        plots: vec![figure_2_13()?],
        assumptions: vec![
            "Loads 10, 20, 35, 50 N and slips 0.1 to 0.7; noise 0.2 N, 10 mN m, 0.5 mm and 0.01 of slip: none is in the \
             thesis."
                .to_owned(),
            sand_assumption(),
        ],
    })
}

/// Drawbar pull over slip as measured and as predicted with the strength of one experiment.
fn figure_2_13() -> Result<Plot, SoilFindingError> {
    let (wheel, sand) = (test_wheel(), testbed_sand());
    let found = identify(1, CARRIAGE_NOISE)?;
    let with = |[c, phi]: [f64; 2]| Soil { cohesion: 1e3 * c, friction_angle: phi.to_radians(), ..sand };
    let (carriage, mut noise) = (testbed(sand, CARRIAGE_NOISE), Noise::new(99));
    let mut lines: [Vec<[f64; 2]>; 3] = Default::default();
    for i in 0..40 {
        let slip = 0.05 + 0.75 * f64::from(i) / 39.0;
        let point = carriage.read(30.0, slip, &mut noise)?;
        let modified = drawbar_pull(&wheel, &with(found.least_squares), &point.reading)?[1];
        let full = full_drawbar_pull(&wheel, &with(found.filter), &point.reading);
        for (line, pull) in lines.iter_mut().zip([point.drawbar_pull + noise.draw(0.2), modified, full]) {
            line.push([100.0 * slip, pull]);
        }
    }
    let names = ["measured", "modified simplified (2.22), closed form's soil", "full integrals, filter's soil"];
    Ok(Plot {
        id: "figure_2_13".to_owned(),
        title: "Drawbar pull measured and predicted, 30 N".to_owned(),
        x_label: "slip, %".to_owned(),
        y_label: "drawbar pull, N".to_owned(),
        series: names.into_iter().zip(lines).map(|(name, line)| series(name, line)).collect(),
    })
}
