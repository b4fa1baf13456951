//! The planar force distribution (4.3): which contact forces balance a given body force.
//!
//! A passive joint carries no moment, so that a jointed vehicle has one more row a joint: the contact forces of the
//! wheels that it carries balance, about the joint, what weight and commanded acceleration of the carried bodies
//! ask for. The motors' torques are inner to these bodies, each motor sitting on the body that carries its wheel.
//! Friction of the joints and the bodies' turning are neglected: the balance is quasi-static, and a joint's damping
//! (0.05 N m s in the built-in rocker-bogie) is unknown to the controller.

use crate::control::{Nominal, Posture};
use crate::vehicle::MAX_COORDINATES;
use nalgebra::{SMatrix, SVector};

/// Most rows of the balance: three of the whole rover, one a passive joint.
const MOST_ROWS: usize = MAX_COORDINATES;

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

    /// Moments of a unit T and a unit N at `foot` (world axes, from the point about which they count, m), m.
    fn moments(&self, foot: [f64; 2]) -> [f64; 2] {
        [foot[0] * self.sin - foot[1] * self.cos, foot[0] * self.cos + foot[1] * self.sin]
    }

    /// Column of G that belongs to the normal force N: [force x, force z, moment].
    #[must_use]
    pub fn load_column(&self) -> [f64; 3] {
        [-self.sin, self.cos, -self.arm[0]]
    }
}

/// Balance of moments about one passive joint.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointBalance {
    /// Which wheels it carries, itself or through other joints.
    pub carries: Vec<bool>,
    /// Arms of (T_i, N_i) about the joint, nose up positive, m; zero for wheels that the joint does not carry.
    pub arms: Vec<[f64; 2]>,
    /// Moment that the contact forces add up to, nose up positive, N m.
    pub moment: f64,
    /// What of that moment an acceleration of the rover along x takes away: mass times height over the joint, kg m.
    pub inertia: f64,
}

/// The equations G x = f_s (4.3, 4.4) with x = [T_1, N_1, .., T_n, N_n].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Distribution {
    /// One contact a wheel, rear to front.
    pub contacts: Vec<Contact>,
    /// f_s: horizontal and vertical force that the contact forces add up to, N, and their moment about the
    /// centre of mass, nose up positive, N m.
    pub body_force: [f64; 3],
    /// One a passive joint.
    pub joints: Vec<JointBalance>,
    /// Share of a change of the torque's force T_i = tau/r that arrives as pull at the axle, one a wheel; the soil's
    /// resistance takes the rest. 1 takes all torque for pull (4.3).
    pub yields: Vec<f64>,
    /// Change of the pull at the axle per newton of load under the same torque, one a wheel; negative where the resistance grows
    /// faster than the thrust. 0: the resistance does not depend on the load.
    pub load_yields: Vec<f64>,
    /// Wheel radius, m.
    radius: f64,
    /// Where the bodies are.
    posture: Posture,
    /// Sine and cosine of the pitch.
    heading: (f64, f64),
}

impl Distribution {
    /// Equations for the nominal rover, to be filled by [`place`](Self::place).
    #[must_use]
    pub fn new(nominal: &Nominal) -> Self {
        let wheels = nominal.wheels();
        let joint = |link: usize| JointBalance {
            carries: nominal.wheel_bodies.iter().map(|&body| nominal.carries(link, body)).collect(),
            arms: vec![[0.0; 2]; wheels],
            moment: 0.0,
            inertia: 0.0,
        };
        Self {
            contacts: vec![Contact::default(); wheels],
            body_force: [0.0; 3],
            joints: (0..nominal.links.len()).map(joint).collect(),
            yields: vec![1.0; wheels],
            load_yields: vec![0.0; wheels],
            radius: nominal.wheel.radius,
            posture: Posture::new(nominal),
            heading: (0.0, 1.0),
        }
    }

    /// Number of equations.
    #[must_use]
    pub fn rows(&self) -> usize {
        3 + self.joints.len()
    }

    /// Puts the contacts where nominal geometry, pitch, joint angles and contact angles (rad, rear to front) say.
    pub fn place(
        &mut self,
        nominal: &Nominal,
        pitch: f64,
        joint_angles: impl Iterator<Item = f64>,
        angles: impl Iterator<Item = f64>,
    ) {
        self.posture.update(nominal, pitch, joint_angles);
        self.heading = pitch.sin_cos();
        self.yields.fill(1.0);
        self.load_yields.fill(0.0);
        for (k, angle) in angles.enumerate().take(self.contacts.len()) {
            let centre = self.posture.point(nominal.wheel_bodies[k], nominal.wheel_centres[k]);
            let contact = Contact::new(centre, nominal.wheel.radius, angle);
            self.contacts[k] = contact;
            let foot = [centre[0] + nominal.wheel.radius * contact.sin, centre[1] - nominal.wheel.radius * contact.cos];
            for (j, joint) in self.joints.iter_mut().enumerate() {
                if joint.carries[k] {
                    let pivot = self.posture.joint(j);
                    joint.arms[k] = contact.moments([foot[0] - pivot[0], foot[1] - pivot[1]]);
                }
            }
        }
    }

    /// Asks for the acceleration K (v_desired - v) along x, carries the weight, and keeps the balance of
    /// moments: f_s = [m K (v_desired - v), m g, 0] (errata 8 and 11). `acceleration` in m/s^2.
    pub fn demand(&mut self, nominal: &Nominal, acceleration: f64) {
        self.body_force = [nominal.mass * acceleration, nominal.weight(), 0.0];
        for (j, joint) in self.joints.iter_mut().enumerate() {
            let (mass, [x, z]) = self.posture.carried(j);
            joint.moment = mass * (x * nominal.gravity - z * acceleration);
            joint.inertia = mass * z;
        }
    }

