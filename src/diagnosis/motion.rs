//! How the model's rover moves in a recorded drive: what a page shows beside the measured signals.

use super::free::Free;
use super::layout::Layout;
use super::prediction::PredictionError;
use super::problem::Problem;
use crate::measurement::{Experiment, Kind};
use crate::model::Model;
use crate::rover::Rover;
use crate::rover::kinematics::Frames;
use bekker_modeldescription::Parameters;
use std::borrow::Cow;
use std::ops::Range;

/// The model's rover in one run of a traverse, row by row in SI units; NaN in rows without an answer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Motion {
    /// Rows of each window, which begins from the measured state; one for the whole run where it was not cut.
    pub windows: Vec<Range<usize>>,
    /// x, z (m) and pitch (rad) of the chassis reference point.
    pub chassis: Vec<[f64; 3]>,
    /// x and z of each wheel's centre, m, by row and wheel.
    pub centres: Vec<Vec<[f64; 2]>>,
    /// Radius of the wheels, m.
    pub radius: f64,
    /// Slip of each wheel, by wheel and row.
    pub slip: Vec<Vec<f64>>,
    /// Force of the soil along the ground's normal on each wheel, N, by wheel and row.
    pub load: Vec<Vec<f64>>,
    /// Angle of the line from the ground under the hindmost wheel to that under the foremost, rad, rising along x positive.
    pub slope: Vec<f64>,
    /// Height of the ground over the chassis reference point, m.
    pub ground: Vec<f64>,
}

/// How the model moves in each run with `effects` added and its free parameters at `values`; empty for a kind of experiment in
/// which nothing drives, of several experiments, and where the simulations were asked to end.
///
/// # Errors
/// [`PredictionError`] where the model cannot be placed on the experiment's runs.
pub(crate) fn motions(problem: &Problem, effects: &[String], values: &[f64]) -> Result<Vec<Motion>, PredictionError> {
    if problem.experiment.kind != Kind::Traverse || !problem.experiment.parts.is_empty() {
        return Ok(Vec::new());
    }
    let free = problem.free(effects);
    let mut shown = problem.shown().into_owned();
    shown.experiment = Cow::Owned(with_signals_of_the_motion(problem));
    shown.layout = Layout::unmeasured(&shown.experiment);
    let answers = match shown.predict(&free, |predict| predict.answers(values))? {
        Err(PredictionError::Interrupted) => return Ok(Vec::new()),
        answers => answers?,
    };
    let runs = 0..problem.experiment.runs.len();
    Ok(runs.map(|run| motion(&shown, run, &model(&shown, run, &free, values), &answers.values)).collect())
}

/// The experiment as if only what tells the motion had been measured, by perfect sensors.
fn with_signals_of_the_motion(problem: &Problem) -> Experiment {
    let mut experiment = (*problem.experiment).clone();
    experiment.sensors.clear();
    for (run, model) in experiment.runs.iter_mut().zip(&problem.models) {
        let links = (1..=model.rover.links.len()).map(|link| format!("link[{link}].angle"));
        let wheels = 1..=model.rover.wheels.len();
        let of_wheels = |field: &'static str| wheels.clone().map(move |wheel| format!("wheel[{wheel}].{field}"));
        let chassis = ["x", "z", "pitch"].map(str::to_owned);
        run.measured =
            chassis.into_iter().chain(links).chain(of_wheels("slip")).chain(of_wheels("normal_force")).collect();
    }
    experiment
}

/// The model of a run with these values of its free parameters; what the run itself states holds against them.
fn model(problem: &Problem, run: usize, free: &[Free], values: &[f64]) -> Model {
    let mut model = problem.models[run].clone();
    let own = &problem.experiment.runs[run].parameters;
    model.visit("", &mut |variable, place| {
        let at = free.iter().position(|free| free.variable.name == variable.name);
        if let Some(at) = at.filter(|_| !own.contains_key(&variable.name)) {
            *place = values[at];
        }
    });
    model
}

