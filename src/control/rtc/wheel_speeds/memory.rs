//! What rough-terrain control with wheel-speed loops remembers from one command to the next.

use crate::snapshot::Moving;

/// What one wheel remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Moving)]
pub(super) struct WheelMemory {
    /// Filtered slip.
    pub slip: Option<f64>,
    /// For how long it has looked as if in the air, s.
    pub light: f64,
    pub lifted: bool,
    /// Torque commanded last, N m.
    pub torque: f64,
    /// Slip of the last force distribution, start of the next search.
    pub last_slip: f64,
    /// Load of that distribution, N; 0 before the first and in the air.
    pub last_load: f64,
}

impl WheelMemory {
    /// Slip and load of the last force distribution.
    pub fn found(&self) -> Option<[f64; 2]> {
        (self.last_load > 0.0).then_some([self.last_slip, self.last_load])
    }
}

/// How the body gets on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Moving)]
pub(super) struct Progress {
    /// What is added to the wanted speed, m/s.
    pub trim: f64,
    /// Filtered mean slip.
    pub slip: Option<f64>,
    /// For how long it has crept, s.
    pub creeps: f64,
    /// How long it still backs off, s.
    pub backs_off: f64,
    /// Speed along x that limits the wheel speeds, m/s: the measured one, but decreasing no faster than with `speed_hold`.
    pub held: f64,
    /// For how long the optimiser has given up, s.
    pub lost: f64,
}
