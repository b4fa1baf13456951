//! Parameters of rough-terrain control with wheel-speed loops.

use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// Rough-terrain control with wheel-speed loops, whose gains are those of velocity control.
    pub struct SpeedRoughTerrainControl {
        /// Gain K of the acceleration K (v_desired - v) that the force distribution counts with.
        gain: [Unit::PER_SECOND] = 0.5, 0.0..=1e3, Fixed, "assumption: 2 s, longer than the loops of the wheels need to follow";
        /// Gain of the wanted speed on the integral of v_desired - v, against slip that the soil model does not foresee.
        integral_gain: [Unit::PER_SECOND] = 0.05, 0.0..=100.0, Fixed, "assumption: 20 s, slower than hills come";
        /// Time constant with which the rims' mean speed follows the slip: until then the body slows down where slip grows, which
        /// takes less energy than to hold its speed there; 0 holds it.
        rim_time: [Unit::SECOND] = 20.0, 0.0..=1e4, Fixed, "assumption: slower than hills come";
        /// Contact angle C above which traction counts instead of power (4.11).
        switch_angle: [Unit::RADIAN] = 15.0_f64.to_radians(), 0.0..=1.6, Fixed, "Iagnemma 2001, 4.4.1";
        /// Least normal force asked of every wheel, for N_i > 0 (4.13).
        minimum_load: [Unit::NEWTON] = 0.2, 1e-3..=1e5, Fixed, "assumption: 2 % of a wheel of 10 N, the lightest built in";
        /// Growth n_1 of the sinkage exponent with slip that the controller believes in.
        slip_sinkage: [Unit::ONE] = 0.0, 0.0..=1.5, Fixed, "neutral; Ding et al. 2011, J. Terramechanics 48: 0.35-0.5";
        /// Height of the lugs in the controller's model of the soil, which the lugs shear at their tips.
        lug_height: [Unit::METRE] = 0.0, 0.0..=0.03, Fixed, "neutral; vehicle drawing: 5-15 mm on small wheels";
        /// Speed of the body under which it creeps.
        creep: [Unit::METRE_PER_SECOND] = 0.01, 1e-4..=1.0, Fixed, "assumption: a tenth to a quarter of what rovers drive at";
        /// Time constant of the filter on the slips.
        slip_filter: [Unit::SECOND] = 0.1, 0.0..=10.0, Fixed, "assumption: ten periods";
        /// Time constant with which the body's speed in the limit of the wheel speeds decreases: where a wheel meets a slope the
        /// body slows down briefly, and wheels slowed down with it would lose the pull that it needs; 0 takes the measured speed.
        speed_hold: [Unit::SECOND] = 0.3, 0.0..=10.0, Fixed, "assumption: falls from 6 cm/s to the creeping speed in 0.54 s; tried on walls of sand";
        /// How long the body may creep on digging soil before it backs off.
        patience: [Unit::SECOND] = 2.0, 0.0..=1e3, Fixed, "assumption: longer than a start takes";
        /// How long it backs off; 0 never.
        back_off: [Unit::SECOND] = 2.0, 0.0..=1e3, Fixed, "assumption: a contact's length at a few centimetres a second";
    }
}
