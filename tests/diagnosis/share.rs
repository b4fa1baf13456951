//! What several experiments share: the soil, the vehicle or the drive, as their folders or the user say.

use crate::noisy_wheel::{model, wheel_on};
use bekker::diagnosis::{CompareError, CompareOptions, Comparison, Given, compare};
use bekker::measurement::{Experiment, Share};
use bekker::model::Model;
use bekker::modeldescription::Lookup;

/// Standard errors within which an estimate must lie: 1 in 16,000 beyond.
const WITHIN: f64 = 4.0;
/// The second soil is half as stiff again: far more than beds differ.
const STIFFER: f64 = 1.5;
/// What is known of the radius, m, and how well.
const RADIUS: &str = "[priors]\n\"wheel.radius\" = { mean = 0.101, sd = 0.002 }\n";

/// Three wheels, of which the last one runs on another soil.
fn three(folder: &str, settings: [&str; 3]) -> Experiment {
    let wheels = [("a", 0.10, 1.0), ("b", 0.16, 1.0), ("c", 0.12, STIFFER)];
    let of = |((name, width, stiffer), settings): (_, &str)| wheel_on(folder, name, width, 0.0, settings, stiffer);
    Experiment::joint(wheels.into_iter().zip(settings).map(of).collect()).unwrap()
}

fn calibrated(given: Given, experiment: &Experiment) -> Result<Comparison, CompareError> {
    compare(given, experiment, &CompareOptions { calibrate: true, ..CompareOptions::default() })
}

/// Names of the free parameters that hold `part`.
fn names(comparison: &Comparison, part: &str) -> Vec<String> {
    let (calibration, _) = comparison.calibrated.as_ref().unwrap();
    let all = calibration.parameters.iter().map(|own| own.variable.name.clone());
    all.filter(|name| name.contains(part)).collect()
}

fn refusal(given: Given, experiment: &Experiment) -> String {
    calibrated(given, experiment).unwrap_err().to_string()
}

#[test]
fn agreement_soils_that_folders_name_are_found_each_by_itself() {
    let named = |soil: &str| format!("[shared]\nsoil = \"{soil}\"\n");
    let [pit, box_of_sand] = [named("pit"), named("box")];
    let joint = three("named", [&pit, &pit, &box_of_sand]);
    let comparison = calibrated(Given::default(), &joint).unwrap();
    assert!(comparison.sources.iter().any(|line| line == "a soil each in a & b; c"), "{:?}", comparison.sources);
    let truth = model().get("soil.k_phi").unwrap();
    let (calibration, _) = comparison.calibrated.as_ref().unwrap();
    // k_c stays in the second soil, on which one width runs; k = k_c/b + k_phi is what it tells.
    for (name, stiffer) in [("soil in a & b.k_phi", 1.0), ("soil in c.k_phi", STIFFER)] {
        let found = calibration.parameters.iter().find(|own| own.variable.name == name).unwrap();
        let error = (found.value - stiffer * truth) / found.deviation.unwrap();
        assert!(error.abs() < WITHIN, "{name}: {found:?}");
    }
    assert_eq!(names(&comparison, "k_c"), ["soil in a & b.k_c"]);
    // Beds of one soil differ; c has a soil of its own and nothing to differ from.
    assert!(!names(&comparison, "soil_scatter in a.stiffness").is_empty());
    assert!(names(&comparison, "soil_scatter in c").is_empty());
    // Each part has a model with its own soil.
    let stiffness = |k: usize| comparison.part_models[k].1.clone().get("soil.k_phi").unwrap();
    assert!(stiffness(2) > 1.2 * stiffness(0), "{} and {}", stiffness(2), stiffness(0));
}

#[test]
fn property_what_the_user_says_goes_before_the_folders() {
    let joint = three("by_hand", ["[shared]\nsoil = \"pit\"\n", "", ""]);
    let words = refusal(Given::default(), &joint);
    assert!(words.contains("names the soil of a and not that of b, c"), "{words}");
    let apart = calibrated(Given::default().with_share(&[]), &joint).unwrap();
    assert_eq!(names(&apart, "k_phi"), ["soil in a.k_phi", "soil in b.k_phi", "soil in c.k_phi"]);
    assert!(names(&apart, "soil_scatter").is_empty());
    assert!(apart.sources.iter().any(|line| line == "a soil of its own in each experiment"));
    let one = calibrated(Given::default().with_share(&[Share::Soil]), &joint).unwrap();
    assert_eq!(names(&one, "k_phi"), ["soil.k_phi"]);
}

#[test]
fn property_a_shared_vehicle_is_measured_once() {
    let joint = three("vehicle", [RADIUS, "", ""]);
    let own = calibrated(Given::default(), &joint).unwrap();
    assert_eq!(names(&own, "radius"), ["wheel in a.radius"]);
    let vehicle = Given::default().with_share(&[Share::Vehicle, Share::Soil]);
    let words = refusal(vehicle.clone(), &joint);
    assert!(words.contains("wheel.width is 0.1 in a and 0.16 in b, which share one vehicle"), "{words}");
    // Set by hand, the widths do not matter.
    let vehicle = vehicle.with_value("wheel.width", 0.12);
    let shared = calibrated(vehicle.clone(), &joint).unwrap();
    assert_eq!(names(&shared, "radius"), ["wheel.radius"]);
    assert!(shared.sources.iter().any(|line| line == "one vehicle in all experiments"), "{:?}", shared.sources);
    let radius = |k: usize| shared.part_models[k].1.clone().get("wheel.radius").unwrap();
    assert!(radius(0) == radius(1) && radius(1) == radius(2));
    // A vehicle has its drive, so that its name alone changes nothing.
    let drive = calibrated(vehicle.with_share(&[Share::Vehicle, Share::Soil, Share::Drive]), &joint).unwrap();
    assert_eq!(names(&drive, ""), names(&shared, ""));
}

#[test]
fn property_a_radius_that_one_folder_states_holds_for_the_vehicle() {
    let joint = three("stated", ["\"wheel.radius\" = 0.11\n", "", ""]);
    let vehicle = Given::default().with_share(&[Share::Vehicle, Share::Soil]).with_value("wheel.width", 0.12);
    let radii = |given| {
        let comparison = compare(given, &joint, &CompareOptions::default()).unwrap();
        let radius = |(_, model): &(String, Model)| model.clone().get("wheel.radius").unwrap();
        comparison.part_models.iter().map(radius).collect::<Vec<f64>>()
    };
    let usual = model().get("wheel.radius").unwrap();
    assert_eq!(radii(vehicle), [0.11, 0.11, 0.11]);
    assert_eq!(radii(Given::default()), [0.11, usual, usual]);
}

#[test]
fn property_a_known_soil_is_refused_for_several() {
    let joint = three("known", ["", "", ""]);
    let soil = calibrated(Given::default(), &joint).unwrap().soil.unwrap();
    let words = refusal(Given::default().with_share(&[]).with_soil(soil, "soil.toml"), &joint);
    assert!(words.contains("soil.toml: the experiments stand on 3 soils"), "{words}");
}
