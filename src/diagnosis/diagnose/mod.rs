//! The diagnosis: which physical effect is missing from the model, if any.
//!
//! The method in steps, with the module that holds each:
//!
//! 1. noise from repeats, one noise model for all that follows ([`super::noise`]);
//! 2. calibration of the soil with priors ([`super::calibrate`]);
//! 3. lack of fit, in all and along every condition (`discrepancy`);
//! 4. sensitivities to every effect, and what the calibrated parameters cannot absorb of them (`signature`);
//! 5. every single effect and pair refitted jointly with the calibration, the long list first screened by its
//!    sensitivities where a refit is dear (`search`);
//! 6. p-values by a parametric bootstrap of the best of all candidates (`bootstrap`), gains on left-out conditions
//!    (`held_out`), probabilities over candidates, "enough" and "something else" (`probability`);
//! 7. the verdict and its cautions (`verdict`), profile likelihoods (`profile`), the next experiment
//!    ([`super::separate`]).

mod bootstrap;
mod cautions;
mod choose;
mod control;
mod discrepancy;
mod doubts;
mod engine;
mod evidence;
mod fits;
mod folds;
mod held_out;
mod judge;
mod prepare;
mod probability;
mod profile;
mod report_parts;
mod result;
mod scout;
mod search;
mod signature;
mod soil;
mod stage;
mod starts;
mod untried;
mod verdict;
mod watch;

pub(crate) use bootstrap::Projected;
pub use control::{Control, Progress, Spread, Threads};
pub use engine::{DiagnoseOptions, diagnose};
pub use fits::{Noise, Outcome, Task, fit_task};
pub(crate) use prepare::{calibrated_baseline, prepare};
pub(crate) use report_parts::DETECTABLE;
pub use result::{
    CandidateResult, Diagnosis, FinalParameter, LackOfFit, PairResult, ParameterResult, Share, Step, Verdict,
};
pub(crate) use signature::{Sensitivities, View, prune, sensitivities};
pub(crate) use stage::largest_cosine;
pub(crate) use untried::Untried;
pub(crate) use verdict::ALIKE;
pub(crate) use watch::Watch;
