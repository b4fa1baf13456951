//! A planned path driven by the core's planar rover.
//!
//! The path is cut where the rover turns in place, since a turn puts the wheels on other ground. Each straight stretch is driven from
//! rest over the heights under the wheels: their mean over both tracks, which a body on a differential follows in its middle plane,
//! or those of one side, which then pulls and climbs alone.

mod side;

pub use side::{Side, planar_side};

use crate::map::Surface;
use crate::robot::Robot;
use bekker::model::{ControlKind, Model, ModelError, Run, RunError, SummaryBuilder};
use bekker::modeldescription::{Lookup, ParameterError};
use bekker::rover::Rover;
use bekker::simulation::{Status, StepError};
use bekker::soil::Soil;
use bekker::terrain::{Profile, Samples, SamplesError, Terrain};

/// Spacing of the profile, m: a sixth of the smallest wheel's radius.
const SPACING: f64 = 0.01;

/// Which ground the planar rover drives over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Track {
    /// The mean of both sides' heights: what the middle plane of a rover on a differential follows.
    Mean,
    /// That of the left wheels: the side gets no help from the other.
    Left,
    /// That of the right wheels.
    Right,
}

/// Ground before and behind a stretch beyond the outermost wheels of the level rover, in wheel radii: a wheel touches up to one radius
/// ahead, and a rover that pitches reaches farther.
const BEYOND: f64 = 3.0;

/// A drive may take this many times as long as the commanded speed would: wheels slip.
const PATIENCE: f64 = 3.0;

/// Time to set off, s: a stretch may be as short as a node's spacing.
const SETTING_OFF: f64 = 5.0;

/// Where a stretch may begin, m from its start: a search for the equilibrium can fail at one place and not beside it. No farther than the
/// profile's samples lie apart.
const START_SHIFTS: [f64; 5] = [0.0, -0.005, 0.005, -0.01, 0.01];

/// How a stretch ends at whose start the rover finds no equilibrium: it slides.
const NO_STAND: &str = "cannot_stand";

/// How a driven path ended.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Drive {
    /// The ground.
    pub track: Track,
    /// Whether the end of every stretch was reached.
    pub reached: bool,
    /// Stretches without a turn.
    pub stretches: usize,
    /// Where the end of a stretch was not reached, in the order of the path.
    pub stops: Vec<Stop>,
    /// Length of the path, m.
    pub length: f64,
    /// Time on the stretches, s; turns in place take none.
    pub duration: f64,
    /// Electrical energy of all motors (twice the half rover's), J; turns in place take none.
    pub energy: f64,
    /// Mean slip of the wheels over time.
    pub slip: f64,
}

/// A stretch that was not driven to its end.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Stop {
    /// How it ended: a word of [`Status::WORDS`], `too_slow` or `cannot_stand`.
    pub end: String,
    /// Way from the start of the path, m.
    pub travelled: f64,
    /// Where the rover stopped, m.
    pub place: [f64; 2],
    /// Heading, rad.
    pub heading: f64,
}

/// A straight part of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Where it begins, m.
    pub from: [f64; 2],
    /// Heading, rad from east to north.
    pub heading: f64,
    /// Length, m.
    pub length: f64,
    /// Way on the path before it, m.
    pub travelled: f64,
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
    /// The robot has no sides.
    #[error("the robot has wheels on one side of its middle plane only; expected some on both")]
    OneSided,
    /// The path leaves the map.
    #[error("the path leaves known ground at ({x:.2}, {y:.2})")]
    Unknown {
        /// Easting, m.
        x: f64,
        /// Northing, m.
        y: f64,
    },
}

/// The straight parts of a polyline: points on one line belong together.
#[must_use]
pub fn stretches(points: &[[f64; 2]]) -> Vec<Stretch> {
    // Nodes on one line differ in direction by rounding only.
    const ONE_LINE: f64 = 1e-6;
    let mut all: Vec<Stretch> = Vec::new();
    for pair in points.windows(2) {
        let (dx, dy) = (pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]);
        let (length, heading) = (dx.hypot(dy), dy.atan2(dx));
        if length == 0.0 {
            continue;
        }
        let travelled = all.last().map_or(0.0, |last| last.travelled + last.length);
        match all
            .last_mut()
            .filter(|last| (heading - last.heading).sin().abs() < ONE_LINE && (heading - last.heading).cos() > 0.0)
        {
            Some(last) => last.length += length,
            None => all.push(Stretch { from: pair[0], heading, length, travelled }),
        }
    }
    all
}

