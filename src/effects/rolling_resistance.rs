//! Rolling resistance of the wheel itself.

use super::{Advice, Effect, Facts, Local, Place};
use crate::scalar::{Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// A wheel resists its own turning by a moment M = f r N that grows with its load N: an elastic rim loses energy where
    /// it flattens, so that its pressure leads the axle by f r (Wong 2008, 1.2), and a bearing rubs in proportion to its
    /// load (Palmgren 1959). The soil has no part in it, and a lifted wheel, as which the friction of a drive is usually
    /// measured, does not show it.
    ///
    /// Torque alone shows it, not the drawbar pull or the sinkage. Two loads or more tell it from dry friction of the drive,
    /// which is the same at every load; several slips at one load tell it from the gear's efficiency and the torque's scale,
    /// which grow with the torque. A level run of a rover has neither.
    pub struct RollingResistance {
        /// Moment f of the turning wheel over its load and radius.
        coefficient: [Unit::ONE] = 0.0, 0.0..=0.2, Effect, "Wong 2008, 1.2: car tyres on a road 0.01-0.02; soft rims and plain bushings several times that";
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for RollingResistance<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_carriage: &["torque"],
            seen_on_rover: &["wheel[1].torque"],
            typical: &[("coefficient", 0.05)],
            advice: const {
                &[Advice::carriage(
                    "roll the wheel freely over a hard plate under two loads and record its torque: what grows with the load is the wheel's own rolling resistance, what remains is friction of the drive",
                )]
            },
            ..Facts::USUAL
        }
    }

    fn surface(&self, _place: &Place<S>, local: &mut Local<S>) {
        if !self.coefficient.is_exactly(0.0) {
            local.surface.lead += self.coefficient * local.wheel.radius;
        }
    }
}
