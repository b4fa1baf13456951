//! The HTML page of a diagnosis.

#![cfg(feature = "report")]

use crate::saved_page::{data, differences, figures, numbers, text};
use crate::schema::faults;
use bekker::diagnosis::{Control, DiagnoseOptions, Diagnosis, Suggestion, Verdict, diagnose, interpolation_weights};
use bekker::effects::EFFECTS;
use bekker::measurement::Experiment;
use bekker::model::Model;
use bekker::report::{diagnosis_page, verdict_in_words};
use std::path::Path;
use std::sync::LazyLock;

/// Draws of the bootstrap: enough for p below 0.01, few enough for a test without optimisation.
const DRAWS: usize = 199;

/// The shipped experiment with three candidates.
static DIAGNOSIS: LazyLock<Diagnosis> = LazyLock::new(|| {
    let experiment = Experiment::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/sand_wheel")).unwrap();
    let candidates = ["slip_sinkage", "exit_angle", "drag"].map(str::to_owned).to_vec();
    let options = DiagnoseOptions { candidates: Some(candidates), draws: DRAWS, ..DiagnoseOptions::default() };
    diagnose(&Model::preset("two_wheeled").unwrap(), &experiment, &options, &Control::default()).unwrap()
});

/// Three significant digits in plain notation, as the page shows numbers of middle size.
fn digits(value: f64) -> String {
    let decimals = (2 - value.abs().log10().floor() as i32).max(0) as usize;
    format!("{value:.decimals$}")
}

/// The page up to the links to its sections.
fn first_screen(page: &str) -> &str {
    let text = text(page);
    &text[..text.find("<nav").unwrap()]
}

/// The section that begins at a place, up to the next one.
fn section<'a>(page: &'a str, place: &str) -> &'a str {
    let page = text(page);
    let begin = page.find(&format!("<h2 id=\"{place}\"")).unwrap();
    let end = page[begin + 1..].find("<h2 ").map_or(page.len(), |at| begin + 1 + at);
    &page[begin..end]
}

#[test]
fn property_the_page_of_the_shipped_experiment_is_complete_and_alone() {
    let diagnosis = &*DIAGNOSIS;
    let page = diagnosis_page(diagnosis);
    std::fs::write(Path::new(env!("CARGO_TARGET_TMPDIR")).join("sand_wheel_diagnosis.html"), &page).unwrap();

    // Nothing is loaded from elsewhere.
    for tag in ["<script src", "<link rel=\"style", "<img", "@import", "<iframe"] {
        assert!(!page.contains(tag), "{tag}");
    }
    // Every link of the text has its place, every place its link.
    let text = text(&page);
    for heading in text.split("<h2 id=\"").skip(1) {
        let place = heading.split('"').next().unwrap();
        assert!(text.contains(&format!("<a href=\"#{place}\"")), "{place}");
    }
    for link in text.split("<a href=\"#").skip(1) {
        let place = link.split('"').next().unwrap();
        assert_eq!(text.matches(&format!("<h2 id=\"{place}\"")).count(), 1, "{place}");
    }
    // Every figure has data, and a name for those who do not see it.
    let plots = text.matches("class=\"plot\" id=\"plot").count();
    assert_eq!(plots, figures(&page).len());
    assert_eq!(plots, text.matches("role=\"img\" aria-label=\"").count());
    // As given, calibrated and with the effect; at first the last.
    let saved = data(&page);
    let labels: Vec<&str> =
        saved["snapshot"]["steps"].as_array().unwrap().iter().map(|step| step["label"].as_str().unwrap()).collect();
    assert_eq!(labels, ["as given", "soil calibrated", "+ slip sinkage"]);
    let megabytes = format!("one file of {:.1} MB", page.len() as f64 / 1e6);
    assert!(page.contains(&megabytes), "{megabytes}");
}

