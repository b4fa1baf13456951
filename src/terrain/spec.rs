//! The ground as a model file describes it.

use super::profile_file::{self, ProfileFile};
use super::{
    Ditch, Profile, Random, Samples, SamplesError, Slope, SoilColumn, SoilTable, SoilTableError, Spectrum, Step,
    Terrain, Waves,
};
use bekker_modeldescription::{Lookup, ParameterError, Parameters, Variable, join};
use serde::{Deserialize, Deserializer, Serialize, de::Error as _};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Prefix of the terrain's parameters in the vocabulary.
const PREFIX: &str = "terrain";

/// A terrain in a model file: a preset with its numbers, a CSV file, or samples.
///
/// ```
/// use bekker::terrain::TerrainSpec;
/// let spec: TerrainSpec = toml::from_str("preset = 'waves'\namplitude = 0.1\nwavelength = 3.0").unwrap();
/// let terrain = spec.terrain(std::path::Path::new(".")).unwrap();
/// assert_eq!(terrain.at(2.0).height, 0.2);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TerrainSpec {
    /// A preset; its numbers stand beside it by their names in the vocabulary without `terrain.`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub preset: Option<Preset>,
    /// A CSV file with the columns `x` and `z` (m) and, where the soil varies, columns such as `soil.k_phi` or
    /// `soil.k_phi_factor`; relative to the model file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<PathBuf>,
    /// Positions of the samples, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub x: Option<Vec<f64>>,
    /// Heights of the samples, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub z: Option<Vec<f64>>,
    /// Seed of the preset `random`; 0 where missing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seed: Option<u32>,
    /// Numbers of the preset; its defaults where missing.
    #[serde(flatten, deserialize_with = "numbers")]
    pub parameters: BTreeMap<String, f64>,
    /// Soil that varies along x.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub soil: Option<SoilSpec>,
}

/// A profile by formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Preset {
    /// The level z = 0.
    Flat,
    /// An inclined plane: [`Slope`].
    Slope,
    /// Waves behind a level run-in: [`Waves`].
    Waves,
    /// A ditch: [`Ditch`].
    Ditch,
    /// A step of finite slope: [`Step`].
    Step,
    /// Random ground: [`Spectrum`] and a seed.
    Random,
}

/// Soil parameters along x: linear between the positions, constant beyond.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SoilSpec {
    /// Positions, m.
    pub x: Vec<f64>,
    /// Values by the parameter's name without `soil.`; with the ending `_factor`, factors on it.
    #[serde(flatten)]
    pub columns: BTreeMap<String, Vec<f64>>,
}

