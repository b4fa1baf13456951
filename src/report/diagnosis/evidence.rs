//! Is it more than noise, which effect is it, and how the error falls.

use super::begin;
use super::words::{meaning, p_value, percent, probability};
use crate::diagnosis::{CandidateResult, Diagnosis, FloorSource};
use crate::report::page::{Page, escape, table};
use crate::report::plots::{probabilities, steps};
use crate::report::units::{digits, of_column, short, spoken};
use crate::report::words::source;

/// Pairs in the table.
const MOST_PAIRS: usize = 8;

/// Lack of fit and the noise models on which it rests.
pub(super) fn add_noise(page: &mut Page, diagnosis: &Diagnosis) {
    let from = match diagnosis.noise_floor_source {
        FloorSource::Replicates => {
            "The noise comes from the scatter between repeats, which contains no error of the model."
        }
        FloorSource::Stated => "The noise is that which the experiment states.",
        FloorSource::Unknown => {
            "The noise is not known for every signal; where it is not, the scatter about a flexible curve stands in for it."
        }
    };
    begin(page, "noise", from);
    let fit = &diagnosis.lack_of_fit;
    let rows = vec![
        vec![
            "all of the residual".to_owned(),
            digits(fit.chi_square),
            fit.degrees_of_freedom.to_string(),
            p_value(fit.p_value, diagnosis.smallest_p),
        ],
        vec![
            "along the conditions, beyond noise".to_owned(),
            digits(fit.explainable),
            String::new(),
            p_value(fit.p_structure, diagnosis.smallest_p),
        ],
    ];
    page.html(&table(&["the calibrated baseline leaves", "chi-square", "degrees of freedom", "p"], &rows));
    page.html(&format!(
        "<p class=\"small\">p is the probability that noise alone leaves as much, from simulated repetitions of the experiment; it cannot be \
         smaller than {}. Along the conditions means along slip, load, speed, position or time, less what noise puts there: that is what an \
         effect could explain.</p>",
        short(diagnosis.smallest_p)
    ));
    let rows: Vec<Vec<String>> = diagnosis
        .noise
        .iter()
        .map(|(signal, noise)| {
            vec![
                spoken(signal),
                of_column(signal).number(noise.deviation),
                percent(noise.run_share),
                digits(noise.correlation),
                source(&diagnosis.noise_floor, signal),
            ]
        })
        .collect();
    let header = ["noise of", "one sample", "variance common to a run", "correlation of neighbours", "from"];
    page.html(&table(&header, &rows));
}

/// The candidates, alone and in pairs.
pub(super) fn add_candidates(page: &mut Page, diagnosis: &Diagnosis) {
    begin(
        page,
        "effects",
        "Each candidate was added to the baseline and everything refitted. A probability says how likely the effect is part of the \
         explanation, judged on data that were left out of the fit; \u{201c}enough already\u{201d} is the baseline as it is, \
         \u{201c}something else\u{201d} a curve that no candidate gives. Where effects come in pairs the probabilities add up to more than one.",
    );
    if diagnosis.candidates.is_empty() {
        page.html("<p>No candidate was looked at.</p>");
    } else {
        page.html(&probabilities(diagnosis));
        let rows: Vec<Vec<String>> = diagnosis.candidates.iter().map(|c| candidate(diagnosis, c)).collect();
        let header = [
            "effect",
            "probability",
            "p",
            "held-out gain (nats)",
            "better on left-out data",
            "misfit left",
            "fall of chi-square",
            "note",
        ];
        page.html(&table(&header, &rows));
        page.html(
            "<p class=\"small\">p: probability that noise alone gives the best of all candidates as large a gain, so it is corrected for their \
             number. Screened only: judged by its sensitivities, not refitted.</p>",
        );
        let meanings: String = diagnosis
            .candidates
            .iter()
            .map(|c| (c, meaning(&c.effect)))
            .filter(|(_, meaning)| !meaning.is_empty())
            .map(|(c, meaning)| format!("<li><code>{}</code> {}</li>", escape(&c.effect), escape(&meaning)))
            .collect();
        page.html(&format!("<details><summary>What the effects are</summary><ul>{meanings}</ul></details>"));
    }
    if !diagnosis.invisible.is_empty() {
        let names: Vec<String> = diagnosis.invisible.iter().map(|id| spoken(id)).collect();
        page.html(&format!("<p>Invisible to this experiment, and so not judged: {}.</p>", escape(&names.join(", "))));
    }
    if !diagnosis.pairs.is_empty() {
        let row = |pair: &crate::diagnosis::PairResult| {
            let names = format!("{} + {}", spoken(&pair.effects[0]), spoken(&pair.effects[1]));
            vec![names, digits(pair.gain), if pair.refitted { "" } else { "screened only" }.to_owned()]
        };
        let rows: Vec<Vec<String>> = diagnosis.pairs.iter().take(MOST_PAIRS).map(row).collect();
        let table = table(&["pair", "fall of chi-square", "note"], &rows);
        page.html(&format!(
            "<details><summary>The best of {} pairs of effects</summary>{table}</details>",
            diagnosis.pairs.len()
        ));
    }
}

