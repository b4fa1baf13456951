//! Margin against tipping over, (3.6)-(3.11), with a manipulator's force and moment, (3.21)-(3.22).

use crate::pose::Pose;
use nalgebra::Vector3;

/// How near the robot is to tipping over.
#[derive(Clone, Debug, PartialEq)]
pub struct Stability {
    /// Stability angle gamma of each axis, rad; negative where the robot tips over it (3.9).
    pub angles: Vec<f64>,
    /// Contacts (indices of wheels) that are joined by each axis.
    pub axes: Vec<[usize; 2]>,
    /// The smallest angle, rad (3.11).
    pub margin: f64,
}

/// Why contacts make no support.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StabilityError {
    /// Fewer than three contacts, or all on one line.
    #[error("{contacts} contacts on one line hold no robot; expected three that span an area in plan view")]
    Line {
        /// Contacts.
        contacts: usize,
    },
}

/// Stability of a pose under the weight along -z and what a manipulator does to the robot: `force` and `moment` (N, N m, in the
/// world) act at the centre of mass; the thesis's f_m, which the manipulator exerts on its surroundings, is the opposite.
///
/// # Errors
/// [`StabilityError`] where the contacts span no area.
pub fn stability(
    pose: &Pose,
    weight: f64,
    force: Vector3<f64>,
    moment: Vector3<f64>,
) -> Result<Stability, StabilityError> {
    let points: Vec<Vector3<f64>> = pose.contacts.iter().map(|contact| contact.point - pose.centre_of_mass).collect();
    let net = force - weight * Vector3::z();
    about_axes(&points, net, moment)
}

/// The same for contact points given from the centre of mass (m), under a net force (N) and a moment (N m) there.
///
/// The tip-over axes join the contacts of the convex hull in plan view (a wheel inside it, such as a middle wheel, cannot be
/// tipped over). They run clockwise seen from above, as in the thesis.
///
/// # Errors
/// [`StabilityError`] where the contacts span no area.
pub fn about_axes(
    points: &[Vector3<f64>],
    net: Vector3<f64>,
    moment: Vector3<f64>,
) -> Result<Stability, StabilityError> {
    let hull = clockwise_hull(points);
    if hull.len() < 3 {
        return Err(StabilityError::Line { contacts: points.len() });
    }
    let axes: Vec<[usize; 2]> = (0..hull.len()).map(|k| [hull[k], hull[(k + 1) % hull.len()]]).collect();
    let angles: Vec<f64> = axes.iter().map(|[from, to]| angle(points[*from], points[*to], net, moment)).collect();
    let margin = angles.iter().copied().fold(f64::INFINITY, f64::min);
    Ok(Stability { angles, axes, margin })
}

/// Stability angle of the axis from one contact to the next.
pub(crate) fn angle(from: Vector3<f64>, to: Vector3<f64>, net: Vector3<f64>, moment: Vector3<f64>) -> f64 {
    // (3.6)-(3.7)
    let axis = (to - from).normalize();
    let across = |v: Vector3<f64>| v - axis * axis.dot(&v);
    // (3.8): from the centre of mass to the axis, at a right angle.
    let to_axis = across(to);
    let length = to_axis.norm();
    let direction = to_axis / length;
    // (3.21)-(3.22). The moment about the axis is that of a force across the axis at the distance of the centre of mass, so it is
    // divided by the length of l; (3.22) as printed divides by that of its unit vector, which is 1.
    let force = across(net) + direction.cross(&(axis * axis.dot(&moment))) / length;
    // (3.9)-(3.10): the angle is positive while the force points inside of the axis.
    let turn = direction.cross(&force).dot(&axis);
    -turn.atan2(direction.dot(&force))
}

/// Contacts on the convex hull in plan view, clockwise from above (monotone chain).
pub(crate) fn clockwise_hull(points: &[Vector3<f64>]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| points[a].x.total_cmp(&points[b].x).then(points[a].y.total_cmp(&points[b].y)));
    let turn = |a: usize, b: usize, c: usize| {
        let (u, v) = (points[b] - points[a], points[c] - points[a]);
        u.x * v.y - u.y * v.x
    };
    let chain = |order: &mut dyn Iterator<Item = usize>| {
        let mut chain: Vec<usize> = Vec::new();
        for point in order {
            while chain.len() >= 2 && turn(chain[chain.len() - 2], chain[chain.len() - 1], point) >= 0.0 {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut order.iter().copied());
    hull.extend(chain(&mut order.iter().rev().copied()));
    hull
}
