//! Sums of the hooks over the registered effects.

use super::{RegisteredEffect, RegisteredEffects};
use crate::contact::Forces;
use crate::effects::{BodyMotion, Local, Place, RecordingLag, Warming};
use crate::motor::{Geared, Motor, TorqueRange};
use crate::scalar::Scalar;
use crate::signals::{BodySignals, WheelSignals};
use crate::vehicle::Body;
use crate::wheel::Wheel;
use bekker_modeldescription::Over;

/// With no effect they are empty loops.
impl<S: Scalar> RegisteredEffects<S> {
    /// Of what `of` gives for each effect, all put together by `and`.
    #[inline]
    fn all<T>(&self, of: impl Fn(&RegisteredEffect<S>) -> Option<T>, and: impl Fn(T, T) -> T) -> Option<T> {
        self.0.iter().filter_map(of).reduce(and)
    }

    pub(in crate::effects) fn with_memory(&self) -> Option<&str> {
        let keeps = |effect: &&RegisteredEffect<S>| effect.counts_passes() || effect.lag().is_some();
        self.0.iter().find(keeps).map(RegisteredEffect::id)
    }

    #[inline]
    pub(in crate::effects) fn contact(&self, place: &Place<S>, local: &mut Local<S>) {
        for effect in &self.0 {
            effect.change(local, &|effect, k, local| effect.contact(&place.map(&|number| number.part(k)), local));
        }
    }

    #[inline]
    pub(in crate::effects) fn surface(&self, place: &Place<S>, local: &mut Local<S>) {
        for effect in &self.0 {
            effect.change(local, &|effect, k, local| effect.surface(&place.map(&|number| number.part(k)), local));
        }
    }

    #[inline]
    pub(in crate::effects) fn forces(&self, place: &Place<S>, local: &Local<S>, forces: &mut Forces<S>) {
        for effect in &self.0 {
            effect.change(forces, &|effect, k, forces| {
                let part = |number: S| number.part(k);
                effect.forces(&place.map(&part), &local.over(&part), forces);
            });
        }
    }

    #[inline]
    pub(in crate::effects) fn counts_passes(&self) -> bool {
        self.0.iter().any(RegisteredEffect::counts_passes)
    }

    #[inline]
    pub(in crate::effects) fn digging_length(&self) -> Option<S> {
        self.0.iter().find_map(|effect| effect.number(&|effect, _| effect.digging_length()))
    }

    /// The true wheel where the library makes `changed` of the `nominal` one.
    #[inline]
    pub(in crate::effects) fn wheel(&self, nominal: &Wheel<S>, changed: Option<Wheel<S>>) -> Option<Wheel<S>> {
        self.0.iter().fold(changed, |changed, effect| {
            let wheel = changed.as_ref().unwrap_or(nominal);
            effect.given(&|effect, k| effect.wheel(&wheel.map(&|number| number.part(k)))).or(changed)
        })
    }

    /// From the last one on: the inverse of what they do to a true radius.
    #[inline]
    pub(in crate::effects) fn recorded_radius(&self, radius: &mut S) {
        for effect in self.0.iter().rev() {
            let before = *radius;
            let recorded = effect.number(&|effect, k| {
                let mut part = before.part(k);
                effect.recorded_radius(&mut part);
                Some(part)
            });
            *radius = recorded.unwrap_or(before);
        }
    }

    #[inline]
    pub(in crate::effects) fn added_mass(&self) -> Option<S> {
        self.all(|effect| effect.number(&|effect, _| effect.added_mass()), |a, b| a + b)
    }

    #[inline]
    pub(in crate::effects) fn chassis(&self, body: &mut Body<S>) {
        for effect in &self.0 {
            effect.change(body, &|effect, _, body| effect.chassis(body));
        }
    }

    #[inline]
    pub(in crate::effects) fn motor(&self, winding_rise: S, motor: &mut Motor<S>) {
        for effect in &self.0 {
            effect.change(motor, &|effect, k, motor| effect.motor(winding_rise.part(k), motor));
        }
    }

    #[inline]
    pub(in crate::effects) fn warming(&self, power: S) -> Option<Warming<S>> {
        self.all(|effect| effect.given(&|effect, k| effect.warming(power.part(k))), Warming::beside)
    }

    #[inline]
    pub(in crate::effects) fn torque_gain(&self) -> Option<S> {
        self.all(|effect| effect.number(&|effect, _| effect.torque_gain()), |a, b| a * b)
    }

    #[inline]
    pub(in crate::effects) fn torque_range(&self, motor: &Motor<S>, speed: S) -> Option<TorqueRange<S>> {
        let range = |effect: &RegisteredEffect<S>| {
            effect.given(&|effect, k| effect.torque_range(&motor.map(&|number| number.part(k)), speed.part(k)))
        };
        self.all(range, TorqueRange::and)
    }

    pub(in crate::effects) fn share_of_limit(&self, motor: &Motor<S>, speed: S, torque: S) -> Option<S> {
        let share = |effect: &RegisteredEffect<S>| {
            effect.number(&|effect, k| {
                let motor = motor.map(&|number| number.part(k));
                effect.share_of_limit(&motor, speed.part(k), torque.part(k))
            })
        };
        self.all(share, |a: S, b| a.larger(b))
    }

    #[inline]
    pub(in crate::effects) fn gear(&self, speed: S, torque: S, slope: S) -> (S, S) {
        self.0.iter().fold((torque, slope), |(torque, slope), effect| {
            let geared: Option<Geared<S>> = effect.given(&|effect, k| effect.gear(speed.part(k), torque.part(k)));
            geared.map_or((torque, slope), |geared| (geared.torque, geared.by_torque * slope + geared.by_speed))
        })
    }

    #[inline]
    pub(in crate::effects) fn gear_input(&self, speed: S, torque: S) -> S {
        self.0.iter().rev().fold(torque, |torque, effect| {
            effect.number(&|effect, k| effect.gear_input(speed.part(k), torque.part(k))).unwrap_or(torque)
        })
    }

    #[inline]
    pub(in crate::effects) fn drive_friction(&self, speed: S) -> Option<(S, S)> {
        let friction = |effect: &RegisteredEffect<S>| {
            let torque = effect.number(&|effect, k| effect.drive_friction(speed.part(k)).map(|(torque, _)| torque))?;
            let slope = effect.number(&|effect, k| effect.drive_friction(speed.part(k)).map(|(_, slope)| slope))?;
            Some((torque, slope))
        };
        self.all(friction, |a, b| (a.0 + b.0, a.1 + b.1))
    }

    #[inline]
    pub(in crate::effects) fn joint_friction(&self, rate: S) -> Option<S> {
        self.all(|effect| effect.number(&|effect, k| effect.joint_friction(rate.part(k))), |a, b| a + b)
    }

    #[inline]
    pub(in crate::effects) fn body_force(&self, motion: &BodyMotion<S>) -> Option<S> {
        let force = |effect: &RegisteredEffect<S>| {
            effect.number(&|effect, k| effect.body_force(&motion.over(&|number| number.part(k))))
        };
        self.all(force, |a, b| a + b)
    }

    #[inline]
    pub(in crate::effects) fn record(&self, start_x: S, body: &mut BodySignals<S>, wheels: &mut [WheelSignals<S>]) {
        self.0.iter().for_each(|effect| effect.record(start_x, body, wheels));
    }

    pub(in crate::effects) fn lags(&self) -> impl Iterator<Item = RecordingLag<S>> {
        self.0.iter().filter_map(RegisteredEffect::lag)
    }
}
