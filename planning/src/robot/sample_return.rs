//! JPL's Sample Return Rover of section 3.5: four wheels, two active shoulders, an arm of three joints.

use super::{Belly, Joint, JointKind, Link, Robot, RobotWheel};
use bekker_modeldescription::{Unit, parameters};

/// Pivot of the arm's first joint over the body's reference point and its links lie this far out, m: an assumption, for which the
/// thesis has "mounted at the front".
const ARM_AT: [f64; 3] = [0.2, 0.0, 0.05];

parameters! {
    /// The Sample Return Rover. Each side has two legs on a shoulder. The shoulder's motor opens and closes the angle between the
    /// legs; a passive differential lets the two sides rock against each other, without which four wheels could not all stand on
    /// rough ground (an assumption: the thesis names "independently controlled shoulder joints" alone).
    pub struct SampleReturn {
        /// Mass without the arm.
        mass: [Unit::KILOGRAM] = 7.0, 0.1..=5000.0, Rig, "Iagnemma 2001, 3.5.1";
        /// Mass of the arm.
        arm_mass: [Unit::KILOGRAM] = 2.25, 0.0..=1000.0, Rig, "Iagnemma 2001, 3.5.1";
        /// Length of a leg, shoulder to wheel.
        leg: [Unit::METRE] = 0.3, 0.01..=10.0, Rig, "assumption: not in the thesis";
        /// Angle of a leg to the level on flat ground.
        leg_angle: [Unit::RADIAN] = 0.6, 0.01..=1.5, Rig, "assumption: not in the thesis";
        /// Distance between the planes of the left and right wheels.
        track: [Unit::METRE] = 0.5, 0.01..=10.0, Rig, "assumption: not in the thesis";
        /// Height of the centre of mass over the shoulders.
        centre_of_mass_z: [Unit::METRE] = 0.05, -5.0..=5.0, Rig, "assumption: not in the thesis";
        /// Wheel radius.
        wheel_radius: [Unit::METRE] = 0.1, 0.01..=2.0, Rig, "assumption: not in the thesis";
        /// Wheel width.
        wheel_width: [Unit::METRE] = 0.1, 0.005..=2.0, Rig, "assumption: not in the thesis";
        /// Largest torque of a drive, wheel side.
        wheel_torque: [Unit::NEWTON_METRE] = 5.0, 1e-3..=1e5, Rig, "assumption: not in the thesis";
        /// Largest angle of a shoulder to each side of its angle on flat ground.
        shoulder_limit: [Unit::RADIAN] = 45.0_f64.to_radians(), 0.01..=1.5, Rig, "Iagnemma 2001, 3.5.2: 45 degrees";
        /// Largest rocking of a side.
        rocker_limit: [Unit::RADIAN] = 0.5, 0.01..=1.5, Rig, "assumption: not in the thesis";
        /// Length of each of the arm's two links.
        arm_link: [Unit::METRE] = 0.3, 0.01..=10.0, Rig, "assumption: not in the thesis";
    }
}

/// The rover with its default data.
#[must_use]
pub fn sample_return() -> Robot {
    SampleReturn::default().robot()
}

impl SampleReturn {
    /// The robot. Active values 0 and 1 are the left and right shoulder (positive closes the legs and lifts the side), 2 to 4 the
    /// arm: about the vertical, shoulder and elbow. Wheels left rear, front, then right.
    #[must_use]
    pub fn robot(&self) -> Robot {
        let y = 0.5 * self.track;
        let reach = self.leg * self.leg_angle.cos();
        let drop = -self.leg * self.leg_angle.sin();
        let joint = |name: String, y: f64, passive, active, limit: f64| Joint {
            name,
            kind: JointKind::Revolute,
            axis: [0.0, -1.0, 0.0],
            at: [0.0, y, 0.0],
            passive,
            active,
            least: -limit,
            most: limit,
        };
        let massless = |parent, joint| Link { parent, joint, mass: 0.0, centre_of_mass: [0.0; 3] };
        let rocker = |side: &str, y: f64, factor: f64| {
            massless(None, joint(format!("{side} rocker"), y, Some((0, factor)), None, self.rocker_limit))
        };
        let leg = |rocker: usize, name: &str, y: f64, factor: f64| {
            let shoulder = Some((rocker, factor));
            massless(Some(rocker), joint(format!("{name} leg"), y, None, shoulder, self.shoulder_limit))
        };
        let (a, l) = (ARM_AT, self.arm_link);
        // The arm is stowed along x: 60 % of its mass in the upper link, the rest in the lower one.
        let arm = |name: &str, parent, axis, at: [f64; 3], active, limit: f64, share: f64| Link {
            parent,
            joint: Joint {
                name: name.to_owned(),
                kind: JointKind::Revolute,
                axis,
                at,
                passive: None,
                active: Some((active, 1.0)),
                least: -limit,
                most: limit,
            },
            mass: share * self.arm_mass,
            centre_of_mass: [at[0] + 0.5 * l, at[1], at[2]],
        };
        let up = [0.0, 0.0, 1.0];
        let nose_up = [0.0, -1.0, 0.0];
        let links = vec![
            rocker("left", y, 1.0),
            rocker("right", -y, -1.0),
            // A leg that points back turns nose up to close towards the vertical, one that points forward nose down.
            leg(0, "left rear", y, 1.0),
            leg(0, "left front", y, -1.0),
            leg(1, "right rear", -y, 1.0),
            leg(1, "right front", -y, -1.0),
            arm("arm turn", None, up, a, 2, 2.0, 0.0),
            arm("arm shoulder", Some(6), nose_up, a, 3, 1.5, 0.6),
            arm("arm elbow", Some(7), nose_up, [a[0] + l, a[1], a[2]], 4, 2.0, 0.4),
        ];
        let wheel =
            |name: &str, link, x, y| RobotWheel { name: name.to_owned(), link: Some(link), centre: [x, y, drop] };
        Robot {
            mass: self.mass,
            centre_of_mass: [0.0, 0.0, self.centre_of_mass_z],
            belly: Some(Belly { rear: -0.2, front: 0.2, half_width: 0.15, z: -0.05 }),
            wheel_radius: self.wheel_radius,
            wheel_width: self.wheel_width,
            wheel_torque: self.wheel_torque,
            links,
            wheels: vec![
                wheel("left rear", 2, -reach, y),
                wheel("left front", 3, reach, y),
                wheel("right rear", 4, -reach, -y),
                wheel("right front", 5, reach, -y),
            ],
        }
    }
}
