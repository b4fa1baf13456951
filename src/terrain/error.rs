//! What can go wrong on the ground.

/// Why a wheel has no contact foot.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TerrainError {
    /// The foot lies beyond the samples of a sampled profile.
    #[error("left the terrain at x = {x} m; it is described from {from} m to {to} m")]
    Left {
        /// Position of the foot on the straight extension of the profile, m.
        x: f64,
        /// First described position, m.
        from: f64,
        /// Last described position, m.
        to: f64,
    },
    /// The centre is further above or below the ground than any wheel can be.
    #[error("the wheel centre is {clearance} m above the ground at x = {x} m; expected at most {limit} m either way")]
    TooFar {
        /// Position of the centre, m.
        x: f64,
        /// Height of the centre above the profile, m.
        clearance: f64,
        /// Largest allowed distance, m.
        limit: f64,
    },
    /// The centre is not a pair of finite numbers.
    #[error("the wheel centre [{x}, {z}] m is not finite")]
    NotFinite {
        /// Position of the centre along the ground, m.
        x: f64,
        /// Height of the centre, m.
        z: f64,
    },
}
