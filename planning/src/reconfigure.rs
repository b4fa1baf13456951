//! Kinematic reconfiguration: active joints put where the robot stands safest, (3.23)-(3.24).
//!
//! The ground is known by the contacts alone, as the thesis has it: each wheel stands on the plane through its contact point. Over
//! small changes of the joints the contacts and the centre of mass then move linearly; within that range the index, with a barrier at the ground below the belly,
//! is minimised, and a robot that drives does so again at every step.

use crate::pose::{Placing, Pose};
use crate::robot::Frames;
use bekker_modeldescription::{Unit, parameters};
use nalgebra::{DMatrix, SVector, Vector3};

/// Most active joints.
pub const MAX_ACTIVE: usize = 8;

/// Most steps of the descent. It ends earlier where a step changes nothing.
const STEPS: usize = 60;

/// The descent ends where the projected gradient times the step is below this share of the index.
const SETTLED: f64 = 1e-7;

/// Halvings of a step before it counts as none.
const HALVINGS: usize = 20;

type Vector = SVector<f64, MAX_ACTIVE>;

parameters! {
    /// Weights and range of the reconfiguration.
    pub struct Reconfiguration {
        /// Weight K of one over each stability angle (3.24), rad.
        stability: [Unit::RADIAN] = 1.0, 0.0..=1e3, Fixed, "assumption: the thesis gives no weights";
        /// Weight of the square of each joint's distance from its nominal value (3.24), 1/rad^2 or 1/m^2.
        excursion: [Unit::ONE] = 0.5, 0.0..=1e3, Fixed, "assumption: the thesis gives no weights";
        /// Weight of one over the belly's distance from the ground, m: interference, as a barrier.
        clearance: [Unit::METRE] = 0.002, 0.0..=1.0, Fixed, "assumption: as much as a stability angle of 1 rad at 2 mm";
        /// Largest change of a joint in one optimisation, rad or m.
        range: [Unit::RADIAN] = 0.15, 1e-3..=1.5, Fixed, "assumption: over which contacts move linearly";
    }
}

/// Contacts and centre of mass as linear functions of the active joints' changes.
#[derive(Clone, Debug)]
pub struct Stance {
    /// Contacts from the centre of mass, m, on the hull, clockwise from above.
    hull: Vec<Vector3<f64>>,
    /// Their changes with each active value.
    motion: Vec<[Vector3<f64>; MAX_ACTIVE]>,
    /// Distance of the belly from the ground now, m; infinite without a belly.
    clearance: f64,
    /// How far each of its corners rises with each active value, m.
    rise: Vec<[f64; MAX_ACTIVE]>,
    /// Values now, nominal ones, smallest and largest change.
    values: Vector,
    nominal: Vector,
    low: Vector,
    high: Vector,
    penalised: usize,
    /// Active joints.
    active: usize,
    settings: Reconfiguration,
}

/// Why a pose cannot be reconfigured.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReconfigureError {
    /// Too many active joints, or none.
    #[error("{active} active joints; expected 1 to {MAX_ACTIVE}")]
    Active {
        /// Active joints.
        active: usize,
    },
    /// The contacts do not fix the pose.
    #[error("the wheels' contacts do not fix the robot's pose, or hold it on a line only")]
    Singular,
}

/// Joints found.
#[derive(Clone, Debug, PartialEq)]
pub struct Optimum {
    /// Values of the active joints, rad or m.
    pub values: Vec<f64>,
    /// Performance index there (3.24).
    pub index: f64,
    /// Smallest stability angle that is expected there, rad.
    pub margin: f64,
}

