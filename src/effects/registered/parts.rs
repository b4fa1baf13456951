//! Hooks of one registered effect, called for one part of all numbers after the other.

use super::RegisteredEffect;
use crate::effects::{Effect, RecordingLag};
use crate::scalar::{Part, Scalar};
use crate::signals::{BodySignals, WheelSignals};
use bekker_modeldescription::Over;

/// A hook of an effect over one scalar of parts.
pub(super) type Hook<'h, S, T> = &'h dyn Fn(&dyn Effect<<S as Scalar>::Part>, usize) -> T;
/// A hook that changes something.
pub(super) type Change<'h, S, T> = &'h dyn Fn(&dyn Effect<<S as Scalar>::Part>, usize, &mut T);

impl<S: Scalar> RegisteredEffect<S> {
    /// Calls `f` with the effect for part `k` of all numbers.
    fn call(&self, k: usize, f: &mut dyn FnMut(&dyn Effect<S::Part>)) {
        S::Part::choose(&self.shared.family).call(&|i| self.values[i].part(k), f);
    }

    /// The number that a hook gives.
    pub(super) fn number(&self, hook: Hook<S, Option<S::Part>>) -> Option<S> {
        let mut whole: Option<S> = None;
        for k in 0..S::parts() {
            self.call(k, &mut |effect| {
                if let Some(part) = hook(effect, k) {
                    whole = Some(whole.unwrap_or(S::from(0.0)).with_part(k, part));
                }
            });
        }
        whole
    }

    /// The numbers that a hook gives.
    pub(super) fn given<T, P>(&self, hook: Hook<S, Option<P>>) -> Option<T>
    where
        T: Over<S, S::Part, Output = P>,
        P: Over<S::Part, S, Output = T>,
    {
        let mut whole: Option<T> = None;
        for k in 0..S::parts() {
            self.call(k, &mut |effect| {
                if let Some(part) = hook(effect, k) {
                    whole
                        .get_or_insert_with(|| part.over(&|_| S::from(0.0)))
                        .merge(&part, &|number, part| number.with_part(k, part));
                }
            });
        }
        whole
    }

    /// Lets a hook change `whole`.
    pub(super) fn change<T: Over<S, S::Part> + Copy>(&self, whole: &mut T, hook: Change<S, T::Output>) {
        let before = *whole;
        for k in 0..S::parts() {
            let mut part = before.over(&|number| number.part(k));
            self.call(k, &mut |effect| hook(effect, k, &mut part));
            whole.merge(&part, &|number, part| number.with_part(k, part));
        }
    }

    pub(super) fn record(&self, start_x: S, body: &mut BodySignals<S>, wheels: &mut [WheelSignals<S>]) {
        let (body_before, wheels_before) = (*body, wheels.to_vec());
        for k in 0..S::parts() {
            let part = |number: S| number.part(k);
            let mut part_of_body = body_before.over(&part);
            let mut part_of_wheels: Vec<_> = wheels_before.iter().map(|wheel| wheel.over(&part)).collect();
            self.call(k, &mut |effect| effect.record(start_x.part(k), &mut part_of_body, &mut part_of_wheels));
            let put = |number: S, part| number.with_part(k, part);
            body.merge(&part_of_body, &put);
            wheels.iter_mut().zip(&part_of_wheels).for_each(|(wheel, part)| wheel.merge(part, &put));
        }
    }

    pub(super) fn counts_passes(&self) -> bool {
        (0..S::parts()).any(|k| {
            let mut counts = false;
            self.call(k, &mut |effect| counts = effect.counts_passes());
            counts
        })
    }

    pub(super) fn lag(&self) -> Option<RecordingLag<S>> {
        self.given(&|effect, _| effect.lag())
    }
}
