//! The soil's strength from what a driven wheel feels (chapter 2 of Iagnemma 2001).
//!
//! A wheel under a load W that turns with slip i needs the torque T. The modulus of the pressure-sinkage curve is
//! the unknown that the load fixes; what is left is one equation a reading in cohesion c, friction angle phi and
//! shear modulus K:
//!
//! ```text
//! T = T_c(K) c + (W - N_c(K) c) T_s(phi, K)/N_s(phi, K)
//! ```
//!
//! with N_c, T_c the load and torque of unit cohesion alone and N_s, T_s those of the pressure and its friction.
//!
//! | what | how | error |
//! |---|---|---|
//! | [`ClosedForm`] | the thesis's (2.24)-(2.26): linear stresses, c known or from pairs or least squares | phi +1.8 deg on average, without noise |
//! | [`friction_angle_at`] | the same equation with the full integrals, c and K known | none but noise |
//! | [`StrengthFilter`] | recursive on the full integrals, bounded memory, no allocation | noise; consistent (NEES 3.2 of 3) |
//! | [`fit`] | all readings at once, for reference | as the filter |
//! | [`SoilIdentifier`] | the filter in the loop: loads, slips and sinkages from a rover's sensors | and those of its inputs |
//!
//! What cannot be told apart: at one load and one slip there is one equation, so one combination of c, phi and K is
//! learned and the other two keep their prior. Loads separate c from phi (cohesion carries a share of T that does
//! not grow with W); slips separate K (at high slip the shear is developed and K no longer matters). Measured with 400
//! readings of the test wheel, the share of the prior deviation that is left in the three combinations:
//!
//! | readings | best settled | | worst settled |
//! |---|---|---|---|
//! | one load, one slip | 0.5 % | 100 % | 100 % |
//! | one load, three slips | 0.4 % | 2.5 % | 99.9 % |
//! | three loads, one slip | 0.3 % | 2.8 % | 21 % |
//! | three loads at three slips | 0.3 % | 1.7 % | 2.8 % |
//!
//! [`StrengthFilter::directions`] says which combinations the readings have settled.

mod bevameter;
mod closed_form;
mod directions;
mod equation;
mod filter;
mod fit;
mod held;
mod identifier;
mod kinematics;
mod loads;
mod parameters;
mod reading;
mod sinkage;

pub use bevameter::{
    AnnulusTest, PlateTest, PressureSinkage, ShearStrength, StrengthLine, pressure_sinkage, reduce_annulus,
    strength_line,
};
pub use closed_form::{ClosedForm, CohesionByPairs, FrictionAndCohesion, drawbar_pull};
pub use directions::Direction;
pub use equation::{Prediction, friction_angle_at, predict};
pub use filter::{StrengthFilter, Update};
pub use fit::{Fit, fit};
pub use identifier::{SoilIdentifier, WheelUse};
pub use kinematics::{KinematicSinkage, SinkageChange};
pub use parameters::SoilIdentification;
pub use reading::{Deviations, Reading, StrengthParameters};
pub use sinkage::sinkage_under_load;
