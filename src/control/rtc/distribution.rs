//! The planar force distribution (4.3): which contact forces balance a given body force.

use crate::control::Nominal;
use nalgebra::{Matrix3, Vector3};

/// One wheel's contact with the ground, as the controller believes it.
///
/// The contact point is the lowest point of the rim along the ground's normal, at the full radius r from
/// the wheel centre, also where the wheel has sunk: the shear stress acts on the rim, so that a torque
/// tau answers a tractive force tau/r in the balance of the wheel as well as in that of the body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contact {
    /// cos gamma, of the contact angle.
    pub cos: f64,
    /// sin gamma, of the contact angle.
    pub sin: f64,
    /// p = [p^x, p^y]: from the contact point to the centre of mass, along the ground's tangent and normal, m.
    pub arm: [f64; 2],
}

impl Contact {
    /// Contact of the wheel whose centre lies at `centre` (world axes, from the centre of mass, m) on
    /// ground of slope `angle` (rad).
    #[must_use]
    pub fn new(centre: [f64; 2], radius: f64, angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        let along = centre[0] * cos + centre[1] * sin;
        let across = centre[1] * cos - centre[0] * sin;
        Self { cos, sin, arm: [-along, radius - across] }
    }

    /// Column of G that belongs to the tractive force T: [force x, force z, moment].
    #[must_use]
    pub fn traction_column(&self) -> [f64; 3] {
        [self.cos, self.sin, self.arm[1]]
    }

    /// Column of G that belongs to the normal force N: [force x, force z, moment].
    #[must_use]
    pub fn load_column(&self) -> [f64; 3] {
        [-self.sin, self.cos, -self.arm[0]]
    }
}

/// The equations G x = f_s (4.3, 4.4) with x = [T_1, N_1, .., T_n, N_n].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Distribution {
    /// One contact a wheel, rear to front.
    pub contacts: Vec<Contact>,
    /// f_s: horizontal and vertical force that the contact forces add up to, N, and their moment about the
    /// centre of mass, nose up positive, N m.
    pub body_force: [f64; 3],
}

impl Distribution {
    /// Equations for `wheels` wheels, to be filled by [`place`](Self::place).
    #[must_use]
    pub fn new(wheels: usize) -> Self {
        Self { contacts: vec![Contact::default(); wheels], body_force: [0.0; 3] }
    }

    /// Puts the contacts where nominal geometry, pitch and contact angles (rad, rear to front) say.
    pub fn place(&mut self, nominal: &Nominal, pitch: f64, angles: impl Iterator<Item = f64>) {
        let places = nominal.wheel_centres.iter().zip(angles);
        for (contact, (centre, angle)) in self.contacts.iter_mut().zip(places) {
            *contact = Contact::new(from_centre_of_mass(nominal, *centre, pitch), nominal.wheel.radius, angle);
        }
    }

    /// Asks for the acceleration K (v_desired - v) along x, carries the weight, and keeps the balance of
    /// moments: f_s = [m K (v_desired - v), m g, 0] (errata 8 and 11). `acceleration` in m/s^2.
    pub fn demand(&mut self, nominal: &Nominal, acceleration: f64) {
        self.body_force = [nominal.mass * acceleration, nominal.weight(), 0.0];
    }

    /// Adds to f_s what a force of `resistance` N against the motion at the centre of wheel `index` takes:
    /// radial stresses act through the wheel's centre, not on the rim.
    pub fn resist(&mut self, index: usize, radius: f64, resistance: f64) {
        let contact = self.contacts[index];
        let column = [contact.cos, contact.sin, contact.arm[1] - radius];
        for (force, share) in self.body_force.iter_mut().zip(column) {
            *force += share * resistance;
        }
    }

    /// G x for `forces` = x, in the units of f_s.
    #[must_use]
    pub fn balance(&self, forces: &[f64]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (contact, pair) in self.contacts.iter().zip(forces.chunks_exact(2)) {
            let (traction, load) = (contact.traction_column(), contact.load_column());
            for (row, total) in sum.iter_mut().enumerate() {
                *total += traction[row] * pair[0] + load[row] * pair[1];
            }
        }
        sum
    }

    /// The least-norm forces G' (G G')^-1 f that balance `body_force` = f (N, N, N m), written into
    /// `forces`, with forces counted in N and moments in N times `length` m. `None` where all contact
    /// points coincide.
    pub fn least_norm(&self, body_force: [f64; 3], length: f64, forces: &mut [f64]) -> Option<()> {
        let scaled = |column: [f64; 3]| Vector3::new(column[0], column[1], column[2] / length);
        let mut gram = Matrix3::zeros();
        for contact in &self.contacts {
            for column in [scaled(contact.traction_column()), scaled(contact.load_column())] {
                gram += column * column.transpose();
            }
        }
        let multipliers = gram.cholesky()?.solve(&scaled(body_force));
        for (contact, pair) in self.contacts.iter().zip(forces.chunks_exact_mut(2)) {
            pair[0] = scaled(contact.traction_column()).dot(&multipliers);
            pair[1] = scaled(contact.load_column()).dot(&multipliers);
        }
        forces.iter().all(|force| force.is_finite()).then_some(())
    }
}

/// A point of the chassis (from its reference point, m), seen from the centre of mass along world axes.
fn from_centre_of_mass(nominal: &Nominal, point: [f64; 2], pitch: f64) -> [f64; 2] {
    let (sin, cos) = pitch.sin_cos();
    let x = point[0] - nominal.centre_of_mass[0];
    let z = point[1] - nominal.centre_of_mass[1];
    [x * cos - z * sin, x * sin + z * cos]
}
