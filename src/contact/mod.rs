//! A wheel touching deformable soil.
//!
//! [`rolling()`] gives the forces at a sinkage, a speed and a rate of turning: the full stress integrals.
//! [`touch`] is the contact that the rover's dynamics use: the same, with normal damping, and with static
//! friction at standstill so that a parked rover stays.

mod flattened;
mod pieces;
mod quadrature;
mod rim;
mod rolling;
mod surface;
mod touch;

pub use rolling::{Forces, rolling, rolling_on, rolling_sunk, slip};
pub use surface::Surface;
pub use touch::{Hold, Motion, Slopes, Touch, touch};
