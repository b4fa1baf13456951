//! Reasons against naming a fitted set of effects although it fits: effects that the set could do without, a soil that
//! no class of soil allows, experiments that may not stand on one soil, a bound that carries the fit.

use super::bootstrap::p_value;
use super::one_soil::{OwnSoil, own_soil};
use super::search::Search;
use super::stage::Stage;
use crate::diagnosis::calibrate::{CalibratedParameter, Calibration};
use crate::diagnosis::linear_algebra::{Basis, dot};
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::thresholds::{ALIKE, CHI_SQUARE_95, HELD_BACK, LEAST_VALUES, LITTLE, NAMED, NORMAL_95, REACH};

/// One reason not to name a set.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Doubt {
    /// Two of its effects change the same.
    Alike { effects: [String; 2], cosine: f64, weaker: String },
    /// The strength of an effect is not told from none.
    Neutral { effect: String, strength: String, loss: f64 },
    /// Without the effect the fit is hardly worse.
    Spare { effect: String, loss: f64, gain: f64 },
    /// So few set-points were measured that another set of parameters may do as well; the weakest effect.
    Few { effect: String, values: usize, parameters: usize },
    /// No class of soil allows the fitted soil.
    Soil(String),
    /// The experiments may not stand on one soil.
    OwnSoil(OwnSoil),
    /// The fit leans on a bound.
    Bound { parameter: String, value: String, gain: f64 },
}

impl Doubt {
    /// The effect that the set could do without.
    pub fn superfluous(&self) -> Option<&str> {
        match self {
            Self::Alike { weaker, .. } => Some(weaker),
            Self::Neutral { effect, .. } | Self::Spare { effect, .. } | Self::Few { effect, .. } => Some(effect),
            Self::Soil(_) | Self::OwnSoil(_) | Self::Bound { .. } => None,
        }
    }

    /// Whether it says that this effect may only stand in for something else. With few set-points an effect may well be a
    /// part of the explanation.
    pub fn is_against(&self, id: &str) -> bool {
        self.superfluous() == Some(id) && !matches!(self, Self::Few { .. })
    }

    /// The reason in a sentence.
    pub fn words(&self) -> String {
        match self {
            Self::Alike { effects: [a, b], cosine, .. } => {
                format!("{a} and {b} look alike here: the cosine of what they change is {cosine:.2}")
            }
            Self::Neutral { effect, strength, loss } => format!(
                "the strength of {effect} is not told from none: {strength}; without it chi-square rises by {loss:.1}"
            ),
            Self::Spare { effect, loss, gain } => {
                format!("{effect} could be left out: chi-square rises by {loss:.1} only, of {gain:.0} that all gain")
            }
            Self::Few { values, parameters, .. } => format!(
                "{values} values at different set-points (and priors) are too few to name anything by a fit of {parameters} parameters"
            ),
            Self::Soil(words) => words.clone(),
            Self::OwnSoil(found) => found.words(),
            Self::Bound { parameter, value, gain } => format!(
                "{parameter} is held at its bound, {value}, and the fit leans on it: beyond it chi-square would fall by about {gain:.0} more"
            ),
        }
    }
}

/// All reasons against naming `effects`, which are fitted. Sets with one effect less are fitted where they are missing.
///
/// # Errors
/// [`PredictionError`] where the model has no answer at the fit.
pub(crate) fn doubts(search: &mut Search, stage: &Stage, effects: &[String]) -> Result<Vec<Doubt>, PredictionError> {
    let mut found = Vec::new();
    // After a stop nothing is fitted any more, and nothing is named.
    let Some(fit) = search.fits.get(effects).filter(|_| !search.watch.stopped()).cloned() else { return Ok(found) };
    let losses: Vec<f64> = effects.iter().map(|id| loss(search, effects, id)).collect();
    for (k, own) in effects.iter().enumerate() {
        found.extend(spare(search, stage, effects, own, losses[k]));
        found.extend(neutral(search, effects, own, &fit, losses[k]));
        for other in &effects[k + 1..] {
            let cosine = stage.cosine(own, other);
            if cosine > ALIKE {
                let j = effects.iter().position(|id| id == other).unwrap_or(k);
                let weaker = if losses[j] < losses[k] { other } else { own }.clone();
                found.push(Doubt::Alike { effects: [own.clone(), other.clone()], cosine, weaker });
            }
        }
    }
    found.extend(few(stage, effects, &fit, &losses));
    found.extend(leaning(search, effects, &fit)?);
    found.extend(super::soil::unbelievable(search, effects, &fit).map(Doubt::Soil));
    // Where an effect is to be left out, the smaller set is asked.
    if search.problem.experiment.parts.len() > 1 && !found.iter().any(|doubt| doubt.superfluous().is_some()) {
        found.extend(own_soil(search, effects, &fit).map(Doubt::OwnSoil));
    }
    Ok(found)
}

