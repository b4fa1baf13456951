//! What goes in and out of the rover: commands, true signals, measurements, references.

mod measurement;

pub use measurement::{LinkMeasurement, Measurement, WheelMeasurement};

use crate::scalar::LaneAccess;
use crate::snapshot::{Moving, Reader, SnapshotError, Writer, load_all, moving_code, save_all};
use bekker_modeldescription::{Parameters, Unit, Variable, parameters};

const ANY: std::ops::RangeInclusive<f64> = f64::NEG_INFINITY..=f64::INFINITY;

parameters! {
    /// Signals of the whole rover.
    #[derive(LaneAccess)]
    pub struct BodySignals {
        /// Position of the chassis reference point along the ground.
        x: [Unit::METRE] = 0.0, ANY, Signal, "physics";
        /// Height of the chassis reference point.
        z: [Unit::METRE] = 0.0, ANY, Signal, "physics";
        /// Speed of the chassis reference point along its path, signed by its direction along x.
        velocity: [Unit::METRE_PER_SECOND] = 0.0, ANY, Signal, "physics";
        /// Pitch of the chassis, nose up positive.
        pitch: [Unit::RADIAN] = 0.0, ANY, Signal, "physics";
        /// Rate of the pitch.
        pitch_rate: [Unit::RADIAN_PER_SECOND] = 0.0, ANY, Signal, "physics";
        /// Power dissipated in the motors' windings, the thesis's measure (4.6).
        power: [Unit::WATT] = 0.0, ANY, Signal, "Iagnemma 2001 (4.6)";
        /// Electrical power drawn by the motors: dissipated plus mechanical.
        electrical_power: [Unit::WATT] = 0.0, ANY, Signal, "physics";
        /// Energy dissipated in the windings since the start.
        dissipated_energy: [Unit::JOULE] = 0.0, ANY, Signal, "integral of power";
        /// Electrical energy drawn since the start.
        electrical_energy: [Unit::JOULE] = 0.0, ANY, Signal, "integral of electrical_power";
        /// Mechanical work of the drives on the wheels since the start.
        drive_work: [Unit::JOULE] = 0.0, ANY, Signal, "integral of rim torque (after drive friction) times wheel speed";
        /// Energy that the rover has lost to the soil since the start.
        soil_loss: [Unit::JOULE] = 0.0, ANY, Signal, "integral of the contact forces' power";
        /// Energy lost to joint friction and to resistances at the chassis since the start.
        other_loss: [Unit::JOULE] = 0.0, ANY, Signal, "integral of their power";
        /// Kinetic plus potential energy of the rover.
        mechanical_energy: [Unit::JOULE] = 0.0, ANY, Signal, "physics";
    }
}

parameters! {
    /// Signals of one wheel.
    #[derive(LaneAccess)]
    pub struct WheelSignals {
        /// Wheel speed relative to the body that carries it, as an encoder sees it.
        speed: [Unit::RADIAN_PER_SECOND] = 0.0, ANY, Signal, "physics";
        /// Slip: 1 - V/(r omega) driving, r omega/V - 1 otherwise.
        slip: [Unit::ONE] = 0.0, ANY, Signal, "Onafko and Reece 1967";
        /// Sinkage along the ground's normal.
        sinkage: [Unit::METRE] = 0.0, ANY, Signal, "physics";
        /// Force of the soil along the ground's normal (2.7), damping included.
        normal_force: [Unit::NEWTON] = 0.0, ANY, Signal, "Iagnemma 2001 (2.7)";
        /// Net force of the soil along the ground's tangent (2.8).
        drawbar_pull: [Unit::NEWTON] = 0.0, ANY, Signal, "Iagnemma 2001 (2.8)";
        /// Torque of the drive on the wheel, wheel side of the gear.
        torque: [Unit::NEWTON_METRE] = 0.0, ANY, Signal, "physics";
        /// Motor current.
        current: [Unit::AMPERE] = 0.0, ANY, Signal, "Iagnemma 2001 (4.7)";
        /// Contact angle gamma: slope of the ground at the contact foot, uphill positive.
        contact_angle: [Unit::RADIAN] = 0.0, ANY, Signal, "Iagnemma 2001, 2.5";
    }
}