#[test]
fn agreement_the_first_screen_has_the_verdict_and_the_numbers_of_the_result() {
    let diagnosis = &*DIAGNOSIS;
    assert_eq!(diagnosis.verdict, Verdict::EffectMissing);
    assert_eq!(diagnosis.effects, ["slip_sinkage"]);
    let page = diagnosis_page(diagnosis);
    let screen = first_screen(&page);
    assert!(screen.contains("One effect is missing from the model: slip sinkage."), "{screen}");
    let (_, meaning) = EFFECTS.iter().find(|(id, _)| *id == "slip_sinkage").unwrap();
    assert!(screen.contains(meaning.trim()), "{screen}");
    // Error before and after, and the noise floor, of every signal, in display units.
    for (signal, unit, factor) in [("sinkage", "mm", 1e3), ("drawbar_pull", "N", 1.0), ("torque", "N.m", 1.0)] {
        let number = |value: f64| digits(value * factor);
        let (before, after) = (diagnosis.baseline().rmse[signal], diagnosis.last().rmse[signal]);
        let floor = diagnosis.noise_floor[signal].value().unwrap();
        let change = format!("<b>{} \u{2192} {} {unit}</b>", number(before), number(after));
        assert!(screen.contains(&change), "{change} in {screen}");
        let floor = format!("noise {} {unit}", number(floor));
        assert!(screen.contains(&floor), "{floor} in {screen}");
    }
    let parameter = &diagnosis.last().parameters.iter().find(|p| p.effect).unwrap().fitted;
    let value =
        format!("slip_sinkage.n1 = {} \u{b1} {}", digits(parameter.value), digits(parameter.deviation.unwrap()));
    assert!(screen.contains(&value), "{value} in {screen}");
}

#[test]
fn agreement_the_sections_have_the_numbers_of_the_result() {
    let diagnosis = &*DIAGNOSIS;
    let page = diagnosis_page(diagnosis);
    let effects = section(&page, "effects");
    for candidate in &diagnosis.candidates {
        let name = format!("<tr><td>{}</td>", candidate.effect.replace('_', " "));
        assert!(effects.contains(&name), "{name}");
    }
    assert!(effects.contains("enough already") && effects.contains("something else"));
    let best = &diagnosis.candidates[0];
    assert!(effects.contains(&format!("<td>{}</td>", digits(best.gain))), "{}", best.gain);
    let steps = section(&page, "steps");
    let left_out = diagnosis.last().heldout_rmse["sinkage"] * 1e3;
    assert!(steps.contains(&format!("<td>{} mm</td>", digits(left_out))));
    let noise = section(&page, "noise");
    assert!(noise.contains(&format!("<td>{}</td>", digits(diagnosis.lack_of_fit.chi_square))));
    let parameters = section(&page, "parameters");
    let profile = diagnosis.profiles.iter().find(|profile| profile.name == "slip_sinkage.n1").unwrap();
    let (low, high) = (profile.interval.0.unwrap(), profile.interval.1.unwrap());
    assert!(parameters.contains(&format!("<td>{} .. {}</td>", digits(low), digits(high))));
    assert_eq!(parameters.matches("data-plot=\"").count(), diagnosis.profiles.len());
    // The baseline's parameter on its bound is flagged.
    assert!(diagnosis.baseline().parameters.iter().any(|p| p.fitted.at_bound));
    assert!(section(&page, "calibration").contains("on its bound"));
}

