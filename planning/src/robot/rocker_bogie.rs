//! The six-wheeled rocker-bogie rover of appendix A.

use super::{Belly, Joint, JointKind, Link, Robot, RobotWheel};
use bekker_modeldescription::{Unit, parameters};
use std::f64::consts::PI;

parameters! {
    /// A rocker-bogie rover by the lengths of figure A.1. Rear wheel at the rocker's rear arm; middle and front wheel on a bogie
    /// at the end of the rocker's front arm; both pairs of arms at right angles, as (A.1)-(A.5) have them. The reference point is
    /// midway between the rockers' pivots, on the axis of the differential.
    pub struct RockerBogie {
        /// Rear arm of the rocker l_1, pivot to rear wheel.
        rear_arm: [Unit::METRE] = 0.229, 0.01..=10.0, Rig, "assumption: see `fsrl`";
        /// Front arm of the rocker l_2, pivot to bogie.
        front_arm: [Unit::METRE] = 0.1587, 0.01..=10.0, Rig, "assumption: see `fsrl`";
        /// Rear arm of the bogie l_3, to the middle wheel.
        bogie_rear_arm: [Unit::METRE] = 0.112, 0.01..=10.0, Rig, "assumption: see `fsrl`";
        /// Front arm of the bogie l_4, to the front wheel.
        bogie_front_arm: [Unit::METRE] = 0.1657, 0.01..=10.0, Rig, "assumption: see `fsrl`";
        /// Distance w between the planes of the left and right wheels.
        track: [Unit::METRE] = 0.3, 0.01..=10.0, Rig, "assumption: not in the thesis";
        /// Mass of everything, at the centre of mass.
        mass: [Unit::KILOGRAM] = 6.1, 0.1..=5000.0, Rig, "Iagnemma 2001, appendix C";
        /// Centre of mass along x.
        centre_of_mass_x: [Unit::METRE] = 0.0, -5.0..=5.0, Rig, "follows from the loads of 4.4.2, see `fsrl`";
        /// Centre of mass along z.
        centre_of_mass_z: [Unit::METRE] = -0.08, -5.0..=5.0, Rig, "assumption: 17 cm above the ground";
        /// Wheel radius.
        wheel_radius: [Unit::METRE] = 0.064, 0.01..=2.0, Rig, "Iagnemma 2001, appendix C: 8 cm/s at 12 rpm";
        /// Wheel width.
        wheel_width: [Unit::METRE] = 0.06, 0.005..=2.0, Rig, "assumption: as the planar `fsrl`";
        /// Largest torque of a drive, wheel side.
        wheel_torque: [Unit::NEWTON_METRE] = 0.706, 1e-3..=1e5, Rig, "Iagnemma 2001, appendix C: 100 oz-in";
        /// Length of the belly, half of it ahead of the reference point.
        belly_length: [Unit::METRE] = 0.3, 0.01..=10.0, Rig, "assumption: not in the thesis";
        /// Width of the belly.
        belly_width: [Unit::METRE] = 0.18, 0.01..=10.0, Rig, "assumption: between the wheels";
        /// Height of the belly.
        belly_z: [Unit::METRE] = -0.12, -5.0..=5.0, Rig, "assumption: a wheel's diameter above the ground";
        /// Largest angle of a rocker to each side of that on flat ground.
        rocker_limit: [Unit::RADIAN] = 0.5, 0.01..=1.5, Rig, "assumption: 29 degrees";
        /// Largest angle of a bogie to each side of that on flat ground.
        bogie_limit: [Unit::RADIAN] = 0.8, 0.01..=1.5, Rig, "assumption: 46 degrees";
    }
}

/// The FSRL rover of appendix C. Given there: mass and drives; the radius follows from its top speed. By section 4.4.2 the wheels
/// carry 49, 35 and 16 % of the weight on flat ground. With wheels 20 cm apart (as in the planar model of the core), arms at right
/// angles and the centre of mass below the axis of the differential, all arms follow from those loads.
#[must_use]
pub fn fsrl() -> Robot {
    RockerBogie::default().robot()
}

