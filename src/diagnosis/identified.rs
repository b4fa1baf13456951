//! What a calibration determines: which parameters by themselves, which only together with others, and which not.
//!
//! Before the experiment a parameter is open by its bounds (a uniform distribution) and by what was known of it. How much of that is left
//! afterwards, as a ratio of standard deviations in the search coordinate, says whether it was determined; how much would be left if all
//! others were known says whether only the others stand in the way.

use super::calibrate::Calibration;
use super::information::Information;
use super::problem::Problem;
use nalgebra::DMatrix;
use serde::Serialize;

/// Share of what was open before that may be left of a parameter that counts as determined.
const DETERMINED: f64 = 0.1;
/// Correlation from which a parameter is named among those that another one trades with.
const TRADES: f64 = 0.5;
/// Parameters that are named so, at most.
const MOST_NAMED: usize = 3;

/// How well a calibration determines a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Determined {
    /// By itself: at most a tenth of what was open before is left.
    Alone,
    /// Only together with others: at most a tenth would be left if they were known.
    Together,
    /// Not: more is left even if all others were known.
    Not,
}

/// What a calibration determines of one parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Identified {
    /// Name of the parameter.
    pub name: String,
    /// How well it is determined.
    pub determined: Determined,
    /// Standard deviation over that of what was open before, by its bounds and what was known of it.
    pub left: f64,
    /// The same if all other parameters were known.
    pub left_alone: f64,
    /// Where it is determined only together with others: this one a standard error higher, and how those that it trades with the most then
    /// move, in words. Such a change the measurements hardly see.
    pub trade: Option<String>,
}

/// What the measurements determine of the parameters of a calibrated baseline.
pub(crate) fn identified(problem: &Problem, fit: &Calibration, information: &Information) -> Vec<Identified> {
    let mut found = identified_at(problem, &fit.values(), information);
    let at_bound = |name: &str| fit.parameters.iter().any(|own| own.variable.name == name && own.at_bound);
    found.retain(|one| !at_bound(&one.name));
    found
}

/// What measurements with this information determine of the baseline's parameters, which stand at `values`.
pub(crate) fn identified_at(problem: &Problem, values: &[f64], information: &Information) -> Vec<Identified> {
    let free = &problem.base;
    let step = |k: usize, change: f64| {
        let (name, unit) = (&free[k].variable.name, free[k].variable.unit.symbol);
        let moved = free[k].value(free[k].coordinate(values[k]) + change);
        if moved == values[k] {
            format!("{name} beyond its bound")
        } else if free[k].is_logarithmic() {
            format!("{name} times {}", two_digits(moved / values[k]))
        } else {
            let unit = if unit == "1" { String::new() } else { format!(" {unit}") };
            format!("{name} {}{unit}", signed(moved - values[k]))
        }
    };
    let names: Vec<&str> = free.iter().map(|free| free.variable.name.as_str()).collect();
    let mut found = of_precisions(&names, &information.before(), &information.after(), &step).unwrap_or_default();
    let factor = |name: &str| free.iter().any(|free| free.variable.name == name && free.is_factor());
    found.retain(|one| !factor(&one.name));
    found
}

/// The same from precisions of the search coordinates before and after the experiment. `None` where nothing is known of some direction.
fn of_precisions(
    names: &[&str],
    before: &DMatrix<f64>,
    precision: &DMatrix<f64>,
    step: &dyn Fn(usize, f64) -> String,
) -> Option<Vec<Identified>> {
    let (open, after) = (before.clone().cholesky()?.inverse(), precision.clone().cholesky()?.inverse());
    let of = |k: usize| {
        let left = (after[(k, k)] / open[(k, k)]).sqrt();
        let left_alone = (1.0 / (precision[(k, k)] * open[(k, k)])).sqrt();
        let determined = match (left <= DETERMINED, left_alone <= DETERMINED) {
            (true, _) => Determined::Alone,
            (false, true) => Determined::Together,
            (false, false) => Determined::Not,
        };
        let trade = (determined == Determined::Together).then(|| trade(&after, k, step));
        Identified { name: names[k].to_owned(), determined, left, left_alone, trade }
    };
    Some((0..names.len()).map(of).collect())
}

