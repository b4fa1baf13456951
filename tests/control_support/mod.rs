//! Random rovers and slopes, and the optimisation problem that they pose, written down a second time: by
//! vectors in the world frame, a pseudo-inverse and dense matrices. Shares no code with `control::rtc`.
#![allow(dead_code)]

pub mod jointed;
pub mod nonnegative;

use bekker::control::{Controller, Nominal, RoughTerrainControl, Rtc, RtcOptions, Solver};
use bekker::motor::Motor;
use bekker::signals::{Command, LinkMeasurement, Measurement, Reference, WheelMeasurement};
use bekker::soil::Soil;
use bekker::wheel::Wheel;
use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Gain K of the cases, 1/s; their results by hand are for this one.
const GAIN: f64 = 10.0;

/// The two-wheeled rover of 4.4.1 with the centre of mass 0.15 m over the wheel centres.
pub fn thesis_rover() -> Nominal {
    level_rover(2)
}

/// 10 kg, 0.7 m from the rearmost to the foremost of `wheels` equally spaced wheels.
pub fn level_rover(wheels: usize) -> Nominal {
    let at = |k: usize| [0.7 * k as f64 / (wheels - 1) as f64 - 0.35, 0.0];
    Nominal {
        gravity: 9.81,
        mass: 10.0,
        centre_of_mass: [0.0, 0.15],
        wheel_centres: (0..wheels).map(at).collect(),
        wheel_bodies: vec![0; wheels],
        links: Vec::new(),
        wheel: Wheel::default(),
        motor: Motor::default(),
        soil: Soil::default(),
    }
}

/// A rover with readings, and what is asked of it.
#[derive(Clone, Debug)]
pub struct Case {
    pub nominal: Nominal,
    pub parameters: RoughTerrainControl,
    pub pitch: f64,
    pub angles: Vec<f64>,
    pub velocity: f64,
    pub goal: f64,
    /// Joint angles, rad.
    pub joints: Vec<f64>,
    pub solver: Solver,
}

impl Case {
    /// On level ground, at the wanted speed.
    pub fn level(nominal: Nominal) -> Self {
        let angles = vec![0.0; nominal.wheels()];
        let parameters = RoughTerrainControl { gain: GAIN, ..RoughTerrainControl::default() };
        let (joints, solver) = (Vec::new(), Solver::default());
        Self { nominal, parameters, pitch: 0.0, angles, velocity: 0.0, goal: 0.0, joints, solver }
    }

