//! A figure as the page draws it: numbers in the units of its labels, and what they are.

use serde::Serialize;

/// Places of colours in the page's list, which differ for people with every kind of colour vision.
pub(in crate::report) const COLOURS: [usize; 6] = [0, 1, 2, 3, 5, 7];
/// The place of grey.
pub(in crate::report) const GREY: usize = 6;

/// One figure.
#[derive(Clone, Debug, Serialize)]
pub(in crate::report) struct Figure {
    pub x: Scale,
    pub y: Scale,
    pub traces: Vec<Trace>,
    /// Half the height of a grey band about zero.
    pub band: Option<f64>,
    /// A dotted line.
    pub level: Option<f64>,
    /// A shaded range of the abscissa.
    pub inside: Option<[f64; 2]>,
}

/// An axis.
#[derive(Clone, Debug, Default, Serialize)]
pub(in crate::report) struct Scale {
    pub label: String,
    /// Names in the place of the numbers 0, 1, 2.
    pub names: Vec<String>,
    pub logarithmic: bool,
}

impl Scale {
    /// An axis of numbers.
    pub fn numbers(label: &str) -> Self {
        Self { label: label.to_owned(), ..Self::default() }
    }
}

/// How a trace is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(in crate::report) enum Mark {
    Line,
    Dashed,
    Points,
    /// Larger points for means.
    Means,
    /// Points joined by lines.
    Joined,
}

/// Values over an abscissa; a value that is not finite is a gap.
#[derive(Clone, Debug, Serialize)]
pub(in crate::report) struct Trace {
    pub name: String,
    pub mark: Mark,
    pub colour: usize,
    #[serde(serialize_with = "short")]
    pub x: Vec<f64>,
    #[serde(serialize_with = "short")]
    pub y: Vec<f64>,
    /// Half the length of an error bar or of a band at each place; none where empty.
    #[serde(serialize_with = "short")]
    pub spread: Vec<f64>,
}

impl Trace {
    /// A trace without spread.
    pub fn new(name: &str, mark: Mark, colour: usize, x: Vec<f64>, y: Vec<f64>) -> Self {
        Self { name: name.to_owned(), mark, colour, x, y, spread: Vec::new() }
    }
}

impl Figure {
    /// A figure without bands and levels.
    pub fn new(x: Scale, y: Scale, traces: Vec<Trace>) -> Self {
        Self { x, y, traces, band: None, level: None, inside: None }
    }
}

/// Five digits are more than a screen shows, and keep the file small.
fn short<S: serde::Serializer>(values: &[f64], to: S) -> Result<S::Ok, S::Error> {
    let five = |value: &f64| value.is_finite().then(|| format!("{value:.4e}").parse::<f64>().unwrap_or(*value));
    to.collect_seq(values.iter().map(five))
}
