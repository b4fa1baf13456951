//! The convex programme.

use super::{Assumptions, Equilibrium, Lateral, Load, Shear};
use crate::pose::{Placing, Pose};
use crate::robot::Frames;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SupportedConeT};
use nalgebra::{DMatrix, DVector, Vector3};

/// Tolerance of the interior-point method on data of order 1.
const TOLERANCE: f64 = 1e-9;

/// Forces count as balanced, and limits as kept, to this share of the weight: two orders above the solver's tolerance, far below
/// what soil is known to.
const KEPT: f64 = 1e-6;

/// Why the programme has no answer, which is another thing than "no forces".
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ForceError {
    /// The solver stopped without an answer.
    #[error("the force programme has no answer: {0}")]
    Solver(String),
    /// A number of the load or the soil is wrong.
    #[error("{name} is {value}; expected {expected}")]
    Number {
        /// What it is.
        name: &'static str,
        /// The value.
        value: f64,
        /// What it may be.
        expected: &'static str,
    },
}

/// Forces on the wheels.
#[derive(Clone, Debug, PartialEq)]
pub struct Forces {
    /// Normal force N of each wheel, N.
    pub normal: Vec<f64>,
    /// Traction T, forward positive, N.
    pub traction: Vec<f64>,
    /// Lateral force L, to the left positive, N.
    pub lateral: Vec<f64>,
    /// Thrust in the direction of travel that they leave, N.
    pub thrust: f64,
}

/// The equations and limits of one pose. Variables: N, T, L of each wheel, thrust, then (where lateral forces are compliant) the
/// body's sideways shift and turn times the stiffness. Forces are in units of the weight.
#[derive(Clone, Debug)]
pub struct Programme {
    pub(super) wheels: usize,
    pub(super) variables: usize,
    pub(super) weight: f64,
    /// Equations: matrix and right-hand side.
    pub(super) equations: DMatrix<f64>,
    pub(super) values: DVector<f64>,
    /// Largest traction, adhesion, friction.
    pub(super) drive: f64,
    pub(super) adhesion: f64,
    pub(super) friction: f64,
}

impl Programme {
    /// The programme of a pose on ground of strength `shear`.
    ///
    /// # Errors
    /// [`ForceError::Number`] where load or strength is no number.
    pub fn new(
        placing: &Placing,
        pose: &Pose,
        load: &Load,
        shear: &Shear,
        assumptions: Assumptions,
    ) -> Result<Self, ForceError> {
        check(load, shear)?;
        let robot = placing.robot();
        let weight = robot.total_mass() * load.gravity;
        let wheels = pose.contacts.len();
        let compliant = assumptions.lateral == Lateral::Compliant;
        let variables = 3 * wheels + 1 + if compliant { 2 } else { 0 };
        let frames = Frames::new(robot, &pose.attitude, placing.active());
        let mut rows = Rows { variables, rows: Vec::new() };
        balance(&mut rows, pose, load, weight, &frames, shear.resistance);
        if assumptions.equilibrium == Equilibrium::Jointed {
            joints(&mut rows, placing, pose, load, weight, &frames);
        }
        if compliant {
            compliance(&mut rows, pose, &frames);
        }
        let equations = DMatrix::from_fn(rows.rows.len(), variables, |i, j| rows.rows[i].0[j]);
        let values = DVector::from_iterator(rows.rows.len(), rows.rows.iter().map(|row| row.1));
        Ok(Self {
            wheels,
            variables,
            weight,
            equations,
            values,
            drive: robot.wheel_torque / robot.wheel_radius / weight,
            adhesion: shear.adhesion / weight,
            friction: shear.friction,
        })
    }

    /// The forces with the largest thrust in the direction of travel, the margin; `None` where no forces hold the robot at all.
    ///
    /// # Errors
    /// [`ForceError`] where the solver gives no answer.
    pub fn largest_thrust(&self) -> Result<Option<Forces>, ForceError> {
        self.solve(-1.0)
    }

    /// The forces with the smallest thrust, the strongest braking; `None` where no forces hold the robot at all.
    ///
    /// # Errors
    /// [`ForceError`] where the solver gives no answer.
    pub fn smallest_thrust(&self) -> Result<Option<Forces>, ForceError> {
        self.solve(1.0)
    }

    /// Whether some forces leave exactly `thrust` (N) in the direction of travel. A thrust within a millionth of the weight of
    /// what is possible counts as impossible.
    ///
    /// # Errors
    /// [`ForceError`] where the solver gives no answer.
    pub fn gives(&self, thrust: f64) -> Result<bool, ForceError> {
        let slack = KEPT * self.weight;
        let reaches = self.largest_thrust()?.is_some_and(|forces| forces.thrust >= thrust + slack);
        Ok(reaches && self.smallest_thrust()?.is_some_and(|forces| forces.thrust <= thrust - slack))
    }

    /// Solves for the forces that minimise `sense` times the thrust.
    fn solve(&self, sense: f64) -> Result<Option<Forces>, ForceError> {
        let mut cost = vec![0.0; self.variables];
        cost[3 * self.wheels] = sense;
        let x = self.minimised(&cost, None)?;
        Ok(x.map(|x| self.forces(&x)))
    }

