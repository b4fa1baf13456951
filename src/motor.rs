//! A DC motor with gear at each wheel (4.6-4.10).

use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// Drive of one wheel; all wheels have the same.
    pub struct Motor {
        /// Gear ratio, motor turns a wheel turn; the N_i of (4.9).
        gear_ratio: [Unit::ONE] = 100.0, 1.0..=5000.0, Fixed, "assumption, not in the thesis: usual for small rovers";
        /// Torque constant K_t, motor side (4.7).
        torque_constant: [Unit::NEWTON_METRE_PER_AMPERE] = 0.0234, 1e-4..=1.0, Fixed, "assumption: a 20 W, 24 V brushed motor of 25 mm";
        /// Winding resistance R (4.6).
        resistance: [Unit::OHM] = 2.32, 0.0..=1e3, Fixed, "assumption: a 20 W, 24 V brushed motor of 25 mm";
        /// One over the largest torque, wheel side; 0 is no limit (4.14).
        inverse_torque_limit: [Unit::PER_NEWTON_METRE] = 0.0, 0.0..=100.0, Fixed, "Iagnemma 2001 (4.14)";
        /// One over the largest current; 0 is no limit.
        inverse_current_limit: [Unit::PER_AMPERE] = 0.0, 0.0..=100.0, Fixed, "amplifier data";
    }
}
