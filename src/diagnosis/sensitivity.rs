//! What a model says where an experiment measured, and how that depends on parameters.

use super::compare::CompareError;
use super::free::Free;
use super::given::Given;
use super::prediction::{Derivatives, Predict};
use super::problem::Problem;
use crate::measurement::Experiment;
use bekker_modeldescription::Lookup;

/// Modelled values with their derivatives, in SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivity {
    /// One value for each row of each measured signal of each run, in the experiment's order.
    pub values: Vec<f64>,
    /// For each parameter the derivatives of all values in it; 0 in a run that sets the parameter itself.
    pub slopes: Vec<Vec<f64>>,
    /// How the derivatives were obtained.
    pub derivatives: Derivatives,
}

/// The modelled values of an experiment of either kind.
///
/// # Errors
/// [`CompareError`] where the experiment does not fit the model or a row cannot be computed.
pub fn modelled(given: impl Into<Given>, experiment: &Experiment) -> Result<Vec<f64>, CompareError> {
    predicting(given, experiment, &[], |predict, free| Ok(predict.values(free)?))
}

/// The modelled values of an experiment of either kind and their derivatives in the `parameters`, by name: of
/// the model, or [errors of sensors](crate::measurement::SensorError::parameter) that the experiment states.
///
/// # Errors
/// [`CompareError`] where the experiment does not fit the model, a parameter is unknown or a row cannot be computed.
pub fn sensitivity(
    given: impl Into<Given>,
    experiment: &Experiment,
    parameters: &[&str],
) -> Result<Sensitivity, CompareError> {
    predicting(given, experiment, parameters, |predict, free| {
        let (values, slopes) = predict.slopes(free)?;
        Ok(Sensitivity { values, slopes, derivatives: predict.derivatives() })
    })
}

/// Calls `f` with the prediction of either kind and the present values of the `parameters`.
fn predicting<R>(
    given: impl Into<Given>,
    experiment: &Experiment,
    parameters: &[&str],
    f: impl Fn(&dyn Predict, &[f64]) -> Result<R, CompareError>,
) -> Result<R, CompareError> {
    let mut problem = Problem::new(given, experiment, &[])?;
    let listed = problem.known.list();
    let mut free = Vec::new();
    for name in parameters {
        if let Some(of_a_sensor) = Free::of_sensors(experiment).find(|free| free.variable.name == *name) {
            free.push(of_a_sensor);
            continue;
        }
        let Some((variable, start)) = listed.iter().find(|(variable, _)| variable.name == *name) else {
            let place = "sensitivity".to_owned();
            return Err(CompareError::Parameter { place, source: problem.known.unknown(name) });
        };
        free.push(Free { variable: variable.clone(), start: *start, prior: None, shared: None, within: None });
    }
    let start: Vec<f64> = free.iter().map(|free| free.start).collect();
    problem.predict(&free, |predict| f(predict, &start))?
}
