//! A planned path driven by the core's planar rover: one side of the rocker-bogie on the profile along the path.

use crate::map::Surface;
use crate::plan::Plan;
use bekker::model::{ControlKind, Model, ModelError, RunError, SummaryBuilder};
use bekker::modeldescription::{Lookup, ParameterError};
use bekker::rover::Rover;
use bekker::simulation::Status;
use bekker::soil::Soil;
use bekker::terrain::{Profile, Samples, SamplesError, Terrain};

/// Level ground before and behind the path, m: the rover starts there, and its rear wheels stand there.
const RUN_IN: f64 = 0.6;

/// Spacing of the profile, m.
const SPACING: f64 = 0.02;

/// A drive may take this many times as long as the commanded speed would: wheels slip.
const PATIENCE: f64 = 5.0;

/// How a driven path ended.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Drive {
    /// Whether the rover reached the end.
    pub reached: bool,
    /// How it ended otherwise: "stuck", "tipped over", .. or "too slow".
    pub end: String,
    /// Way covered, m, of the path's length.
    pub covered: f64,
    /// Length of the path, m.
    pub length: f64,
    /// Time, s.
    pub duration: f64,
    /// Electrical energy of the side's motors, J.
    pub energy: f64,
    /// Mean slip of the wheels.
    pub slip: f64,
}

/// Why a path cannot be driven.
#[derive(Debug, thiserror::Error)]
pub enum DriveError {
    /// The profile.
    #[error("the profile along the path: {0}")]
    Profile(#[from] SamplesError),
    /// The model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The run.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A number of the model.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The path leaves the map.
    #[error("the path leaves known ground at ({x:.2}, {y:.2})")]
    Unknown {
        /// Easting, m.
        x: f64,
        /// Northing, m.
        y: f64,
    },
}

/// Heights along the path, over the way travelled: x and z, m. Turns in place leave no trace; the ground goes on level at both ends.
///
/// # Errors
/// [`DriveError`] where the path leaves known ground.
pub fn profile(surface: &Surface, points: &[[f64; 2]]) -> Result<(Vec<f64>, Vec<f64>), DriveError> {
    let (mut x, mut z, mut way) = (Vec::new(), Vec::new(), 0.0);
    for pair in points.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let count = (length / SPACING).ceil() as usize;
        for k in 0..count {
            let share = k as f64 / count as f64;
            let at = [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])];
            z.push(surface.height(at).ok_or(DriveError::Unknown { x: at[0], y: at[1] })?);
            x.push(way + share * length);
        }
        way += length;
    }
    if let Some(last) = points.last() {
        z.push(surface.height(*last).ok_or(DriveError::Unknown { x: last[0], y: last[1] })?);
        x.push(way);
    }
    let (first, last) = (z.first().copied().unwrap_or(0.0), z.last().copied().unwrap_or(0.0));
    x.insert(0, -2.0 * RUN_IN);
    z.insert(0, first);
    x.push(way + 2.0 * RUN_IN);
    z.push(last);
    Ok((x, z))
}

/// The rover on ground that gives way by less than a millimetre and has this coefficient of friction.
#[must_use]
pub fn on_firm_ground(mut rover: Rover, friction: f64) -> Rover {
    rover.soil = Soil {
        cohesion: 0.0,
        friction_angle: friction.atan(),
        k_c: 0.0,
        k_phi: 1e8,
        exponent: 1.0,
        shear_modulus: 0.001,
        ..rover.soil
    };
    rover
}

/// Drives a plan with one side of `rover` under the controller `kind` at `speed` (m/s).
///
/// The plane sees neither roll nor the other side: a drive that gets stuck refutes a plan, one that arrives does not prove it.
///
/// # Errors
/// [`DriveError`] where profile, model or run fail.
pub fn driven(
    plan: &Plan,
    surface: &Surface,
    rover: Rover,
    kind: ControlKind,
    speed: f64,
) -> Result<Drive, DriveError> {
    let points: Vec<[f64; 2]> = plan.points.iter().map(|point| [point.x, point.y]).collect();
    let (x, z) = profile(surface, &points)?;
    let mut model = Model::new("planned path", rover);
    model.rover.terrain = Terrain::new(Profile::Samples(std::sync::Arc::new(Samples::new(&x, &z)?)));
    model.control.kind = kind;
    let mut run = model.start()?;
    run.inputs_mut().set("velocity_command", speed)?;
    let stride = (0.02 / run.step_size()).round().max(1.0) as u64;
    let mut summary = SummaryBuilder::default();
    while run.signals().body.x < plan.length
        && run.time() < PATIENCE * plan.length / speed
        && run.status() == Status::Running
    {
        run.advance(stride)?;
        summary.push(&run);
    }
    let reached = run.signals().body.x >= plan.length;
    let end = if reached {
        "reached".to_owned()
    } else if run.status() == Status::Running {
        "too slow".to_owned()
    } else {
        run.status().word().to_owned()
    };
    let covered = run.signals().body.x;
    let figures = summary.summary(&run);
    let energy = figures.energy_per_metre * figures.distance;
    Ok(Drive { reached, end, covered, length: plan.length, duration: run.time(), energy, slip: figures.slip })
}
