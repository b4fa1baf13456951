//! Vehicles that are built in.

use super::{Body, Environment, Link, LinkParameters, Mount, Rover, WheelMount};
use crate::effects::Effects;
use crate::motor::Motor;
use crate::soil::Soil;
use crate::terrain::Terrain;
use crate::wheel::Wheel;

/// Supply voltage of the motors, V, which are of 24 V by their data sheet.
const SUPPLY: f64 = 24.0;

/// Angle of a bogie's stops, rad: an assumption; at 45 degrees a wheel of the presets is 7 to 9 cm above the others.
const JOINT_STOP: f64 = std::f64::consts::FRAC_PI_4;

impl Rover<f64> {
    /// The planar two-wheeled rover of Iagnemma 2001, 4.4.1: 10 kg, wheels of radius 10 cm and width
    /// 15 cm, 70 cm apart, on flat ground of the soil given there. The height of the centre of mass, the
    /// pitch inertia and the motors are not in the thesis and are assumptions of the vocabulary.
    #[must_use]
    pub fn two_wheeled() -> Self {
        Self::rigid(&[-0.35, 0.35])
    }

    /// A rover whose wheels sit rigidly on the chassis at these x, rear to front, m.
    #[must_use]
    pub fn rigid(wheel_x: &[f64]) -> Self {
        let mount = |&x: &f64| WheelMount { body: 0, mount: Mount { x, z: 0.0 } };
        Self {
            environment: Environment::default(),
            body: Body::default(),
            links: Vec::new(),
            wheel: Wheel::default(),
            wheels: wheel_x.iter().map(mount).collect(),
            motor: Motor { inverse_voltage: 1.0 / SUPPLY, ..Motor::default() },
            soil: Soil::default(),
            terrain: Terrain::default(),
            effects: Effects::default(),
        }
    }

    /// One side of the six-wheeled FSRL rover of Iagnemma 2001, appendix C, as a plane sees it: half of 6.1 kg, rear
    /// wheel on the rocker, middle and front wheel on a bogie.
    ///
    /// Given there: the mass; drives of 100 oz-in (0.706 N m) and 12 rpm; 8 cm/s at that speed, hence a wheel radius of
    /// 6.4 cm; by section 4.4.2 the wheels carry 49, 35 and 16 % of the weight at rest on flat ground. Assumptions: wheel
    /// spacing 20 cm and width 6 cm, a bogie of 0.6 kg with its mass in the middle of its wheels, heights, inertias; the
    /// pivot and the centre of mass then follow from the shares of the weight. The body moves with its side's rocker
    /// (the differential is not in a plane). The wheels of 14.6 cm in section 2.4 are the single-wheel rig's. The soil is
    /// dry sand of Wong 2008: the thesis's soil of 4.4.1 does not carry wheels this narrow forward.
    #[must_use]
    pub fn fsrl() -> Self {
        let mut rover = Self::rocker_bogie();
        rover.wheel.radius = 0.064;
        rover.motor.inverse_torque_limit = 1.0 / 0.706;
        let spacing = 0.2;
        let [rear, _, front] = [0.49, 0.35, 0.16];
        let (total, bogie) = (3.05, 0.6);
        // Moments about the pivot of the bogie, then of the whole rover about the middle wheel.
        let pivot = spacing * (front * total - 0.5 * bogie) / ((1.0 - rear) * total - bogie);
        let whole = spacing * (front - rear);
        rover.body.mass = total - bogie;
        rover.body.centre_of_mass_x = (total * whole - bogie * 0.5 * spacing) / rover.body.mass;
        if let Some(link) = rover.links.first_mut() {
            link.parameters.mass = bogie;
            link.parameters.x = pivot;
            link.parameters.centre_of_mass_x = 0.5 * spacing;
        }
        rover
    }

    /// One side of a six-wheeled rocker-bogie rover after appendix C of Iagnemma 2001: half of 6.1 kg,
    /// rear wheel on the rocker, middle and front wheel on a bogie, on dry sand. Only the mass is in the thesis; wheel
    /// size, spacing and pivots are assumptions for a rover of that class.
    #[must_use]
    pub fn rocker_bogie() -> Self {
        let mut rover = Self::rigid(&[-0.2, 0.0, 0.2]);
        rover.wheel = Wheel { radius: 0.06, width: 0.06, inertia: 0.005 };
        rover.body =
            Body { mass: 2.45, pitch_inertia: 0.03, centre_of_mass_x: -0.05, centre_of_mass_z: 0.08, belly_z: 0.03 };
        let bogie = LinkParameters {
            x: 0.1,
            z: 0.05,
            mass: 0.6,
            inertia: 0.006,
            centre_of_mass_x: 0.1,
            centre_of_mass_z: 0.01,
            damping: 0.05,
            stop: JOINT_STOP,
            ..LinkParameters::default()
        };
        rover.links = vec![Link { parent: 0, parameters: bogie }];
        rover.wheels[1].body = 1;
        rover.wheels[2].body = 1;
        // Dry sand of Wong 2008: the thesis's soil does not carry wheels this narrow forward.
        rover.soil = Soil {
            cohesion: 1040.0,
            friction_angle: 28.0_f64.to_radians(),
            k_c: 990.0,
            k_phi: 1_528_430.0,
            exponent: 1.1,
            shear_modulus: 0.01,
            damping: 100.0,
            ..Soil::default()
        };
        rover
    }
}
