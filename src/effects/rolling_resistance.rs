//! Rolling resistance of the wheel itself.

use super::{Advice, Effect, Facts, Local, Place};
use crate::scalar::{Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

/// Load at which `growth` is the share of the load, N: that of a wheel of a small rover.
const GROWTH_LOAD: f64 = 50.0;

parameters! {
    /// A wheel resists its own turning by a moment M = r N (f + g (N/50 N)^0.5) that grows with its load N: an elastic rim loses
    /// energy where it flattens, so that its pressure leads the axle (Wong 2008, 1.2), by a distance that is the same at every load
    /// in a tyre and grows with the root of the load on an elastic cylinder (Tabor 1955), and a bearing rubs in proportion to its
    /// load (Palmgren 1959). The soil has no part in it, and a lifted wheel, as which the friction of a drive is usually
    /// measured, does not show it.
    ///
    /// Torque alone shows it, not the drawbar pull or the sinkage. Two loads or more tell it from dry friction of the drive,
    /// which is the same at every load, three tell its two parts; several slips at one load tell it from the gear's efficiency and the torque's scale,
    /// which grow with the torque. A level run of a rover has neither.
    pub struct RollingResistance {
        /// Moment f of the turning wheel over its load and radius.
        coefficient: [Unit::ONE] = 0.0, 0.0..=0.2, Effect, "Wong 2008, 1.2: car tyres on a road 0.01-0.02; soft rims and plain bushings several times that";
        /// Moment of the turning wheel over its load and radius that grows with the root of the load, at a load of 50 N.
        growth: [Unit::ONE] = 0.0, 0.0..=0.3, Effect, "Tabor 1955, Proc. R. Soc. A 229: losses of an elastic cylinder grow with N^1.5; bound: assumption, 1.5 times that of the coefficient";
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for RollingResistance<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_carriage: &["torque"],
            seen_on_rover: &["wheel[1].torque"],
            typical: &[("coefficient", 0.05), ("growth", 0.03)],
            smooth_at_neutral: &["coefficient", "growth"],
            advice: const {
                &[Advice::carriage(
                    "roll the wheel freely over a hard plate under three loads and record its torque: what grows with the load is the wheel's own rolling resistance, what remains at none is friction of the drive",
                )]
            },
            ..Facts::USUAL
        }
    }

    fn surface(&self, _place: &Place<S>, local: &mut Local<S>) {
        if !self.coefficient.is_exactly(0.0) {
            local.surface.lead += self.coefficient * local.wheel.radius;
        }
        if !self.growth.is_exactly(0.0) {
            local.surface.lead_by_root += self.growth * local.wheel.radius * (1.0 / GROWTH_LOAD.sqrt());
        }
    }
}