parameters! {
    /// Signals of one link.
    #[derive(LaneAccess)]
    pub struct LinkSignals {
        /// Angle of the joint that carries the link, nose up positive, relative to the body that carries the joint;
        /// zero in the vehicle's drawing.
        angle: [Unit::RADIAN] = 0.0, ANY, Signal, "physics";
        /// Rate of the joint's angle.
        rate: [Unit::RADIAN_PER_SECOND] = 0.0, ANY, Signal, "physics";
    }
}

/// All true signals of the rover at one instant.
#[derive(Clone, Debug, PartialEq, LaneAccess)]
pub struct Signals<S = f64> {
    /// Signals of the whole rover.
    pub body: BodySignals<S>,
    /// Signals of wheel 1..n, rear to front.
    pub wheels: Vec<WheelSignals<S>>,
    /// Signals of link 1..m; none for a rigid vehicle.
    pub links: Vec<LinkSignals<S>>,
}

impl Moving for Signals {
    fn save(&self, to: &mut Writer) {
        save_all(self, to);
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        load_all(self, from)
    }
}

impl<S: Clone + From<f64>> Signals<S> {
    /// Signals, all at their defaults, of a rover with so many wheels and links.
    #[must_use]
    pub fn of(wheels: usize, links: usize) -> Self {
        Self {
            body: BodySignals::default(),
            wheels: vec![WheelSignals::default(); wheels],
            links: vec![LinkSignals::default(); links],
        }
    }
}

impl<S: From<f64>> Default for Signals<S> {
    fn default() -> Self {
        Self { body: BodySignals::default(), wheels: Vec::new(), links: Vec::new() }
    }
}

impl<S: Copy> Parameters<S> for Signals<S> {
    fn visit(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut S)) {
        self.body.visit(prefix, f);
        for (k, wheel) in self.wheels.iter_mut().enumerate() {
            wheel.visit(&bekker_modeldescription::join(prefix, &format!("wheel[{}]", k + 1)), f);
        }
        for (k, link) in self.links.iter_mut().enumerate() {
            link.visit(&bekker_modeldescription::join(prefix, &format!("link[{}]", k + 1)), f);
        }
    }

    fn values(&self, f: &mut dyn FnMut(S)) {
        self.body.values(f);
        self.wheels.iter().for_each(|wheel| wheel.values(f));
        self.links.iter().for_each(|link| link.values(f));
    }
}

/// How the drives are commanded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Drive {
    /// Motor torques, wheel side of the gear, N m.
    #[default]
    Torque,
    /// Wheel speeds relative to the carrying body, rad/s, followed exactly.
    Speed,
}

moving_code!(Drive, "what is commanded" { Drive::Torque => 0 => Drive::Torque, Drive::Speed => 1 => Drive::Speed });

/// Command to the drives: one value a wheel, held until the next command.
#[derive(Clone, Debug, PartialEq, Moving)]
pub struct Command<S = f64> {
    /// Meaning of the values.
    pub drive: Drive,
    /// One value a wheel, rear to front: N m or rad/s.
    pub values: Vec<S>,
}

impl Command {
    /// Torque commands, N m, wheel side of the gear.
    #[must_use]
    pub fn torque(values: Vec<f64>) -> Self {
        Self { drive: Drive::Torque, values }
    }

    /// Speed commands, rad/s, relative to the carrying body.
    #[must_use]
    pub fn speed(values: Vec<f64>) -> Self {
        Self { drive: Drive::Speed, values }
    }

    /// Whether it commands `value(k)` to each wheel k.
    pub(crate) fn is(&self, drive: Drive, value: &dyn Fn(usize) -> f64) -> bool {
        self.drive == drive && self.values.iter().enumerate().all(|(k, own)| *own == value(k))
    }

    /// Commands `value(k)` to each wheel k from now on.
    pub(crate) fn set(&mut self, drive: Drive, value: &dyn Fn(usize) -> f64) {
        self.drive = drive;
        self.values.iter_mut().enumerate().for_each(|(k, own)| *own = value(k));
    }
}

/// What the rover is asked to do.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Reference {
    /// Desired speed of the body along its path, m/s.
    pub velocity: f64,
}
