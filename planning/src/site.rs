//! Ground, robot and settings in one value: what the command line and Python work on.

use crate::anisotropic::{EnergyError, FieldError, GroundEnergy, SlopeEnergy, plan_over};
use crate::force::{Assumptions, Load, Programme, Shear, ShearError};
use crate::map::{
    CsvGrid, Difficulty, ElevationMap, Interpolation, MapError, MapReadError, RangeError, Surface, blurred, rocky,
};
use crate::plan::{
    CostField, Evaluator, Failure, Limits, Localisation, PerformanceIndex, Plan, PlanError, Planner, Request,
};
use crate::pose::{Placing, Pose, PoseError};
use crate::robot::{Robot, RobotError, fsrl, sample_return};
use crate::slip::{SlipBand, SoilSpread};
use crate::trial::ground_shape;
use bekker::soil::Soil;
use bekker::wheel::Wheel;
use bekker_modeldescription::{Parameters, Unit, Variable, join, parameters};
use std::path::{Path, PathBuf};

/// Robots that are built in, and what they are.
pub const ROBOTS: [(&str, &str); 2] = [
    ("fsrl", "the six-wheeled rocker-bogie rover of the thesis's appendix C"),
    (
        "sample_return",
        "JPL's four-wheeled Sample Return Rover of section 3.5: active shoulders, an arm of three joints",
    ),
];

parameters! {
    /// Firm ground, where no soil is given.
    pub struct Traction {
        /// Coefficient of friction.
        friction: [Unit::ONE] = 0.6, 0.0..=5.0, Fixed, "assumption: rubber or lugs on rock and compact soil";
    }
}

parameters! {
    /// What a plan by energy counts.
    pub struct Energy {
        /// Resistance beside that of the soil, of drives and roughness, as a share of the weight.
        resistance: [Unit::ONE] = 0.02, 0.0..=1.0, Fixed, "assumption: a small positive share, so that no way is free";
        /// Largest slip on the way.
        most_slip: [Unit::ONE] = 0.5, 0.01..=0.95, Fixed, "that at which the force analysis takes the soil's strength";
    }
}

/// All numbers that a plan needs beside map and robot, by name.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settings {
    /// Gravity.
    pub environment: bekker::rover::Environment,
    /// Strength of firm ground.
    pub traction: Traction,
    /// What the rover must keep.
    pub limits: Limits,
    /// Weights of the search.
    pub index: PerformanceIndex,
    /// Error of the map.
    pub range_error: RangeError,
    /// Error of dead reckoning.
    pub localisation: Localisation,
    /// Plans by energy.
    pub energy: Energy,
}

impl Parameters<f64> for Settings {
    fn visit(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut f64)) {
        self.environment.visit(prefix, f);
        self.traction.visit(&join(prefix, "traction"), f);
        self.limits.visit(&join(prefix, "limits"), f);
        self.index.visit(&join(prefix, "index"), f);
        self.range_error.visit(&join(prefix, "range_error"), f);
        self.localisation.visit(&join(prefix, "localisation"), f);
        self.energy.visit(&join(prefix, "energy"), f);
    }

    fn values(&self, f: &mut dyn FnMut(f64)) {
        self.environment.values(f);
        self.traction.values(f);
        self.limits.values(f);
        self.index.values(f);
        self.range_error.values(f);
        self.localisation.values(f);
        self.energy.values(f);
    }
}

/// Where ground and robot come from.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// A file, see [`ElevationMap::read`]; or `benign`, `moderate`, `difficult`, each with an optional `:SEED`: generated ground.
    pub map: String,
    /// Spacing and place for files that do not state them.
    pub grid: CsvGrid,
    /// Ground between the nodes.
    pub interpolation: Interpolation,
    /// Nodes that stand out of all neighbours by more than this (m) are put to their median.
    pub spikes: Option<f64>,
    /// Whether holes are filled from their rims.
    pub fill: bool,
    /// The name of a built-in robot, see [`ROBOTS`], or a TOML file of a [`Robot`].
    pub robot: String,
}

