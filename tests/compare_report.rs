//! The HTML page of a comparison.
#![allow(clippy::unwrap_used)]
#![cfg(feature = "report")]

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

    // Nothing is loaded from elsewhere. (The plotting library's own text names addresses that it does not open.)
    for tag in ["<script src", "<link", "<img", "@import", "<iframe"] {
        assert!(!page.contains(tag), "{tag}");
    }
    // The library stands in the page once; three signals over slip, load and wheel speed, and their residuals against these.
    assert_eq!(page.matches("plotly.js v").count(), 1);
    assert_eq!(page.matches("data-plot=\"").count(), 3 * 3 + 3 * 3);
    for axis in ["slip", "load", "wheel_speed"] {
        assert_eq!(page.matches(&format!("<div class=\"overlay\" data-when=\"axis={axis}\">")).count(), 1, "{axis}");
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
    assert!(!page.contains("<script>alert") && page.contains("&lt;script&gt;alert(1)"));
    assert!(page.contains("Floor unknown for torque"));
    assert!(!page.contains("Calibrated parameters"));
}
