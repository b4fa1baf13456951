//! The library of what may be wrong with a soil test: one line an effect.

use super::effects::{BoxBottom, BoxFriction, BoxWalls, PlateSize, Seating, ShearPlay, ShearRate, ShearSoftening};
use super::{Pressing, ShearBox, Shearing, SoilBox, TestEffect};
use crate::effects::Facts;
use crate::scalar::{MapScalar, Scalar};
use bekker_modeldescription::{Parameters, Variable, join};

/// Declares the library: struct, vocabulary and one call of each hook.
macro_rules! test_effects {
    ($($(#[doc = $doc:literal])+ $id:ident: $group:ident,)*) => {
        /// What an ideal soil test lacks. All are neutral by default.
        #[derive(Clone, Debug, PartialEq, MapScalar)]
        pub struct TestEffects<S = f64> {
            $($(#[doc = $doc])+ pub $id: $group<S>,)*
        }

        impl<S: From<f64>> Default for TestEffects<S> {
            fn default() -> Self {
                Self { $($id: $group::default(),)* }
            }
        }

        /// Ids and meanings of the effects on soil tests, in the library's order.
        pub const TEST_EFFECTS: &[(&str, &str)] = &[$((stringify!($id), concat!($($doc),+)),)*];

        impl<S: Scalar> Parameters<S> for TestEffects<S> {
            fn visit(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut S)) {
                $(self.$id.visit(&join(prefix, stringify!($id)), f);)*
            }

            fn values(&self, f: &mut dyn FnMut(S)) {
                $(self.$id.values(f);)*
            }
        }

        impl<S: Scalar> TestEffects<S> {
            /// Ids with what there is to know of each.
            pub fn facts(&self) -> impl Iterator<Item = (&'static str, Facts)> {
                [$((stringify!($id), TestEffect::<S>::facts(&self.$id)),)*].into_iter()
            }

            /// Changes a plate test.
            pub(super) fn press(&self, soil_box: &SoilBox<S>, at: &mut Pressing<S>) {
                $(self.$id.press(soil_box, at);)*
            }

            /// Changes a shear test.
            pub(super) fn shear(&self, shear_box: &ShearBox<S>, at: &mut Shearing<S>) {
                $(self.$id.shear(shear_box, at);)*
            }
        }
    };
}

test_effects! {
    /// Size of the plate: the soil resists larger plates more, or less, than k_c/b + k_phi says.
    plate_size: PlateSize,
    /// Walls of the soil box that confine the soil under a plate.
    box_walls: BoxWalls,
    /// Bottom of the soil box that carries a part of a plate's load.
    box_bottom: BoxBottom,
    /// Seating of a plate: the recorded sinkage does not start where the plate meets the soil.
    seating: Seating,
    /// Rate of shearing: the soil resists fast shearing more.
    shear_rate: ShearRate,
    /// Friction of the shear box or ring itself, there from the first displacement on.
    box_friction: BoxFriction,
    /// Play of the shear box: the first displacement shears nothing.
    shear_play: ShearPlay,
    /// Softening: the shear stress falls again behind its peak.
    shear_softening: ShearSoftening,
}