impl Source {
    /// The given map and robot, with what is usual.
    #[must_use]
    pub fn new(map: &str, robot: &str) -> Self {
        let (grid, interpolation) = (CsvGrid::default(), Interpolation::default());
        Self { map: map.to_owned(), grid, interpolation, spikes: None, fill: false, robot: robot.to_owned() }
    }
}

/// Why a site cannot be opened or used.
#[derive(Debug, thiserror::Error)]
pub enum SiteError {
    /// The map's file.
    #[error(transparent)]
    Read(#[from] MapReadError),
    /// The map.
    #[error(transparent)]
    Map(#[from] MapError),
    /// The seed after the name of generated ground.
    #[error("`{0}`: expected a whole number after the colon, the seed of generated ground")]
    Seed(String),
    /// The robot's file.
    #[error("`{file}`: {problem}", file = file.display())]
    RobotFile {
        /// The file.
        file: PathBuf,
        /// What is wrong.
        problem: String,
    },
    /// The robot's text.
    #[error("robot: {0}")]
    RobotText(String),
    /// No such robot.
    #[error("unknown robot `{0}`; expected fsrl, sample_return, or a TOML file of a robot")]
    UnknownRobot(String),
    /// The robot's description.
    #[error(transparent)]
    Robot(#[from] RobotError),
    /// The soil does not carry the robot.
    #[error(transparent)]
    Shear(#[from] ShearError),
    /// A plan by energy without soil.
    #[error("a plan by energy needs the soil under the wheels; firm ground costs the same everywhere")]
    NoSoil,
    /// The soil does not carry the robot forward.
    #[error(transparent)]
    Energy(#[from] EnergyError),
    /// No costs by direction.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// No pose.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// No plan.
    #[error(transparent)]
    Plan(#[from] PlanError),
}

/// Deformable soil under the wheels.
#[derive(Clone, Debug)]
struct OnSoil {
    soil: Soil,
    shear: Shear,
    spread: SoilSpread,
}

/// Ground, robot and settings.
#[derive(Clone, Debug)]
pub struct Site {
    surface: Surface,
    robot: Robot,
    /// All numbers beside.
    pub settings: Settings,
    /// What the force analysis assumes.
    pub assumptions: Assumptions,
    /// Values of the robot's active joints; 0 where empty.
    pub active: Vec<f64>,
    soil: Option<OnSoil>,
    /// What was changed in the map: "12 spikes smoothed".
    changes: Vec<String>,
}

impl Site {
    /// Reads map and robot.
    ///
    /// # Errors
    /// [`SiteError`] names the file and what was expected.
    pub fn open(source: &Source) -> Result<Self, SiteError> {
        Self::of(ground(source)?, robot_of(&source.robot)?, source)
    }

    /// A site of a map and a robot at hand; interpolation, spikes and holes as `source` has them.
    ///
    /// # Errors
    /// [`SiteError`] names what is wrong in the robot's description or cannot be changed in the map.
    pub fn of(mut map: ElevationMap, robot: Robot, source: &Source) -> Result<Self, SiteError> {
        robot.check()?;
        let mut changes = Vec::new();
        if let Some(threshold) = source.spikes {
            let (smooth, count) = map.without_spikes(threshold)?;
            map = smooth;
            changes.push(format!("{count} spikes put to the median of their neighbours"));
        }
        if source.fill {
            let (filled, count) = map.filled()?;
            map = filled;
            changes.push(format!("{count} holes filled from their rims"));
        }
        Ok(Self::new(map, robot, source.interpolation).changed(changes))
    }

    /// A site of a map and a robot at hand.
    #[must_use]
    pub fn new(map: ElevationMap, robot: Robot, interpolation: Interpolation) -> Self {
        let surface = Surface::new(map, interpolation);
        let (settings, assumptions) = (Settings::default(), Assumptions::default());
        Self { surface, robot, settings, assumptions, active: Vec::new(), soil: None, changes: Vec::new() }
    }

    fn changed(self, changes: Vec<String>) -> Self {
        Self { changes, ..self }
    }

    /// Deformable soil in place of firm ground: its strength under the robot's wheels at an equal share of the weight. Its uncertainty is
    /// assumed to be that of the class of soil nearest to it.
    ///
    /// # Errors
    /// [`SiteError::Shear`] where the soil does not carry the wheels.
    pub fn on_soil(&mut self, soil: &Soil) -> Result<(), SiteError> {
        self.on_uncertain_soil(soil, SoilSpread::nearest(soil))
    }

    /// The same with what is known of the soil; values that experiments have found replace those of `soil`.
    ///
    /// # Errors
    /// [`SiteError::Shear`] where the soil does not carry the wheels.
    pub fn on_uncertain_soil(&mut self, soil: &Soil, spread: SoilSpread) -> Result<(), SiteError> {
        let soil = spread.around(soil);
        let (wheel, load) = (self.wheel(), self.weight() / self.robot.wheels.len() as f64);
        self.soil = Some(OnSoil { soil, shear: Shear::of(&soil, &wheel, load)?, spread });
        Ok(())
    }

    /// Slip by slope on the soil, with the band of its uncertainty; none on firm ground.
    #[must_use]
    pub fn slip_band(&self) -> Option<SlipBand> {
        let on = self.soil.as_ref()?;
        let (weight, wheels) = (self.weight(), self.robot.wheels.len());
        Some(SlipBand::new(&on.soil, on.spread.clone(), &self.wheel(), weight, wheels))
    }

    /// Energy and slip by slope on the soil; none on firm ground.
    ///
    /// # Errors
    /// [`EnergyError`] where the soil does not carry the robot forward on level ground.
    pub fn slope_energy(&self) -> Option<Result<SlopeEnergy, EnergyError>> {
        let on = self.soil.as_ref()?;
        let (weight, most_slip) = (self.weight(), self.settings.energy.most_slip);
        Some(SlopeEnergy::new(&on.soil, &self.wheel(), weight, self.robot.wheels.len(), most_slip))
    }

    fn wheel(&self) -> Wheel {
        Wheel { radius: self.robot.wheel_radius, width: self.robot.wheel_width, ..Wheel::default() }
    }

    /// Weight of the robot, N.
    #[must_use]
    pub fn weight(&self) -> f64 {
        self.robot.total_mass() * self.settings.environment.gravity
    }

    /// What resists beside the soil, J/m.
    pub(crate) fn resistance(&self) -> f64 {
        self.weight() * self.settings.energy.resistance
    }

    /// The ground.
    #[must_use]
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// The robot.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// Strength of the ground.
    #[must_use]
    pub fn shear(&self) -> Shear {
        self.soil.as_ref().map_or_else(|| Shear::firm(self.settings.traction.friction), |on| on.shear)
    }

    /// What is doubtful in the map, and what was changed in it.
    #[must_use]
    pub fn remarks(&self) -> Vec<String> {
        let doubts = self.surface.map().doubts().into_iter().map(|doubt| doubt.to_string());
        self.changes.iter().cloned().chain(doubts).collect()
    }

    /// The evaluator of stands; with an uncertain map as seen from `sensor` (m).
    ///
    /// # Errors
    /// [`RobotError`] where the active values do not fit.
    pub fn evaluator(&self, sensor: [f64; 2]) -> Result<Evaluator<'_>, RobotError> {
        let mut evaluator = Evaluator::new(&self.robot, &self.surface, &self.active, self.shear())?;
        evaluator.load = Load { gravity: self.settings.environment.gravity, ..Load::default() };
        evaluator.assumptions = self.assumptions;
        evaluator.limits = self.settings.limits;
        let error = self.settings.range_error;
        evaluator.uncertainty = (error != RangeError::default()).then_some((error, sensor));
        Ok(evaluator)
    }

    /// The pose at a place (m) and heading (rad), and whether the rover is safe there.
    ///
    /// # Errors
    /// [`SiteError`] where there is no pose.
    pub fn pose(&self, place: [f64; 2], heading: f64) -> Result<(Pose, Option<Failure>), SiteError> {
        let placing = Placing::new(&self.robot, &self.surface, &self.active)?;
        let pose = placing.pose(place, heading, None)?;
        let failure = self.evaluator(place)?.assess(place, heading, None).err();
        Ok((pose, failure))
    }

    /// Largest thrust in the direction of travel, N; `None` where no forces hold the rover.
    pub(crate) fn largest_thrust(&self, pose: &Pose) -> Option<f64> {
        let placing = Placing::new(&self.robot, &self.surface, &self.active).ok()?;
        let load = Load { gravity: self.settings.environment.gravity, ..Load::default() };
        let programme = Programme::new(&placing, pose, &load, &self.shear(), self.assumptions).ok()?;
        programme.largest_thrust().ok()?.map(|forces| forces.thrust)
    }

    /// The map as it is seen with the sensor's error from the start, where the sensor is taken to stand.
    pub(crate) fn seen(&self, request: &Request) -> Result<ElevationMap, SiteError> {
        Ok(blurred(self.surface.map(), request.start, &self.settings.range_error)?)
    }

    /// A safe path. The sensor that measured the map is taken to stand at the start.
    ///
    /// # Errors
    /// [`SiteError::Plan`] says why there is none.
    pub fn plan(&self, request: &Request) -> Result<Plan, SiteError> {
        let field = CostField::new(&self.seen(request)?, &self.robot, &self.settings.index);
        let mut planner = Planner::new(self.evaluator(request.start)?, field, self.settings.localisation);
        Ok(planner.plan(request)?)
    }

    /// The path on which the wheels need the least energy by the wheel-soil model, and every stand is safe.
    ///
    /// # Errors
    /// [`SiteError::NoSoil`] on firm ground, and as [`Site::plan`].
    pub fn plan_by_energy(&self, request: &Request) -> Result<Plan, SiteError> {
        let energy = self.slope_energy().ok_or(SiteError::NoSoil)??;
        let seen = Surface::new(self.seen(request)?, self.surface.interpolation());
        let cost = GroundEnergy::new(&seen, &energy, self.resistance());
        Ok(plan_over(&self.evaluator(request.start)?, cost.table()?, request)?)
    }
}

/// The map that a source names: of a file, or generated ground.
///
/// # Errors
/// [`SiteError::Read`] for a file that is no map, [`SiteError::Seed`] for a seed that is no number.
pub fn ground(source: &Source) -> Result<ElevationMap, SiteError> {
    let (name, seed) = source.map.split_once(':').map_or((&source.map[..], None), |(name, seed)| (name, Some(seed)));
    let difficulty = match name {
        "benign" => Difficulty::Benign,
        "moderate" => Difficulty::Moderate,
        "difficult" => Difficulty::Difficult,
        _ => return Ok(ElevationMap::read(Path::new(&source.map), &source.grid)?),
    };
    let seed = seed.map_or(Ok(0), |seed| seed.parse().map_err(|_| SiteError::Seed(source.map.clone())))?;
    Ok(rocky(&ground_shape(difficulty), seed)?)
}

/// A robot by the name of one that is built in, or by its TOML file.
///
/// # Errors
/// [`SiteError::UnknownRobot`] and [`SiteError::RobotFile`].
pub fn robot_of(name: &str) -> Result<Robot, SiteError> {
    match name {
        "fsrl" => return Ok(fsrl()),
        "sample_return" => return Ok(sample_return()),
        _ => {}
    }
    if !name.ends_with(".toml") {
        return Err(SiteError::UnknownRobot(name.to_owned()));
    }
    let file = PathBuf::from(name);
    let refused = |problem: String| SiteError::RobotFile { file: file.clone(), problem };
    let text = std::fs::read_to_string(&file).map_err(|error| refused(error.to_string()))?;
    robot_from(&text).map_err(|error| refused(error.to_string()))
}

/// A robot from the text of a TOML file.
///
/// # Errors
/// [`SiteError::RobotText`] names the field and what was expected.
pub fn robot_from(text: &str) -> Result<Robot, SiteError> {
    toml::from_str(text).map_err(|error| SiteError::RobotText(error.to_string().trim_end().to_owned()))
}
