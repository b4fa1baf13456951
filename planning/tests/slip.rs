//! Slip that a slope needs, and its band.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker::carriage::{Rig, steady_point};
use bekker::effects::Effects;
use bekker::known_soil::{KnownParameter, KnownSoil, Scale};
use bekker::rover::{Environment, Rover};
use bekker::soil::Soil;
use bekker::wheel::Wheel;
use bekker_planning::anisotropic::SlopeEnergy;
use bekker_planning::answer::PlanAnswer;
use bekker_planning::map::{ElevationMap, Interpolation};
use bekker_planning::plan::Request;
use bekker_planning::robot::fsrl;
use bekker_planning::site::Site;
use bekker_planning::slip::{SlipBand, SlopeSlip, SoilSpread};

const WEIGHT: f64 = 60.0;
const WHEELS: usize = 6;
/// Both tables are linear between their entries, half a degree and some percent of slip apart.
const BETWEEN_ENTRIES: f64 = 3e-3;
/// The same as a force over the load, where the pull rises by at most five loads a unit of slip.
const PULL: f64 = 1e-2;
/// Quantiles of 101 numbers scatter by a fifth of a standard deviation; this is three times that.
const SCATTER: f64 = 0.6;

fn sand() -> Soil {
    Rover::fsrl().soil
}

fn wheel() -> Wheel {
    Wheel { radius: 0.064, width: 0.06, ..Wheel::default() }
}

fn known(sd: f64) -> SoilSpread {
    let parameter = KnownParameter {
        name: "soil.friction_angle".to_owned(),
        value: sand().friction_angle,
        unit: "rad".to_owned(),
        scale: Scale::Linear,
        sd,
        at_bound: false,
        covariance: vec![sd * sd],
    };
    SoilSpread::Known(KnownSoil { name: "shear box".to_owned(), contact_widths: vec![], parameters: vec![parameter] })
}

fn band(spread: SoilSpread) -> SlipBand {
    SlipBand::new(&sand(), spread, &wheel(), WEIGHT, WHEELS)
}

#[test]
fn analytic_at_the_slip_of_a_slope_a_wheel_pulls_its_share_of_the_weight_uphill() {
    let rig = Rig { environment: Environment::default(), wheel: wheel(), soil: sand(), effects: Effects::default() };
    let table = SlopeSlip::new(&sand(), &wheel(), WEIGHT, WHEELS);
    for slope in [-0.3_f64, -0.1, 0.0, 0.05, 0.1, 0.2] {
        let (load, pull) = (WEIGHT * slope.cos() / 6.0, WEIGHT * slope.sin() / 6.0);
        let point = steady_point(&rig, load, table.at(slope), 1.0).unwrap();
        assert!((point.drawbar_pull - pull).abs() < PULL * load, "{slope}: {} {pull}", point.drawbar_pull);
    }
}

#[test]
fn agreement_the_slip_of_a_slope_is_that_of_the_table_by_energy() {
    let table = SlopeSlip::new(&sand(), &wheel(), WEIGHT, WHEELS);
    let energy = SlopeEnergy::new(&sand(), &wheel(), WEIGHT, WHEELS, 0.9).unwrap();
    let mut compared = 0;
    for k in -30..=30 {
        let slope = 0.01 * f64::from(k);
        let (ours, theirs) = (table.at(slope), energy.slip(slope));
        if ours.abs() < 0.6 {
            assert!((ours - theirs).abs() < BETWEEN_ENTRIES, "{slope}: {ours} {theirs}");
            compared += 1;
        }
    }
    assert!(compared > 40, "{compared}");
}

#[test]
fn property_where_the_slope_is_too_steep_no_slip_is_enough() {
    let band = band(SoilSpread::nearest(&sand()));
    let [up, down] = [1.2, -1.2].map(|slope| band.at(slope, [slope; 2]));
    assert_eq!((up.slip, up.low, up.none), (f64::INFINITY, f64::INFINITY, 1.0));
    assert_eq!((down.slip, down.low), (f64::NEG_INFINITY, f64::NEG_INFINITY));
    // Of the soils drawn a few hold a braking wheel by their cohesion.
    assert!(down.none > 0.8, "{}", down.none);
    // Between level and there the share of soils on which none is enough rises.
    let shares: Vec<f64> = (0..8).map(|k| 0.1 * f64::from(k)).map(|slope| band.at(slope, [slope; 2]).none).collect();
    assert!(shares[0] < 0.1 && shares.windows(2).all(|pair| pair[0] <= pair[1]), "{shares:?}");
}