impl Stance {
    /// The stance of a pose. The first `penalised` active joints are drawn towards their nominal values (0) by (3.24): the two
    /// shoulders of the Sample Return Rover, not its arm.
    ///
    /// # Errors
    /// [`ReconfigureError`] where joints or contacts do not fit.
    pub fn new(
        placing: &Placing,
        pose: &Pose,
        penalised: usize,
        settings: Reconfiguration,
    ) -> Result<Self, ReconfigureError> {
        let robot = placing.robot();
        let active = robot.active();
        if active == 0 || active > MAX_ACTIVE {
            return Err(ReconfigureError::Active { active });
        }
        let frames = Frames::new(robot, &pose.attitude, placing.active());
        let wheels = robot.wheels.len();
        let passive: Vec<_> = (0..wheels).map(|k| contact_motion(&frames, pose, k, Frames::motion)).collect();
        let driven: Vec<_> = (0..wheels).map(|k| contact_motion(&frames, pose, k, Frames::active_motion)).collect();
        // A contact stays on the ground: n . (dp/dq dq + dp/da da) = 0.
        let by_passive = DMatrix::from_fn(wheels, wheels, |k, j| pose.contacts[k].normal.dot(&passive[k][j]));
        let by_active = DMatrix::from_fn(wheels, active, |k, j| pose.contacts[k].normal.dot(&driven[k][j]));
        let follows = by_passive.lu().solve(&-by_active).ok_or(ReconfigureError::Singular)?;
        let moved = |passive: &[Vector3<f64>], driven: &[Vector3<f64>], j: usize| {
            let followed = passive.iter().enumerate().map(|(i, motion)| motion * follows[(i, j)]);
            followed.fold(driven[j], |sum, part| sum + part)
        };
        let mass = com_motion(robot, &frames, active);
        let of_mass: Vec<Vector3<f64>> = (0..active).map(|j| moved(&mass.0, &mass.1, j)).collect();
        let points: Vec<Vector3<f64>> = pose.contacts.iter().map(|c| c.point - pose.centre_of_mass).collect();
        let order = crate::stability::clockwise_hull(&points);
        if order.len() < 3 {
            return Err(ReconfigureError::Singular);
        }
        let motion = order.iter().map(|&k| {
            let mut columns = [Vector3::zeros(); MAX_ACTIVE];
            (0..active).for_each(|j| columns[j] = moved(&passive[k], &driven[k], j) - of_mass[j]);
            columns
        });
        let corners = robot.belly.into_iter().flat_map(|belly| {
            let corner = move |x: f64, side: f64| [x, side * belly.half_width, belly.z];
            [corner(belly.rear, -1.0), corner(belly.rear, 1.0), corner(belly.front, -1.0), corner(belly.front, 1.0)]
        });
        let rise = corners.map(|corner| {
            let at = frames.point(None, corner);
            let (passive, driven) = (frames.motion(None, at), frames.active_motion(None, at));
            let mut columns = [0.0; MAX_ACTIVE];
            (0..active).for_each(|j| columns[j] = moved(&passive, &driven, j).z);
            columns
        });
        let rise = rise.collect();
        let mut stance = Self {
            hull: order.iter().map(|&k| points[k]).collect(),
            motion: motion.collect(),
            clearance: pose.clearance,
            rise,
            values: Vector::zeros(),
            nominal: Vector::zeros(),
            low: Vector::zeros(),
            high: Vector::zeros(),
            penalised,
            active,
            settings,
        };
        for (j, ([least, most], value)) in robot.active_limits().into_iter().zip(placing.active()).enumerate() {
            stance.values[j] = *value;
            stance.low[j] = (least - value).max(-settings.range).min(0.0);
            stance.high[j] = (most - value).min(settings.range).max(0.0);
        }
        Ok(stance)
    }

    /// The performance index (3.24) after the joints have changed by `change`, and the smallest stability angle.
    #[must_use]
    pub fn index(&self, change: &[f64]) -> (f64, f64) {
        let mut full = Vector::zeros();
        full.iter_mut().zip(change).for_each(|(to, from)| *to = *from);
        self.index_at(&full)
    }

    /// Smallest and largest change of each joint.
    #[must_use]
    pub fn range(&self) -> Vec<[f64; 2]> {
        self.low.iter().zip(self.high.iter()).map(|(low, high)| [*low, *high]).collect()
    }