impl Stretch {
    /// The place after a way along it, and beside it by `across` (to the left positive), m.
    #[must_use]
    pub fn place(&self, way: f64, across: f64) -> [f64; 2] {
        let (sin, cos) = self.heading.sin_cos();
        [self.from[0] + way * cos - across * sin, self.from[1] + way * sin + across * cos]
    }
}

/// Heights along a stretch, the mean of those at the places `across` (m, to the left positive), from `behind` its start to `ahead` of
/// its end: way and height, m. Where the ground beyond the ends is unknown it goes on level.
///
/// # Errors
/// [`DriveError`] where the stretch itself leaves known ground.
pub fn profile(
    surface: &Surface,
    stretch: &Stretch,
    across: &[f64],
    [behind, ahead]: [f64; 2],
) -> Result<(Vec<f64>, Vec<f64>), DriveError> {
    let whole = stretch.length + behind + ahead;
    let count = (whole / SPACING).ceil() as usize;
    let x: Vec<f64> = (0..=count).map(|k| whole * k as f64 / count as f64 - behind).collect();
    let height = |way: f64| {
        let tracks = across.iter().map(|across| surface.height(stretch.place(way, *across)));
        tracks.sum::<Option<f64>>().map(|sum| sum / across.len() as f64)
    };
    let heights: Vec<Option<f64>> = x.iter().map(|way| height(*way)).collect();
    let hole = |(way, z): (&f64, &Option<f64>)| (z.is_none() && (0.0..=stretch.length).contains(way)).then_some(*way);
    if let Some(way) = x.iter().zip(&heights).find_map(hole) {
        let [x, y] = stretch.place(way, 0.0);
        return Err(DriveError::Unknown { x, y });
    }
    let mut last = heights.iter().flatten().next().copied().unwrap_or(0.0);
    let level_on = |z: Option<f64>| {
        last = z.unwrap_or(last);
        last
    };
    let z = heights.into_iter().map(level_on).collect();
    Ok((x, z))
}

/// The rover on ground that gives way by about a millimetre and has this coefficient of friction, as firm as a drive with control
/// periods of 10 ms runs smoothly on. A planner asks
/// [`Shear::of`](crate::force::Shear::of) what of it the wheels can use.
#[must_use]
pub fn on_firm_ground(mut rover: Rover, friction: f64) -> Rover {
    rover.soil = Soil {
        cohesion: 0.0,
        friction_angle: friction.atan(),
        k_c: 0.0,
        k_phi: 2e7,
        exponent: 1.0,
        shear_modulus: 0.001,
        ..rover.soil
    };
    rover
}

/// Drives a path with half of `robot`, whose motors hold `active`, over `track` under the controller `kind` at `speed` (m/s). Soil,
/// motor and inertia of the wheels are those of `base`.
///
/// The plane sees neither roll nor the belly between the tracks: a drive that gets stuck on the mean track refutes a plan for this
/// control, one that arrives does not prove it.
///
/// # Errors
/// [`DriveError`] where profile, model or run fail.
pub fn driven(
    points: &[[f64; 2]],
    surface: &Surface,
    half: &Half,
    track: Track,
    kind: ControlKind,
    speed: f64,
) -> Result<Drive, DriveError> {
    let parts = stretches(points);
    let length = parts.last().map_or(0.0, |last| last.travelled + last.length);
    let mut drive = Drive {
        track,
        reached: true,
        stretches: parts.len(),
        stops: Vec::new(),
        length,
        duration: 0.0,
        energy: 0.0,
        slip: 0.0,
    };
    for stretch in &parts {
        let one = drive_stretch(stretch, surface, half, track, kind, speed)?;
        drive.duration += one.time;
        drive.energy += 2.0 * one.energy;
        drive.slip += one.slip * one.time;
        if let Some(end) = one.end {
            let place = stretch.place(one.covered, 0.0);
            let (travelled, heading) = (stretch.travelled + one.covered, stretch.heading);
            drive.stops.push(Stop { end, travelled, place, heading });
        }
    }
    drive.reached = drive.stops.is_empty();
    drive.slip /= drive.duration.max(f64::MIN_POSITIVE);
    Ok(drive)
}