    /// The variables that minimise `cost` (one more than variables where `room` is asked for: the last is then the distance to
    /// every limit); `None` where there are none.
    pub(super) fn minimised(&self, cost: &[f64], thrust: Option<f64>) -> Result<Option<Vec<f64>>, ForceError> {
        let room = cost.len() > self.variables;
        let equations = self.equations.nrows() + usize::from(thrust.is_some());
        let mut cones = Cones { entries: Vec::new(), bounds: Vec::new() };
        for i in 0..self.equations.nrows() {
            cones.row((0..self.variables).map(|j| (j, self.equations[(i, j)])), self.values[i]);
        }
        if let Some(thrust) = thrust {
            cones.row([(3 * self.wheels, 1.0)].into_iter(), thrust / self.weight);
        }
        let distance = |size: f64| room.then_some((self.variables, size));
        let mut linear = 0;
        for k in 0..self.wheels {
            let [n, t, _] = self.columns(k);
            // N >= 0, T <= drive, -T <= drive.
            cones.row([(n, -1.0)].into_iter().chain(distance(1.0)), 0.0);
            cones.row([(t, 1.0)].into_iter().chain(distance(1.0)), self.drive);
            cones.row([(t, -1.0)].into_iter().chain(distance(1.0)), self.drive);
            linear += 3;
        }
        let around = 1.0_f64.hypot(self.friction);
        for k in 0..self.wheels {
            let [n, t, l] = self.columns(k);
            // (A c + N tan phi, T, L) in the cone of second order.
            cones.row([(n, -self.friction)].into_iter().chain(distance(around)), self.adhesion);
            cones.row([(t, -1.0)].into_iter(), 0.0);
            cones.row([(l, -1.0)].into_iter(), 0.0);
        }
        let mut kinds = vec![SupportedConeT::ZeroConeT(equations), SupportedConeT::NonnegativeConeT(linear)];
        kinds.extend((0..self.wheels).map(|_| SupportedConeT::SecondOrderConeT(3)));
        cones.solve(cost, &kinds)
    }

    /// Columns of N, T and L of a wheel.
    pub(super) fn columns(&self, wheel: usize) -> [usize; 3] {
        [wheel, self.wheels + wheel, 2 * self.wheels + wheel]
    }

    fn forces(&self, x: &[f64]) -> Forces {
        let part = |from: usize| x[from..from + self.wheels].iter().map(|f| f * self.weight).collect();
        let [n, t, l] = self.columns(0);
        Forces { normal: part(n), traction: part(t), lateral: part(l), thrust: x[3 * self.wheels] * self.weight }
    }

    /// Largest error of the equations and largest excess over a limit, in shares of the weight.
    #[must_use]
    pub fn errors(&self, forces: &Forces, shift_and_turn: [f64; 2]) -> [f64; 2] {
        let all = forces.normal.iter().chain(&forces.traction).chain(&forces.lateral).chain([&forces.thrust]);
        let mut x: Vec<f64> = all.map(|f| f / self.weight).collect();
        x.extend(shift_and_turn.iter().take(self.variables - x.len()));
        let unbalanced = (&self.equations * DVector::from_column_slice(&x) - &self.values).amax();
        let excess = (0..self.wheels).map(|k| self.excess(&x, k)).fold(f64::NEG_INFINITY, f64::max);
        [unbalanced, excess]
    }

    /// How far a wheel's forces are beyond their limits.
    pub(super) fn excess(&self, x: &[f64], wheel: usize) -> f64 {
        let [n, t, l] = self.columns(wheel).map(|column| x[column]);
        (-n).max(t.abs() - self.drive).max(t.hypot(l) - self.adhesion - self.friction * n)
    }
}

fn check(load: &Load, shear: &Shear) -> Result<(), ForceError> {
    let refuse = |name, value, expected| Err(ForceError::Number { name, value, expected });
    let in_range = |value: f64, low: f64| value.is_finite() && value >= low;
    if !(load.gravity > 0.0 && load.gravity.is_finite()) {
        return refuse("gravity", load.gravity, "a positive number");
    }
    if let Some(&value) = load.force.iter().chain(load.moment.iter()).find(|x| !x.is_finite()) {
        return refuse("a force or moment of the load", value, "a finite number");
    }
    for (name, value) in [("adhesion", shear.adhesion), ("friction", shear.friction), ("resistance", shear.resistance)]
    {
        if !in_range(value, 0.0) {
            return refuse(name, value, "0 or more");
        }
    }
    Ok(())
}

/// Equations under construction.
struct Rows {
    variables: usize,
    rows: Vec<(Vec<f64>, f64)>,
}