    fn index_at(&self, change: &Vector) -> (f64, f64) {
        let count = self.hull.len();
        let point = |k: usize| {
            let motion = &self.motion[k % count];
            (0..self.active).fold(self.hull[k % count], |sum, j| sum + motion[j] * change[j])
        };
        let (mut index, mut margin, mut from) = (0.0, f64::INFINITY, point(0));
        for k in 0..count {
            let to = point(k + 1);
            let angle = crate::stability::angle(from, to, -Vector3::z(), Vector3::zeros());
            // Beyond tipping the index is infinite, not negative.
            index += if angle > 0.0 { self.settings.stability / angle } else { f64::INFINITY };
            margin = margin.min(angle);
            from = to;
        }
        // The ground below the belly is taken to be as near to every corner as where it is nearest now.
        for rise in &self.rise {
            let clearance = (0..self.active).fold(self.clearance, |sum, j| sum + rise[j] * change[j]);
            index += if clearance > 0.0 { self.settings.clearance / clearance } else { f64::INFINITY };
        }
        let excursion = |j: usize| (self.values[j] + change[j] - self.nominal[j]).powi(2);
        index += self.settings.excursion * (0..self.penalised.min(self.active)).map(excursion).sum::<f64>();
        (index, margin)
    }

    /// The joints with the smallest index within their limits and the range: projected steepest descent with the step of Barzilai
    /// and Borwein (1988), halved where the index would not fall.
    #[must_use]
    pub fn optimised(&self) -> Optimum {
        let mut change = Vector::zeros();
        let (mut index, mut margin) = self.index_at(&change);
        let active = self.low.iter().zip(self.high.iter()).rposition(|(low, high)| low < high).map_or(0, |j| j + 1);
        if !index.is_finite() {
            // It tips, or its belly is in the ground: no slope leads out of there.
            return Optimum { values: self.values.iter().take(active).copied().collect(), index, margin };
        }
        let mut gradient = self.gradient(&change);
        let mut step = 0.05;
        for _ in 0..STEPS {
            let mut better = None;
            for _ in 0..HALVINGS {
                let next = self.within(&(change - gradient * step));
                let there = self.index_at(&next);
                if there.0 < index {
                    better = Some((next, there));
                    break;
                }
                step *= 0.5;
            }
            let Some((next, there)) = better else { break };
            let fell = index - there.0;
            let new_gradient = self.gradient(&next);
            let (moved, bent) = (next - change, new_gradient - gradient);
            let curvature = moved.dot(&bent);
            step = if curvature > 0.0 { (moved.norm_squared() / curvature).min(1.0) } else { 2.0 * step };
            (change, index, margin, gradient) = (next, there.0, there.1, new_gradient);
            if fell <= SETTLED * index {
                break;
            }
        }
        Optimum { values: (0..active).map(|j| self.values[j] + change[j]).collect(), index, margin }
    }

    fn within(&self, change: &Vector) -> Vector {
        change.zip_zip_map(&self.low, &self.high, |x, low, high| x.clamp(low, high))
    }

    /// Slopes of the index. With the weight alone (3.8)-(3.10) say gamma = -atan2(S, C) with S = a . (p x g) and C = |a| l . g, where a is
    /// the axis that ends in p, and l . g = p . g - (a . p) (a . g) / a^2.
    fn gradient(&self, change: &Vector) -> Vector {
        let (count, down) = (self.hull.len(), -Vector3::z());
        let mut gradient = Vector::zeros();
        let point = |k: usize| {
            let motion = &self.motion[k % count];
            (0..self.active).fold(self.hull[k % count], |sum, j| sum + motion[j] * change[j])
        };
        let mut from = point(0);
        for k in 0..count {
            let to = point(k + 1);
            let axis = to - from;
            let (square, along, fall) = (axis.norm_squared(), axis.dot(&to), axis.dot(&down));
            let (length, below) = (square.sqrt(), to.dot(&down) - along * fall / square);
            let (sine, cosine) = (axis.dot(&to.cross(&down)), length * below);
            let angle = -sine.atan2(cosine);
            let to_index = -self.settings.stability / (angle * angle);
            for j in 0..self.active {
                let moved = self.motion[(k + 1) % count][j];
                let turned = moved - self.motion[k][j];
                let of_sine = turned.dot(&to.cross(&down)) + axis.dot(&moved.cross(&down));
                let of_square = 2.0 * axis.dot(&turned);
                let of_below = moved.dot(&down)
                    - ((turned.dot(&to) + axis.dot(&moved)) * fall + along * turned.dot(&down)) / square
                    + along * fall * of_square / (square * square);
                let of_cosine = 0.5 * of_square / length * below + length * of_below;
                let of_angle = -(cosine * of_sine - sine * of_cosine) / (sine * sine + cosine * cosine);
                gradient[j] += to_index * of_angle;
            }
            from = to;
        }
        for rise in &self.rise {
            let clearance = (0..self.active).fold(self.clearance, |sum, j| sum + rise[j] * change[j]);
            (0..self.active).for_each(|j| gradient[j] -= self.settings.clearance * rise[j] / (clearance * clearance));
        }
        for j in 0..self.penalised.min(self.active) {
            gradient[j] += 2.0 * self.settings.excursion * (self.values[j] + change[j] - self.nominal[j]);
        }
        gradient
    }
}

