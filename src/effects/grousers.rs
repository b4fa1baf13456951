//! Lugs on the rim.

use super::{Effect, Facts, Header, Local, Place, SOIL_TEST};
use crate::scalar::{Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// Lugs hold the soil between them, so it is sheared at r + lambda h (Ding et al. 2011), and along the lugs' sides:
    /// Bekker's c (1 + 2 h/b) and tan phi (1 + 0.64 (h/b) acot(h/b)) (Bekker 1956, for spuds of a track).
    pub struct Grousers {
        /// Height h of the lugs.
        height: [Unit::METRE] = 0.0, 0.0..=0.03, Effect, "vehicle drawing: 5-15 mm on small wheels";
        /// Share lambda of the height at which the soil is sheared.
        share: [Unit::ONE] = 1.0, 0.0..=1.0, Fixed, "Ding et al. 2011, J. Terramechanics 48: up to 1 where the lugs stand close";
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for Grousers<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_carriage: &["drawbar_pull", "torque", "sinkage"],
            seen_on_rover: &["wheel[1].torque"],
            advice: &[SOIL_TEST],
            headers: &[
                Header { words: &["grouser", "height"], parameter: "height" },
                Header { words: &["lug", "height"], parameter: "height" },
            ],
            ..Facts::USUAL
        }
    }

    fn surface(&self, _place: &Place<S>, local: &mut Local<S>) {
        if self.height.is_exactly(0.0) {
            return;
        }
        local.surface = local.surface.with_lugs(&local.wheel, self.height, self.share);
    }
}