impl Rows {
    /// Adds an equation whose coefficients of each wheel's N, T and L are `wheel(k)`; returns it for more.
    fn add(&mut self, wheels: usize, wheel: impl Fn(usize) -> [f64; 3], value: f64) -> Option<&mut Vec<f64>> {
        let mut row = vec![0.0; self.variables];
        for k in 0..wheels {
            let [n, t, l] = wheel(k);
            (row[k], row[wheels + k], row[2 * wheels + k]) = (n, t, l);
        }
        self.rows.push((row, value));
        self.rows.last_mut().map(|(row, _)| row)
    }
}

/// Direction of each of a wheel's three forces; a driving wheel's normal force comes with the resistance to compaction.
fn directions(pose: &Pose, wheel: usize, resistance: f64) -> [Vector3<f64>; 3] {
    let contact = &pose.contacts[wheel];
    [contact.normal - resistance * contact.forward, contact.forward, contact.left]
}

/// Forces and moments about the centre of mass (A.7, with errata 7 and 8: the contact forces balance the weight).
fn balance(rows: &mut Rows, pose: &Pose, load: &Load, weight: f64, frames: &Frames, resistance: f64) {
    let wheels = pose.contacts.len();
    let travel = frames.direction(None, Vector3::x());
    let needed = Vector3::new(0.0, 0.0, 1.0) - load.force / weight;
    for axis in 0..3 {
        let row = rows.add(wheels, |k| directions(pose, k, resistance).map(|d| d[axis]), needed[axis]);
        if let Some(row) = row {
            row[3 * wheels] = -travel[axis];
        }
    }
    let arm = |k: usize| pose.contacts[k].point - pose.centre_of_mass;
    for axis in 0..3 {
        let moment = |k: usize| directions(pose, k, resistance).map(|d| arm(k).cross(&d)[axis]);
        rows.add(wheels, moment, -load.moment[axis] / weight);
    }
}

/// Virtual work of a motion of each passive coordinate, the drives holding their wheels: contact forces and the links' weights.
fn joints(rows: &mut Rows, placing: &Placing, pose: &Pose, load: &Load, weight: f64, frames: &Frames) {
    let robot = placing.robot();
    let motions: Vec<Vec<Vector3<f64>>> = robot
        .wheels
        .iter()
        .zip(&pose.contacts)
        .map(|(wheel, contact)| frames.motion(wheel.link, contact.point))
        .collect();
    for coordinate in 0..robot.passive() {
        let lifted = robot.links.iter().enumerate().map(|(k, link)| {
            let motion = frames.motion(Some(k), frames.point(Some(k), link.centre_of_mass));
            link.mass * load.gravity / weight * motion[3 + coordinate].z
        });
        let work = |k: usize| directions(pose, k, 0.0).map(|d| d.dot(&motions[k][3 + coordinate]));
        rows.add(pose.contacts.len(), work, lifted.sum());
    }
}

/// L_k = shift + turn x (how far the contact is ahead of the centre of mass).
fn compliance(rows: &mut Rows, pose: &Pose, frames: &Frames) {
    let wheels = pose.contacts.len();
    let travel = frames.direction(None, Vector3::x());
    for wheel in 0..wheels {
        let ahead = (pose.contacts[wheel].point - pose.centre_of_mass).dot(&travel);
        let row = rows.add(wheels, |k| [0.0, 0.0, if k == wheel { 1.0 } else { 0.0 }], 0.0);
        if let Some(row) = row {
            (row[3 * wheels + 1], row[3 * wheels + 2]) = (-1.0, -ahead);
        }
    }
}

/// Rows of Clarabel's A x + s = b.
struct Cones {
    entries: Vec<(usize, usize, f64)>,
    bounds: Vec<f64>,
}

impl Cones {
    fn row(&mut self, terms: impl Iterator<Item = (usize, f64)>, bound: f64) {
        let row = self.bounds.len();
        self.entries.extend(terms.filter(|(_, value)| *value != 0.0).map(|(column, value)| (row, column, value)));
        self.bounds.push(bound);
    }

    fn solve(self, cost: &[f64], kinds: &[SupportedConeT<f64>]) -> Result<Option<Vec<f64>>, ForceError> {
        let (rows, columns) = (self.bounds.len(), cost.len());
        let (i, (j, v)) = self.entries.into_iter().map(|(i, j, v)| (i, (j, v))).unzip();
        let matrix = CscMatrix::new_from_triplets(rows, columns, i, j, v);
        let quadratic = CscMatrix::zeros((columns, columns));
        let settings = DefaultSettings {
            verbose: false,
            tol_gap_abs: TOLERANCE,
            tol_gap_rel: TOLERANCE,
            tol_feas: TOLERANCE,
            ..DefaultSettings::default()
        };
        let solver = DefaultSolver::new(&quadratic, cost, &matrix, &self.bounds, kinds, settings);
        let mut solver = solver.map_err(|error| ForceError::Solver(error.to_string()))?;
        solver.solve();
        use clarabel::solver::SolverStatus as Status;
        match solver.solution.status {
            Status::Solved | Status::AlmostSolved => Ok(Some(solver.solution.x.clone())),
            Status::PrimalInfeasible | Status::AlmostPrimalInfeasible => Ok(None),
            status => Err(ForceError::Solver(format!("{status:?}"))),
        }
    }
}