fn motion(problem: &Problem, run: usize, model: &Model, values: &[f64]) -> Motion {
    let rover = &model.rover;
    let rows = problem.experiment.runs[run].data.rows();
    let columns: Vec<&[f64]> = problem.layout.of_run(run).map(|block| &values[block.range.clone()]).collect();
    let (links, wheels) = (rover.links.len(), rover.wheels.len());
    let column = |at: usize| columns.get(at).map_or_else(|| vec![f64::NAN; rows], |column| column.to_vec());
    let ground = Ground::of(problem, run);
    let [rear, front] = ends(rover);
    let slope = |x: f64| ((ground.height(x + front) - ground.height(x + rear)) / (front - rear)).atan();
    let positions: Vec<Vec<f64>> = (0..rows).map(|row| columns[..3 + links].iter().map(|c| c[row]).collect()).collect();
    let windows = problem.windows.get(run).map_or(&[][..], Vec::as_slice);
    Motion {
        windows: match windows {
            [] => std::iter::once(0..rows).collect(),
            _ => windows.iter().map(|window| window.rows.clone()).collect(),
        },
        chassis: positions.iter().map(|position| [position[0], position[1], position[2]]).collect(),
        centres: positions.iter().map(|position| centres(rover, position)).collect(),
        radius: rover.true_wheel().radius,
        slip: (0..wheels).map(|wheel| column(3 + links + wheel)).collect(),
        load: (0..wheels).map(|wheel| column(3 + links + wheels + wheel)).collect(),
        slope: positions.iter().map(|position| slope(position[0])).collect(),
        ground: positions.iter().map(|position| ground.height(position[0])).collect(),
    }
}

/// Places of the hindmost and of the foremost wheel along the chassis, m; of a rover with one wheel its radius to both sides.
fn ends(rover: &Rover) -> [f64; 2] {
    let places = rover.wheels.iter().map(|wheel| wheel.mount.x);
    let (rear, front) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    if front > rear { [rear, front] } else { [rear - rover.wheel.radius, front + rover.wheel.radius] }
}

/// Centres of the wheels where the coordinates of the rover are these.
fn centres(rover: &Rover, position: &[f64]) -> Vec<[f64; 2]> {
    let mut frames = Frames::new(rover);
    frames.update(rover, position, &vec![0.0; position.len()]);
    let centre = |k: usize| {
        let mount = &rover.wheels[k];
        frames.point(rover, mount.body, [mount.mount.x, mount.mount.z]).position
    };
    (0..rover.wheels.len()).map(centre).collect()
}

/// The recorded ground of a run: straight between its points and on beyond them, flat where none was recorded.
pub(crate) struct Ground<'a> {
    x: &'a [f64],
    z: &'a [f64],
}

impl<'a> Ground<'a> {
    fn of(problem: &'a Problem, run: usize) -> Self {
        let run = &problem.experiment.runs[run];
        let column = |name| run.terrain.as_ref().and_then(|table| table.column(name)).unwrap_or_default();
        Self { x: column("x"), z: column("z") }
    }

    /// Height, m.
    pub fn height(&self, x: f64) -> f64 {
        if self.x.len() < 2 {
            return if x.is_nan() { x } else { 0.0 };
        }
        let after = self.x.partition_point(|at| *at < x).clamp(1, self.x.len() - 1);
        let share = (x - self.x[after - 1]) / (self.x[after] - self.x[after - 1]);
        self.z[after - 1] + share * (self.z[after] - self.z[after - 1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_the_ground_is_straight_between_its_points_and_beyond_them() {
        let ground = Ground { x: &[0.0, 1.0, 3.0], z: &[0.0, 0.2, 0.0] };
        for (x, z) in [(0.5, 0.1), (2.0, 0.1), (-1.0, -0.2), (4.0, -0.1)] {
            assert!((ground.height(x) - z).abs() < 1e-12, "{x}");
        }
        assert!(Ground { x: &[], z: &[] }.height(2.0).abs() < f64::EPSILON);
    }

    #[test]
    fn analytic_wheels_turn_with_the_chassis() {
        let rover = Rover::two_wheeled();
        let [rear, front] = ends(&rover);
        let level = centres(&rover, &[1.0, 0.5, 0.0]);
        assert!((level[0][0] - 1.0 - rear).abs() < 1e-12 && (level[1][0] - 1.0 - front).abs() < 1e-12);
        // Nose up by 90 degrees the foremost wheel is above the hindmost.
        let up = centres(&rover, &[1.0, 0.5, std::f64::consts::FRAC_PI_2]);
        assert!((up[1][1] - up[0][1] - (front - rear)).abs() < 1e-12);
    }
}