fn candidate(diagnosis: &Diagnosis, candidate: &CandidateResult) -> Vec<String> {
    let mut notes = Vec::new();
    if diagnosis.effects.contains(&candidate.effect) && !candidate.tied {
        notes.push("named");
    }
    if candidate.tied {
        notes.push("tied");
    }
    if !candidate.refitted {
        notes.push("screened only");
    }
    if !candidate.parameters.is_empty() && candidate.parameters.iter().all(|parameter| parameter.fitted.is_off()) {
        notes.push("the fit leaves it off");
    } else if candidate.parameters.iter().any(|parameter| parameter.fitted.at_bound) {
        notes.push("on a bound");
    }
    vec![
        spoken(&candidate.effect),
        probability(candidate.probability),
        p_value(candidate.p_value, diagnosis.smallest_p),
        candidate.heldout_gain.map_or("\u{2013}".to_owned(), gain),
        candidate.better.map_or("\u{2013}".to_owned(), probability),
        percent(candidate.left),
        gain(candidate.gain),
        notes.join(", "),
    ]
}

/// A gain; rounding errors of a gain of nothing are nothing.
fn gain(value: f64) -> String {
    if value.abs() < 0.005 { "0".to_owned() } else { digits(value) }
}

/// The error by signal from the given model to the final one.
pub(super) fn add_steps(page: &mut Page, diagnosis: &Diagnosis) {
    begin(
        page,
        "steps",
        "Root mean square error over the noise floor, for the fit (solid) and for data left out of it (dashed). The dotted line is the noise: no \
         model can do better on new data.",
    );
    let mut names = vec!["as given".to_owned()];
    names.extend(diagnosis.steps.iter().map(|step| match &step.added {
        None => "calibrated".to_owned(),
        Some(effect) => format!("+ {}", spoken(effect)),
    }));
    page.plots(&[("Error over noise floor".to_owned(), steps(diagnosis, &names))]);
    let mut header = vec!["error (RMS)".to_owned(), names[0].clone()];
    for name in &names[1..] {
        header.push(name.clone());
        header.push("left out".to_owned());
    }
    header.push("noise floor".to_owned());
    let mut rows: Vec<Vec<String>> = Vec::new();
    for signal in diagnosis.baseline().rmse.keys() {
        let shown = of_column(signal);
        let number = |value: Option<f64>| value.map_or("\u{2013}".to_owned(), |value| shown.number(value));
        let mut row =
            vec![spoken(signal), number(diagnosis.given.as_ref().and_then(|fit| fit.rmse.get(signal)).copied())];
        for step in &diagnosis.steps {
            row.push(number(step.rmse.get(signal).copied()));
            row.push(number(step.heldout_rmse.get(signal).copied()));
        }
        row.push(number(diagnosis.noise_floor.get(signal).and_then(|floor| floor.value())));
        rows.push(row);
    }
    let mut left = vec!["misfit left".to_owned(), String::new()];
    for step in &diagnosis.steps {
        left.extend([percent(step.left), String::new()]);
    }
    left.push(String::new());
    rows.push(left);
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    page.html(&table(&header, &rows));
}
