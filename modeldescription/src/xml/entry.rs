//! One variable of a description: an entry of the vocabulary and its part in a simulation.

use super::{DescriptionError, finite, writable};
use crate::{Role, Unit, Variable};
use std::borrow::Cow;

/// Who sets a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Causality {
    /// Time.
    Independent,
    /// The user, before or (where tunable) during a simulation.
    Parameter,
    /// Another model, at every communication point.
    Input,
    /// The model.
    Output,
    /// The model, for itself: continuous states and their derivatives.
    Local,
}

impl Causality {
    /// Both versions of the standard use these words.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Independent => "independent",
            Self::Parameter => "parameter",
            Self::Input => "input",
            Self::Output => "output",
            Self::Local => "local",
        }
    }
}

/// When a variable may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variability {
    /// Not after initialization.
    Fixed,
    /// At communication points.
    Tunable,
    /// At events.
    Discrete,
    /// Always.
    Continuous,
}

impl Variability {
    /// Both versions of the standard use these words.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Fixed => "fixed",
            Self::Tunable => "tunable",
            Self::Discrete => "discrete",
            Self::Continuous => "continuous",
        }
    }
}

/// One value of an enumeration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Item {
    /// Name of the value.
    pub name: &'static str,
    /// Its number.
    pub value: i64,
    /// Its meaning.
    pub doc: &'static str,
}

/// Type of a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A 64 bit floating point number.
    Real,
    /// A signed integer of 32 bits, which FMI 2.0 and 3.0 both have.
    Integer,
    /// One of a few named integers.
    Enumeration {
        /// Name of the type.
        name: &'static str,
        /// Its values.
        items: &'static [Item],
    },
}

/// A variable and its part in a simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Name, meaning, unit and bounds.
    pub variable: Variable,
    /// Type.
    pub kind: Kind,
    /// Value before a simulation; for an output without meaning.
    pub start: f64,
    /// Who sets it.
    pub causality: Causality,
    /// When it may change.
    pub variability: Variability,
    /// For the derivative of a continuous state: the reference of that state. A variable is a continuous state where
    /// another one is its derivative.
    pub derivative_of: Option<usize>,
    /// Typical size, where one is known.
    pub nominal: Option<f64>,
    /// Of what the model computes: references of the inputs and continuous states on which the value depends at the same
    /// instant; `None` where it is all of them.
    pub dependencies: Option<Vec<usize>>,
    /// As `dependencies`, for the inputs on which the value depends at the start, where parameters decide the states.
    pub initial_dependencies: Option<Vec<usize>>,
}

impl Entry {
    /// The simulation's time, s.
    #[must_use]
    pub fn time() -> Self {
        let variable = Variable {
            name: "time".into(),
            doc: "Simulation time.".into(),
            unit: Unit::SECOND,
            default: 0.0,
            min: f64::NEG_INFINITY,
            max: f64::INFINITY,
            role: Role::Signal,
            source: Cow::Borrowed(""),
        };
        Self::real(variable, 0.0, Causality::Independent, Variability::Continuous)
    }

    fn real(variable: Variable, start: f64, causality: Causality, variability: Variability) -> Self {
        Self {
            variable,
            kind: Kind::Real,
            start,
            causality,
            variability,
            derivative_of: None,
            nominal: None,
            dependencies: None,
            initial_dependencies: None,
        }
    }

    /// A parameter with the value `start`, which may not change after initialization.
    #[must_use]
    pub fn parameter(variable: Variable, start: f64) -> Self {
        Self::real(variable, start, Causality::Parameter, Variability::Fixed)
    }

    /// An input with the value `start` until another is set.
    #[must_use]
    pub fn input(variable: Variable, start: f64) -> Self {
        Self::real(variable, start, Causality::Input, Variability::Continuous)
    }

    /// An output.
    #[must_use]
    pub fn output(variable: Variable) -> Self {
        let start = variable.default;
        Self::real(variable, start, Causality::Output, Variability::Continuous)
    }

    /// A continuous state of typical size `nominal`, computed at the start.
    #[must_use]
    pub fn state(variable: Variable, nominal: f64) -> Self {
        Self { causality: Causality::Local, nominal: Some(nominal), ..Self::output(variable) }
    }

    /// The time derivative of the continuous state with the reference `state`.
    #[must_use]
    pub fn derivative(variable: Variable, state: usize) -> Self {
        Self { causality: Causality::Local, derivative_of: Some(state), ..Self::output(variable) }
    }

    /// An output that is one of a few named integers.
    #[must_use]
    pub fn enumeration(variable: Variable, name: &'static str, items: &'static [Item]) -> Self {
        let kind = Kind::Enumeration { name, items };
        Self { kind, variability: Variability::Discrete, ..Self::output(variable) }
    }

    /// An output that is an integer.
    #[must_use]
    pub fn integer(variable: Variable) -> Self {
        Self { kind: Kind::Integer, variability: Variability::Discrete, ..Self::output(variable) }
    }

    /// A parameter that is an integer, which may not change after initialization.
    #[must_use]
    pub fn integer_parameter(variable: Variable, start: f64) -> Self {
        Self { kind: Kind::Integer, ..Self::parameter(variable, start) }
    }

    /// The same with these [`dependencies`](Self::dependencies), at any instant and at the start.
    #[must_use]
    pub fn depending_on(self, at_any_instant: Vec<usize>, at_the_start: Vec<usize>) -> Self {
        Self { dependencies: Some(at_any_instant), initial_dependencies: Some(at_the_start), ..self }
    }

    pub(super) fn check(&self) -> Result<(), DescriptionError> {
        writable(&self.variable.name)?;
        writable(&self.variable.doc)?;
        finite(&format!("the start value of `{}`", self.variable.name), self.start)
    }
}
