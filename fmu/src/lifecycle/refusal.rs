//! Why a call is refused, in words for the host's log.

use super::Phase;
use super::stepping::LONGEST;
use crate::model::Failure;

/// Why a call was not carried out. The instance is as before the call, except after [`Refusal::Failed`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// The call is not legal in this phase.
    #[error("not allowed in the phase `{phase}`; expected {expected}")]
    Order {
        /// The phase.
        phase: Phase,
        /// The phases in which the call is legal.
        expected: String,
    },
    /// No variable has this value reference.
    #[error("no variable has the value reference {reference}; the largest is {largest}")]
    Reference {
        /// The reference asked for.
        reference: u32,
        /// The largest one that exists.
        largest: usize,
    },
    /// The variable has another type than the function.
    #[error("`{name}` (value reference {reference}) is {actual}, not {asked}")]
    Type {
        /// The variable.
        name: String,
        /// Its reference.
        reference: u32,
        /// Its type.
        actual: &'static str,
        /// The type that the function works on.
        asked: &'static str,
    },
    /// The variable may not be set, or not now.
    #[error("`{name}` is {what} and cannot be set {when}")]
    ReadOnly {
        /// The variable.
        name: String,
        /// Causality and variability.
        what: String,
        /// `by the importer` or the phase.
        when: String,
    },
    /// The value is outside the variable's bounds, or not a number.
    #[error("{value} is not allowed for `{name}`; expected a finite number in {range}")]
    Value {
        /// The variable.
        name: String,
        /// The value.
        value: f64,
        /// Its bounds and unit.
        range: String,
    },
    /// An output is asked for before it has been computed.
    #[error("`{0}` is an output and has no value before initialization")]
    NotComputed(String),
    /// Numbers of referenced elements and of values differ.
    #[error("the references stand for {references} values, but {values} are given")]
    Length {
        /// How many elements.
        references: usize,
        /// How many values.
        values: usize,
    },
    /// The equations have no value at the point that the importer's integrator tries; it may try another.
    #[error("{0}")]
    Discarded(Failure),
    /// A communication step is longer than one call makes; shorter ones may follow each other.
    #[error(
        "the communication step {size} s is longer than {LONGEST} s, the most in one call; \
         expected shorter steps or, in FMI 3.0, an importer that allows early return"
    )]
    Long {
        /// The step, s.
        size: f64,
    },
    /// A list has the wrong length.
    #[error("there are {expected} {what}, not {given}")]
    Count {
        /// What the list holds.
        what: &'static str,
        /// How many were given.
        given: usize,
        /// How many are expected.
        expected: usize,
    },
    /// A derivative cannot be set or read; the reason follows.
    #[error("{0}")]
    Derivative(String),
    /// A state as bytes cannot be read back.
    #[error("the serialised state is {0}")]
    Bytes(&'static str),
    /// The importer's memory is too small.
    #[error("the state has {needed} bytes, the memory given {given}")]
    Memory {
        /// How many bytes the state has.
        needed: usize,
        /// How many bytes the importer gives.
        given: usize,
    },
    /// A time or a step is not usable.
    #[error("{0}")]
    Time(String),
    /// The simulation has ended; the reason follows.
    #[error("the simulation has ended: {0}")]
    Ended(String),
    /// The model could not start or go on.
    #[error("{0}")]
    Failed(#[from] Failure),
    /// A pointer is NULL or not aligned.
    #[error("`{0}` is NULL or not aligned")]
    Pointer(&'static str),
    /// A text is not UTF-8.
    #[error("`{0}` is not UTF-8 text")]
    Text(&'static str),
    /// The FMU does not offer this.
    #[error("{0}")]
    Unsupported(String),
}
