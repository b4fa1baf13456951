//! The soil's strength under a wheel, from the core's soil and wheel.

use bekker::carriage::{Rig, SteadyError, steady_point};
use bekker::effects::Effects;
use bekker::rover::Environment;
use bekker::soil::Soil;
use bekker::wheel::Wheel;

/// Slip and wheel speed (rad/s) at which contact area and resistance are taken: driving, moderately.
const SLIP: f64 = 0.2;
const SPIN: f64 = 1.0;

/// Slip up to which strength is counted on. The shear of (2.1) builds up with displacement along the contact, so a wheel transmits
/// A c + N tan phi only where it spins; a plan that needed that would have the rover dig in where it stands.
const MOST_SLIP: f64 = 0.5;

/// Why the soil has no strength under a wheel.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ShearError {
    /// The wheel finds no steady point.
    #[error("under its share of {load:.1} N: {source}")]
    Sinks {
        /// Load on the wheel, N.
        load: f64,
        /// What the carriage says.
        source: SteadyError,
    },
    /// The load is no force.
    #[error("a load of {load} N on a wheel; expected a positive number")]
    Load {
        /// The load, N.
        load: f64,
    },
}

/// Shear limit of a contact: adhesion + friction N (A.11 with errata 12).
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Shear {
    /// Area times cohesion A c, N.
    pub adhesion: f64,
    /// tan phi.
    pub friction: f64,
    /// Drawbar pull that a driving wheel keeps less than its traction, as a share of the load: the soil's compaction.
    pub resistance: f64,
}

impl Shear {
    /// Firm ground of a coefficient of friction.
    #[must_use]
    pub fn firm(friction: f64) -> Self {
        Self { adhesion: 0.0, friction, resistance: 0.0 }
    }

    /// The limit under a wheel that carries `load` (N): the contact area is b r theta_1 with the entry angle theta_1 of the core's
    /// wheel at 20 % slip, and the resistance to compaction is what the traction T/r loses on its way to the drawbar pull. Adhesion
    /// and friction are the share of theirs that (2.1) has built up at 50 % slip.
    ///
    /// # Errors
    /// [`ShearError`] where the soil does not carry the wheel.
    pub fn of(soil: &Soil, wheel: &Wheel, load: f64) -> Result<Self, ShearError> {
        if !(load > 0.0 && load.is_finite()) {
            return Err(ShearError::Load { load });
        }
        let rig = Rig { environment: Environment::default(), wheel: *wheel, soil: *soil, effects: Effects::default() };
        let point = steady_point(&rig, load, SLIP, SPIN).map_err(|source| ShearError::Sinks { load, source })?;
        let entry = (1.0 - point.sinkage / wheel.radius).acos();
        let area = wheel.width * wheel.radius * entry;
        let resistance = (point.torque / wheel.radius - point.drawbar_pull) / load;
        let [adhesion, friction] = [area * soil.cohesion, soil.friction_angle.tan()];
        let slipping =
            steady_point(&rig, load, MOST_SLIP, SPIN).map_err(|source| ShearError::Sinks { load, source })?;
        let built_up = (slipping.torque / wheel.radius / (adhesion + friction * load)).clamp(0.0, 1.0);
        Ok(Self { adhesion: built_up * adhesion, friction: built_up * friction, resistance })
    }
}
