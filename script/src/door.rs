//! What can be driven through a script, and what comes of it.

use super::read::Script;

/// What a door says when it cannot go on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{door}, t = {time} s: {message}")]
pub struct DoorError {
    /// Name of the door.
    pub door: String,
    /// Time of the drive, s.
    pub time: f64,
    /// What it says.
    pub message: String,
}

/// Something that carries out drives: the core, an FMU, the environment, or a program of the user's own.
pub trait Door {
    /// Name for people.
    fn name(&self) -> String;

    /// Puts it at the start of the script's model, whatever it did before.
    ///
    /// # Errors
    /// A sentence where it does not start.
    fn reset(&mut self) -> Result<(), String>;

    /// Goes on for one interval with `inputs` held, one value an input in the vocabulary's order.
    ///
    /// # Errors
    /// A sentence where it cannot go on. That the run ends by an event is no error.
    fn step(&mut self, inputs: &[f64]) -> Result<(), String>;

    /// Time since the start, s.
    fn time(&self) -> f64;

    /// Writes the signals called [`Script::signals`] into `out`, in that order.
    ///
    /// # Errors
    /// A sentence where they cannot be read.
    fn signals(&mut self, out: &mut [f64]) -> Result<(), String>;

    /// How the run stands: one of [`Status::WORDS`](bekker::simulation::Status::WORDS).
    ///
    /// # Errors
    /// A sentence where that cannot be told.
    fn status(&mut self) -> Result<String, String>;
}

/// What a door gave: samples at the start and after every interval, until the script or the run ends.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    /// Name of the door.
    pub door: String,
    /// Names of the signals.
    pub names: Vec<String>,
    /// Times, s.
    pub times: Vec<f64>,
    /// One row a time, one value a signal.
    pub rows: Vec<Vec<f64>>,
    /// How the run stood at the end: one of [`Status::WORDS`](bekker::simulation::Status::WORDS).
    pub status: String,
}

/// Drives `door` through `script`.
///
/// # Errors
/// [`DoorError`] where the door does not start or cannot go on.
pub fn drive(script: &Script, door: &mut dyn Door) -> Result<Recording, DoorError> {
    let name = door.name();
    let failed = |time: f64| {
        let door = name.clone();
        move |message| DoorError { door, time, message }
    };
    door.reset().map_err(failed(0.0))?;
    if script.warm_up > 0 {
        for inputs in script.inputs.iter().take(script.warm_up) {
            if door.status().map_err(failed(door.time()))? != RUNNING {
                break;
            }
            door.step(inputs).map_err(failed(door.time()))?;
        }
        door.reset().map_err(failed(0.0))?;
    }
    let mut recording = Recording { door: name.clone(), names: script.signals.clone(), ..Recording::default() };
    sample(door, &mut recording).map_err(failed(0.0))?;
    for inputs in &script.inputs {
        if recording.status != RUNNING {
            break;
        }
        door.step(inputs).map_err(failed(door.time()))?;
        sample(door, &mut recording).map_err(failed(door.time()))?;
    }
    Ok(recording)
}

const RUNNING: &str = "running";

fn sample(door: &mut dyn Door, recording: &mut Recording) -> Result<(), String> {
    let mut row = vec![f64::NAN; recording.names.len()];
    door.signals(&mut row)?;
    recording.status = door.status()?;
    // An event in the very first inner step of an interval leaves the time where it was: the later sample stands.
    if recording.times.last() == Some(&door.time()) {
        recording.times.pop();
        recording.rows.pop();
    }
    recording.times.push(door.time());
    recording.rows.push(row);
    Ok(())
}
