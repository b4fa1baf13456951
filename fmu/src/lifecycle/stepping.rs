//! Co-simulation: communication steps of any size.
//!
//! The model's own steps lie at whole multiples of its inner step; a communication point between two of
//! them is served from both. So a communication step changes which values are seen, never the simulation.

use super::{Interface, Lifecycle, Phase, Refusal};
use crate::model::{Failure, Outcome};
use bekker_modeldescription::xml::Causality;

/// Largest relative distance at which a communication point counts as one on the grid of inner steps: a
/// host that computes its steps as differences of times around 1e6 steps is off by 1e-10 at most.
const GRID_TOLERANCE: f64 = 1e-9;

/// Largest distance of the host's time from the model's, relative to the communication step: the host
/// may have added up many steps. The model counts its own steps, so nothing follows from the difference.
const TIME_TOLERANCE: f64 = 1e-3;

/// Longest part of a communication step that is made in one call, s: an hour of driving, which takes a minute or less. A host
/// that asks for more by mistake would wait for hours.
pub const LONGEST: f64 = 3600.0;

/// Where a communication step arrived.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// The host's time that was reached, s.
    pub time: f64,
    /// Why the simulation ended, where it did.
    pub ended: Option<String>,
}

/// A derivative of an input by time, from which the input is extrapolated within the next step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slope {
    pub(super) reference: usize,
    pub(super) order: u32,
    pub(super) value: f64,
}

impl Lifecycle {
    /// Goes on from the host's time `current` by `size`, s.
    ///
    /// # Errors
    /// [`Refusal::Order`], [`Refusal::Ended`]; [`Refusal::Time`] where `current` is not the model's time,
    /// or `size` not positive, or the end beyond the stop time; [`Refusal::Long`] where `size` is more than
    /// [`LONGEST`]; [`Refusal::Value`] where an extrapolated
    /// input leaves its bounds; [`Refusal::Failed`] where the model could not go on, after which only
    /// reading, reset and restoring are allowed.
    pub fn step(&mut self, current: f64, size: f64) -> Result<Progress, Refusal> {
        let target = self.begin_step(current, size)?;
        self.not_too_long(target)?;
        if self.slopes.is_empty() {
            return self.go_to(target);
        }
        let slopes = std::mem::take(&mut self.slopes);
        self.follow(&slopes, target)
    }

    /// Checks a communication step; the result is its end, in seconds since the start.
    ///
    /// # Errors
    /// As [`step`](Self::step), but for [`Refusal::Failed`].
    pub fn begin_step(&self, current: f64, size: f64) -> Result<f64, Refusal> {
        self.require(&[Phase::Step])?;
        if let Some(reason) = &self.ended {
            return Err(Refusal::Ended(reason.clone()));
        }
        let time = self.time();
        if !(size.is_finite() && size > 0.0) {
            return Err(Refusal::Time(format!("the communication step is {size}, expected a positive number")));
        }
        let late = TIME_TOLERANCE * size;
        if !current.is_finite() || (current - time).abs() > late {
            return Err(Refusal::Time(format!("the step starts at {current} s, but this instance is at {time} s")));
        }
        if let Some(stop) = self.stop.filter(|stop| time + size > stop + late) {
            return Err(Refusal::Time(format!("the step ends at {} s, after the stop time {stop} s", time + size)));
        }
        Ok(self.on_grid(self.model.elapsed() + size))
    }

    /// Refuses a step to `target`, seconds since the start, that is too long for one call.
    ///
    /// # Errors
    /// [`Refusal::Long`].
    pub fn not_too_long(&self, target: f64) -> Result<(), Refusal> {
        let size = target - self.model.elapsed();
        if size > LONGEST * (1.0 + GRID_TOLERANCE) { Err(Refusal::Long { size }) } else { Ok(()) }
    }

    /// The end of the longest step that one call makes towards `target`; both in seconds since the start.
    #[must_use]
    pub fn in_one_call(&self, target: f64) -> f64 {
        target.min(self.on_grid(self.model.elapsed() + LONGEST))
    }

    /// `time`, or the whole multiple of the inner step from which only rounding keeps it.
    fn on_grid(&self, time: f64) -> f64 {
        let inner = self.model.inner_step();
        let point = (time / inner).round() * inner;
        if (point - time).abs() <= GRID_TOLERANCE * inner.max(time) { point } else { time }
    }