    /// Random rover, slopes, demand and limits; steep slopes and tight limits often, infeasible ones too.
    pub fn random(seed: u64, wheels: usize) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut nominal = level_rover(wheels);
        nominal.mass = rng.random_range(2.0..60.0);
        nominal.gravity = [9.81, 3.71, 1.62][rng.random_range(0..3)];
        nominal.centre_of_mass = [rng.random_range(-0.1..0.1), rng.random_range(0.0..0.3)];
        for centre in &mut nominal.wheel_centres {
            centre[0] += rng.random_range(-0.04..0.04);
            centre[1] += rng.random_range(-0.03..0.03);
        }
        nominal.soil.cohesion = rng.random_range(0.0..2000.0);
        nominal.soil.friction_angle = rng.random_range(0.3..0.7);
        let weight = nominal.weight();
        if rng.random_bool(0.5) {
            let share = nominal.wheel.radius * weight / wheels as f64;
            let inverse = 1.0 / (share * rng.random_range(0.02..0.5));
            nominal.motor.inverse_torque_limit = inverse.min(100.0);
        }
        let pitch = rng.random_range(-0.4..0.4);
        let angles = (0..wheels).map(|_| pitch + rng.random_range(-0.35..0.35)).collect();
        let parameters = RoughTerrainControl {
            minimum_load: weight / wheels as f64 * rng.random_range(0.01..0.6),
            margin: rng.random_range(0.0..0.3),
            gain: GAIN,
            ..RoughTerrainControl::default()
        };
        let goal = rng.random_range(-0.3..0.3);
        let velocity = goal + rng.random_range(-0.15..0.15);
        Self { nominal, parameters, pitch, angles, velocity, goal, joints: Vec::new(), solver: Solver::default() }
    }

    /// A random case whose centre of mass is high, whose drives are weak and whose wheels all ought to
    /// carry nearly the same: often not even the weight can be balanced.
    pub fn tipping(seed: u64, wheels: usize) -> Self {
        let mut case = Self::random(seed, wheels);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let share = case.nominal.weight() / wheels as f64;
        case.nominal.centre_of_mass[1] = rng.random_range(0.3..0.6);
        case.nominal.wheel.radius = 0.2; // keeps the torque limit within its bounds
        case.nominal.motor.inverse_torque_limit = (1.0 / (0.2 * share * rng.random_range(0.02..0.1))).min(100.0);
        case.parameters.minimum_load = share * rng.random_range(0.8..0.95);
        case
    }

    pub fn measurement(&self) -> Measurement {
        let wheel = |&contact_angle: &f64| WheelMeasurement { contact_angle, ..WheelMeasurement::default() };
        let wheels = self.angles.iter().map(wheel).collect();
        let links = self.joints.iter().map(|&angle| LinkMeasurement { angle, rate: 0.0 }).collect();
        Measurement { pitch: self.pitch, velocity: self.velocity, wheels, links, ..Measurement::default() }
    }

    pub fn reference(&self) -> Reference {
        Reference { velocity: self.goal }
    }

    /// The controller after one command, and the torques.
    pub fn run(&self) -> (Rtc, Vec<f64>) {
        let options = RtcOptions { solver: self.solver, ..RtcOptions::default() };
        let mut rtc = Rtc::with_options(self.nominal.clone(), self.parameters, options).expect("the case is valid");
        let mut command = Command::torque(vec![0.0; self.angles.len()]);
        rtc.command(&self.measurement(), &self.reference(), &mut command).expect("the readings are finite");
        (rtc, command.values)
    }

    /// G and f_s (4.3): sums of forces, moments r x F about the centre of mass, and one row a passive joint.
    pub fn balance(&self) -> (DMatrix<f64>, DVector<f64>) {
        self.balance_at(self.parameters.gain * (self.goal - self.velocity))
    }

    fn balance_at(&self, acceleration: f64) -> (DMatrix<f64>, DVector<f64>) {
        let nominal = &self.nominal;
        let mut g = DMatrix::zeros(3 + self.joints.len(), 2 * self.angles.len());
        let mut f = DVector::zeros(g.nrows());
        f[0] = nominal.mass * acceleration;
        f[1] = nominal.mass * nominal.gravity;
        for (k, &gamma) in self.angles.iter().enumerate() {
            let normal = nalgebra::Vector2::new(-gamma.sin(), gamma.cos());
            let point = self.wheel_centre(k) - nominal.wheel.radius * normal - self.centre_of_mass();
            for (column, force) in [(2 * k, [gamma.cos(), gamma.sin()]), (2 * k + 1, normal.into())] {
                g[(0, column)] = force[0];
                g[(1, column)] = force[1];
                g[(2, column)] = point[0] * force[1] - point[1] * force[0];
            }
        }
        for joint in 0..self.joints.len() {
            let (row, asked) = self.joint_row(joint, acceleration);
            row.into_iter().enumerate().for_each(|(column, arm)| g[(3 + joint, column)] = arm);
            f[3 + joint] = asked;
        }
        (g, f)
    }

    /// A x <= b: (4.13), (4.14), (4.16), in this order, wheel by wheel.
    pub fn limits(&self) -> (DMatrix<f64>, DVector<f64>) {
        let adhesion = self.adhesion();
        let wheels = self.angles.len();
        let usable = 1.0 - self.parameters.margin;
        let tan = usable * self.nominal.soil.friction_angle.tan();
        let inverse = self.nominal.motor.inverse_torque_limit;
        let drive = if inverse > 0.0 { 1.0 / (inverse * self.nominal.wheel.radius) } else { f64::INFINITY };
        let mut a = DMatrix::zeros(5 * wheels, 2 * wheels);
        let mut b = DVector::zeros(5 * wheels);
        for k in 0..wheels {
            let rows = [(0.0, -1.0), (1.0, 0.0), (-1.0, 0.0), (1.0, -tan), (-1.0, -tan)];
            let bounds = [-self.parameters.minimum_load, drive, drive, usable * adhesion[k], usable * adhesion[k]];
            for (row, ((traction, load), bound)) in rows.into_iter().zip(bounds).enumerate() {
                a[(5 * k + row, 2 * k)] = traction;
                a[(5 * k + row, 2 * k + 1)] = load;
                b[5 * k + row] = bound;
            }
        }
        let finite: Vec<usize> = (0..b.len()).filter(|&row| b[row].is_finite()).collect();
        (a.select_rows(&finite), b.select_rows(&finite))
    }

    /// A_i c (errata 12) at the loads of the least-norm forces that carry the weight.
    fn adhesion(&self) -> Vec<f64> {
        let nominal = &self.nominal;
        let (r, b, soil) = (nominal.wheel.radius, nominal.wheel.width, &nominal.soil);
        let (mut g, mut weight) = self.balance_at(0.0);
        let centres = || nominal.wheel_centres.iter().map(|c| c[0]);
        let half = 0.5 * (centres().fold(-1e9, f64::max) - centres().fold(1e9, f64::min));
        for row in 2..g.nrows() {
            g.row_mut(row).scale_mut(1.0 / half);
            weight[row] /= half;
        }
        let loads = g.pseudo_inverse(1e-12).expect("a pseudo-inverse exists") * weight;
        let area = |k: usize| {
            let load = loads[2 * k + 1].max(self.parameters.minimum_load);
            let k_phi = soil.k_c / b + soil.k_phi;
            let base = 3.0 * load / ((3.0 - soil.exponent) * b * k_phi * (2.0 * r).sqrt());
            let z = base.powf(2.0 / (2.0 * soil.exponent + 1.0));
            b * r * (1.0 - z.min(r) / r).acos()
        };
        (0..self.angles.len()).map(|k| area(k) * soil.cohesion).collect()
    }
}