#[test]
fn agreement_the_page_holds_the_models_of_the_steps_and_each_effect_along_its_strength() {
    let diagnosis = &*DIAGNOSIS;
    let saved = data(&diagnosis_page(diagnosis));
    let last = saved["models"].as_array().unwrap().last().unwrap();
    for (run, fit) in last["runs"].as_array().unwrap().iter().zip(&diagnosis.last().fit.runs) {
        for signal in &fit.signals {
            let range = signal.modelled.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            for (drawn, value) in numbers(&run[&signal.signal]).iter().zip(&signal.modelled) {
                assert!((drawn - value).abs() <= range / 32_000.0, "{}: {drawn} {value}", signal.signal);
            }
        }
    }
    let responses = saved["responses"].as_array().unwrap();
    let of = |id: &str| responses.iter().filter(|response| response["effects"][0] == id).collect::<Vec<_>>();
    for candidate in &diagnosis.candidates {
        assert!(!of(&candidate.effect).is_empty(), "{} was tried", candidate.effect);
    }
    // A strength between: what the page interpolates is what the library simulates, within the error that the page states.
    let response = of("slip_sinkage")[0];
    let strengths: Vec<f64> = numbers(&response["strengths"]);
    let at = 0.5 * (strengths[2] + strengths[3]);
    let weights = interpolation_weights(&strengths, at);
    let mut values: std::collections::BTreeMap<String, f64> = response["values"]
        .as_object()
        .unwrap()
        .iter()
        .map(|(name, value)| (name.clone(), value.as_f64().unwrap()))
        .collect();
    values.insert(response["parameter"].as_str().unwrap().to_owned(), at);
    let truth = diagnosis.workbench.trial(&values, false).unwrap().fit;
    let mut moved: f64 = 0.0;
    for (run, own) in response["runs"].as_array().unwrap().iter().zip(&truth.runs) {
        for signal in &own.signals {
            let stated = ["largest_error", "rounding"].map(|what| response[what][&signal.signal].as_f64().unwrap());
            let allowed = stated[0] + 2.0 * stated[1] + 1e-4;
            let (base, others) = (numbers(&run[&signal.signal]["base"]), differences(&run[&signal.signal]["others"]));
            for (row, value) in signal.modelled.iter().enumerate() {
                let change: f64 = weights.iter().enumerate().map(|(k, w)| w * others[k * base.len() + row]).sum();
                moved = moved.max(change.abs() / allowed);
                assert!((base[row] + change - value).abs() <= allowed, "{} row {row}", signal.signal);
            }
        }
    }
    assert!(moved > 10.0, "the strength moves the model by far more than the error");
    // Its error follows from the mean products of the residuals, over all rows.
    let products: Vec<Vec<f64>> = response["products"]["sinkage"].as_array().unwrap().iter().map(numbers).collect();
    let square: f64 = (0..weights.len())
        .flat_map(|j| (0..weights.len()).map(move |k| (j, k)))
        .map(|(j, k)| weights[j] * weights[k] * products[j][k])
        .sum();
    let stated = response["largest_error"]["sinkage"].as_f64().unwrap();
    assert!((square.sqrt() - truth.rmse["sinkage"]).abs() <= stated, "{} {}", square.sqrt(), truth.rmse["sinkage"]);
}

/// The first screen of the diagnosis with another verdict.
fn screen_of(change: impl FnOnce(&mut Diagnosis)) -> String {
    let mut diagnosis = DIAGNOSIS.clone();
    // What the script is given is another test's matter, and takes simulations.
    diagnosis.tried.clear();
    change(&mut diagnosis);
    first_screen(&diagnosis_page(&diagnosis)).to_owned()
}

#[test]
fn property_every_kind_of_verdict_reads_right() {
    let explained = screen_of(|d| {
        (d.verdict, d.effects) = (Verdict::Explained, Vec::new());
        d.steps.truncate(1);
    });
    assert!(explained.contains("the calibrated model leaves only noise") && !explained.contains('\u{2192}'));

    let unknown = screen_of(|d| (d.verdict, d.effects) = (Verdict::Unexplained, Vec::new()));
    assert!(unknown.contains("something that no known effect explains"));
    // The tried effect is no result: the tiles stay at the baseline.
    assert!(unknown.contains("The nearest candidate, slip sinkage,") && !unknown.contains('\u{2192}'));

    let partial = screen_of(|d| (d.verdict, d.explained_share) = (Verdict::Unexplained, 0.6));
    assert!(partial.contains("Slip sinkage explains only part of what the model misses (60 %)"), "{partial}");

    let tied = screen_of(|d| {
        d.verdict = Verdict::Undetermined;
        d.effects.push("exit_angle".to_owned());
        d.candidates.iter_mut().for_each(|c| c.tied = c.effect != "drag");
    });
    assert!(tied.contains("this experiment cannot tell what: slip sinkage or exit angle."), "{tied}");
    assert!(tied.contains("<code>exit_angle</code>") && !tied.contains("One effect is missing"));

    let doubted = screen_of(|d| d.verdict = Verdict::Undetermined);
    assert!(doubted.contains("the evidence does not hold"));

    let blind = screen_of(|d| {
        (d.verdict, d.effects) = (Verdict::Undetermined, Vec::new());
        d.steps.truncate(1);
    });
    assert!(blind.contains("cannot decide whether an effect is missing"));

    let two = screen_of(|d| {
        let mut step = d.steps[1].clone();
        step.added = Some("drag".to_owned());
        d.steps.push(step);
        d.effects.push("drag".to_owned());
    });
    assert!(two.contains("2 effects are missing from the model: slip sinkage and drag."));

    let interrupted = screen_of(|d| {
        d.interrupted = true;
        d.profiles.clear();
    });
    assert!(
        interrupted.contains("Interrupted, so far: One effect is missing") && interrupted.contains("partial result")
    );
}

