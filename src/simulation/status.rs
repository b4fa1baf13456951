//! Whether a run goes on, and what ended it.

use crate::snapshot::{Moving, Reader, SnapshotError, Writer, moving_code};
use std::fmt;

/// What ends a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Event {
    /// The wheels turn, the rover does not move.
    Stuck,
    /// The pitch is beyond 80 degrees.
    TippedOver,
    /// The belly touches the ground.
    BellyContact,
    /// A wheel is beyond the known ground.
    LeftTerrain,
    /// A wheel has sunk to its axle.
    SunkToAxle,
}

moving_code!(Event, "an event" {
    Event::Stuck => 1 => Event::Stuck,
    Event::TippedOver => 2 => Event::TippedOver,
    Event::BellyContact => 3 => Event::BellyContact,
    Event::LeftTerrain => 4 => Event::LeftTerrain,
    Event::SunkToAxle => 5 => Event::SunkToAxle,
});

impl fmt::Display for Event {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Event::Stuck => "stuck: the wheels turn, the rover does not move",
            Event::TippedOver => "tipped over: the pitch is beyond 80 degrees",
            Event::BellyContact => "belly contact: the chassis touches the ground",
            Event::LeftTerrain => "left the terrain: a wheel is beyond the known ground",
            Event::SunkToAxle => "sunk to the axle: the wheel model does not hold any more",
        })
    }
}

/// Whether a run goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Status {
    /// It goes on.
    Running,
    /// It has ended; further steps change nothing.
    Ended(Event),
}

impl Status {
    /// What [`Status::word`] may say, as scripts, FMUs and the environment write it.
    pub const WORDS: [&str; 6] = ["running", "stuck", "tipped_over", "belly_contact", "left_terrain", "sunk_to_axle"];

    /// Its place among [`Status::WORDS`].
    #[must_use]
    pub fn place(self) -> usize {
        match self {
            Status::Running => 0,
            Status::Ended(Event::Stuck) => 1,
            Status::Ended(Event::TippedOver) => 2,
            Status::Ended(Event::BellyContact) => 3,
            Status::Ended(Event::LeftTerrain) => 4,
            Status::Ended(Event::SunkToAxle) => 5,
        }
    }

    /// One word for it.
    #[must_use]
    pub fn word(self) -> &'static str {
        Self::WORDS[self.place()]
    }
}

impl Moving for Status {
    fn save(&self, to: &mut Writer) {
        match self {
            Status::Running => to.number(0),
            Status::Ended(event) => {
                to.number(1);
                event.save(to);
            }
        }
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        *self = match from.number()? {
            0 => Status::Running,
            1 => {
                let mut event = Event::Stuck;
                event.load(from)?;
                Status::Ended(event)
            }
            code => return Err(SnapshotError::Code { what: "a status", code }),
        };
        Ok(())
    }
}