    /// The next end of an inner step after the present time, but at most `target`; seconds since the start.
    #[must_use]
    pub fn next_point(&self, target: f64) -> f64 {
        let inner = self.model.inner_step();
        let now = self.model.elapsed();
        let mut count = (now / inner).floor() + 1.0;
        if count * inner - now <= GRID_TOLERANCE * inner.max(now) {
            count += 1.0;
        }
        (count * inner).min(target)
    }

    /// Whether nothing but rounding keeps the present time from `target`, seconds since the start.
    #[must_use]
    pub fn has_reached(&self, target: f64) -> bool {
        target - self.model.elapsed() <= GRID_TOLERANCE * self.model.inner_step().max(target)
    }

    /// Goes on to `target`, seconds since the start, with the present inputs.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn go_to(&mut self, target: f64) -> Result<Progress, Refusal> {
        self.require(&[Phase::Step])?;
        match self.advance(target) {
            Ok(Outcome::Running) => {}
            Ok(Outcome::Ended { reason }) => self.ended = Some(reason),
            Err(failure) => {
                self.phase = Phase::Failed;
                return Err(failure.into());
            }
        }
        Ok(Progress { time: self.time(), ended: self.ended.clone() })
    }

    /// Whole inner steps where there are some, else to a point between two.
    fn advance(&mut self, target: f64) -> Result<Outcome, Failure> {
        let inner = self.model.inner_step();
        let count = |time: f64| {
            let whole = (time / inner).round();
            ((whole * inner - time).abs() <= GRID_TOLERANCE * inner.max(time)).then_some(whole)
        };
        match (count(self.model.elapsed()), count(target)) {
            (Some(from), Some(to)) if to > from => self.model.advance((to - from) as u64),
            (Some(from), Some(to)) if to == from => Ok(Outcome::Running),
            _ => self.model.advance_to(target),
        }
    }

    /// Enters or leaves the importer's callback inside a step.
    ///
    /// # Errors
    /// [`Refusal::Order`].
    pub fn intermediate(&mut self, inside: bool) -> Result<(), Refusal> {
        let (from, to) = if inside { (Phase::Step, Phase::Intermediate) } else { (Phase::Intermediate, Phase::Step) };
        self.require(&[from])?;
        self.phase = to;
        Ok(())
    }

    /// Steps of co-simulation with events: on from an event.
    ///
    /// # Errors
    /// [`Refusal::Order`], or [`Refusal::Unsupported`] for an instance without events.
    pub fn enter_step_mode(&mut self) -> Result<(), Refusal> {
        if !matches!(self.interface, Interface::CoSimulation { events: true }) {
            return Err(Refusal::Unsupported(
                "step mode is entered from event mode in co-simulation with eventModeUsed = true".into(),
            ));
        }
        self.require(&[Phase::Event])?;
        self.phase = Phase::Step;
        Ok(())
    }

    /// Says how inputs go on within the next step: derivatives by time at its beginning. An input whose value is
    /// set alone stays as it is; after the step the derivatives are forgotten, and the value reached remains.
    ///
    /// # Errors
    /// [`Refusal::Order`] outside of co-simulation; [`Refusal::Reference`], [`Refusal::Type`];
    /// [`Refusal::Derivative`] for a variable that is no input, an order below 1 or a value that is not finite.
    pub fn set_input_derivatives(&mut self, references: &[u32], orders: &[i32], values: &[f64]) -> Result<(), Refusal> {
        self.require(&[Phase::Instantiated, Phase::Initialization, Phase::Step])?;
        if matches!(self.interface, Interface::ModelExchange) {
            return Err(Refusal::Unsupported("input derivatives are for co-simulation".into()));
        }
        let mut slopes = Vec::with_capacity(references.len());
        for ((&reference, &order), &value) in references.iter().zip(orders).zip(values) {
            let entry = self.entry(reference, super::Type::Real)?;
            let name = || entry.variable.name.clone();
            if entry.causality != Causality::Input {
                return Err(Refusal::Derivative(format!("`{}` is no input and has no derivative to set", name())));
            }
            let order = u32::try_from(order).ok().filter(|order| *order > 0).ok_or_else(|| {
                Refusal::Derivative(format!(
                    "the order of the derivative of `{}` is {order}, expected 1 or more",
                    name()
                ))
            })?;
            if !value.is_finite() {
                let text = format!("the derivative of `{}` is {value}, expected a finite number", name());
                return Err(Refusal::Derivative(text));
            }
            slopes.push(Slope { reference: reference as usize, order, value });
        }
        for slope in slopes {
            self.slopes.retain(|old| (old.reference, old.order) != (slope.reference, slope.order));
            self.slopes.push(slope);
        }
        Ok(())
    }

    /// Goes on with inputs that change: each inner step has the inputs of its middle, the last values are those of
    /// the end.
    fn follow(&mut self, slopes: &[Slope], target: f64) -> Result<Progress, Refusal> {
        let begin = self.model.elapsed();
        let starts: Vec<(usize, f64)> = slopes.iter().map(|s| (s.reference, self.model.get(s.reference))).collect();
        self.check_path(slopes, &starts, target - begin)?;
        let mut progress = Progress { time: self.time(), ended: None };
        let mut now = begin;
        while now < target && progress.ended.is_none() {
            let point = self.next_point(target);
            self.extrapolate(slopes, &starts, 0.5 * (now + point) - begin);
            progress = self.go_to(point)?;
            now = point;
        }
        self.extrapolate(slopes, &starts, self.model.elapsed() - begin);
        Ok(progress)
    }

    fn extrapolate(&mut self, slopes: &[Slope], starts: &[(usize, f64)], after: f64) {
        for &(reference, start) in starts {
            self.model.set(reference, extrapolated(slopes, reference, start, after));
        }
    }

    /// Refuses a step on which an input would leave its bounds: at its ends and at every inner step.
    fn check_path(&self, slopes: &[Slope], starts: &[(usize, f64)], size: f64) -> Result<(), Refusal> {
        let count = (size / self.model.inner_step()).ceil().max(1.0) as u64;
        for &(reference, start) in starts {
            let variable = &self.model.description().entries[reference].variable;
            for k in 0..=count {
                let value = extrapolated(slopes, reference, start, size * k as f64 / count as f64);
                if !variable.allows(value) {
                    return Err(Refusal::Value { name: variable.name.clone(), value, range: variable.range() });
                }
            }
        }
        Ok(())
    }

    /// First derivatives of outputs by time, 1/s: what the next inner step will change with the present inputs, over
    /// its length. A copy makes that step, so the error is of the order of the inner step.
    ///
    /// # Errors
    /// [`Refusal::Order`]; [`Refusal::Reference`], [`Refusal::Type`]; [`Refusal::Derivative`] for a variable that is
    /// no output or another order than 1; [`Refusal::Failed`] where the next step cannot be made.
    pub fn output_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        put: &mut dyn FnMut(usize, f64),
    ) -> Result<(), Refusal> {
        self.require(&[Phase::Step, Phase::Intermediate, Phase::Terminated])?;
        for (&reference, &order) in references.iter().zip(orders) {
            let entry = self.entry(reference, super::Type::Real)?;
            let name = &entry.variable.name;
            if entry.causality != Causality::Output {
                return Err(Refusal::Derivative(format!("`{name}` is no output and has no derivative to read")));
            }
            if order != 1 {
                let text = format!("the order of the derivative of `{name}` is {order}, expected 1");
                return Err(Refusal::Derivative(text));
            }
        }
        if let Some(reason) = &self.ended {
            return Err(Refusal::Ended(reason.clone()));
        }
        let mut ahead = self.clone();
        let inner = ahead.model.inner_step();
        ahead.advance(self.on_grid(self.model.elapsed() + inner))?;
        let length = ahead.model.elapsed() - self.model.elapsed();
        for (place, &reference) in references.iter().enumerate() {
            let reference = reference as usize;
            put(place, (ahead.model.get(reference) - self.model.get(reference)) / length);
        }
        Ok(())
    }
}

/// Taylor's polynomial of an input.
fn extrapolated(slopes: &[Slope], reference: usize, start: f64, after: f64) -> f64 {
    let factorial = |order: u32| (1..=order).map(f64::from).product::<f64>();
    let terms = slopes.iter().filter(|slope| slope.reference == reference);
    start + terms.map(|s| s.value * after.powi(s.order.min(1000) as i32) / factorial(s.order.min(1000))).sum::<f64>()
}
