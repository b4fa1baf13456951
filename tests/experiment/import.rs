//! `bekker import`: folders that are proposed for files with names and units of their own.

use bekker::measurement::{Experiment, ImportError, Kind, Proposal, WriteError};
use std::path::{Path, PathBuf};

/// A place of its own for each test, with the given files; the folder to be made does not exist.
fn files(name: &str, texts: &[(&str, &str)]) -> (Vec<PathBuf>, PathBuf) {
    let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("experiment_import").join(name);
    let _ = std::fs::remove_dir_all(&place);
    std::fs::create_dir_all(&place).unwrap();
    let path = |(file, text): &(&str, &str)| {
        std::fs::write(place.join(file), text).unwrap();
        place.join(file)
    };
    (texts.iter().map(path).collect(), place.join("made"))
}

/// Rows of a wheel rig: slip, pull (N), load (N), sinkage (m), carriage and rim speed (m/s).
fn rig() -> Vec<[f64; 6]> {
    (0..9)
        .map(|k| {
            let slip = 0.1 * f64::from(k);
            [slip, 20.0 * ((6.0 * slip).tanh() * 0.5 - 0.1), 20.0, 0.01 + 0.01 * slip, 0.01, 0.01 / (1.0 - slip)]
        })
        .collect()
}

#[test]
fn property_a_rig_in_millimetres_is_imported_once_its_radius_is_known() {
    let mut csv = "beta,trial,slip,DP,W,z,sDP,Vx,Vr\n".to_owned();
    for (k, [slip, pull, load, sinkage, carriage, rim]) in rig().into_iter().enumerate() {
        let beta = if k % 2 == 0 { 0.0 } else { 15.0 };
        csv += &format!("{beta},1,{slip},{pull},{load},{},0.1,{},{}\n", 1e3 * sinkage, 1e3 * carriage, 1e3 * rim);
    }
    let (paths, folder) = files("rig", &[("trials.csv", &csv)]);
    let proposal = Proposal::of(&paths, None).unwrap();
    assert_eq!(proposal.kind, Kind::SingleWheel);
    for line in [
        "\"z\" = { signal = \"sinkage\", unit = \"mm\" }",
        "\"Vx\" = { signal = \"carriage_speed\", unit = \"mm/s\" }",
        "\"Vr\" = { signal = \"rim_speed\", unit = \"mm/s\" }",
        "\"DP\" = { signal = \"drawbar_pull\" }",
        "\"sDP\",",
    ] {
        assert!(proposal.settings.contains(line), "{line} is not in\n{}", proposal.settings);
    }
    let said =
        |words: &str, list: &[String]| assert!(list.iter().any(|line| line.contains(words)), "{words}: {list:?}");
    said("where = { \"beta\" = 0 }", &proposal.unsure);
    said("`z` as sinkage: a short name; in mm by the size of its values", &proposal.unsure);
    said("\"wheel.radius\" under [parameters]", &proposal.missing);
    let imported = proposal.write(&folder).unwrap();
    let problem = imported.read.unwrap_err().to_string();
    assert!(problem.contains("needs \"wheel.radius\" under [parameters]"), "{problem}");
    // What is said to be missing is all that is missing.
    let settings = std::fs::read_to_string(folder.join("experiment.toml")).unwrap();
    let filled = settings.replace("# \"wheel.radius\" = 0.1", "\"wheel.radius\" = 0.058");
    std::fs::write(folder.join("experiment.toml"), filled).unwrap();
    let experiment = Experiment::read(&folder).unwrap();
    let data = &experiment.runs[0].data;
    assert_eq!((data.rows(), experiment.signals()), (9, vec!["drawbar_pull".to_owned(), "sinkage".to_owned()]));
    assert!((data.value("sinkage", 0).unwrap() - 0.01).abs() < 1e-12);
    assert!(experiment.doubts.is_empty(), "{:?}", experiment.doubts);
    // Nothing is written over.
    assert!(matches!(proposal.write(&folder), Err(WriteError::Exists { .. })));
}

