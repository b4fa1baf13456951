//! Terrains in model files: what is written is read back, and what is wrong is named.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker::modeldescription::{Lookup, Parameters};
use bekker::soil::Soil;
use bekker::terrain::{Preset, Profile, Terrain, TerrainSpec};
use std::path::{Path, PathBuf};

const ALL: [Preset; 6] = [Preset::Flat, Preset::Slope, Preset::Waves, Preset::Ditch, Preset::Step, Preset::Random];

fn build(text: &str) -> Result<Terrain, String> {
    let spec: TerrainSpec = toml::from_str(text).map_err(|error| error.to_string())?;
    spec.terrain(Path::new("nowhere")).map_err(|error| error.to_string())
}

/// A file of this test run, removed when dropped.
struct File(PathBuf);

impl File {
    fn new(name: &str, text: &str) -> Self {
        let path = std::env::temp_dir().join(format!("bekker-{}-{name}.csv", std::process::id()));
        std::fs::write(&path, text).unwrap();
        Self(path)
    }
}

impl Drop for File {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

fn from_file(name: &str, text: &str) -> Result<Terrain, String> {
    let file = File::new(name, text);
    let folder = file.0.parent().unwrap();
    let spec = TerrainSpec::file(file.0.file_name().unwrap());
    spec.terrain(folder).map_err(|error| error.to_string().replace(&folder.display().to_string(), ""))
}

#[test]
fn property_every_terrain_survives_its_description() {
    let soil = "\n[soil]\nx = [0, 1]\nk_phi_factor = [1.0, 0.3]\ncohesion = [100, 200]";
    let mut texts: Vec<String> =
        ALL.iter().map(|p| toml::to_string(&TerrainSpec::preset(*p)).unwrap() + soil).collect();
    texts.push("preset = 'random'\nseed = 4294967295\nroughness = 0.123456789012345678".into());
    texts.push("x = [0, 0.1, 3]\nz = [0, 0.3333333333333333, -1e-17]".into());
    for text in texts {
        let terrain = build(&text).unwrap();
        let again = build(&toml::to_string(&terrain.to_spec()).unwrap()).unwrap();
        assert_eq!(terrain, again, "{text}");
    }
}

#[test]
fn property_each_number_of_a_preset_changes_the_ground_and_is_read_by_its_name() {
    for preset in ALL {
        let mut spec = TerrainSpec::preset(preset);
        if preset == Preset::Random {
            // Without rocks the largest one is not to be seen.
            spec.parameters.insert("rock_coverage".into(), 0.15);
        }
        let terrain = spec.terrain(Path::new("")).unwrap();
        for (variable, value) in terrain.clone().list() {
            // Rocks are there or not: so much more that some are added on the 100 m.
            let (share, range) = if variable.name.contains("rock") { (0.5, 10_000) } else { (0.01, 400) };
            let changed = value + share * (variable.max - value).min(1.0);
            let mut spec = spec.clone();
            spec.parameters.insert(variable.name.clone(), changed);
            let other = spec.terrain(Path::new("")).unwrap();
            let differs = |x: f64| terrain.at(x) != other.at(x);
            assert!((0..range).any(|i| differs(0.01 * f64::from(i))), "{preset:?} {}", variable.name);
            assert_eq!(other.clone().get(&variable.name), Ok(changed));
        }
    }
}

#[test]
fn property_values_come_in_the_order_of_the_visit() {
    for preset in ALL {
        let terrain = TerrainSpec::preset(preset).terrain(Path::new("")).unwrap();
        let mut values = Vec::new();
        Parameters::values(&terrain, &mut |value: f64| values.push(value));
        assert_eq!(values, terrain.clone().list().into_iter().map(|(_, value)| value).collect::<Vec<_>>());
    }
}

#[test]
fn property_a_file_and_the_same_samples_in_the_model_file_are_the_same_ground() {
    let text = "# surveyed by hand\nx, z, soil.k_phi_factor\n0, 0, 1\n1, 0.2, 0.5\n3, 0.1, 0.25\n";
    let terrain = from_file("same", text).unwrap();
    let inline = "x = [0, 1, 3]\nz = [0, 0.2, 0.1]\n[soil]\nx = [0, 1, 3]\nk_phi_factor = [1, 0.5, 0.25]";
    assert_eq!(terrain, build(inline).unwrap());
    assert_eq!(build(&toml::to_string(&terrain.to_spec()).unwrap()).unwrap(), terrain);
}

#[test]
fn analytic_soil_varies_linearly_between_positions_and_stays_beyond() {
    let text = "preset = 'flat'\n[soil]\nx = [1, 3]\nk_phi_factor = [1, 0.5]\ncohesion = [500, 700]";
    let terrain = build(text).unwrap();
    let base = Soil::default();
    for (x, factor, cohesion) in [(-5.0, 1.0, 500.0), (1.5, 0.875, 550.0), (2.0, 0.75, 600.0), (9.0, 0.5, 700.0)] {
        let soil = terrain.soil(&base, x);
        let expected = Soil { k_phi: base.k_phi * factor, cohesion, ..base };
        assert_eq!(soil, expected, "x = {x}");
    }
}

#[test]
fn property_without_a_table_the_soil_is_the_base_bit_for_bit() {
    let base = Soil { cohesion: 0.1 + 0.2, ..Soil::default() };
    assert_eq!(Terrain::default().soil(&base, 1.0), base);
}

/// What is wrong, and what the message must say.
const WRONG: [(&str, &[&str]); 20] = [
    ("preset = 'wave'", &["line 1, column 10", "unknown variant `wave`", "`waves`"]),
    ("preset = 'waves'\namplitud = 1", &["`terrain.amplitud`", "did you mean terrain.amplitude"]),
    ("preset = 'waves'\namplitude = 3", &["`terrain.amplitude` = 3", "0 .. 2 m"]),
    ("preset = 'waves'\namplitude = nan", &["`terrain.amplitude` = NaN", "0 .. 2 m"]),
    ("preset = 'waves'\namplitude = 'a'", &["`terrain.amplitude`: expected a number, found string"]),
    ("preset = 'flat'\nslope = 0.1", &["unknown parameter `terrain.slope`"]),
    ("preset = 'flat'\nseed = 1", &["`seed` belongs to the preset `random`"]),
    ("preset = 'random'\nseed = -1", &["line 2", "-1", "u32"]),
    ("preset = 'flat'\nfile = 'a.csv'", &["expected one of `preset`, `file`", "found preset, file"]),
    ("seed = 1", &["expected one of `preset`, `file`", "found seed"]),
    ("x = [0, 1]", &["both `x` and `z`; found x"]),
    ("x = [0, 1]\nz = [0, 1, 2]", &["as many values of z as of x, found 3 and 2"]),
    ("x = [0]\nz = [0]", &["at least 2 samples, found 1"]),
    ("x = [0, 2, 1]\nz = [0, 0, 0]", &["sample 3", "x = 1 does not come after x = 2"]),
    ("x = [0, 1]\nz = [0, inf]", &["sample 2: z = inf", "finite"]),
    ("x = [0, 1]\nz = [0, 1]\nslope = 0.1", &["unknown parameter `terrain.slope`"]),
    ("preset = 'flat'\n[soil]\nx = [0]\nk_fi = [1]", &["terrain.soil", "unknown soil column `k_fi`", "k_phi"]),
    ("preset = 'flat'\n[soil]\nx = [0, 1]\nk_phi = [1e6]", &["`k_phi` has 1 values; expected 2"]),
    ("preset = 'flat'\n[soil]\nx = [0]\nk_phi = [1e6]\nk_phi_factor = [1]", &["k_phi_factor", "already changes"]),
    ("preset = 'flat'\n[soil]\nx = [0]\nfriction_angle = [30]", &["`friction_angle`, row 1: 30", "0 .. 1 rad"]),
];

#[test]
fn property_wrong_descriptions_are_refused_by_name() {
    for (text, expected) in WRONG {
        let message = build(text).expect_err(text);
        expected.iter().for_each(|part| assert!(message.contains(part), "{text}\n{message}\nexpected {part}"));
    }
}

/// The same for files.
const WRONG_FILES: [(&str, &[&str]); 12] = [
    ("x,z\n0,0\n1,a\n", &["line 3, column `z`", "expected a number, found `a`"]),
    ("x,z\n0,0\n1,\n", &["line 3, column `z`", "expected a number, found ``"]),
    ("x,z\n0,0\n\n# a remark\n0,1\n", &["line 5, column `x`", "x = 0 does not come after x = 0"]),
    ("x,z\n0,0\n1,NaN\n", &["line 3, column `z`", "z = NaN"]),
    ("x,z\n0,0\n", &["line 2", "at least 2 samples, found 1"]),
    ("x,y\n0,0\n1,1\n", &["line 1, column `y`", "unknown column; expected `x`, `z`"]),
    ("x\n0\n1\n", &["column `z`", "expected this column; found x"]),
    ("x,z,z\n0,0,0\n1,1,1\n", &["column `z`", "one column of this name"]),
    ("x,z\n0,0\n1,1,1\n", &["line 3", "expected 2 fields, found 3"]),
    ("x,z,soil.k_fi\n0,0,1\n1,1,1\n", &["line 1, column `soil.k_fi`", "unknown column"]),
    ("x,z,soil.k_phi\n0,0,1e6\n1,1,1\n", &["line 3, column `soil.k_phi`", "1000 .. 100000000"]),
    ("", &["expected `x`, `z`"]),
];

#[test]
fn property_wrong_files_are_refused_with_line_and_column() {
    for (i, (text, expected)) in WRONG_FILES.into_iter().enumerate() {
        let message = from_file(&format!("wrong{i}"), text).expect_err(text);
        expected.iter().for_each(|part| assert!(message.contains(part), "{text}\n{message}\nexpected {part}"));
        assert!(message.contains(".csv"), "{message}");
    }
    let message = TerrainSpec::file("missing.csv").terrain(Path::new("nowhere")).unwrap_err().to_string();
    assert!(message.contains("missing.csv") && message.contains("No such file"), "{message}");
}

#[test]
fn property_a_model_without_a_terrain_stands_on_the_flat() {
    assert_eq!(TerrainSpec::default().terrain(Path::new("")).unwrap().profile, Profile::Flat);
}
