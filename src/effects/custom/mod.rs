//! Effects of the user's own: a term given as an expression in TOML.
//!
//! ```toml
//! [[effect]]
//! id = "cable"                                   # snake_case, not an id of the library
//! about = "A cable that pays out behind the rover"
//! target = "body.force_x"
//! expression = "-k * max(travelled, 0)"
//! [effect.parameters.k]                          # called `cable.k` everywhere
//! neutral = 0.0                                  # the default: changes nothing, bit for bit
//! min = 0.0
//! max = 10.0
//! unit = "N/m"
//! about = "Stiffness"
//!
//! [[effect]]
//! id = "wet_patch"
//! about = "Weaker soil between 2 m and 3 m"
//! target = "soil.cohesion"
//! mode = "factor"                                # or "add"; soil.* and wheel.* only
//! expression = "1 - a * 0.5 * (tanh((x - 2) / 0.05) - tanh((x - 3) / 0.05))"
//! parameters = { a = { neutral = 0.0, min = 0.0, max = 0.9, about = "Share of the cohesion that is lost" } }
//! ```
//!
//! The tables stand in a model file, in `experiment.toml`, or in a file of their own that
//! [`Model::add_effects`](crate::model::Model::add_effects) and `--effects` of the command line take. Such an effect is
//! set, calibrated, exported and listed like those of the library.
//!
//! | target | acts on | signals |
//! |---|---|---|
//! | `soil.cohesion`, `.friction_angle`, `.k_c`, `.k_phi`, `.exponent`, `.shear_modulus`, `.c1`, `.c2`, `.damping`, `wheel.radius`, `.width` | the soil and the wheel as one contact sees them, by `factor` or `add` | `wheel` (1 at the rear), `x`, `contact_angle`, `slip`, `sinkage`, `normal_velocity`, `velocity` |
//! | `contact.normal_force`, `.drawbar_pull` (N), `.torque` (N m) | added where the wheel touches the ground; the normal force never falls below 0 | the same and `normal_force`, `drawbar_pull`, `torque` before any such effect |
//! | `drive.friction` (N m) | friction torque of each drive, wheel side, positive against forward turning | `speed` |
//! | `body.force_x` (N) | horizontal force at the chassis reference point | `travelled`, `velocity` |
//!
//! Signals are in SI units, as in [`Place`] and [`BodyMotion`]. An expression knows `+ - * / ^`, parentheses, `pi`,
//! `abs`, `sign`, `sqrt`, `exp`, `ln`, `sin`, `cos`, `tan`, `asin`, `acos`, `atan`, `tanh`, `min(a, b)` and
//! `max(a, b)`. A power of a negative base needs a whole number as exponent.
//!
//! The text is parsed once, with the crate winnow; nothing of it is run. It is then evaluated over the scalar of the
//! physics, dual numbers included, so derivatives are exact, see [`Derivatives`]. (Of the crates that parse and
//! evaluate, exmex binds a sign before a power, so that -x^2 is x^2, and gives no place of an error; evalexpr's
//! licence is the AGPL; fasteval and meval are not maintained and know f64 only.)
//!
//! A value or derivative that is not finite, or a value that leaves a parameter of the soil without a meaning, ends the computation with an
//! [`ExpressionFailure`].

mod definition;
mod parse;
mod program;
mod target;

use super::{BodyMotion, Local, Place};
use crate::contact::Forces;
use crate::scalar::Scalar;
use bekker_modeldescription::{Parameters, Variable, join};
use num_dual::Dual;
use program::Program;
use std::sync::Arc;
use target::{Hook, Target};

pub(crate) use definition::check_id;
pub use definition::{DefinitionError, EffectDefinition, ParameterDefinition};
pub use target::Mode;

/// How a computation obtains the derivatives of an effect in its parameters and signals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Derivatives {
    /// Exact everywhere, but for the infinite ones of `sqrt` and `^` at a base of 0 and of `asin` and `acos` at 1 and
    /// -1, which are left out.
    Exact,
    /// The same, and one-sided at the kinks of `abs`, `sign`, `min` and `max`, where there is no derivative.
    ExactBesideKinks,
}

/// What every expression must give.
const FINITE: &str = "a finite number with finite derivatives";

/// An expression whose value has no meaning in the simulation.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("effect `{id}`: {target} would be {value} where {place}; expected {expected}")]
pub struct ExpressionFailure {
    /// The effect.
    pub id: Box<str>,
    /// What it acts on.
    pub target: Box<str>,
    /// The value.
    pub value: f64,
    /// Signals and parameters at that instant.
    pub place: Box<str>,
    /// What was expected.
    pub expected: Box<str>,
}

