//! How a candidate is looked at from a fit: derivatives where its neutral value shows something, finite changes where it does not.

use crate::diagnosis::free::Free;
use crate::diagnosis::layout::Layout;
use crate::diagnosis::linear_algebra::Reach;
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::problem::{Candidate, Problem};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Seed and number of the draws of an effect whose parameters cannot all be seen at its neutral value.
const SEED: u64 = 1969;
/// A prime, so that the strata of no two of the first six parameters go together.
const DRAWS: usize = 7;

/// Share of a parameter's range that a start keeps from its bounds.
const MARGIN: f64 = 0.002;

/// Share of the largest value of a signal below which a change is rounding: a thousand times what adds up over a few thousand steps.
const ROUNDING: f64 = 1e-9;

/// Share of a parameter's range over which its derivative beside the neutral value is taken.
const SMALL_CHANGE: f64 = 1e-4;

/// Change of the modelled values, in the layout's order, with one coordinate.
#[derive(Clone, Debug)]
pub(crate) struct Column {
    pub values: Vec<f64>,
    /// How far the coordinate may go from where the column was taken.
    pub reach: Reach,
}

/// One way of looking at an effect: columns that are fitted together.
#[derive(Clone, Debug)]
pub(crate) struct View {
    pub columns: Vec<Column>,
    way: Way,
}

#[derive(Clone, Debug)]
enum Way {
    /// Derivatives in some of the parameters, from the neutral values.
    Slopes { members: Vec<usize>, origin: Vec<f64> },
    /// A finite change to these values.
    Change(Vec<f64>),
}

impl View {
    /// Parameters of the effect that the columns belong to, one each; `None` where the view is a finite change.
    pub fn members(&self) -> Option<&[usize]> {
        match &self.way {
            Way::Slopes { members, .. } => Some(members),
            Way::Change(_) => None,
        }
    }

    /// Parameter values of the effect for coefficients of the columns, to start a refit from.
    pub fn start(&self, free: &[Free], coefficients: &[f64]) -> Vec<f64> {
        let (members, origin) = match &self.way {
            Way::Change(draw) => return draw.clone(),
            Way::Slopes { members, origin } => (members, origin),
        };
        let mut values = origin.clone();
        for (k, d) in members.iter().zip(coefficients) {
            values[*k] += d * free[*k].slope(origin[*k]);
        }
        // Well inside the bounds: the linear guess may overshoot, and a search cannot leave a corner.
        let inside = |(value, free): (f64, &Free)| {
            let margin = MARGIN * (free.variable.max - free.variable.min);
            value.clamp(free.variable.min + margin, free.variable.max - margin)
        };
        values.into_iter().zip(free).map(inside).collect()
    }
}

/// Where a candidate is looked at from: a fit, what it gives, and the least change that is more than rounding.
pub(super) struct Place<'a> {
    pub problem: &'a Problem<'a>,
    pub effects: &'a [String],
    pub values: &'a [f64],
    pub modelled: &'a [f64],
    pub rounding: &'a Rounding,
}

impl Place<'_> {
    /// Free parameters with those of a candidate.
    fn with(&self, candidate: &Candidate) -> Vec<Free> {
        let with: Vec<String> = self.effects.iter().chain([&candidate.id]).cloned().collect();
        self.problem.free(&with)
    }
}

/// The views of a candidate, whose own derivatives at its neutral values are `columns`.
///
/// # Errors
/// [`PredictionError`] where the model cannot be posed with the candidate.
pub(super) fn views(at: &Place, candidate: &Candidate, columns: Vec<Vec<f64>>) -> Result<Vec<View>, PredictionError> {
    let Place { problem, rounding, .. } = *at;
    let (still, members): (Vec<usize>, Vec<usize>) = (0..columns.len()).partition(|k| rounding.hides(&columns[*k]));
    let mut views = Vec::new();
    if !members.is_empty() {
        let column = |k: &usize| {
            let free = &candidate.free[*k];
            Column { values: columns[*k].clone(), reach: free.reach(free.start) }
        };
        let origin = candidate.free.iter().map(|free| free.start).collect();
        views.push(View {
            columns: members.iter().map(column).collect(),
            way: Way::Slopes { members: members.clone(), origin },
        });
    }
    if !still.is_empty() {
        // A parameter that only says how another one acts shows nothing at the neutral value. Where not every effect is fitted, what
        // the other one would change has to be seen under both ends of its range.
        if problem.strategy().budget().singles.is_some() && !members.is_empty() {
            views.extend(views_at_far_ends(at, candidate, &still, &members)?);
        }
        views.extend(finite_views(at, candidate)?);
    }
    Ok(views)
}

/// Views by those parameters that change something measured at the neutral values, one for each parameter that does not: that
/// parameter is at the end of its range away from the neutral value. The effect is neutral there too.
fn views_at_far_ends(
    at: &Place,
    candidate: &Candidate,
    still: &[usize],
    members: &[usize],
) -> Result<Vec<View>, PredictionError> {
    let free = at.with(candidate);
    let own = &candidate.free;
    let mut views = Vec::new();
    at.problem.predict(&free, |predict| {
        for far in still {
            let mut origin: Vec<f64> = own.iter().map(|free| free.start).collect();
            origin[*far] += own[*far].span();
            let column = |k: &usize| {
                let mut beside = origin.clone();
                beside[*k] += SMALL_CHANGE * own[*k].span();
                let all: Vec<f64> = at.values.iter().chain(&beside).copied().collect();
                let changed = predict.values(&all).ok()?;
                let per_coordinate = own[*k].slope(origin[*k]) / (SMALL_CHANGE * own[*k].span());
                let values = changed.iter().zip(at.modelled).map(|(a, b)| (a - b) * per_coordinate).collect();
                Some(Column { values, reach: own[*k].reach(origin[*k]) })
            };
            let columns: Option<Vec<Column>> = members.iter().map(column).collect();
            let seen = columns.filter(|columns| columns.iter().all(|column| !at.rounding.hides(&column.values)));
            let way = Way::Slopes { members: members.to_vec(), origin };
            views.extend(seen.map(|columns| View { columns, way }));
        }
    })?;
    Ok(views)
}

