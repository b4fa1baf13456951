//! The results of sections 2.3 and 2.4 beside the thesis's: they are computed, repeat, and hold what they state.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker_reproduction::soil::{drawbar_pull_of_models, stress_distributions};
use bekker_reproduction::soil_on_board::rover_identification;
use bekker_reproduction::soil_testbed::{bevameter, wheel_testbed};
use bekker_reproduction::{Finding, Spread};

fn show(finding: &Finding) {
    println!("{} ({})", finding.title, finding.section);
    for row in &finding.rows {
        let Spread { median, low, high, trials } = row.ours;
        println!("  {}: thesis {:?}, ours {median:.3} ({low:.3} .. {high:.3}; {trials})", row.quantity, row.thesis);
    }
    for plot in &finding.plots {
        for series in &plot.series {
            assert_eq!(series.x.len(), series.y.len());
            assert!(series.y.iter().any(|y| y.is_finite()), "{}: {}", plot.id, series.name);
        }
    }
}

fn row(finding: &Finding, words: &str) -> Spread {
    finding.rows.iter().find(|row| row.quantity.contains(words)).expect(words).ours
}

#[test]
fn agreement_linear_stresses_differ_as_an_independent_derivation_says() {
    /// The bands of `linear_stress_error`: assumptions that the thesis leaves open.
    const BANDS: [(&str, f64, f64); 3] =
        [("normal stress curve", 13.8, 0.5), ("shear stress curve", 11.3, 1.0), ("bias of phi", 1.85, 0.1)];
    let finding = stress_distributions().unwrap();
    show(&finding);
    for (words, stated, band) in BANDS {
        let ours = row(&finding, words).median;
        assert!((ours - stated).abs() < band, "{words}: {ours}");
    }
}

#[test]
fn property_pulls_of_the_models_agree_to_a_few_percent_of_the_load() {
    let finding = drawbar_pull_of_models().unwrap();
    show(&finding);
    assert!(row(&finding, "% of the load").median < 10.0);
    assert!(row(&finding, "within 10 % of the load").median > row(&finding, "within 10 % of itself").median);
}

#[test]
fn property_bevameter_finds_its_sand() {
    let finding = bevameter(40).unwrap();
    show(&finding);
    let within = |words: &str, truth: f64| {
        let Spread { low, high, .. } = row(&finding, words);
        assert!(low < truth && truth < high, "{words}: {low} .. {high}");
    };
    within("cohesion", 0.18);
    within("friction angle", 29.2);
    within("shear modulus", 10.0);
    within("exponent", 1.1);
    assert_eq!(finding, bevameter(40).unwrap());
}

#[test]
fn property_testbed_filter_removes_the_bias_of_the_closed_form() {
    let finding = wheel_testbed(24).unwrap();
    show(&finding);
    let filter = row(&finding, "friction angle by the filter");
    assert!(filter.low < 29.2 && 29.2 < filter.high, "{filter:?}");
    assert!(row(&finding, "c known and without noise").median > 29.2 + 0.5);
}

#[test]
fn property_rover_experiment_repeats_and_holds_its_intervals() {
    let finding = rover_identification(4).unwrap();
    show(&finding);
    let (phi, deviation) = (row(&finding, "friction angle by the filter"), row(&finding, "filter states for phi"));
    assert!((phi.median - 29.2).abs() < 2.0 * deviation.median, "{phi:?} {deviation:?}");
    let again = rover_identification(4).unwrap();
    assert_eq!(finding.rows, again.rows);
}