#[test]
fn property_units_in_names_parameters_and_texts() {
    let header = "source;wheel_radius_m;wheel_width_m;grouser_height_mm;vertical_load_kg;slip_percent;meas_drawbar_pull_n;meas_sinkage_cm;Torque [N mm];wheel speed (rpm)";
    let mut csv = format!("{header}\n");
    for height in [0, 10] {
        for [slip, pull, load, sinkage, ..] in rig() {
            let row = [0.15, 0.1, f64::from(height), load / 9.81, 100.0 * slip, -pull, -100.0 * sinkage, 500.0, 2.0];
            let cells = row.map(|value| format!("{value}").replace('.', ","));
            csv += &format!("ding, 2011;{}\n", cells.join(";"));
        }
    }
    let (paths, folder) = files("names", &[("points.csv", &csv)]);
    let proposal = Proposal::of(&paths, None).unwrap();
    let imported = proposal.write(&folder).unwrap();
    let experiment = imported.read.unwrap_or_else(|error| panic!("{error}\n{}", proposal.settings));
    assert_eq!(experiment.runs.len(), 2);
    assert_eq!(experiment.runs[1].parameters["grousers.height"], 0.01);
    assert_eq!(experiment.runs[1].parameters["wheel.radius"], 0.15);
    let data = &experiment.runs[0].data;
    let [_, pull, _, sinkage, ..] = rig()[8];
    let close = |name: &str, value: f64| {
        let found = data.value(name, 8).unwrap();
        assert!((found / value - 1.0).abs() < 1e-3, "{name}: {found} is not {value}\n{}", proposal.settings);
    };
    // The load was divided by 9.81, and is multiplied by standard gravity.
    close("load", 20.0);
    close("slip", 0.8);
    close("drawbar_pull", pull);
    close("sinkage", sinkage);
    close("torque", 0.5);
    close("wheel_speed", 0.2094);
    assert!(proposal.unsure.iter().any(|line| line.contains("sign is taken as turned")), "{:?}", proposal.unsure);
    assert!(proposal.settings.contains("separator = \";\"") && proposal.settings.contains("decimal = \",\""));
}

#[test]
fn property_a_log_of_a_rover_is_imported() {
    let mut csv =
        "run,time,rim_speed_left,rim_speed_right,current_left,current_right,ax,imu_pitch_deg,velocity\n".to_owned();
    for run in 0..2 {
        for k in 0..40 {
            csv += &format!("{run:02},{},0.2,0.2,1.5,1.6,0.1,{},0.18\n", 0.1 * f64::from(k), f64::from(k % 7) - 3.0);
        }
    }
    let (paths, folder) = files("log", &[("log.csv", &csv), ("second.csv", &csv)]);
    let proposal = Proposal::of(&paths, None).unwrap();
    assert_eq!(proposal.kind, Kind::Traverse);
    let imported = proposal.write(&folder).unwrap();
    let problem = imported.read.unwrap_err().to_string();
    assert!(problem.contains("needs \"wheel.radius\""), "{problem}\n{}", proposal.settings);
    let settings = std::fs::read_to_string(folder.join("experiment.toml")).unwrap();
    std::fs::write(folder.join("experiment.toml"), settings.replace("# \"wheel.radius\"", "\"wheel.radius\"")).unwrap();
    let experiment = Experiment::read(&folder).unwrap();
    let names: Vec<&str> = experiment.runs.iter().map(|run| run.name.as_str()).collect();
    assert_eq!(names, ["log#00", "log#01", "second#00", "second#01"]);
    assert_eq!(experiment.signals(), ["wheel[1+2].current", "pitch", "velocity"]);
    assert!((experiment.runs[0].data.value("pitch", 0).unwrap() + 3.0_f64.to_radians()).abs() < 1e-12);
    assert_eq!(experiment.runs[0].data.value("wheel[2].speed", 0), Some(2.0));
    // Both sides have a column; the planar rover has their mean.
    assert!((experiment.runs[0].data.value("wheel[1+2].current", 0).unwrap() - 1.55).abs() < 1e-12);
    assert!(
        settings.contains("\"current_right\" = { signal = \"current\", wheels = [1, 2], side = \"right\" }"),
        "{settings}"
    );
    assert_eq!(experiment.runs[0].inputs, ["wheel[1].speed", "wheel[2].speed"]);
    assert!(proposal.unsure.iter().any(|line| line.contains("there is no command")), "{:?}", proposal.unsure);
}

#[test]
fn property_what_cannot_be_proposed_is_said() {
    assert!(matches!(Proposal::of(&[], None), Err(ImportError::NoFiles)));
    let (paths, _) = files("strange", &[("a.csv", "apples,pears\n1,2\n")]);
    let message = Proposal::of(&paths, None).unwrap_err().to_string();
    assert!(message.contains("neither a `single_wheel`") && message.contains("apples, pears"), "{message}");
    let (paths, folder) = files("bare", &[("a.csv", "slip,DP\n0.1,2\n0.2,3\n")]);
    let proposal = Proposal::of(&paths, None).unwrap();
    let missing = proposal.missing.join("\n");
    assert!(missing.contains("load under [inputs]") && missing.contains("wheel_speed under [inputs]"), "{missing}");
    let problem = proposal.write(&folder).unwrap().read.unwrap_err().to_string();
    assert!(problem.contains("`load`") && problem.contains("[inputs]"), "{problem}");
    // The places to be filled in are there.
    let settings = std::fs::read_to_string(folder.join("experiment.toml")).unwrap();
    let filled = settings.replace("# load =", "load =").replace("# wheel_speed =", "wheel_speed =");
    std::fs::write(folder.join("experiment.toml"), filled).unwrap();
    assert_eq!(Experiment::read(&folder).unwrap().runs[0].data.value("load", 0), Some(50.0));
}
