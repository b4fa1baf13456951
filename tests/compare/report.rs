//! The HTML page of a comparison.

#![cfg(feature = "report")]

use crate::saved_page::{data, figures, numbers, text};
use bekker::diagnosis::{CompareOptions, compare};
use bekker::measurement::Experiment;
use bekker::model::Model;
use bekker::report::comparison_page;
use std::path::Path;

#[test]
fn property_the_page_of_the_shipped_experiment_is_complete_and_alone() {
    let experiment = Experiment::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/sand_wheel")).unwrap();
    let model = Model::preset("two_wheeled").unwrap();
    let comparison =
        compare(&model, &experiment, &CompareOptions { calibrate: true, ..CompareOptions::default() }).unwrap();
    let page = comparison_page(&comparison);
    std::fs::write(Path::new(env!("CARGO_TARGET_TMPDIR")).join("sand_wheel.html"), &page).unwrap();

    // Nothing is loaded from elsewhere.
    for tag in ["<script src", "<link rel=\"style", "<img", "@import", "<iframe"] {
        assert!(!page.contains(tag), "{tag}");
    }
    // Residuals of three signals against three inputs; both models over each of these for the script.
    assert_eq!(figures(&page).len(), 3 * 3);
    let saved = data(&page);
    assert_eq!(saved["models"].as_array().unwrap().len(), 2);
    for (axis, curves) in ["slip", "load", "wheel_speed"].iter().zip(&comparison.curves) {
        for (model, step) in saved["models"].as_array().unwrap().iter().zip([None, Some(0)]) {
            let groups = model["curves"][axis]["groups"].as_array().unwrap();
            assert_eq!(groups.len(), curves.groups.len(), "{axis}");
            let own = curves.groups[0].models.iter().find(|own| own.step == step).unwrap();
            let value = &own.signals["torque"].value;
            for (drawn, value) in numbers(&groups[0]["signals"]["torque"]["value"]).iter().zip(value) {
                // Words of two bytes over the range of a curve.
                assert!((drawn - value).abs() < 1e-3 || value.is_nan(), "{axis}: {drawn} {value}");
            }
        }
    }
    // The numbers of the comparison stand in the table, in display units.
    let rmse = comparison.fit().rmse["sinkage"] * 1e3;
    let floor = comparison.noise_floor["sinkage"].value().unwrap() * 1e3;
    for cell in [format!("<td>{rmse:.2} mm</td>"), format!("<td>{floor:.3} mm</td>")] {
        assert!(page.contains(&cell), "{cell}");
    }
    assert!(page.contains("On a bound after calibration: soil.c2"));
    assert!(page.contains("times the noise of one sample"));
}

#[test]
fn property_names_from_files_cannot_break_the_page() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("compare_report");
    std::fs::create_dir_all(&folder).unwrap();
    let toml = "name = '<script>alert(1)</script> & \"x\"'\nkind = \"single_wheel\"\n[[run]]\nfile = \"a.csv\"\n";
    std::fs::write(folder.join("experiment.toml"), toml).unwrap();
    std::fs::write(folder.join("a.csv"), "load,slip,wheel_speed,torque\n30,0.2,1,1.5\n30,0.4,1,\n").unwrap();
    let experiment = Experiment::read(&folder).unwrap();
    let comparison = compare(&Model::preset("two_wheeled").unwrap(), &experiment, &CompareOptions::default()).unwrap();
    let page = comparison_page(&comparison);
    let page = &page;
    assert!(!text(page).contains("<script>alert") && text(page).contains("&lt;script&gt;alert(1)"));
    assert!(
        data(page)["experiment"]["name"].as_str().unwrap().starts_with("<script>alert"),
        "the data is read as it is"
    );
    assert!(!page.contains("<script>alert"));
    assert!(page.contains("Floor unknown for torque"));
    assert!(!page.contains("Calibrated parameters"));
}
