//! The macro that makes the library of effects from its table: struct, vocabulary, and one sum of each hook.

/// Declares the library: one line an effect.
macro_rules! effects {
    ($($(#[doc = $doc:literal])+ $id:ident: $group:ident,)*) => {
        $(pub use $id::$group;)*

        /// The library of effects. All are present in every rover and neutral by default.
        #[derive(Clone, PartialEq)]
        pub struct Effects<S = f64> {
            $($(#[doc = $doc])+ pub $id: $group<S>,)*
            /// The user's own that are given as expressions, after those of the library.
            pub custom: CustomEffects<S>,
            /// Those of other crates, after all others.
            pub registered: RegisteredEffects<S>,
        }

        /// A model without effects of other crates has the same text, and with it the same
        /// [`Fingerprint`](crate::snapshot::Fingerprint), whether or not they can be registered.
        impl<S: fmt::Debug> fmt::Debug for Effects<S> {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                let mut text = f.debug_struct("Effects");
                $(text.field(stringify!($id), &self.$id);)*
                text.field("custom", &self.custom);
                if !self.registered.is_empty() {
                    text.field("registered", &self.registered);
                }
                text.finish()
            }
        }

        impl<S: From<f64>> Default for Effects<S> {
            fn default() -> Self {
                Self {
                    $($id: $group::default(),)*
                    custom: CustomEffects::default(),
                    registered: RegisteredEffects::default(),
                }
            }
        }

        impl<S: Copy> Effects<S> {
            /// The same effects over another scalar.
            #[must_use]
            pub fn map<T>(&self, f: &dyn Fn(S) -> T) -> Effects<T> {
                Effects {
                    $($id: self.$id.map(f),)*
                    custom: self.custom.map(f),
                    registered: self.registered.map(f),
                }
            }
        }

        impl<S: Scalar> Parameters<S> for Effects<S> {
            fn visit(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut S)) {
                $(self.$id.visit(&join(prefix, stringify!($id)), f);)*
                self.custom.visit(prefix, f);
                self.registered.visit(prefix, f);
            }

            fn values(&self, f: &mut dyn FnMut(S)) {
                $(self.$id.values(f);)*
                self.custom.values(f);
                self.registered.values(f);
            }
        }

        /// Ids and meanings of all effects, in the library's order.
        pub const EFFECTS: &[(&str, &str)] = &[$((stringify!($id), concat!($($doc),+)),)*];

        impl<S: Scalar> Effects<S> {
            /// Ids of the effects of the library and of other crates, with what there is to know of each. An effect that is
            /// given as an expression has no facts.
            pub fn facts(&self) -> impl Iterator<Item = (&str, Facts)> {
                let library = [$((stringify!($id), Effect::<S>::facts(&self.$id)),)*];
                library.into_iter().chain(self.registered.facts())
            }

            /// The first effect that keeps a memory which is no state of a differential equation.
            pub(crate) fn with_memory(&self) -> Option<&str> {
                $(if self.$id.counts_passes() || self.$id.lag().is_some() {
                    return Some(stringify!($id));
                })*
                self.registered.with_memory()
            }
        }

        /// Sums of the hooks over the library and the user's own effects.
        #[lanes]
        impl<S: Scalar> Effects<S> {
            /// A contact at `place` of the true wheel on `soil`: wheel, soil and rim as the effects leave them, and the
            /// forces that follow from what `stresses` integrates on them.
            pub(crate) fn contact<T: AsMut<Forces<S>>>(
                &self,
                place: &Place<S>,
                wheel: Wheel<S>,
                soil: Soil<S>,
                stresses: impl FnOnce(&Local<S>) -> T,
            ) -> Result<(Local<S>, T), ExpressionFailure> {
                let mut local = Local::new(wheel, soil);
                $(self.$id.contact(place, &mut local);)*
                self.custom.contact(place, &mut local)?;
                self.registered.contact(place, &mut local);
                $(self.$id.surface(place, &mut local);)*
                self.registered.surface(place, &mut local);
                let mut touched = stresses(&local);
                $(self.$id.forces(place, &local, touched.as_mut());)*
                self.custom.forces(place, touched.as_mut())?;
                self.registered.forces(place, &local, touched.as_mut());
                Ok((local, touched))
            }

            /// Whether an effect needs to know which ground has been passed.
            pub(crate) fn counts_passes(&self) -> bool {
                self.registered.counts_passes() $(|| self.$id.counts_passes())*
            }

            /// The length with which the ground under a wheel follows its slip: that of the first effect that gives one.
            pub(crate) fn digging_length(&self) -> Option<S> {
                $(if let Some(length) = self.$id.digging_length() {
                    return Some(length);
                })*
                self.registered.digging_length()
            }

            /// The true wheel, where it is not the nominal one.
            pub(crate) fn wheel(&self, nominal: &Wheel<S>) -> Option<Wheel<S>> {
                let mut changed = None;
                $(if let Some(wheel) = self.$id.wheel(changed.as_ref().unwrap_or(nominal)) {
                    changed = Some(wheel);
                })*
                self.registered.wheel(nominal, changed)
            }

            pub(crate) fn recorded_radius(&self, mut radius: S) -> S {
                self.registered.recorded_radius(&mut radius);
                $(self.$id.recorded_radius(&mut radius);)*
                radius
            }

            /// Sum of the masses that the data sheet does not have; `None` where there is none.
            pub(crate) fn added_mass(&self) -> Option<S> {
                let mut sum = self.registered.added_mass();
                $(if let Some(mass) = self.$id.added_mass() {
                    sum = Some(sum.map_or(mass, |before| before + mass));
                })*
                sum
            }

            pub(crate) fn chassis(&self, body: &mut Body<S>) {
                if let Some(mass) = self.added_mass() {
                    body.mass += mass;
                }
                $(self.$id.chassis(body);)*
                self.registered.chassis(body);
            }

            pub(crate) fn motor(&self, winding_rise: S, motor: &mut Motor<S>) {
                $(self.$id.motor(winding_rise, motor);)*
                self.registered.motor(winding_rise, motor);
            }

            /// How a winding warms that dissipates `power`; `None` where windings stay cold.
            pub(crate) fn warming(&self, power: S) -> Option<Warming<S>> {
                let mut all = self.registered.warming(power);
                $(if let Some(law) = self.$id.warming(power) {
                    all = Some(all.map_or(law, |before| before.beside(law)));
                })*
                all
            }

            pub(crate) fn joint_friction(&self, rate: S) -> S {
                let mut sum = S::from(0.0);
                $(if let Some(coefficient) = self.$id.joint_friction(rate) {
                    sum += coefficient;
                })*
                self.registered.joint_friction(rate).map_or(sum, |coefficient| sum + coefficient)
            }

            pub(crate) fn body_force(&self, motion: &BodyMotion<S>) -> Result<S, ExpressionFailure> {
                let mut sum = self.custom.body_force(motion)?;
                $(if let Some(force) = self.$id.body_force(motion) {
                    sum += force;
                })*
                Ok(self.registered.body_force(motion).map_or(sum, |force| sum + force))
            }
        }

        /// Sums of what concerns records.
        impl<S: Scalar> Effects<S> {
            pub(crate) fn record(&self, start_x: S, body: &mut BodySignals<S>, wheels: &mut [WheelSignals<S>]) {
                $(self.$id.record(start_x, body, wheels);)*
                self.registered.record(start_x, body, wheels);
            }

            /// The lags of the records, one behind the other.
            pub(crate) fn lags(&self) -> Vec<RecordingLag<S>> {
                let library = [$(self.$id.lag(),)*];
                library.into_iter().flatten().chain(self.registered.lags()).collect()
            }
        }

        /// From the motor outwards: limits and gears of the library in its order, then those of other crates.
        #[lanes]
        impl<S: Scalar> Drivetrain<S> for Effects<S> {
            type Failure = ExpressionFailure;

            /// Product of the gains.
            fn torque_gain(&self) -> Option<S> {
                let mut product = self.registered.torque_gain();
                $(if let Some(gain) = self.$id.torque_gain() {
                    product = Some(product.map_or(gain, |before| before * gain));
                })*
                product
            }

            /// What all limits allow.
            fn torque_range(&self, motor: &Motor<S>, speed: S) -> Option<TorqueRange<S>> {
                let mut all = self.registered.torque_range(motor, speed);
                $(if let Some(range) = self.$id.torque_range(motor, speed) {
                    all = Some(all.map_or(range, |before| before.and(range)));
                })*
                all
            }

            /// Share of the limit that is nearest.
            fn share_of_limit(&self, motor: &Motor<S>, speed: S, torque: S) -> Option<S> {
                let mut largest = self.registered.share_of_limit(motor, speed, torque);
                $(if let Some(share) = self.$id.share_of_limit(motor, speed, torque) {
                    largest = Some(largest.map_or(share, |before: S| before.larger(share)));
                })*
                largest
            }

            fn gear(&self, speed: S, torque: S, slope: S) -> (S, S) {
                let (mut torque, mut slope) = (torque, slope);
                $(if let Some(geared) = self.$id.gear(speed, torque) {
                    slope = geared.by_torque * slope + geared.by_speed;
                    torque = geared.torque;
                })*
                self.registered.gear(speed, torque, slope)
            }

            fn gear_input(&self, speed: S, torque: S) -> S {
                let mut torque = self.registered.gear_input(speed, torque);
                last_first!(self, speed, torque; $($id)*);
                torque
            }

            fn drive_friction(&self, speed: S) -> Result<(S, S), ExpressionFailure> {
                let mut sum = self.custom.drive_friction(speed)?;
                $(if let Some((torque, slope)) = self.$id.drive_friction(speed) {
                    sum.0 += torque;
                    sum.1 += slope;
                })*
                Ok(self.registered.drive_friction(speed).map_or(sum, |(torque, slope)| (sum.0 + torque, sum.1 + slope)))
            }
        }
    };
}

/// The inverse of all gears: that of the last one comes first.
macro_rules! last_first {
    ($effects:ident, $speed:ident, $torque:ident;) => {};
    ($effects:ident, $speed:ident, $torque:ident; $id:ident $($others:ident)*) => {
        last_first!($effects, $speed, $torque; $($others)*);
        if let Some(before) = $effects.$id.gear_input($speed, $torque) {
            $torque = before;
        }
    };
}

pub(super) use {effects, last_first};