/// Half of a robot in the plane, and where its sides' wheels roll.
#[derive(Clone, Debug)]
pub struct Half {
    /// The planar rover.
    pub rover: Rover,
    /// Places of the left and the right wheels across the path, m, to the left positive.
    pub across: [f64; 2],
}

impl Half {
    /// Half of `robot`, whose motors hold `active`, as its left side shows it. Soil, motor and inertia of the wheels are `base`'s.
    ///
    /// # Errors
    /// [`DriveError::OneSided`] where a side has no wheels.
    pub fn new(robot: &Robot, active: &[f64], base: &Rover) -> Result<Self, DriveError> {
        let side = |side| planar_side(robot, active, side, base).ok_or(DriveError::OneSided);
        let ((rover, left), (_, right)) = (side(Side::Left)?, side(Side::Right)?);
        Ok(Self { rover, across: [left, right] })
    }
}

/// A run of the model from the start of a stretch, or from as near as the rover finds an equilibrium; none where it finds none.
fn settled(model: &mut Model) -> Result<Option<Run>, DriveError> {
    for shift in START_SHIFTS {
        model.start.x0 = shift;
        match model.start() {
            Err(RunError::Step(StepError::Settle(_))) => {}
            run => return Ok(Some(run?)),
        }
    }
    Ok(None)
}

/// What came of one stretch.
struct Stretched {
    /// How it ended where not at the end of the stretch.
    end: Option<String>,
    covered: f64,
    time: f64,
    energy: f64,
    slip: f64,
}

fn drive_stretch(
    stretch: &Stretch,
    surface: &Surface,
    half: &Half,
    track: Track,
    kind: ControlKind,
    speed: f64,
) -> Result<Stretched, DriveError> {
    let places = half.rover.wheels.iter().map(|wheel| wheel.mount.x);
    let (rear, front) = places.fold((0.0_f64, 0.0_f64), |(l, h), x| (l.min(x), h.max(x)));
    let across = match track {
        Track::Mean => &half.across[..],
        Track::Left => &half.across[..1],
        Track::Right => &half.across[1..],
    };
    let beyond = BEYOND * half.rover.wheel.radius;
    let (x, z) = profile(surface, stretch, across, [beyond - rear, beyond + front])?;
    let mut model = Model::new("planned path", half.rover.clone());
    model.rover.terrain = Terrain::new(Profile::Samples(std::sync::Arc::new(Samples::new(&x, &z)?)));
    model.control.kind = kind;
    model.control.velocity_tuned.speed = speed;
    let Some(mut run) = settled(&mut model)? else {
        return Ok(Stretched { end: Some(NO_STAND.to_owned()), covered: 0.0, time: 0.0, energy: 0.0, slip: 0.0 });
    };
    run.inputs_mut().set("velocity_command", speed)?;
    let stride = (0.02 / run.step_size()).round().max(1.0) as u64;
    let mut summary = SummaryBuilder::default();
    summary.push(&run);
    let longest = SETTING_OFF + PATIENCE * stretch.length / speed;
    while run.signals().body.x < stretch.length && run.time() < longest && run.status() == Status::Running {
        run.advance(stride)?;
        summary.push(&run);
    }
    let covered = run.signals().body.x;
    let end = match run.status() {
        _ if covered >= stretch.length => None,
        Status::Running => Some("too_slow".to_owned()),
        status => Some(status.word().to_owned()),
    };
    let (energy, slip) = (run.signals().body.electrical_energy, summary.summary(&run).slip);
    Ok(Stretched { end, covered, time: run.time(), energy, slip })
}
