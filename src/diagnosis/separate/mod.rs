//! Before and after an experiment: what it can tell apart, and which experiment would tell more.

/// An experiment worth making.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Suggestion {
    /// What to do, in one sentence.
    pub text: String,
    /// Effects that it would tell apart or make visible.
    pub effects: Vec<String>,
}
