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

/// A status as scripts, FMUs and the environment write it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StatusEntry {
    /// The status.
    pub status: Status,
    /// One word for it.
    pub word: &'static str,
    /// What it means.
    pub doc: &'static str,
}

impl Status {
    /// Every status, in the order of [`Status::place`].
    pub const ALL: [StatusEntry; 6] = {
        const fn ended(event: Event, word: &'static str, doc: &'static str) -> StatusEntry {
            StatusEntry { status: Status::Ended(event), word, doc }
        }
        [
            StatusEntry { status: Status::Running, word: "running", doc: "The simulation goes on." },
            ended(Event::Stuck, "stuck", "The wheels turn, the rover does not move."),
            ended(Event::TippedOver, "tipped_over", "The pitch is beyond 80 degrees."),
            ended(Event::BellyContact, "belly_contact", "The chassis touches the ground."),
            ended(Event::LeftTerrain, "left_terrain", "A wheel is beyond the known ground."),
            ended(Event::SunkToAxle, "sunk_to_axle", "A wheel has sunk to its axle."),
        ]
    };

    /// The words of [`Status::ALL`].
    pub const WORDS: [&str; 6] = {
        let mut words = [""; 6];
        let mut place = 0;
        while place < words.len() {
            words[place] = Self::ALL[place].word;
            place += 1;
        }
        words
    };

    /// Its place among [`Status::ALL`].
    #[must_use]
    pub fn place(self) -> usize {
        match self {
            Status::Running => 0,
            Status::Ended(event) => event as usize + 1,
        }
    }

    /// One word for it.
    #[must_use]
    pub fn word(self) -> &'static str {
        Self::ALL[self.place()].word
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

#[cfg(test)]
mod tests {
    use super::Status;

    #[test]
    fn property_a_status_has_its_place_among_all() {
        for (place, entry) in Status::ALL.iter().enumerate() {
            assert_eq!((entry.status.place(), entry.status.word()), (place, entry.word));
        }
    }
}
