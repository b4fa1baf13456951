//! Map, robot and settings of `bekker pose` and `bekker plan`.

use crate::model::assignment;
use anyhow::{Context, Result, bail};
use bekker::known_soil::KnownSoil;
use bekker::model::Model;
use bekker::modeldescription::Lookup;
use bekker::soil::Soil;
use bekker_planning::map::{CsvGrid, Interpolation};
use bekker_planning::site::{Site, Source};
use bekker_planning::slip::SoilSpread;
use std::path::PathBuf;

/// Map, robot and settings.
#[derive(clap::Args)]
pub struct GroundArguments {
    /// The map: a file (.tif, .asc, .npy, .csv, .yaml with a PGM; heights in metres), or benign, moderate or difficult for generated
    /// ground, with a seed as in moderate:7.
    map: String,
    /// The robot: fsrl, sample_return, or a TOML file.
    #[arg(long, default_value = "fsrl")]
    robot: String,
    /// Spacing of a .npy or .csv map, m.
    #[arg(long, default_value_t = 1.0)]
    cell: f64,
    /// Place of the south-western node of a .npy or .csv map, m.
    #[arg(long, value_name = "X,Y", default_value = "0,0", value_parser = pair, allow_hyphen_values = true)]
    origin: [f64; 2],
    /// The first row of a .npy or .csv map is the northern one.
    #[arg(long)]
    from_north: bool,
    /// Ground with creases along the grid's lines, in place of a smooth surface.
    #[arg(long)]
    bilinear: bool,
    /// Put single nodes that stand out of all their neighbours by more than this (m) to the neighbours' median.
    #[arg(long, value_name = "METRES")]
    smooth_spikes: Option<f64>,
    /// Fill holes of the map from their rims.
    #[arg(long)]
    fill_holes: bool,
    /// Soil in place of firm ground: that of a model file or a built-in model.
    #[arg(long, value_name = "MODEL")]
    soil: Option<String>,
    /// What another experiment found of that soil, a file of `bekker calibrate --save-soil`: its values replace those of --soil, and
    /// from its covariance follows the band of the slip along a path.
    #[arg(long, value_name = "FILE", requires = "soil")]
    soil_from: Option<PathBuf>,
    /// Class of that soil, whose standard deviations make the band of the slip along a path: dry sand, regolith simulant, sandy loam, clay
    /// or snow; without it the class nearest to the soil is assumed.
    #[arg(long, value_name = "CLASS", requires = "soil", conflicts_with = "soil_from")]
    soil_class: Option<String>,
    /// Set a number by its name, SI units; may be given several times. `bekker plan --list` names all.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    changes: Vec<String>,
    /// Values of the robot's active joints, rad or m, separated by commas; 0 where missing.
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true)]
    active: Vec<f64>,
}

impl GroundArguments {
    /// Reads map and robot, and sets what is given.
    pub fn open(&self) -> Result<Site> {
        let source = Source {
            grid: CsvGrid { cell: self.cell, origin: self.origin, from_north: self.from_north },
            interpolation: if self.bilinear { Interpolation::Bilinear } else { Interpolation::Smooth },
            spikes: self.smooth_spikes,
            fill: self.fill_holes,
            ..Source::new(&self.map, &self.robot)
        };
        let mut site = Site::open(&source)?;
        for change in &self.changes {
            let (name, value) = assignment(change)?;
            site.settings.set(name, value)?;
        }
        if let Some(name) = &self.soil {
            let (model, _) = Model::find(name, None)?;
            let soil = &model.rover.soil;
            site.on_uncertain_soil(soil, self.spread(soil)?).with_context(|| format!("soil of `{name}`"))?;
        }
        site.active.clone_from(&self.active);
        Ok(site)
    }
}

impl GroundArguments {
    /// What is not known of the soil.
    fn spread(&self, soil: &Soil) -> Result<SoilSpread> {
        if let Some(file) = &self.soil_from {
            return Ok(SoilSpread::Known(KnownSoil::read(file)?));
        }
        let Some(name) = &self.soil_class else { return Ok(SoilSpread::nearest(soil)) };
        Ok(SoilSpread::of_class(name)?)
    }
}

/// Reads `X,Y`.
pub fn pair(text: &str) -> Result<[f64; 2], String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse::<f64>()).collect();
    match numbers.as_deref() {
        Ok([x, y]) if x.is_finite() && y.is_finite() => Ok([*x, *y]),
        _ => Err(format!("`{text}`: expected two numbers, X,Y in metres")),
    }
}

/// An angle in degrees as radians.
pub fn degrees(angle: f64) -> Result<f64> {
    if !angle.is_finite() {
        bail!("a heading of {angle} degrees; expected a number");
    }
    Ok(angle.to_radians())
}
