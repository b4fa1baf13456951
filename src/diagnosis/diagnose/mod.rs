//! The diagnosis: which physical effect is missing from the model, if any.
//!
//! [`diagnose`] is the argument, statement by statement; the modules that hold its steps:
//!
//! 1. **noise** from repeats, one noise model for all that follows ([`super::noise`]), and the **baseline**, calibrated under
//!    it with priors (`prepare`, [`super::calibrate`]);
//! 2. **is it more than noise**: lack of fit in all and along every condition (`discrepancy`); sensitivities to every effect,
//!    and what the calibrated parameters cannot absorb of them (`signature`, `views`); what noise alone would give, by a parametric
//!    bootstrap (`stage`, `bootstrap`);
//! 3. **candidates**: every single effect and pair refitted jointly with the calibration, a long list first screened by its
//!    sensitivities where a refit is dear (`candidates`, `search`, `starts`, `scout`, `valleys`);
//! 4. **choice** of the effects that gain more than the best of all candidates does by noise alone (`choose`); where windows of a drive begin
//!    elsewhere under these, 2 to 4 once more from there (`moved`);
//! 5. **verdict**: gains on left-out conditions (`held_out`, `folds`), probabilities over candidates, "enough" and "something
//!    else" (`evidence`, `probability`), doubts (`doubts`, `soil`), what follows (`judge`, `verdict`), and what may act beside the named effects (`beside`);
//! 6. **result** (`finished`, `result`): profile likelihoods (`profile`) and the **next experiment** ([`super::separate`]).
//!
//! Constants of judgement stand in [`super::thresholds`], what depends on the kind of experiment in [`super::kinds`].

mod baseline;
mod beside;
mod bootstrap;
mod candidates;
mod cautions;
mod choose;
mod control;
mod discrepancy;
mod doubts;
mod drive;
mod engine;
mod evidence;
mod far;
mod finished;
mod fits;
mod folds;
mod gains;
mod held_out;
mod inner_step;
mod judge;
mod moved;
mod odd;
mod one_soil;
mod prepare;
mod probability;
mod profile;
mod result;
mod scout;
mod search;
mod serialised;
mod signature;
mod soil;
mod spared;
mod stage;
mod starts;
mod untried;
mod valleys;
mod verdict;
mod views;
mod watch;

pub(crate) use cautions::left_prior;
pub use control::{Control, Progress, Spread, Threads};
pub(crate) use discrepancy::{Condition, Shape, hats, powers, product, recorded, run_order};
pub use drive::WholeDrive;
pub use engine::{DiagnoseOptions, diagnose};
pub use fits::{Noise, Outcome, Task, fit_task};
pub(crate) use fits::{information, run as run_fit};
pub(crate) use gains::Projected;
pub(crate) use prepare::{Prepared, calibrated_baseline, prepare};
pub use result::{
    CandidateResult, Diagnosis, FinalParameter, LackOfFit, PairResult, ParameterResult, Share, Step, TriedFit, Verdict,
};
pub(crate) use signature::{Sensitivities, prune, sensitivities};
pub(crate) use spared::WINDOWS;
pub(crate) use stage::largest_cosine;
pub(crate) use untried::Untried;
pub(crate) use views::View;
pub(crate) use watch::{Phase, Watch};