impl RockerBogie {
    /// Angles theta_1 and theta_2 on flat ground: of the rear arms of rocker and bogie, from forward, turning nose up, rad. Both
    /// point back and down.
    #[must_use]
    pub fn flat_angles(&self) -> [f64; 2] {
        // Middle and front wheel level: l_3 sin theta_2 = l_4 cos theta_2.
        let bogie = PI + (self.bogie_front_arm / self.bogie_rear_arm).atan();
        // Rear and middle wheel level: l_1 sin theta_1 - l_2 cos theta_1 = l_3 sin theta_2 (A.4).
        let arms = self.rear_arm.hypot(self.front_arm);
        let rocker = PI + (self.front_arm / self.rear_arm).atan() - (self.bogie_rear_arm * bogie.sin() / arms).asin();
        [rocker, bogie]
    }

    /// The robot. Joints 0 and 1 are the left and right rocker, 2 and 3 the bogies on them; wheels left rear, middle, front, then
    /// right. The passive coordinates are half the difference of the rockers' angles and the angles of the bogies.
    #[must_use]
    pub fn robot(&self) -> Robot {
        let [rocker, bogie] = self.flat_angles();
        let [bogie_x, bogie_z] = [-self.front_arm * rocker.sin(), self.front_arm * rocker.cos()];
        let y = 0.5 * self.track;
        // Positive turns nose up, as the angles of figure A.1.
        let joint = |name: &str, at, coordinate, factor, limit: f64| Joint {
            name: name.to_owned(),
            kind: JointKind::Revolute,
            axis: [0.0, -1.0, 0.0],
            at,
            passive: Some((coordinate, factor)),
            active: None,
            least: -limit,
            most: limit,
        };
        let link = |parent, joint| Link { parent, joint, mass: 0.0, centre_of_mass: [0.0; 3] };
        let links = vec![
            link(None, joint("left rocker", [0.0, y, 0.0], 0, 1.0, self.rocker_limit)),
            link(None, joint("right rocker", [0.0, -y, 0.0], 0, -1.0, self.rocker_limit)),
            link(Some(0), joint("left bogie", [bogie_x, y, bogie_z], 1, 1.0, self.bogie_limit)),
            link(Some(1), joint("right bogie", [bogie_x, -y, bogie_z], 2, 1.0, self.bogie_limit)),
        ];
        let rear = [self.rear_arm * rocker.cos(), self.rear_arm * rocker.sin()];
        let middle = [bogie_x + self.bogie_rear_arm * bogie.cos(), bogie_z + self.bogie_rear_arm * bogie.sin()];
        let front = [bogie_x - self.bogie_front_arm * bogie.sin(), bogie_z + self.bogie_front_arm * bogie.cos()];
        let side = |name: &str, y: f64, rocker, bogie| {
            let wheel = |place: &str, link, [x, z]: [f64; 2]| RobotWheel {
                name: format!("{name} {place}"),
                link: Some(link),
                centre: [x, y, z],
            };
            [wheel("rear", rocker, rear), wheel("middle", bogie, middle), wheel("front", bogie, front)]
        };
        Robot {
            mass: self.mass,
            centre_of_mass: [self.centre_of_mass_x, 0.0, self.centre_of_mass_z],
            belly: Some(Belly {
                rear: -0.5 * self.belly_length,
                front: 0.5 * self.belly_length,
                half_width: 0.5 * self.belly_width,
                z: self.belly_z,
            }),
            wheel_radius: self.wheel_radius,
            wheel_width: self.wheel_width,
            wheel_torque: self.wheel_torque,
            links,
            wheels: side("left", y, 0, 2).into_iter().chain(side("right", -y, 1, 3)).collect(),
        }
    }
}