/// An orthonormal basis of the null space of `g` and the least-norm solution of g x = f.
pub fn null_space(g: &DMatrix<f64>, f: &DVector<f64>) -> (DMatrix<f64>, DVector<f64>) {
    let gram = (g * g.transpose()).try_inverse().expect("the contact points differ");
    let particular = g.transpose() * &gram * f;
    // The rest of the unit vectors outside the rows of g spans the null space; QR by columns of size.
    let unknowns = g.ncols();
    let mut projector = DMatrix::identity(unknowns, unknowns) - g.transpose() * gram * g;
    let mut basis = DMatrix::zeros(unknowns, unknowns - g.nrows());
    for column in 0..basis.ncols() {
        let largest = (0..unknowns).max_by(|&i, &j| projector.column(i).norm().total_cmp(&projector.column(j).norm()));
        let direction = projector.column(largest.expect("there are columns")).normalize();
        projector -= &direction * (direction.transpose() * &projector);
        basis.set_column(column, &direction);
    }
    (basis, particular)
}

/// All choices of `size` of `0..count`.
pub fn choices(count: usize, size: usize) -> Vec<Vec<usize>> {
    if size == 0 {
        return vec![Vec::new()];
    }
    let mut all = Vec::new();
    for last in size - 1..count {
        for mut choice in choices(last, size - 1) {
            choice.push(last);
            all.push(choice);
        }
    }
    all
}

/// The corners of { x : g x = f, a x <= b }.
pub fn corners(
    (g, f): &(DMatrix<f64>, DVector<f64>),
    (a, b): &(DMatrix<f64>, DVector<f64>),
    tolerance: f64,
) -> Vec<DVector<f64>> {
    let (basis, start) = null_space(g, f);
    let (sides, room) = (a * &basis, b - a * &start);
    let corner = |active: Vec<usize>| {
        let point = sides.select_rows(&active).lu().solve(&room.select_rows(&active))?;
        ((&sides * &point - &room).max() <= tolerance).then(|| &start + &basis * point)
    };
    choices(b.len(), basis.ncols()).into_iter().filter_map(corner).collect()
}
