//! Position of a time among the whole multiples of a step.

use crate::model::Failure;

/// Distance from a whole number of steps, in steps, that counts as rounding; and the part of it that grows with the time,
/// as an importer has it that adds up its steps.
const NEAR: f64 = 1e-6;
const ADDED_UP: f64 = 1e-9;
/// More than this is no rounding, however many steps an importer has added up.
const FAR: f64 = 1e-2;
/// Most steps since the start: at 1 ms eleven days of driving. More is more likely a mistake of the importer, which would wait
/// for hours.
const MOST: f64 = 1e9;

/// A time as `whole` steps and a `share` of the next one, 0 or well over it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StepPosition {
    pub whole: u64,
    pub share: f64,
}

impl StepPosition {
    /// The position of `time` among multiples of `step`, s.
    ///
    /// # Errors
    /// A [`Failure`] for a time that is not finite, negative or too far away.
    pub fn of(time: f64, step: f64) -> Result<Self, Failure> {
        let steps = time / step;
        if !(-FAR..=MOST).contains(&steps) {
            return Err(Failure(format!(
                "the communication point {time} s is not within 0 s and {} s after the start, {MOST:e} inner steps",
                MOST * step
            )));
        }
        let near = (NEAR + ADDED_UP * steps).min(FAR);
        let nearest = steps.round().max(0.0);
        if (steps - nearest).abs() <= near {
            return Ok(Self { whole: nearest as u64, share: 0.0 });
        }
        let whole = steps.floor().max(0.0);
        Ok(Self { whole: whole as u64, share: (steps - whole).max(0.0) })
    }

    /// The first whole step at or after the time.
    pub fn end(self) -> u64 {
        self.whole + u64::from(self.share > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_times_fall_on_steps_as_far_as_a_host_adds_up() {
        let step = 0.002;
        let place = |time| StepPosition::of(time, step).ok();
        let on = |whole| Some(StepPosition { whole, share: 0.0 });
        assert_eq!(place(0.0), on(0));
        assert_eq!(place(0.3), on(150));
        // A million steps of 0.01 s, added up: 1.7e-7 s off.
        let added = (0..1_000_000).fold(0.0, |time, _| time + 0.01);
        assert!((added - 1e4_f64).abs() > 1e-8);
        assert_eq!(place(added), on(5_000_000));
        let between = place(0.0033).map(|place| (place.whole, (place.share * 1e9).round()));
        assert_eq!(between, Some((1, 0.65e9)));
        assert_eq!(place(0.0033).map(StepPosition::end), Some(2));
        for time in [f64::NAN, f64::INFINITY, -0.01, 1e9] {
            assert!(StepPosition::of(time, step).is_err(), "{time}");
        }
    }
}