/// What is the same for all scalars.
#[derive(Debug)]
struct Shared {
    definition: EffectDefinition,
    target: Target,
    mode: Mode,
    program: Program,
    variables: Vec<Variable>,
}

/// An effect of the user's own.
#[derive(Clone, Debug)]
pub struct CustomEffect<S = f64> {
    shared: Arc<Shared>,
    /// Values of the parameters, in the order of their names.
    values: Vec<S>,
}

impl<S: PartialEq> PartialEq for CustomEffect<S> {
    fn eq(&self, other: &Self) -> bool {
        self.shared.definition == other.shared.definition && self.values == other.values
    }
}

impl<S> CustomEffect<S> {
    /// The definition.
    #[must_use]
    pub fn definition(&self) -> &EffectDefinition {
        &self.shared.definition
    }

    /// The id.
    #[must_use]
    pub fn id(&self) -> &str {
        &self.shared.definition.id
    }

    /// What kind of derivatives it has.
    #[must_use]
    pub fn derivatives(&self) -> Derivatives {
        if self.shared.program.is_smooth() { Derivatives::Exact } else { Derivatives::ExactBesideKinks }
    }
}

impl<S: Scalar> CustomEffect<S> {
    /// Whether it acts at a hook: not while all its parameters are exactly neutral.
    fn acts_at(&self, hook: Hook) -> bool {
        let neutral = |(value, variable): (&S, &Variable)| value.is_exactly(variable.default);
        self.shared.target.hook() == hook && !self.values.iter().zip(&self.shared.variables).all(neutral)
    }

    fn value(&self, signals: &[S]) -> Result<S, ExpressionFailure> {
        let value = self.shared.program.evaluate(|k| self.values[k], |k| signals[k]);
        if value.all_finite() { Ok(value) } else { Err(self.failure(value, signals, FINITE)) }
    }

    /// The value and its slope in the only signal.
    fn slope(&self, signal: S) -> Result<(S, S), ExpressionFailure> {
        let parameter = |k: usize| Dual::from_re(self.values[k]);
        let result = self.shared.program.evaluate(parameter, |_| Dual::from_re(signal).derivative());
        let Dual { re: value, eps: slope } = result;
        if value.all_finite() && slope.all_finite() {
            return Ok((value, slope));
        }
        Err(self.failure(value, &[signal], FINITE))
    }

    fn failure(&self, value: S, signals: &[S], expected: &str) -> ExpressionFailure {
        let parameters = self.shared.variables.iter().zip(&self.values);
        let parameters = parameters.map(|(variable, value)| format!("{} = {}", variable.name, value.value()));
        let signals: Vec<f64> = signals.iter().map(|signal| signal.value()).collect();
        ExpressionFailure {
            id: self.id().into(),
            target: self.definition().target.as_str().into(),
            value: value.value(),
            place: format!("{} and {}", self.place(&signals), parameters.collect::<Vec<_>>().join(", ")).into(),
            expected: expected.into(),
        }
    }

    /// The signals in words.
    fn place(&self, signals: &[f64]) -> String {
        let named = self.shared.target.hook().signals().iter().zip(signals);
        named.map(|((name, ..), value)| format!("{name} = {value}")).collect::<Vec<_>>().join(", ")
    }

    fn change_parameter(&self, signals: &[S], local: &mut Local<S>) -> Result<(), ExpressionFailure> {
        let value = self.value(signals)?;
        let Some((place, allowed)) = self.shared.target.parameter(local) else { return Ok(()) };
        *place = match self.shared.mode {
            Mode::Factor => *place * value,
            Mode::Add => *place + value,
        };
        if allowed.contains(&place.value()) {
            return Ok(());
        }
        let bound = |bound: f64| if bound.abs() == f64::MAX { "any".to_owned() } else { format!("{bound}") };
        let expected = match *allowed.start() {
            f64::MIN_POSITIVE => "more than 0".to_owned(),
            low => format!("{} .. {}", bound(low), bound(*allowed.end())),
        };
        Err(self.failure(*place, signals, &expected))
    }
}

/// The effects of the user's own in a rover, in the order in which they were added.
#[derive(Clone, Debug, PartialEq)]
pub struct CustomEffects<S = f64>(Vec<CustomEffect<S>>);

