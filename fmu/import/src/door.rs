//! An FMU as a door of scripted tests.

use crate::ImportError;
use crate::archive::Fmu;
use crate::description::{Kind, Version};
use crate::slave::Slave;
use bekker::simulation::Status;
use bekker_script::{Door, Script};

/// The output that says why a simulation ended: its values are the places in [`Status::WORDS`].
const EVENT: &str = "event";

/// An instance of an FMU, driven through a script.
pub struct FmuDoor<'a> {
    slave: Slave<'a>,
    version: Version,
    interval: f64,
    /// Parameters that the script sets, set again after each reset.
    parameters: (Vec<u32>, Vec<f64>),
    inputs: Vec<u32>,
    signals: Vec<u32>,
    event: Option<u32>,
    steps: u64,
    time: f64,
    ended: bool,
    fresh: bool,
}

impl<'a> FmuDoor<'a> {
    /// An instance about to drive `script`. Every input and signal of the script must be a variable of the FMU, and so
    /// must every parameter that the script sets in its model; the output `event` is needed where the script expects one.
    ///
    /// # Errors
    /// [`ImportError`] naming the variable that is missing, or where the FMU gives no instance.
    pub fn new(fmu: &'a Fmu, script: &Script) -> Result<Self, ImportError> {
        let slave = Slave::new(fmu)?;
        let real = |name: &String| slave.reference(name, Kind::Real);
        let (names, values): (Vec<String>, Vec<f64>) = script.parameters.iter().cloned().unzip();
        let references = |names: &[String]| names.iter().map(real).collect::<Result<Vec<u32>, _>>();
        let (parameters, inputs) = (references(&names)?, references(&script.input_names)?);
        let signals = references(&script.signals)?;
        let event = slave.reference(EVENT, Kind::Integer);
        let event = if script.expect.status == Status::WORDS[0] { event.ok() } else { Some(event?) };
        Ok(Self {
            version: fmu.description.version,
            interval: script.interval,
            parameters: (parameters, values),
            inputs,
            signals,
            event,
            steps: 0,
            time: 0.0,
            ended: false,
            fresh: true,
            slave,
        })
    }

    fn begin(&mut self) -> Result<(), ImportError> {
        if !self.fresh {
            self.slave.reset()?;
        }
        self.fresh = false;
        (self.steps, self.time, self.ended) = (0, 0.0, false);
        let (references, values) = &self.parameters;
        self.slave.set(references, values)?;
        self.slave.start()
    }
}

impl Door for FmuDoor<'_> {
    fn name(&self) -> String {
        match self.version {
            Version::Fmi2 => "FMU (FMI 2.0)".to_owned(),
            Version::Fmi3 => "FMU (FMI 3.0)".to_owned(),
        }
    }

    fn reset(&mut self) -> Result<(), String> {
        self.begin().map_err(|error| error.to_string())
    }

    fn step(&mut self, inputs: &[f64]) -> Result<(), String> {
        let set = self.slave.set(&self.inputs, inputs);
        set.map_err(|error| error.to_string())?;
        let from = self.steps as f64 * self.interval;
        let progress = self.slave.step(from, self.interval).map_err(|error| error.to_string())?;
        self.steps += 1;
        // Counted, not added up, as the core counts its steps.
        self.time = if progress.ended { progress.time } else { self.steps as f64 * self.interval };
        self.ended = progress.ended;
        Ok(())
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn signals(&mut self, out: &mut [f64]) -> Result<(), String> {
        self.slave.get(&self.signals, out).map_err(|error| error.to_string())
    }

    fn status(&mut self) -> Result<String, String> {
        let Some(event) = self.event else {
            let word = if self.ended { "ended by the FMU, which has no output `event`" } else { Status::WORDS[0] };
            return Ok(word.to_owned());
        };
        let number = self.slave.integer(event).map_err(|error| error.to_string())?;
        let word = usize::try_from(number).ok().and_then(|number| Status::WORDS.get(number));
        word.map(|word| (*word).to_owned())
            .ok_or_else(|| format!("the output `event` is {number}, which has no meaning"))
    }
}