/// How a wheel's contact moves with each coordinate: as the point of the rim that touches, without what the wheel turns about its
/// axle by, since on a plane another point of the rim then touches at the same place.
fn contact_motion<'a>(
    frames: &Frames<'a>,
    pose: &Pose,
    wheel: usize,
    motion: impl Fn(&Frames<'a>, Option<usize>, Vector3<f64>) -> Vec<Vector3<f64>>,
) -> Vec<Vector3<f64>> {
    let robot_wheel = frames.wheel(wheel);
    let contact = &pose.contacts[wheel];
    let of_centre = motion(frames, robot_wheel.link, frames.point(robot_wheel.link, robot_wheel.centre));
    let of_rim = motion(frames, robot_wheel.link, contact.point);
    let columns = of_centre.into_iter().zip(of_rim).map(|(centre, rim)| {
        let turned = rim - centre;
        rim - contact.forward * contact.forward.dot(&turned)
    });
    columns.collect()
}

/// How the centre of mass moves with pose coordinates and with active values.
fn com_motion(robot: &crate::robot::Robot, frames: &Frames, active: usize) -> (Vec<Vector3<f64>>, Vec<Vector3<f64>>) {
    let total = robot.total_mass();
    let body = frames.point(None, robot.centre_of_mass);
    let mut passive: Vec<Vector3<f64>> =
        frames.motion(None, body).into_iter().map(|motion| motion * (robot.mass / total)).collect();
    let mut driven = vec![Vector3::zeros(); active];
    for (k, link) in robot.links.iter().enumerate().filter(|(_, link)| link.mass > 0.0) {
        let (at, share) = (frames.point(Some(k), link.centre_of_mass), link.mass / total);
        passive.iter_mut().zip(frames.motion(Some(k), at)).for_each(|(sum, motion)| *sum += motion * share);
        driven.iter_mut().zip(frames.active_motion(Some(k), at)).for_each(|(sum, motion)| *sum += motion * share);
    }
    (passive, driven)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{ElevationMap, Interpolation, Surface};
    use crate::robot::sample_return;

    #[test]
    fn agreement_slopes_of_the_index_are_its_differences() -> Result<(), Box<dyn std::error::Error>> {
        let hilly = |x: f64, y: f64| 0.1 * x + 0.2 * y + 0.03 * (4.0 * x).sin() * (3.0 * y).cos();
        let map = ElevationMap::from_formula(81, 81, 0.05, [-2.0, -2.0], hilly)?;
        let (ground, robot) = (Surface::new(map, Interpolation::Smooth), sample_return());
        let placing = Placing::new(&robot, &ground, &[])?;
        let stance = Stance::new(&placing, &placing.pose([0.1, 0.2], 0.4, None)?, 2, Reconfiguration::default())?;
        let mut change = Vector::zeros();
        [0.02, -0.05, 0.06, -0.03, 0.04].iter().enumerate().for_each(|(j, x)| change[j] = *x);
        let slopes = stance.gradient(&change);
        // Central differences of 1e-5 rad are off by its square and by rounding over it.
        for j in 0..stance.active {
            let at = |step: f64| {
                let mut near = change;
                near[j] += step;
                stance.index_at(&near).0
            };
            let difference = (at(1e-5) - at(-1e-5)) / 2e-5;
            assert!(
                (slopes[j] - difference).abs() < 1e-6 * (1.0 + difference.abs()),
                "{j}: {} {difference}",
                slopes[j]
            );
        }
        Ok(())
    }
}
