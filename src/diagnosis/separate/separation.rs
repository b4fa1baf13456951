//! What an experiment can tell apart.

use super::additions::{Addition, AtHand, additions};
use super::look::Look;
use super::noise::{AssumedNoise, NoiseSource, planned};
use super::strength::{SmallestStrength, smallest};
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::diagnose::{prepare, prune};
use crate::diagnosis::given::Given;
use crate::diagnosis::halt::Halt;
use crate::diagnosis::identified::{Identified, identified_at};
use crate::diagnosis::information::Information;
use crate::diagnosis::linear_algebra::norm;
use crate::diagnosis::noise::{FloorSource, NoiseModel};
use crate::diagnosis::problem::Problem;
use crate::diagnosis::thresholds::{ALIKE, DETECTABLE, SAME_SIGNATURE};
use crate::measurement::Experiment;
use crate::parallel::map_in_order;
use std::collections::BTreeMap;

/// How to look.
#[derive(Clone, Debug, PartialEq)]
pub struct SeparateOptions {
    /// Candidate effects; `None` for all that the model has.
    pub candidates: Option<Vec<String>>,
    /// Effects that are part of the baseline, with free parameters.
    pub added: Vec<String>,
    /// Whether to calibrate first, where there are measurements enough; else the given parameters are taken.
    pub calibrate: bool,
}

impl Default for SeparateOptions {
    fn default() -> Self {
        Self { candidates: None, added: Vec::new(), calibrate: true }
    }
}

/// How alike two effects are to an experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Likeness {
    /// They can be told apart.
    Different,
    /// Cosine over 0.8: an honest diagnosis may have to call them a tie.
    Alike,
    /// Cosine over 0.99: no amount of data of this kind tells them apart.
    Same,
}

impl Likeness {
    fn of(cosine: f64) -> Self {
        match cosine {
            cosine if cosine > SAME_SIGNATURE => Self::Same,
            cosine if cosine > ALIKE => Self::Alike,
            _ => Self::Different,
        }
    }

    /// The word for reports and JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Different => "different",
            Self::Alike => "alike",
            Self::Same => "the same",
        }
    }
}

/// How strongly one effect shows in an experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectSight {
    /// Id of the effect.
    pub effect: String,
    /// Share of its signature that the calibrated parameters cannot absorb, 0 to 1.
    pub visible_share: f64,
    /// Size of what it changes beyond the calibration over the range of its parameters, to first order, in standard
    /// deviations of the noise.
    pub size: f64,
    /// The smallest strength that would be found, for each parameter that changes something on its own.
    pub smallest: Vec<SmallestStrength>,
    /// Whether it would be found somewhere within its bounds.
    pub visible: bool,
}

/// How strongly the difference between two effects shows in an experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct PairSight {
    /// Their ids.
    pub effects: [String; 2],
    /// Cosine of their signatures beyond the calibration, 0 to 1.
    pub cosine: f64,
    /// What that means.
    pub likeness: Likeness,
}

/// What an experiment can tell apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Separation {
    /// Name of the experiment.
    pub name: String,
    /// Whether the model was calibrated to measurements first; else it stands at the given parameters.
    pub calibrated: bool,
    /// Noise by signal.
    pub noise: BTreeMap<String, AssumedNoise>,
    /// Parameters that a calibration moves, which can swallow effects, with the values at which they stand.
    pub absorbing: Vec<(String, f64)>,
    /// The effects that change something measured, the best visible first.
    pub effects: Vec<EffectSight>,
    /// Effects without any signature.
    pub invisible: Vec<String>,
    /// Pairs of visible effects, the most alike first.
    pub pairs: Vec<PairSight>,
    /// What the measurements, made or planned, determine of the free parameters.
    pub identified: Vec<Identified>,
    /// Tests that would determine parameters of the soil which these measurements leave open, the cheapest first.
    pub additions: Vec<Addition>,
    /// What was taken from where, in words, where two places disagree; priors of a class of soil.
    pub sources: Vec<String>,
}

impl Separation {
    /// Pairs that are alike or the same.
    pub fn ties(&self) -> impl Iterator<Item = &PairSight> {
        self.pairs.iter().filter(|pair| pair.likeness > Likeness::Different)
    }