impl<S> Default for CustomEffects<S> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<S: Copy> CustomEffects<S> {
    /// The same effects over another scalar.
    #[must_use]
    pub fn map<T>(&self, f: &dyn Fn(S) -> T) -> CustomEffects<T> {
        let mapped = |effect: &CustomEffect<S>| CustomEffect {
            shared: Arc::clone(&effect.shared),
            values: effect.values.iter().map(|value| f(*value)).collect(),
        };
        CustomEffects(self.0.iter().map(mapped).collect())
    }
}

impl<S: Scalar> CustomEffects<S> {
    /// The effects.
    pub fn iter(&self) -> impl Iterator<Item = &CustomEffect<S>> {
        self.0.iter()
    }

    /// Values of an effect's parameters, in the order of their names.
    #[cfg(feature = "experiments")]
    pub(crate) fn values_of(&mut self, id: &str) -> Option<&mut [S]> {
        self.0.iter_mut().find(|effect| effect.id() == id).map(|effect| effect.values.as_mut_slice())
    }

    fn at(&self, hook: Hook) -> impl Iterator<Item = &CustomEffect<S>> {
        self.0.iter().filter(move |effect| effect.acts_at(hook))
    }

    pub(super) fn contact(&self, place: &Place<S>, local: &mut Local<S>) -> Result<(), ExpressionFailure> {
        self.at(Hook::Contact).try_for_each(|effect| effect.change_parameter(&contact_signals(place), local))
    }

    pub(super) fn forces(&self, place: &Place<S>, forces: &mut Forces<S>) -> Result<(), ExpressionFailure> {
        if self.0.is_empty() || place.sinkage.value() <= 0.0 {
            return Ok(());
        }
        let [wheel, x, angle, slip, sinkage, normal_velocity, velocity] = contact_signals(place);
        let Forces { normal, drawbar, torque } = *forces;
        let signals = [wheel, x, angle, slip, sinkage, normal_velocity, velocity, normal, drawbar, torque];
        for effect in self.at(Hook::Forces) {
            let value = effect.value(&signals)?;
            match effect.shared.target {
                // The ground pushes and does not pull.
                Target::NormalForce => forces.normal = (forces.normal + value).larger(S::from(0.0)),
                Target::DrawbarPull => forces.drawbar += value,
                _ => forces.torque += value,
            }
        }
        Ok(())
    }

    pub(super) fn drive_friction(&self, speed: S) -> Result<(S, S), ExpressionFailure> {
        self.at(Hook::Drive).try_fold((S::from(0.0), S::from(0.0)), |sum, effect| {
            effect.slope(speed).map(|(torque, slope)| (sum.0 + torque, sum.1 + slope))
        })
    }

    pub(super) fn body_force(&self, motion: &BodyMotion<S>) -> Result<S, ExpressionFailure> {
        self.at(Hook::Body)
            .try_fold(S::from(0.0), |sum, effect| Ok(sum + effect.value(&[motion.travelled, motion.velocity])?))
    }
}

fn contact_signals<S: Scalar>(place: &Place<S>) -> [S; 7] {
    let wheel = S::from((place.wheel + 1) as f64);
    [
        wheel,
        place.x.unwrap_or(S::from(0.0)),
        place.contact_angle,
        place.slip,
        place.sinkage,
        place.normal_velocity,
        place.velocity,
    ]
}

impl CustomEffects {
    /// Adds an effect; one that is there already, with the same definition, stays as it is.
    pub(super) fn add(&mut self, definition: EffectDefinition) -> Result<(), DefinitionError> {
        match self.0.iter().find(|effect| effect.id() == definition.id) {
            Some(present) if *present.definition() == definition => return Ok(()),
            Some(_) => {
                let owner = "another effect of the user's own".to_owned();
                return Err(DefinitionError::Taken { id: definition.id, owner });
            }
            None => self.0.push(definition.build()?),
        }
        Ok(())
    }
}

impl<S: Scalar> Parameters<S> for CustomEffects<S> {
    fn visit(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut S)) {
        for effect in &mut self.0 {
            for (variable, value) in effect.shared.variables.iter().zip(&mut effect.values) {
                f(Variable { name: join(prefix, &variable.name), ..variable.clone() }, value);
            }
        }
    }

    fn values(&self, f: &mut dyn FnMut(S)) {
        self.0.iter().flat_map(|effect| &effect.values).for_each(|value| f(*value));
    }
}