/// Why a terrain cannot be built from its description.
#[derive(Debug, thiserror::Error)]
pub enum TerrainSpecError {
    /// The parts of the description do not fit together.
    #[error("terrain: {0}")]
    Parts(String),
    /// A number of a preset is unknown or out of range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The samples in the model file make no profile.
    #[error("terrain.x, terrain.z: {0}")]
    Samples(#[from] SamplesError),
    /// The soil table in the model file is refused.
    #[error("terrain.soil: {0}")]
    Soil(#[from] SoilTableError),
    /// The CSV file cannot be opened or read.
    #[error("{file}: {source}")]
    Unreadable {
        /// The file.
        file: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// Something in the CSV file is wrong.
    #[error("{file}, line {line}, column `{column}`: {message}")]
    Cell {
        /// The file.
        file: String,
        /// Line, counted from 1.
        line: u64,
        /// Name of the column.
        column: String,
        /// What was found and what was expected.
        message: String,
    },
}

impl Default for TerrainSpec {
    fn default() -> Self {
        Self::preset(Preset::Flat)
    }
}

impl TerrainSpec {
    const EMPTY: Self =
        Self { preset: None, file: None, x: None, z: None, seed: None, parameters: BTreeMap::new(), soil: None };

    /// A preset with its default numbers.
    #[must_use]
    pub fn preset(preset: Preset) -> Self {
        Self { preset: Some(preset), ..Self::EMPTY }
    }

    /// A profile from a CSV file.
    #[must_use]
    pub fn file(file: impl Into<PathBuf>) -> Self {
        Self { file: Some(file.into()), ..Self::EMPTY }
    }

    /// Builds the terrain; a file is looked for in `folder`, where the model file is.
    ///
    /// # Errors
    /// [`TerrainSpecError`] naming the key, or the file, line and column, and what was expected.
    pub fn terrain(&self, folder: &Path) -> Result<Terrain, TerrainSpecError> {
        let (terrain, in_file) = match (self.preset, &self.file, &self.x, &self.z) {
            (Some(preset), None, None, None) => (Terrain::new(self.profile(preset)?), false),
            (None, Some(file), None, None) => {
                let ProfileFile { samples, soil } = profile_file::read(&folder.join(file))?;
                let varies = soil.is_some();
                (sampled(samples, soil), varies)
            }
            (None, None, Some(x), Some(z)) => (sampled(Samples::new(x, z)?, None), false),
            _ => return Err(self.parts("expected one of `preset`, `file`, or both `x` and `z`")),
        };
        let mut terrain = self.with_numbers(terrain)?;
        if let Some(soil) = &self.soil {
            if in_file {
                return Err(self.parts("expected the soil either in `soil` or in the columns of `file`, not in both"));
            }
            terrain = terrain.with_soil(soil.table()?);
        }
        Ok(terrain)
    }

    fn profile(&self, preset: Preset) -> Result<Profile, TerrainSpecError> {
        if self.seed.is_some() && preset != Preset::Random {
            return Err(self.parts("`seed` belongs to the preset `random`"));
        }
        Ok(match preset {
            Preset::Flat => Profile::Flat,
            Preset::Slope => Profile::Slope(Slope::default()),
            Preset::Waves => Profile::Waves(Waves::default()),
            Preset::Ditch => Profile::Ditch(Ditch::default()),
            Preset::Step => Profile::Step(Step::default()),
            Preset::Random => Profile::Random(Random::new(Spectrum::default(), self.seed.unwrap_or(0))),
        })
    }

    fn with_numbers(&self, mut terrain: Terrain) -> Result<Terrain, TerrainSpecError> {
        if self.seed.is_some() && self.preset.is_none() {
            return Err(self.parts("`seed` belongs to the preset `random`"));
        }
        for (name, value) in &self.parameters {
            Named(&mut terrain).set(&join(PREFIX, name), *value)?;
        }
        Ok(terrain)
    }

    /// The error for parts that do not fit, with the keys that were found.
    fn parts(&self, expected: &str) -> TerrainSpecError {
        let keys = [
            ("preset", self.preset.is_some()),
            ("file", self.file.is_some()),
            ("x", self.x.is_some()),
            ("z", self.z.is_some()),
            ("seed", self.seed.is_some()),
            ("soil", self.soil.is_some()),
        ];
        let found: Vec<&str> = keys.iter().filter(|(_, given)| *given).map(|(key, _)| *key).collect();
        let found = if found.is_empty() { "none of its keys".to_owned() } else { found.join(", ") };
        TerrainSpecError::Parts(format!("{expected}; found {found}"))
    }
}

impl SoilSpec {
    fn table(&self) -> Result<SoilTable, SoilTableError> {
        let column = |(name, values): (&String, &Vec<f64>)| SoilColumn { name: name.clone(), values: values.clone() };
        SoilTable::new(self.x.clone(), self.columns.iter().map(column).collect())
    }
}

impl Terrain {
    /// The description of this terrain, complete in itself: samples stand in it, no file is needed.
    #[must_use]
    pub fn to_spec(&self) -> TerrainSpec {
        let mut spec = match &self.profile {
            Profile::Flat => TerrainSpec::preset(Preset::Flat),
            Profile::Slope(_) => TerrainSpec::preset(Preset::Slope),
            Profile::Waves(_) => TerrainSpec::preset(Preset::Waves),
            Profile::Ditch(_) => TerrainSpec::preset(Preset::Ditch),
            Profile::Step(_) => TerrainSpec::preset(Preset::Step),
            Profile::Random(random) => TerrainSpec { seed: Some(random.seed()), ..TerrainSpec::preset(Preset::Random) },
            Profile::Samples(samples) => {
                let (x, z) = samples.points().unzip();
                TerrainSpec { x: Some(x), z: Some(z), ..TerrainSpec::EMPTY }
            }
        };
        self.clone().visit("", &mut |variable, value| {
            spec.parameters.insert(variable.name, *value);
        });
        spec.soil = self.soil_table().map(|table| SoilSpec {
            x: table.positions().to_vec(),
            columns: table.columns().iter().map(|c| (c.name.clone(), c.values.clone())).collect(),
        });
        spec
    }
}

fn sampled(samples: Samples, soil: Option<SoilTable>) -> Terrain {
    let terrain = Terrain::new(Profile::Samples(Arc::new(samples)));
    match soil {
        Some(table) => terrain.with_soil(table),
        None => terrain,
    }
}

/// The terrain's parameters under their full names, so that errors carry them.
struct Named<'a>(&'a mut Terrain);

impl Parameters<f64> for Named<'_> {
    fn visit(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut f64)) {
        self.0.visit(&join(prefix, PREFIX), f);
    }

    fn values(&self, f: &mut dyn FnMut(f64)) {
        self.0.values(f);
    }
}

/// All further keys as numbers; one that is no number is an error with its name.
fn numbers<'de, D: Deserializer<'de>>(from: D) -> Result<BTreeMap<String, f64>, D::Error> {
    let number = |(name, value): (String, toml::Value)| match value {
        toml::Value::Float(value) => Ok((name, value)),
        toml::Value::Integer(value) => Ok((name, value as f64)),
        other => Err(D::Error::custom(format!("`{PREFIX}.{name}`: expected a number, found {}", other.type_str()))),
    };
    BTreeMap::<String, toml::Value>::deserialize(from)?.into_iter().map(number).collect()
}