    /// The effect called `id`, where it changes something.
    #[must_use]
    pub fn effect(&self, id: &str) -> Option<&EffectSight> {
        self.effects.iter().find(|sight| sight.effect == id)
    }

    /// The cosine of two effects that are both visible.
    #[must_use]
    pub fn cosine(&self, a: &str, b: &str) -> Option<f64> {
        let is = |pair: &&PairSight| pair.effects.iter().any(|id| id == a) && pair.effects.iter().any(|id| id == b);
        self.pairs.iter().find(is).map(|pair| pair.cosine)
    }
}

/// What an experiment, made or planned ([`Experiment::read_plan`]), can tell apart.
///
/// Each effect's signature, its change of the measured values, is made white by the noise and rid of what the calibrated
/// parameters can absorb. The noise is that of the repeats, else stated, else of usual instruments: 0.3 N, 0.05 N m, 1 mm,
/// 0.1 degrees, 1 %, every row being independent.
///
/// # Errors
/// [`CompareError`] where the experiment does not fit the model, or the model cannot compute it.
pub fn separate(
    given: impl Into<Given>,
    experiment: &Experiment,
    options: &SeparateOptions,
) -> Result<Separation, CompareError> {
    separate_unless(given, experiment, options, &|| false)
}

/// The same until `stop` says yes, which every simulation asks at every row.
///
/// # Errors
/// Those of [`separate`]; [`CompareError::Interrupted`] after a stop.
pub fn separate_unless(
    given: impl Into<Given>,
    experiment: &Experiment,
    options: &SeparateOptions,
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<Separation, CompareError> {
    let given = given.into();
    let mut problem = Problem::new(given.clone(), experiment, &options.added)?;
    problem.halt = Halt::when(stop);
    told_apart(problem, &given, options).map_err(|error| if stop() { CompareError::Interrupted } else { error })
}

fn told_apart(mut problem: Problem, given: &Given, options: &SeparateOptions) -> Result<Separation, CompareError> {
    if let Some(candidates) = &options.candidates {
        problem.keep_candidates(candidates)?;
    }
    let calibrated = options.calibrate && problem.layout.present() > problem.base.len();
    let (values, noise, invisible) = if calibrated { fitted(&mut problem)? } else { as_given(&mut problem)? };
    let own_noise = models(&noise);
    let look = Look::new(&problem, &values, &own_noise)?;
    let information = Information::of(&problem, &values, &look.whitening, &look.sensitivities.base);
    let identified = identified_at(&problem, &values, &information);
    let at = AtHand { given, added: &options.added, problem: &problem, values: &values, noise: &own_noise };
    let additions = additions(&at, &identified);
    let effects = effects(&problem, &look, &values);
    let visible: Vec<&str> =
        look.ids().filter(|id| effects.iter().any(|sight| sight.effect == **id && sight.visible)).collect();
    let mut pairs = Vec::new();
    for (k, a) in visible.iter().enumerate() {
        for b in &visible[k + 1..] {
            let cosine = look.cosine(a, b);
            let effects = [(*a).to_owned(), (*b).to_owned()];
            pairs.push(PairSight { effects, cosine, likeness: Likeness::of(cosine) });
        }
    }
    pairs.sort_by(|a, b| b.cosine.total_cmp(&a.cosine));
    let absorbing = problem.base.iter().zip(&values).map(|(free, value)| (free.variable.name.clone(), *value));
    let (name, absorbing) = (problem.experiment.name.clone(), absorbing.collect());
    let sources = problem.sources.clone();
    Ok(Separation { name, calibrated, noise, absorbing, effects, invisible, pairs, identified, additions, sources })
}

type Reference = (Vec<f64>, BTreeMap<String, AssumedNoise>, Vec<String>);

/// Values of the free parameters, noise, and what cannot be seen at all, after a calibration.
fn fitted(problem: &mut Problem) -> Result<Reference, CompareError> {
    let prepared = prepare(problem)?;
    let noise = prepared.noise.models.iter().map(|(signal, model)| {
        let source = match prepared.floors.get(signal).map(|floor| floor.source()) {
            Some(FloorSource::Replicates) => NoiseSource::Replicates,
            Some(FloorSource::Stated) => NoiseSource::Stated,
            _ => NoiseSource::Scatter,
        };
        (signal.clone(), AssumedNoise { model: *model, source })
    });
    let noise = noise.collect();
    // Columns that stay to be filled count with the others.
    expect_all(problem);
    Ok((prepared.baseline.values(), noise, prepared.invisible))
}

/// The same at the given parameters.
fn as_given(problem: &mut Problem) -> Result<Reference, CompareError> {
    expect_all(problem);
    let values: Vec<f64> = problem.base.iter().map(|free| free.start).collect();
    let modelled = problem.predict(&problem.base, |predict| predict.values(&values))??;
    let noise = planned_noise(problem, &modelled);
    problem.layout.scale = problem.strategy().noise_scale(problem, &modelled);
    let invisible = prune(problem, &values)?;
    Ok((values, noise, invisible))
}

/// Takes every row of a column without any value as one that will be measured.
pub(crate) fn expect_all(problem: &mut Problem) {
    for block in &problem.layout.blocks {
        // A column of which only rows without an answer were measured has values.
        if problem.layout.recorded[block.range.clone()].iter().all(|value| value.is_nan()) {
            problem.layout.measured[block.range.clone()].fill(0.0);
        }
    }
}

/// Noise of every signal of an experiment to be made.
pub(crate) fn planned_noise(problem: &Problem, modelled: &[f64]) -> BTreeMap<String, AssumedNoise> {
    let largest = |signal: &str| {
        let blocks = problem.layout.blocks.iter().filter(|block| block.signal == signal);
        blocks.flat_map(|block| &modelled[block.range.clone()]).fold(0.0_f64, |most, value| most.max(value.abs()))
    };
    let usual = |signal: &str| {
        let blocks = problem.layout.blocks.iter().filter(|block| block.signal == signal);
        let values: Vec<f64> = blocks.flat_map(|block| modelled[block.range.clone()].iter().copied()).collect();
        (values.iter().map(|value| value * value).sum::<f64>() / values.len().max(1) as f64).sqrt()
    };
    let scatter = problem.strategy().assumed_scatter(&problem.experiment);
    let noise = |signal: String| {
        let mut assumed = planned(&problem.experiment, &signal, largest(&signal));
        if let Some(share) = scatter.get(&signal) {
            assumed.model = assumed.model.with_runs_apart(share * usual(&signal));
        }
        (signal, assumed)
    };
    problem.experiment.signals().into_iter().map(noise).collect()
}

pub(crate) fn models(noise: &BTreeMap<String, AssumedNoise>) -> BTreeMap<String, NoiseModel> {
    noise.iter().map(|(signal, assumed)| (signal.clone(), assumed.model)).collect()
}

fn effects(problem: &Problem, look: &Look, values: &[f64]) -> Vec<EffectSight> {
    let sight = |k: &usize| {
        let id = &look.sensitivities.signatures[*k].id;
        let candidate = problem.candidate(id)?;
        let views = look.sensitivities.signatures[*k].views.iter().zip(&look.projected.views[*k]);
        let mut strengths = Vec::new();
        let mut seen_in_draws = false;
        for (view, columns) in views {
            match view.members() {
                Some(members) => strengths.extend(
                    members
                        .iter()
                        .zip(columns)
                        .map(|(member, column)| smallest(problem, look, values, candidate, *member, norm(column))),
                ),
                // A law without a derivative at neutral, such as a square root.
                None if candidate.free.len() == 1 && strengths.is_empty() => {
                    strengths.push(smallest(problem, look, values, candidate, 0, f64::NAN));
                }
                None => {
                    seen_in_draws |= candidate.free.len() > 1 && columns.iter().any(|column| norm(column) >= DETECTABLE)
                }
            }
        }
        let visible = seen_in_draws || strengths.iter().any(|strength| strength.value.is_some());
        let (visible_share, size) = (look.share(id), look.size(id));
        Some(EffectSight { effect: id.clone(), visible_share, size, smallest: strengths, visible })
    };
    let all: Vec<usize> = (0..look.sensitivities.signatures.len()).collect();
    let mut effects: Vec<EffectSight> = map_in_order(&all, sight).into_iter().flatten().collect();
    effects.sort_by(|a, b| b.visible.cmp(&a.visible).then(b.visible_share.total_cmp(&a.visible_share)));
    effects
}
