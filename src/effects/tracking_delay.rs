//! A body that is tracked from outside, by GPS or cameras: another clock than that of the drives.

use super::sensor_lag::{Delayed, RecordingLag};
use super::{Advice, Effect, Facts};
use crate::scalar::{Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// Position, velocity and pitch are recorded later than what the drives and wheels give.
    pub struct TrackingDelay {
        /// Dead time.
        dead_time: [Unit::SECOND] = 0.0, 0.0..=0.5, Effect, "assumption: latency of GPS, motion capture and filters of attitude";
    }
}

#[lanes]
impl<S: Scalar> Effect<S> for TrackingDelay<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_rover: &["velocity"],
            advice: const {
                &[Advice::rover(
                    "start and stop in steps: what the body and the drives record at them shows the time between their clocks",
                )]
            },
            tunable: false,
            ..Facts::USUAL
        }
    }

    fn lag(&self) -> Option<RecordingLag<S>> {
        let time_constant = S::from(0.0);
        let Self { dead_time } = *self;
        (!dead_time.is_exactly(0.0)).then_some(RecordingLag { time_constant, dead_time, of: Delayed::Body })
    }
}
