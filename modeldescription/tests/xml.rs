//! The writer of `modelDescription.xml`: what it writes reads back, and what cannot be valid is refused.
//! That the file is valid by the standard's schema is checked with FMPy (`env/tests/test_fmu.py`).
#![allow(clippy::unwrap_used)]

use bekker_modeldescription::xml::{Description, DescriptionError, Entry, Experiment, Item, identifier};
use bekker_modeldescription::{Lookup, Unit, parameters};
use quick_xml::events::{BytesStart, Event};

parameters! {
    /// A spring.
    struct Spring {
        /// Stiffness of a <"wire" & hook>.
        stiffness: [Unit::NEWTON_PER_METRE] = 100.0, 0.0..=1e6, Calibrated, "";
        /// Force.
        force: [Unit::NEWTON] = 0.0, f64::NEG_INFINITY..=f64::INFINITY, Signal, "";
        /// Length.
        length: [Unit::METRE] = 0.1, f64::NEG_INFINITY..=f64::INFINITY, Signal, "";
        /// Free length.
        free_length: [Unit::METRE] = 1e-7, 0.0..=1.0, Fixed, "";
    }
}

const PHASES: &[Item] = &[Item { name: "slack", value: 0, doc: "No force." }];

fn description() -> Description {
    let mut entries = vec![Entry::time()];
    for (variable, value) in Spring::default().list() {
        entries.push(match variable.name.as_str() {
            "force" => Entry::input(variable, value),
            "length" => Entry::output(variable),
            _ => Entry::parameter(variable, value),
        });
    }
    let mut phase = entries[1].variable.clone();
    phase.name = "phase".into();
    entries.push(Entry::enumeration(phase, "Phase", PHASES));
    Description {
        name: "a \"spring\" <&>\n2".into(),
        identifier: "spring".into(),
        description: String::new(),
        version: "1".into(),
        license: "MIT".into(),
        generation_tool: "test".into(),
        experiment: Experiment { start: 0.0, stop: 10.0, step: 0.01 },
        inner_step: 0.001,
        log_categories: &[("logStatusError", "Refusals.")],
        content: "spring.toml".into(),
        entries,
    }
}

/// All elements called `name`, each as its attributes.
fn elements(text: &str, name: &str) -> Vec<Vec<(String, String)>> {
    let mut reader = quick_xml::Reader::from_str(text);
    let mut found = Vec::new();
    loop {
        match reader.read_event().expect("well-formed") {
            Event::Start(e) | Event::Empty(e) if e.name().as_ref() == name => found.push(attributes(&e)),
            Event::Eof => return found,
            _ => {}
        }
    }
}

fn attributes(element: &BytesStart) -> Vec<(String, String)> {
    let pair = |a: quick_xml::events::attributes::Attribute| {
        let value = quick_xml::escape::unescape(&a.value).expect("escaped");
        (a.key.as_ref().to_owned(), value.into_owned())
    };
    element.attributes().map(|a| pair(a.expect("attribute"))).collect()
}

fn get<'a>(attributes: &'a [(String, String)], key: &str) -> Option<&'a str> {
    attributes.iter().find(|(k, _)| k == key).map(|(_, v)| v.as_str())
}

#[test]
fn property_every_character_survives_the_escape() {
    let description = description();
    let text = description.fmi3().unwrap();
    assert_eq!(get(&elements(&text, "fmiModelDescription")[0], "modelName"), Some(description.name.as_str()));
    let variables = elements(&text, "Float64");
    assert_eq!(get(&variables[1], "description"), Some("Stiffness of a <\"wire\" & hook>."));
}

#[test]
fn property_bounds_units_and_starts_read_back() {
    let text = description().fmi3().unwrap();
    let variables = elements(&text, "Float64");
    assert_eq!(get(&variables[1], "max").unwrap().parse::<f64>().unwrap(), 1e6);
    assert_eq!(get(&variables[2], "min"), None, "infinite bounds are left out");
    assert_eq!(get(&variables[3], "start"), None, "an output has no start value");
    assert_eq!(get(&variables[4], "start").unwrap().parse::<f64>().unwrap(), 1e-7);
    let units = elements(&text, "Unit");
    let names: Vec<_> = units.iter().map(|unit| get(unit, "name").unwrap()).collect();
    assert_eq!(names, ["s", "N/m", "N", "m"], "each once");
    let base = elements(&text, "BaseUnit");
    let newton = [("kg", "1"), ("m", "1"), ("s", "-2")].map(|(a, b)| (a.to_owned(), b.to_owned()));
    assert_eq!(base[2], newton);
    assert_eq!(get(&elements(&text, "DisplayUnit")[0], "name"), Some("mm"));
}

#[test]
fn property_structure_lists_every_output_twice() {
    let text = description().fmi3().unwrap();
    for element in ["Output", "InitialUnknown"] {
        let listed = elements(&text, element);
        let references: Vec<_> = listed.iter().map(|e| get(e, "valueReference").unwrap()).collect();
        assert_eq!(references, ["3", "5"], "{element}");
    }
}

#[test]
fn property_the_token_follows_the_content() {
    let first = description();
    let token = first.fmi3_token().unwrap();
    assert_eq!(get(&elements(&first.fmi3().unwrap(), "fmiModelDescription")[0], "instantiationToken"), Some(&*token));
    assert_eq!(description().fmi3_token().unwrap(), token);
    let mut start = description();
    start.entries[1].start = 100.0_f64.next_up();
    let mut content = description();
    content.content.push(' ');
    for changed in [start, content] {
        assert_ne!(changed.fmi3_token().unwrap(), token);
    }
}

#[test]
fn property_names_decide_the_convention() {
    let convention = |description: &Description| {
        let text = description.fmi3().unwrap();
        get(&elements(&text, "fmiModelDescription")[0], "variableNamingConvention").unwrap().to_owned()
    };
    let mut description = description();
    description.entries[1].variable.name = "wheel[2].slip".into();
    assert_eq!(convention(&description), "structured");
    description.entries[1].variable.name = "two words".into();
    assert_eq!(convention(&description), "flat");
}

#[test]
fn property_what_cannot_be_valid_is_refused() {
    let refused = |change: &dyn Fn(&mut Description)| {
        let mut description = description();
        change(&mut description);
        description.fmi3().unwrap_err()
    };
    assert_eq!(
        refused(&|d| d.entries[2].variable.name = "stiffness".into()),
        DescriptionError::Duplicate("stiffness".into())
    );
    assert!(matches!(refused(&|d| d.entries[1].start = f64::NAN), DescriptionError::NotFinite { .. }));
    assert!(matches!(refused(&|d| d.experiment.stop = f64::INFINITY), DescriptionError::NotFinite { .. }));
    assert!(matches!(refused(&|d| d.identifier = "2x".into()), DescriptionError::Identifier(_)));
    assert!(matches!(refused(&|d| d.name = "a\0b".into()), DescriptionError::Character { code: 0, .. }));
}

#[test]
fn property_identifiers_are_identifiers() {
    assert_eq!(identifier("thesis-4.4.1"), "thesis_4_4_1");
    assert_eq!(identifier("2 wheels"), "model_2_wheels");
    assert_eq!(identifier(""), "model_");
}
