//! Random vehicles with passive joints, and their balance by virtual work: rotations composed from the outermost
//! body inwards, derivatives by central differences. Shares no code with `control`.

use super::Case;
use bekker::control::{Nominal, NominalLink};
use nalgebra::{Rotation2, Vector2};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Bodies of the wheels and parents of the links, for 3 to 8 wheels: bogies on the chassis and on each other.
const TREES: [(&[usize], &[usize]); 6] = [
    (&[0, 1, 1], &[0]),
    (&[0, 1, 2, 2], &[0, 1]),
    (&[1, 1, 0, 2, 2], &[0, 0]),
    (&[1, 1, 2, 2, 3, 3], &[0, 0, 2]),
    (&[1, 1, 0, 2, 2, 3, 3], &[0, 0, 2]),
    (&[1, 1, 2, 2, 3, 3, 4, 4], &[0, 1, 0, 3]),
];

/// Step of the central differences, rad: their error is its square and rounding over it.
const STEP: f64 = 1e-5;

impl Case {
    /// A random case of 3 to 8 wheels on links.
    pub fn jointed(seed: u64, wheels: usize) -> Self {
        let mut case = Self::random(seed, wheels);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let (bodies, parents) = TREES[wheels - 3];
        let nominal = &mut case.nominal;
        nominal.wheel_bodies = bodies.to_vec();
        for (link, &parent) in parents.iter().enumerate() {
            let on = |body: usize| (body == link + 1) || (body > 0 && parents[body - 1] == link + 1);
            let xs: Vec<f64> = (0..wheels).filter(|&k| on(bodies[k])).map(|k| nominal.wheel_centres[k][0]).collect();
            let x = xs.iter().sum::<f64>() / xs.len() as f64 + rng.random_range(-0.03..0.03);
            let link = NominalLink {
                parent,
                x,
                z: rng.random_range(0.0..0.15),
                mass: nominal.mass * rng.random_range(0.02..0.1),
                centre_of_mass_x: x + rng.random_range(-0.1..0.1),
                centre_of_mass_z: rng.random_range(-0.05..0.1),
            };
            nominal.links.push(link);
        }
        case.joints = parents.iter().map(|_| rng.random_range(-0.3..0.3)).collect();
        case
    }

    /// Row of a passive joint: what a unit of every force does in a unit of its turning, m, and what weight and
    /// acceleration ask for, N m.
    pub fn joint_row(&self, joint: usize, acceleration: f64) -> (Vec<f64>, f64) {
        let turned = |by: f64| {
            let mut joints = self.joints.clone();
            joints[joint] += by;
            joints
        };
        let (ahead, behind) = (turned(STEP), turned(-STEP));
        let moved = |body: usize, reference: Vector2<f64>| {
            let there = placed(&self.nominal, self.pitch, &ahead, body, reference);
            (there - placed(&self.nominal, self.pitch, &behind, body, reference)) / (2.0 * STEP)
        };
        let mut row = Vec::new();
        for (k, &gamma) in self.angles.iter().enumerate() {
            let (tangent, normal) = (Vector2::new(gamma.cos(), gamma.sin()), Vector2::new(-gamma.sin(), gamma.cos()));
            let body = self.nominal.wheel_bodies[k];
            let centre = placed(&self.nominal, self.pitch, &self.joints, body, self.nominal.wheel_centres[k].into());
            let foot = centre - self.nominal.wheel.radius * normal;
            let velocity = moved(body, unplaced(&self.nominal, self.pitch, &self.joints, body, foot));
            row.extend([velocity.dot(&tangent), velocity.dot(&normal)]);
        }
        let pull = Vector2::new(acceleration, self.nominal.gravity);
        let asked = (1..=self.nominal.links.len()).map(|body| {
            let link = &self.nominal.links[body - 1];
            link.mass * moved(body, Vector2::new(link.centre_of_mass_x, link.centre_of_mass_z)).dot(&pull)
        });
        (row, asked.sum())
    }

    /// Centre of mass of the whole, from the chassis reference point, world axes.
    pub fn centre_of_mass(&self) -> Vector2<f64> {
        let nominal = &self.nominal;
        let mut chassis = nominal.mass * Vector2::from(nominal.centre_of_mass);
        let (mut whole, mut mass) = (Vector2::zeros(), nominal.mass);
        for (body, link) in nominal.links.iter().enumerate() {
            let centre = Vector2::new(link.centre_of_mass_x, link.centre_of_mass_z);
            chassis -= link.mass * centre;
            mass -= link.mass;
            whole += link.mass * placed(nominal, self.pitch, &self.joints, body + 1, centre);
        }
        (whole + mass * placed(nominal, self.pitch, &self.joints, 0, chassis / mass)) / nominal.mass
    }

    /// Centre of wheel `wheel`, from the chassis reference point, world axes.
    pub fn wheel_centre(&self, wheel: usize) -> Vector2<f64> {
        let reference = Vector2::from(self.nominal.wheel_centres[wheel]);
        placed(&self.nominal, self.pitch, &self.joints, self.nominal.wheel_bodies[wheel], reference)
    }
}

/// The joint and the angle of every body from `body` inwards.
fn joints_inwards(nominal: &Nominal, joints: &[f64], mut body: usize) -> Vec<(Vector2<f64>, f64)> {
    let mut path = Vec::new();
    while body > 0 {
        let link = &nominal.links[body - 1];
        path.push((Vector2::new(link.x, link.z), joints[body - 1]));
        body = link.parent;
    }
    path
}

/// Where the point of `body` that lies at `point` with all angles at zero is.
fn placed(nominal: &Nominal, pitch: f64, joints: &[f64], body: usize, point: Vector2<f64>) -> Vector2<f64> {
    let turn = |point, (pivot, angle): (Vector2<f64>, f64)| pivot + Rotation2::new(angle) * (point - pivot);
    Rotation2::new(pitch) * joints_inwards(nominal, joints, body).into_iter().fold(point, turn)
}

/// The inverse of [`placed`].
fn unplaced(nominal: &Nominal, pitch: f64, joints: &[f64], body: usize, point: Vector2<f64>) -> Vector2<f64> {
    let turn = |point, (pivot, angle): (Vector2<f64>, f64)| pivot + Rotation2::new(-angle) * (point - pivot);
    joints_inwards(nominal, joints, body).into_iter().rev().fold(Rotation2::new(-pitch) * point, turn)
}