/// Whether there are too few set-points for so many parameters.
fn few(stage: &Stage, effects: &[String], fit: &Calibration, losses: &[f64]) -> Option<Doubt> {
    let priors = fit.parameters.iter().filter(|parameter| parameter.prior.is_some()).count();
    let (values, parameters) = (stage.set_points + priors, fit.parameters.len());
    let weakest = (0..effects.len()).min_by(|a, b| losses[*a].total_cmp(&losses[*b]))?;
    (values < LEAST_VALUES * parameters).then(|| Doubt::Few { effect: effects[weakest].clone(), values, parameters })
}

/// Rise of chi-square without one effect of the set, all else fitted again.
fn loss(search: &mut Search, effects: &[String], id: &String) -> f64 {
    let part: Vec<String> = effects.iter().filter(|other| *other != id).cloned().collect();
    if !part.is_empty() {
        search.fit_part(effects, &part);
    }
    search.gain(effects) - search.gain(&part)
}

/// Whether the set could do without an effect of it.
fn spare(search: &Search, stage: &Stage, effects: &[String], own: &str, loss: f64) -> Option<Doubt> {
    let gain = search.gain(effects);
    let noise = p_value(&stage.draws, |draw| draw.single, loss) >= NAMED;
    let little = noise || loss < LITTLE * gain;
    (effects.len() > 1 && little).then(|| Doubt::Spare { effect: own.to_owned(), loss, gain })
}

/// Whether the strength of an effect differs significantly from none: by the rise of chi-square without it, and, where it has one parameter
/// and the set without it was not fitted again from where the whole came, by its standard error too, both against the misfit that stays.
/// A standard error is that of a straight model: the rear contact angle grows with the root of its parameter, so that none at all may lie
/// within two standard errors and yet be impossible.
fn neutral(search: &Search, effects: &[String], own: &str, fit: &Calibration, loss: f64) -> Option<Doubt> {
    let values = fit.values();
    let count = search.problem.part(effects, &values, own).len();
    let of_own = |parameter: &&CalibratedParameter| parameter.variable.name.split('.').next() == Some(own);
    let parameters: Vec<&CalibratedParameter> =
        fit.parameters[search.problem.base.len()..].iter().filter(of_own).collect();
    let scatter = (fit.chi_square / fit.degrees_of_freedom.max(1) as f64).max(1.0);
    let likely = CHI_SQUARE_95[count.clamp(1, CHI_SQUARE_95.len()) - 1];
    let holds = |parameter: &&CalibratedParameter| {
        let from_neutral = (parameter.value - parameter.variable.default).abs();
        parameter.deviation.is_some_and(|deviation| from_neutral <= NORMAL_95 * deviation)
    };
    let refitted_without = search.problem.strategy().budget().refits_from_larger;
    let by_error = count == 1 && !refitted_without && parameters.iter().all(holds);
    (by_error || loss / scatter < likely).then(|| Doubt::Neutral {
        effect: own.to_owned(),
        strength: parameters.iter().map(|parameter| strength(parameter)).collect::<Vec<_>>().join(", "),
        loss,
    })
}

/// A parameter with its standard error.
fn strength(parameter: &CalibratedParameter) -> String {
    let variable = &parameter.variable;
    let error = parameter.deviation.map_or_else(
        || "with an unknown standard error".to_owned(),
        |deviation| format!("with a standard error of {deviation:.2e}"),
    );
    format!("{} = {:.2e} {} {error}", variable.name, parameter.value, variable.unit.symbol)
}

/// Bounds without which the fit would be better by more than another form of the effects is: by the sensitivities. Where
/// nothing is the natural end of a parameter, as with cohesion, it counts as no bound.
fn leaning(search: &Search, effects: &[String], fit: &Calibration) -> Result<Vec<Doubt>, PredictionError> {
    if !fit.parameters.iter().any(|parameter| parameter.at_bound) {
        return Ok(Vec::new());
    }
    let (problem, values) = (search.problem, fit.values());
    let free = problem.free(effects);
    let residual = search.whitened_residual(effects, &values)?;
    let columns = search.whitened_columns(effects, &values)?;
    let inner = Basis::of(columns.iter().zip(&fit.parameters).filter(|(_, p)| !p.at_bound).map(|(column, _)| column));
    let outside = inner.outside(&residual);
    let bar = REACH.max(HELD_BACK * search.gain(effects));
    let mut found = Vec::new();
    for (k, parameter) in fit.parameters.iter().enumerate().filter(|(_, p)| p.at_bound && p.value != 0.0) {
        let column = inner.outside(&columns[k]);
        let size = dot(&column, &column);
        let step = -dot(&column, &outside) / size.max(f64::MIN_POSITIVE);
        let (low, high) = free[k].bounds();
        let outward = if free[k].coordinate(parameter.value) > 0.5 * (low + high) { step > 0.0 } else { step < 0.0 };
        let gain = step * step * size;
        if outward && gain > bar {
            let value = format!("{:.4} {}", parameter.value, parameter.variable.unit.symbol);
            found.push(Doubt::Bound { parameter: parameter.variable.name.clone(), value, gain });
        }
    }
    Ok(found)
}