/// For every value how much a change over the whole range of a parameter has to exceed to count: what rounding makes of the largest
/// value of its signal. Derivatives of an effect that is neutral are not always exact zeros.
pub(super) struct Rounding(Vec<f64>);

impl Rounding {
    pub fn of(layout: &Layout, modelled: &[f64]) -> Self {
        let mut least = vec![0.0; modelled.len()];
        for block in &layout.blocks {
            let largest = modelled[block.range.clone()].iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            least[block.range.clone()].fill(ROUNDING * largest);
        }
        Self(least)
    }

    /// Whether nothing measured changes.
    pub fn hides(&self, column: &[f64]) -> bool {
        column.iter().zip(&self.0).all(|(x, least)| x.is_nan() || x.abs() <= *least)
    }
}

/// Finite changes at draws over the bounds, in a row that the model can compute.
fn finite_views(at: &Place, candidate: &Candidate) -> Result<Vec<View>, PredictionError> {
    let free = at.with(candidate);
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let mut views = Vec::new();
    at.problem.predict(&free, |predict| {
        for k in 0..DRAWS {
            // Stratified in each coordinate, so that few draws cover the range.
            let draw: Vec<f64> = candidate
                .free
                .iter()
                .enumerate()
                .map(|(j, free)| {
                    let share = ((k * (1 + j % (DRAWS - 1))) % DRAWS) as f64 + rng.random::<f64>();
                    free.variable.min + (free.variable.max - free.variable.min) * share / DRAWS as f64
                })
                .collect();
            let all: Vec<f64> = at.values.iter().chain(&draw).copied().collect();
            let Ok(changed) = predict.values(&all) else { continue };
            let change: Vec<f64> = changed.iter().zip(at.modelled).map(|(a, b)| a - b).collect();
            if !at.rounding.hides(&change) {
                let columns =
                    vec![Column { values: change, reach: Reach { low: 0.0, high: room(&candidate.free, &draw) } }];
                views.push(View { columns, way: Way::Change(draw) });
            }
        }
    })?;
    Ok(views)
}

/// By what factor a draw can grow, all its parameters together, until one of them is on a bound.
fn room(free: &[Free], draw: &[f64]) -> f64 {
    let factor = |(free, value): (&Free, &f64)| {
        let end = if *value > free.start { free.variable.max } else { free.variable.min };
        if *value == free.start { f64::INFINITY } else { (end - free.start) / (value - free.start) }
    };
    free.iter().zip(draw).map(factor).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail by panicking")]
mod tests {
    use super::super::signature::sensitivities;
    use super::*;
    use crate::diagnosis::kinds::synthetic::experiment;
    use crate::model::{ControlKind, Model};

    /// The derivative of the compliance differs by the arm of the torque, which is without influence on a rigid wheel.
    #[test]
    fn property_a_parameter_without_influence_is_seen_at_the_far_end_of_its_range() {
        let experiment = experiment("speed_command", false);
        let mut model = Model::preset("two_wheeled").unwrap();
        model.control.kind = ControlKind::Speed;
        let mut problem = Problem::new(&model, &experiment, &[]).unwrap();
        problem.keep_candidates(&["flexible_wheel".to_owned()]).unwrap();
        problem.coarsen();
        problem.cut();
        let values: Vec<f64> = problem.base.iter().map(|free| free.start).collect();
        let seen = sensitivities(&problem, &[], &values).unwrap();
        let [flexible] = seen.signatures.as_slice() else { panic!("one candidate") };
        let free = &problem.library[0].free;
        let at = |name: &str| free.iter().position(|free| free.variable.name == name).unwrap();
        let (compliance, arm) = (at("flexible_wheel.compliance"), at("flexible_wheel.arm_share"));
        // A unit step along the only column, from which the start shows the origin of the view.
        let slopes: Vec<&View> = flexible.views.iter().filter(|view| view.members() == Some(&[compliance])).collect();
        assert_eq!(slopes.len(), 4, "near, and at the far end of each other parameter");
        let with_arm = |range: std::ops::RangeInclusive<f64>| {
            *slopes.iter().find(|view| range.contains(&view.start(free, &[0.1])[arm])).expect("a view with such an arm")
        };
        let [near, far] = [with_arm(0.0..=0.01), with_arm(0.99..=1.0)];
        let torque =
            problem.layout.blocks.iter().find(|block| block.signal == "wheel[1].torque").unwrap().range.clone();
        let sum = |view: &View| view.columns[0].values[torque.clone()].iter().filter(|x| !x.is_nan()).sum::<f64>();
        assert!(sum(far) > sum(near), "a longer arm takes more torque: {} and {}", sum(far), sum(near));
    }
}
