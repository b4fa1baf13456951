//! Whether a fitted soil is believable: whether the class of soil that the experiment names, or any class where it names
//! none, allows its cohesion, friction angle and exponent together.

use super::search::Search;
use crate::diagnosis::calibrate::Calibration;
use crate::diagnosis::problem::Problem;
use crate::diagnosis::separate::rounded;
use crate::diagnosis::thresholds::{REACH, SOIL_SHARE};
use crate::soil_class::{SOIL_CLASSES, SoilClass};

/// Why a fitted soil is not believable; `None` where it is, or where a believable soil fits about as well.
pub(crate) fn unbelievable(search: &mut Search, effects: &[String], fit: &Calibration) -> Option<String> {
    let named = search.problem.experiment.soil_class.as_deref().and_then(SoilClass::find);
    let classes: Vec<&SoilClass> = named.map_or_else(|| SOIL_CLASSES.iter().collect(), |class| vec![class]);
    let distance = |class: &SoilClass| outside(class, search.problem, fit);
    let mut by_distance: Vec<(f64, &SoilClass)> = classes.into_iter().map(|class| (distance(class), class)).collect();
    by_distance.sort_by(|a, b| a.0.total_cmp(&b.0));
    if by_distance.first().is_none_or(|(nearest, _)| *nearest <= 0.0) {
        return None;
    }
    by_distance.truncate(search.problem.strategy().budget().soil_classes);
    let allowed = REACH.max(SOIL_SHARE * search.gain(effects));
    let cost = |class: &SoilClass| search.cost_within(effects, fit, class);
    let costs = by_distance.iter().filter_map(|(_, class)| cost(class).map(|cost| (cost, *class)));
    let best = costs.min_by(|a, b| a.0.total_cmp(&b.0));
    if best.is_some_and(|(cost, _)| cost <= allowed) {
        return None;
    }
    Some(words(named, fit, best))
}

/// What a class of soil would add, where the experiment names none and nothing else is known of the soil.
pub(crate) fn offer(problem: &Problem) -> Option<String> {
    let open = problem.base.iter().any(|free| free.variable.name.starts_with("soil."));
    if problem.experiment.soil_class.is_some()
        || problem
            .base
            .iter()
            .any(|free| free.prior.or(free.shared).is_some() && !free.is_of_a_sensor() && !free.is_factor())
        || !open
    {
        return None;
    }
    let class = &SOIL_CLASSES[0];
    let prior =
        |(name, mean, deviation): &(&str, f64, f64)| format!("{name} {} +- {}", rounded(*mean), rounded(*deviation));
    let free = |(name, ..): &&(&str, f64, f64)| problem.base.iter().any(|free| free.variable.name == *name);
    let priors: Vec<String> = class.priors.iter().filter(free).map(prior).collect();
    if priors.is_empty() {
        return None;
    }
    Some(format!(
        "no prior of the soil is used; `soil.class = \"{}\"` at the top of experiment.toml would add {} (SI, mean and standard deviation; {}); the classes are {}",
        class.name,
        priors.join(", "),
        class.source,
        SoilClass::names()
    ))
}

/// How far a fitted soil is outside a class: the largest distance over the width of what the class allows, 0 inside.
fn outside(class: &SoilClass, problem: &Problem, fit: &Calibration) -> f64 {
    let beyond = |(name, low, high): &(&str, f64, f64)| {
        let free = problem.base.iter().position(|free| free.variable.name == *name)?;
        let value = fit.parameters[free].value;
        Some((low - value).max(value - high).max(0.0) / (high - low))
    };
    class.limits.iter().filter_map(beyond).fold(0.0, f64::max)
}

fn words(named: Option<&SoilClass>, fit: &Calibration, best: Option<(f64, &SoilClass)>) -> String {
    let value = |name: &str| fit.parameters.iter().find(|p| p.variable.name == name).map(|p| p.value);
    let mut parts = Vec::new();
    parts.extend(value("soil.cohesion").map(|c| format!("cohesion {:.2} kPa", c / 1000.0)));
    parts.extend(value("soil.friction_angle").map(|phi| format!("friction angle {:.1} deg", phi.to_degrees())));
    parts.extend(value("soil.exponent").map(|n| format!("exponent {n:.2}")));
    let who =
        named.map_or_else(|| "no class of soil allows".to_owned(), |class| format!("{} does not have", class.name));
    let cost = best.map_or_else(String::new, |(cost, class)| {
        format!("; the best fit that {} allows costs {cost:.0} in chi-square", class.name)
    });
    format!("the fitted soil is not believable: {who} {}{cost}", parts.join(", "))
}
