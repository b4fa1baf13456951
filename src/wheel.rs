//! A rigid wheel.

use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// Geometry and inertia, the same for all wheels.
    pub struct Wheel {
        /// Radius r.
        radius: [Unit::METRE] = 0.1, 0.01..=2.0, Rig, "Iagnemma 2001, 4.4.1";
        /// Width b.
        width: [Unit::METRE] = 0.15, 0.005..=2.0, Rig, "Iagnemma 2001, 4.4.1";
        /// Moment of inertia about the axle, gear and rotor included.
        inertia: [Unit::KILOGRAM_METRE2] = 0.01, 1e-6..=100.0, Rig, "assumption: 0.5 kg rim plus a rotor seen through the gear";
    }
}