#[test]
fn property_what_may_act_besides_is_on_the_first_screen() {
    let possible_beside = vec!["exit_angle".to_owned(), "drag".to_owned()];
    let diagnosis = Diagnosis { possible_beside, ..DIAGNOSIS.clone() };
    let says = |diagnosis: &Diagnosis| {
        let page = diagnosis_page(diagnosis);
        let sentence = "Perhaps exit angle or drag acts besides; this experiment cannot tell.";
        let clause = "; perhaps exit angle or drag acts besides";
        (first_screen(&page).contains(sentence), verdict_in_words(diagnosis).ends_with(clause))
    };
    assert_eq!((says(&diagnosis), says(&DIAGNOSIS)), ((true, true), (false, false)));
}

#[test]
fn property_missing_parts_and_strange_names_do_not_break_the_page() {
    let mut diagnosis = DIAGNOSIS.clone();
    let strange = "<script>alert(1)</script> & \"x\"";
    diagnosis.experiment.name = strange.to_owned();
    diagnosis.experiment.runs.iter_mut().for_each(|run| run.group = Some(strange.to_owned()));
    diagnosis.cautions = vec![strange.to_owned()];
    diagnosis.suggestions = vec![Suggestion { text: strange.to_owned(), effects: vec!["</script>".to_owned()] }];
    diagnosis.candidates.iter_mut().for_each(|candidate| candidate.effect = strange.to_owned());
    let page = diagnosis_page(&diagnosis);
    assert!(!page.contains("<script>alert") && !text(&page).contains("</script>)"));
    assert_eq!(data(&page)["experiment"]["name"], strange);
    assert!(first_screen(&page).contains("Next:</strong> &lt;script"));
    assert!(section(&page, "next").contains("<li>&lt;script&gt;alert(1)&lt;/script&gt; &amp; &quot;x&quot;"));
    // As many scripts end as begin.
    let text_of_it = text(&page);
    assert_eq!(text_of_it.matches("<script").count(), text_of_it.matches("</script>").count());

    diagnosis.given = None;
    diagnosis.tried.clear();
    diagnosis.candidates.clear();
    diagnosis.pairs.clear();
    diagnosis.profiles.clear();
    diagnosis.suggestions.clear();
    diagnosis.failures.clear();
    diagnosis.failures_left.clear();
    diagnosis.noise_floor.values_mut().for_each(|floor| *floor = bekker::diagnosis::NoiseFloor::default());
    let page = diagnosis_page(&diagnosis);
    assert!(first_screen(&page).contains("noise unknown"));
    assert!(section(&page, "next").contains("No further experiment is suggested."));
    assert!(!text(&page).contains("NaN") && !data(&page).to_string().contains("NaN"));
}

/// The form of the JSON, as it is published.
const SCHEMA: &str = include_str!("../../src/diagnosis/diagnose/result.schema.json");

#[test]
fn property_the_json_has_the_form_that_its_schema_says() {
    let schema: serde_json::Value = serde_json::from_str(SCHEMA).unwrap();
    let json = DIAGNOSIS.to_json();
    let wrong = faults(&schema, &json);
    assert!(wrong.is_empty(), "{wrong:?}");
    // The schema is no form that anything has: it refuses a key that is missing, and one that it does not know.
    let keys = json.as_object().unwrap().keys();
    for key in keys {
        let mut less = json.clone();
        less.as_object_mut().unwrap().remove(key);
        assert!(!faults(&schema, &less).is_empty(), "`{key}` may be missing");
    }
    for place in ["", "/steps/0", "/candidates/0", "/curves/0/groups/0", "/lack_of_fit", "/profiles/0"] {
        let mut more = json.clone();
        let object = more.pointer_mut(place).and_then(serde_json::Value::as_object_mut).unwrap();
        object.insert("strange".to_owned(), serde_json::Value::Null);
        assert!(!faults(&schema, &more).is_empty(), "`{place}` may have a strange key");
    }
}
