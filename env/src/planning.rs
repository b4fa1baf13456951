//! Poses and plans, see [`bekker_planning`].

use crate::error::{self, InputError, ModelError, PlanningError, UnknownNameError};
use crate::model::PyModel;
use bekker::known_soil::KnownSoil;
use bekker::modeldescription::Lookup;
use bekker::soil::Soil;
use bekker_planning::answer::{PlanAnswer, PoseAnswer};
use bekker_planning::map::{CsvGrid, ElevationMap, Interpolation, MapReadError};
use bekker_planning::page::plan_page;
use bekker_planning::plan::{PlanError, Request};
use bekker_planning::site::{ROBOTS, Settings, Site, SiteError, Source, ground, robot_from, robot_of};
use bekker_planning::slip::SoilSpread;
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;

/// Heights of Python's, or the name of a file or of generated ground.
#[derive(FromPyObject)]
pub enum MapGiven<'py> {
    Heights(PyReadonlyArray2<'py, f64>),
    Name(String),
}

/// Map, robot and settings as Python gives them.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct SiteGiven<'py> {
    map: MapGiven<'py>,
    cell: f64,
    origin: [f64; 2],
    from_north: bool,
    smooth: bool,
    spikes: Option<f64>,
    fill: bool,
    /// A name or file; with `robot_is_text` the text of a TOML file.
    robot: String,
    robot_is_text: bool,
    settings: BTreeMap<String, f64>,
    active: Vec<f64>,
    soil: Option<PyRef<'py, PyModel>>,
    /// The text of a known soil's file.
    soil_from: Option<String>,
    soil_class: Option<String>,
}

impl SiteGiven<'_> {
    fn open(&self) -> PyResult<Site> {
        let interpolation = if self.smooth { Interpolation::Smooth } else { Interpolation::Bilinear };
        let mut source = Source::new("", "");
        source.grid = CsvGrid { cell: self.cell, origin: self.origin, from_north: self.from_north };
        (source.interpolation, source.spikes, source.fill) = (interpolation, self.spikes, self.fill);
        let map = match &self.map {
            MapGiven::Name(name) => {
                source.map.clone_from(name);
                ground(&source).map_err(|refused| refuse(&refused))?
            }
            MapGiven::Heights(heights) => self.map_of(heights)?,
        };
        let robot = if self.robot_is_text { robot_from(&self.robot) } else { robot_of(&self.robot) };
        let site = robot.and_then(|robot| Site::of(map, robot, &source));
        let mut site = site.map_err(|refused| refuse(&refused))?;
        for (name, value) in &self.settings {
            site.settings.set(name, *value).map_err(|refused| error::parameter(&refused))?;
        }
        if let Some(model) = &self.soil {
            let soil = &model.core.rover.soil;
            site.on_uncertain_soil(soil, self.spread(soil)?).map_err(|refused| refuse(&refused))?;
        }
        site.active.clone_from(&self.active);
        Ok(site)
    }

    /// What is not known of the soil.
    fn spread(&self, soil: &Soil) -> PyResult<SoilSpread> {
        let known = self.soil_from.as_deref().map(KnownSoil::from_toml).transpose();
        if let Some(known) = known.map_err(|refused| InputError::new_err(refused.to_string()))? {
            return Ok(SoilSpread::Known(known));
        }
        let Some(name) = &self.soil_class else { return Ok(SoilSpread::nearest(soil)) };
        SoilSpread::of_class(name).map_err(|refused| UnknownNameError::new_err(refused.to_string()))
    }

    fn map_of(&self, heights: &PyReadonlyArray2<f64>) -> PyResult<ElevationMap> {
        let heights = heights.as_array();
        let (rows, columns) = heights.dim();
        let row = |k: usize| heights.row(if self.from_north { rows - 1 - k } else { k }).to_vec();
        let all = (0..rows).flat_map(row).collect();
        let map = ElevationMap::new(columns, rows, self.cell, self.origin, all);
        map.map_err(|refused| InputError::new_err(format!("map: {refused}")))
    }
}

fn refuse(refused: &SiteError) -> PyErr {
    let message = refused.to_string();
    match refused {
        SiteError::Read(MapReadError::File { source, .. }) => error::unreachable_file(source, message),
        SiteError::UnknownRobot(_) => UnknownNameError::new_err(message),
        SiteError::Seed(_) => InputError::new_err(message),
        SiteError::Read(_)
        | SiteError::Map(_)
        | SiteError::RobotFile { .. }
        | SiteError::RobotText(_)
        | SiteError::Robot(_)
        | SiteError::NoSoil
        | SiteError::Energy(_)
        | SiteError::Field(_)
        | SiteError::Shear(_) => ModelError::new_err(message),
        SiteError::Plan(PlanError::Unreachable(reached)) => PlanningError::new_err((message, reached.nearest)),
        SiteError::Pose(_) | SiteError::Plan(_) => PlanningError::new_err(message),
    }
}

fn json(answer: &impl Serialize) -> PyResult<String> {
    serde_json::to_string(answer).map_err(|refused| ModelError::new_err(refused.to_string()))
}

/// A plan as JSON and as a page; by the performance index, or by the energy that the wheels need; with other paths where asked for.
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "keywords of the Python function")]
pub fn plan(
    py: Python<'_>,
    site: SiteGiven<'_>,
    start: [f64; 2],
    goal: [f64; 2],
    heading: Option<f64>,
    most_evaluations: usize,
    by_energy: bool,
    alternatives: bool,
) -> PyResult<(String, String)> {
    let site = site.open()?;
    let request = Request { start, heading, goal, most_evaluations };
    let planned = py.detach(|| {
        error::fenced(|| {
            let plan = if by_energy { site.plan_by_energy(&request) } else { site.plan(&request) }?;
            let others = if alternatives { Some(site.alternatives(&request, &plan)?) } else { None };
            let answer = others.iter().fold(PlanAnswer::new(&site, &plan), PlanAnswer::with_alternatives);
            let page = plan_page(&site, &plan, &answer, others.as_ref());
            Ok::<_, SiteError>((answer, page))
        })
    })?;
    let (answer, page) = planned.map_err(|refused| refuse(&refused))?;
    Ok((json(&answer)?, page))
}

/// A pose as JSON.
#[pyfunction]
pub fn pose(py: Python<'_>, site: SiteGiven<'_>, place: [f64; 2], heading: f64) -> PyResult<String> {
    let site = site.open()?;
    let found = py.detach(|| error::fenced(|| site.pose(place, heading)))?;
    let (pose, failure) = found.map_err(|refused| refuse(&refused))?;
    json(&PoseAnswer::new(&site, &pose, failure.as_ref()))
}

/// Names and meanings of the robots that are built in.
#[pyfunction]
pub fn robots() -> Vec<(&'static str, &'static str)> {
    ROBOTS.to_vec()
}

/// Every number that `settings` changes: name, value where it is not given, unit, meaning.
#[pyfunction]
pub fn planning_settings() -> Vec<(String, f64, &'static str, String)> {
    let all = Settings::default().list();
    all.into_iter()
        .map(|(variable, value)| (variable.name, value, variable.unit.symbol, variable.doc.to_string()))
        .collect()
}