/// Parameter `k` a standard deviation higher, and what those that it trades with do on average then.
fn trade(covariance: &DMatrix<f64>, k: usize, step: &dyn Fn(usize, f64) -> String) -> String {
    let deviation = covariance[(k, k)].sqrt();
    let correlation = |j: usize| covariance[(j, k)] / (deviation * covariance[(j, j)].sqrt());
    let mut others: Vec<usize> = (0..covariance.nrows()).filter(|j| *j != k).collect();
    others.sort_by(|a, b| correlation(*b).abs().total_cmp(&correlation(*a).abs()));
    // The strongest is named in any case: something stands in the way.
    let named = others.iter().filter(|j| correlation(**j).abs() >= TRADES).count().clamp(1, MOST_NAMED);
    let moved: Vec<String> = others.iter().take(named).map(|j| step(*j, covariance[(*j, k)] / deviation)).collect();
    format!("{} with {}", step(k, deviation), moved.join(", "))
}

/// A positive number with two digits behind the point, or as many significant ones.
fn two_digits(value: f64) -> String {
    if (0.1..100.0).contains(&value) { format!("{value:.2}") } else { format!("{value:.1e}") }
}

/// Two significant digits with the sign.
fn signed(value: f64) -> String {
    let rounded = format!("{value:.1e}").parse::<f64>().unwrap_or(value);
    format!("{}{}", if rounded < 0.0 { "-" } else { "+" }, rounded.abs())
}

/// What a calibration determines, a sentence for each kind of parameter; none where nothing was looked at.
#[must_use]
pub fn determined_in_words(all: &[Identified]) -> Vec<String> {
    let named = |how: Determined| -> Vec<&str> {
        all.iter().filter(|one| one.determined == how).map(|one| one.name.as_str()).collect()
    };
    let mut words = Vec::new();
    for (how, says) in
        [(Determined::Alone, "determined by these measurements"), (Determined::Not, "not determined by them")]
    {
        let names = named(how);
        if !names.is_empty() {
            words.push(format!("{says}: {}", names.join(", ")));
        }
    }
    let together = all.iter().filter(|one| one.determined == Determined::Together);
    let trades: Vec<&str> = together.filter_map(|one| one.trade.as_deref()).collect();
    if !trades.is_empty() {
        words.insert(
            words.len().min(1),
            format!("only in combination, changes that hardly show: {}", trades.join("; ")),
        );
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(k: usize, change: f64) -> String {
        format!("{} {change:+.3}", ["a", "b", "c"][k])
    }

    #[test]
    fn analytic_a_known_sum_is_named_as_a_trade() {
        // a + b is measured to 0.001, c to 0.01; each was open to 1.
        let sum = 1e6;
        let measured = DMatrix::from_row_slice(3, 3, &[sum, sum, 0.0, sum, sum, 0.0, 0.0, 0.0, 1e4]);
        let before = DMatrix::identity(3, 3);
        let found = of_precisions(&["a", "b", "c"], &before, &(measured + &before), &plain).expect("precisions");
        let how: Vec<Determined> = found.iter().map(|one| one.determined).collect();
        assert_eq!(how, [Determined::Together, Determined::Together, Determined::Alone]);
        // Of two unknowns with one equation each keeps half of its variance.
        assert!((found[0].left - 0.5_f64.sqrt()).abs() < 1e-3, "{}", found[0].left);
        assert_eq!(found[0].trade.as_deref(), Some("a +0.707 with b -0.707"));
        assert_eq!(found[2].trade, None);
    }

    #[test]
    fn analytic_what_nothing_measures_is_not_determined() {
        let measured = DMatrix::from_row_slice(2, 2, &[1e4, 0.0, 0.0, 0.0]);
        let before = DMatrix::identity(2, 2);
        let found = of_precisions(&["a", "b"], &before, &(measured + &before), &plain).expect("precisions");
        assert_eq!((found[1].determined, found[1].left, found[1].left_alone), (Determined::Not, 1.0, 1.0));
        let words = determined_in_words(&found);
        assert_eq!(words, ["determined by these measurements: a", "not determined by them: b"]);
    }
}