#[test]
fn analytic_a_soil_that_is_known_exactly_has_no_band() {
    let band = band(known(1e-9));
    for slope in [-0.2, 0.0, 0.1] {
        let slip = band.at(slope, [slope; 2]);
        // Slip moves by less than fifty a radian of friction angle here.
        assert!((slip.high - slip.low).abs() < 1e-6 && (slip.slip - slip.low).abs() < 1e-6, "{slip:?}");
        assert_eq!(slip.none, 0.0);
    }
}

#[test]
fn analytic_the_band_of_one_uncertain_parameter_is_the_slip_at_its_quantiles() {
    let sd = 0.02;
    let band = band(known(sd));
    let at = |moved: f64, slope: f64| {
        let soil = Soil { friction_angle: sand().friction_angle + moved, ..sand() };
        SlopeSlip::new(&soil, &wheel(), WEIGHT, WHEELS).at(slope)
    };
    for slope in [0.0, 0.1] {
        let slip = band.at(slope, [slope; 2]);
        // A stronger soil needs less slip; 1.645 deviations have 5 % beyond them.
        for (end, deviations) in [(slip.low, 1.645), (slip.high, -1.645)] {
            let [near, far] = [deviations - SCATTER, deviations + SCATTER].map(|share| at(share * sd, slope));
            assert!(far < end && end < near, "{slope}: {far} {end} {near}");
        }
    }
}

#[test]
fn property_an_uncertain_slope_widens_the_band_to_its_worst_cases() {
    let band = band(known(0.02));
    let (sure, wide) = (band.at(0.05, [0.05; 2]), band.at(0.05, [-0.02, 0.1]));
    assert_eq!(sure.slip, wide.slip);
    assert_eq!((wide.low, wide.high), (band.at(-0.02, [-0.02; 2]).low, band.at(0.1, [0.1; 2]).high));
    assert!(wide.low < sure.low && wide.high > sure.high);
    assert!(SoilSpread::of_class("custard").unwrap_err().to_string().contains("dry sand"));
}

#[test]
fn property_the_band_is_the_same_on_any_number_of_threads() {
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let band = pool.install(|| band(SoilSpread::nearest(&sand())));
        [-0.1, 0.0, 0.1].map(|slope| band.at(slope, [slope; 2]))
    };
    assert_eq!(on(1), on(3));
}

#[test]
fn property_the_error_of_map_and_place_widens_the_band_along_a_path() {
    let map = ElevationMap::from_formula(41, 41, 0.1, [0.0, 0.0], |x, y| 0.05 * x + 0.04 * (3.0 * y).sin()).unwrap();
    let mut site = Site::new(map, fsrl(), Interpolation::Smooth);
    let request = Request { start: [1.0, 2.0], heading: None, goal: [3.0, 2.0], most_evaluations: 20_000 };
    let firm = PlanAnswer::new(&site, &site.plan(&request).unwrap());
    assert!(
        firm.slip_told.is_none() && firm.points.iter().all(|point| point.slip.is_none() && point.slip_none.is_none())
    );
    site.on_uncertain_soil(&sand(), known(0.01)).unwrap();
    let widest = |site: &Site| {
        let answer = PlanAnswer::new(site, &site.plan(&request).unwrap());
        let widths = answer.points.iter().map(|point| point.slip_high.unwrap() - point.slip_low.unwrap());
        (widths.fold(0.0, f64::max), answer.slip_told.unwrap())
    };
    let (exact, told) = widest(&site);
    assert!(told.contains("shear box") && !told.contains("dead reckoning"), "{told}");
    site.settings.range_error.systematic = 0.003;
    let (by_map, told) = widest(&site);
    assert!(by_map > exact && told.contains("dead reckoning"), "{by_map} {exact}");
    site.settings.range_error.systematic = 0.0;
    site.settings.localisation.position = 0.1;
    let (by_place, _) = widest(&site);
    assert!(by_place > exact, "{by_place} {exact}");
}