    /// Adds to f_s what a force of `resistance` N against the motion at the centre of wheel `index` takes:
    /// radial stresses act through the wheel's centre, not on the rim.
    pub fn resist(&mut self, index: usize, radius: f64, resistance: f64) {
        let contact = self.contacts[index];
        let column = [contact.cos, contact.sin, contact.arm[1] - radius];
        for (force, share) in self.body_force.iter_mut().zip(column) {
            *force += share * resistance;
        }
        for joint in &mut self.joints {
            if joint.carries[index] {
                joint.moment += (joint.arms[index][0] - radius) * resistance;
            }
        }
    }

    /// Row `row` of G at wheel `wheel`: the coefficients of T_i and N_i, where [`yields`](Self::yields) of T_i and
    /// [`load_yields`](Self::load_yields) of N_i pull at the axle and all of T_i turns the body. Rows 0..3 are those of the whole rover.
    #[must_use]
    pub fn coefficients(&self, row: usize, wheel: usize) -> [f64; 2] {
        let [traction, load] = self.rim_coefficients(row, wheel);
        let (lost, gained) = (1.0 - self.yields[wheel], self.load_yields[wheel]);
        if lost == 0.0 && gained == 0.0 {
            return [traction, load];
        }
        let axle = self.axle_coefficient(row, wheel);
        [traction - lost * axle, load + gained * axle]
    }

    /// Coefficient of a force along the ground at the axle of wheel `wheel` in row `row`.
    #[must_use]
    pub fn axle_coefficient(&self, row: usize, wheel: usize) -> f64 {
        let contact = &self.contacts[wheel];
        match row {
            0 => contact.cos,
            1 => contact.sin,
            2 => contact.arm[1] - self.radius,
            _ if self.joints[row - 3].carries[wheel] => self.joints[row - 3].arms[wheel][0] - self.radius,
            _ => 0.0,
        }
    }

    /// The chassis reference point from the centre of mass, world axes, m.
    pub(super) fn reference(&self) -> [f64; 2] {
        self.posture.point(0, [0.0; 2])
    }

    /// Place along x of the contact point of wheel `wheel` from the chassis reference point, m.
    pub(crate) fn foot(&self, wheel: usize) -> f64 {
        let Contact { cos, sin, arm: [along, across] } = self.contacts[wheel];
        across * sin - along * cos - self.reference()[0]
    }

    /// Those of all wheels, rear to front.
    pub(crate) fn feet(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.contacts.len()).map(|wheel| self.foot(wheel))
    }

    /// Sine and cosine of the pitch.
    pub(super) fn heading(&self) -> (f64, f64) {
        self.heading
    }

    /// The same as [`coefficients`](Self::coefficients) for a force T_i that acts on the rim as a whole (4.3).
    #[must_use]
    pub fn rim_coefficients(&self, row: usize, wheel: usize) -> [f64; 2] {
        let contact = &self.contacts[wheel];
        match row {
            0..3 => [contact.traction_column()[row], contact.load_column()[row]],
            _ => self.joints[row - 3].arms[wheel],
        }
    }

    /// Right-hand side of row `row`: N, N, N m, and N m for every joint.
    #[must_use]
    pub fn wanted(&self, row: usize) -> f64 {
        if row < 3 { self.body_force[row] } else { self.joints[row - 3].moment }
    }

    /// Row `row` of G x for `forces` = x, in the units of [`wanted`](Self::wanted).
    #[must_use]
    pub fn sum(&self, row: usize, forces: &[f64]) -> f64 {
        let mut total = 0.0;
        for (wheel, pair) in forces.chunks_exact(2).enumerate() {
            let [traction, load] = self.coefficients(row, wheel);
            total += traction * pair[0] + load * pair[1];
        }
        total
    }

    /// The least-norm forces G' (G G')^-1 f that carry the weight alone, of the whole and of what each joint
    /// carries, written into `forces`, N, with forces counted in N and moments in N times `length` m. `None` where
    /// the contact points do not span the rows.
    pub fn carry_weight(&self, nominal: &Nominal, length: f64, forces: &mut [f64]) -> Option<()> {
        let rows = self.rows();
        let mut right = SVector::<f64, MOST_ROWS>::zeros();
        right[1] = nominal.weight();
        for j in 0..self.joints.len() {
            let (mass, [x, _]) = self.posture.carried(j);
            right[3 + j] = mass * nominal.gravity * x / length;
        }
        let column = |wheel: usize, which: usize| {
            let scaled = |row: usize| self.coefficients(row, wheel)[which] / if row < 2 { 1.0 } else { length };
            SVector::<f64, MOST_ROWS>::from_fn(|row, _| if row < rows { scaled(row) } else { 0.0 })
        };
        let mut gram = SMatrix::<f64, MOST_ROWS, MOST_ROWS>::zeros();
        // Rows that this vehicle does not have.
        (rows..MOST_ROWS).for_each(|row| gram[(row, row)] = 1.0);
        for wheel in 0..self.contacts.len() {
            for column in [column(wheel, 0), column(wheel, 1)] {
                gram += column * column.transpose();
            }
        }
        let multipliers = gram.cholesky()?.solve(&right);
        for (wheel, pair) in forces.chunks_exact_mut(2).enumerate() {
            pair[0] = column(wheel, 0).dot(&multipliers);
            pair[1] = column(wheel, 1).dot(&multipliers);
        }
        forces.iter().all(|force| force.is_finite()).then_some(())
    }
}
