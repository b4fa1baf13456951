//! Contact angles of all wheels from pitch, wheel speeds and the angles of the joints (2.5).
//!
//! Two points at a fixed distance whose speeds are known tell in which directions they move: those are the contact
//! angles of rigid wheels on firm ground, and the thesis's "effective" ones on soil (figure 2.19).
//!
//! - [`direct`](direct()) solves one reading, (2.29)-(2.37) corrected; at rest and in translation it says that there
//!   is no solution.
//! - [`PairFilter`] is the extended Kalman filter of one pair (2.5.1, appendix D).
//! - [`ProfileFilter`] takes all wheels to cross one smooth ground: what the front wheel's readings tell of it serves again
//!   when the rear wheel gets there.
//! - [`ContactAngles`] chooses the pairs of a rover from its structure, and the filter.
//!
//! The speed of a wheel's centre is taken from its encoder as v = r (omega - rate of the carrying body)(1 - slip). Slip
//! that is not known biases it: where all wheels slip alike by i, the ratio v_2/v_1 stays and l alpha'/v comes out
//! too small by 1 - i, and with it, to first order, the angles between the directions of travel and the line.

mod direct;
mod equation;
mod filter;
mod pairs;
mod parameters;
mod process;
mod profile;
mod rover;
mod shape;
mod singly;
mod window;

pub use direct::{DirectSolution, IllConditioned, PairMotion, PairNoise, direct};
pub use filter::{Covariance, Innovation, PairFilter, PairModel, PairReading, State};
pub use pairs::{Pair, Point};
pub use parameters::ContactAngleEstimation;
pub use profile::{ProfileFilter, ProfileModel, ProfileReading};
pub use rover::ContactAngles;
