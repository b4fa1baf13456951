//! The writer of `modelDescription.xml`: what it writes reads back, and what cannot be valid is refused.
//! That the file is valid by the standard's schema is checked with FMPy (`env/tests/test_fmu.py`).
#![allow(clippy::unwrap_used)]

use bekker_modeldescription::xml::{
    Abilities, Arrays, Component, Description, DescriptionError, Entry, Experiment, Item, Shared, System, identifier,
};
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
        author: "a modeller".into(),
        copyright: "(c) a modeller".into(),
        generation_tool: "test".into(),
        date: None,
        experiment: Experiment { start: 0.0, stop: 10.0, step: 0.01 },
        inner_step: 0.001,
        log_categories: &[("logStatusError", "Refusals.")],
        content: "spring.toml".into(),
        entries,
        arrays: Arrays::default(),
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
    let text = description.fmi3(&Abilities::default()).unwrap();
    assert_eq!(get(&elements(&text, "fmiModelDescription")[0], "modelName"), Some(description.name.as_str()));
    let variables = elements(&text, "Float64");
    assert_eq!(get(&variables[1], "description"), Some("Stiffness of a <\"wire\" & hook>."));
}

#[test]
fn property_bounds_units_and_starts_read_back() {
    let text = description().fmi3(&Abilities::default()).unwrap();
    let variables = elements(&text, "Float64");
    assert_eq!(get(&variables[1], "max").unwrap().parse::<f64>().unwrap(), 1e6);
    assert_eq!(get(&variables[2], "min"), None, "infinite bounds are left out");
    assert_eq!(get(&variables[3], "start"), None, "an output has no start value");
    assert_eq!(get(&variables[4], "start").unwrap().parse::<f64>().unwrap(), 1e-7);
    let units = elements(&text, "Unit");
    let names: Vec<_> = units.iter().map(|unit| get(unit, "name").unwrap()).collect();
    assert_eq!(names, ["s", "N/m", "N", "m", "1"], "each once");
    let base = elements(&text, "BaseUnit");
    let newton = [("kg", "1"), ("m", "1"), ("s", "-2")].map(|(a, b)| (a.to_owned(), b.to_owned()));
    assert_eq!(base[2], newton);
    let displays = elements(&text, "DisplayUnit");
    let names: Vec<_> = displays.iter().map(|unit| get(unit, "name").unwrap()).collect();
    assert_eq!(names, ["mm", "cm"]);
    let types = elements(&text, "Float64Type");
    let names: Vec<_> = types.iter().map(|kind| get(kind, "name").unwrap()).collect();
    assert_eq!(names, ["Time", "Force", "Length"]);
}

#[test]
fn property_fmi2_says_the_same_as_fmi3() {
    let description = description();
    let (old, new) =
        (description.fmi2(&Abilities::default()).unwrap(), description.fmi3(&Abilities::default()).unwrap());
    let token = description.token().unwrap();
    assert_eq!(get(&elements(&old, "fmiModelDescription")[0], "guid"), Some(&*token));
    let (scalars, reals) = (elements(&old, "ScalarVariable"), elements(&old, "Real"));
    assert_eq!(scalars.len(), description.entries.len());
    // Of the elements `Real`, those of the three declared types come first.
    for (k, variable) in elements(&new, "Float64").iter().enumerate() {
        for key in ["name", "valueReference", "description", "causality", "variability", "initial"] {
            assert_eq!(get(&scalars[k], key), get(variable, key), "{key} of {k}");
        }
        for key in ["unit", "displayUnit", "min", "max", "start", "nominal", "declaredType"] {
            assert_eq!(get(&reals[3 + k], key), get(variable, key), "{key} of {k}");
        }
    }
    let unknowns = elements(&old, "Unknown");
    let indices: Vec<_> = unknowns.iter().map(|e| get(e, "index").unwrap()).collect();
    assert_eq!(indices, ["4", "6", "4", "6"], "counted from 1");
}

#[test]
fn property_states_derivatives_and_indicators_are_structured() {
    let mut description = description();
    let length = description.entries[3].variable.clone();
    let state = description.entries.len();
    description
        .entries
        .push(Entry::state(bekker_modeldescription::Variable { name: "state".into(), ..length.clone() }, 0.1));
    description
        .entries
        .push(Entry::derivative(bekker_modeldescription::Variable { name: "rate".into(), ..length }, state));
    let abilities = Abilities { exchange: Some(2), states_as_bytes: true, directional: true, adjoint: true };
    let (old, new) = (description.fmi2(&abilities).unwrap(), description.fmi3(&abilities).unwrap());
    let places = |text: &str, element: &str, key: &str| -> Vec<String> {
        elements(text, element).iter().map(|e| get(e, key).unwrap().to_owned()).collect()
    };
    assert_eq!(places(&new, "ContinuousStateDerivative", "valueReference"), ["7"]);
    assert_eq!(places(&new, "InitialUnknown", "valueReference"), ["3", "5", "6", "7"]);
    assert_eq!(places(&new, "EventIndicator", "valueReference"), ["8", "9"]);
    let rate = elements(&new, "Float64").into_iter().find(|v| get(v, "name") == Some("rate")).unwrap();
    assert_eq!(get(&rate, "derivative"), Some("6"), "by value reference");
    let head = &elements(&old, "fmiModelDescription")[0];
    assert_eq!(get(head, "numberOfEventIndicators"), Some("2"));
    assert!(elements(&old, "Real").iter().any(|real| get(real, "derivative") == Some("7")), "by index");
    for text in [&old, &new] {
        assert_eq!((elements(text, "ModelExchange").len(), elements(text, "CoSimulation").len()), (1, 1));
    }
    assert_eq!(get(&elements(&old, "ModelExchange")[0], "canSerializeFMUstate"), Some("true"));
    assert_eq!(get(&elements(&new, "CoSimulation")[0], "providesAdjointDerivatives"), Some("true"));
}

#[test]
fn property_terminals_group_inputs_and_outputs() {
    let mut description = description();
    description.entries[2].variable.name = "wheel[2].force".into();
    let text = description.terminals().unwrap();
    let names: Vec<_> = elements(&text, "Terminal").iter().map(|t| get(t, "name").unwrap().to_owned()).collect();
    assert_eq!(names, ["wheel[2]", "rover"]);
    let members = elements(&text, "TerminalMemberVariable");
    let pairs: Vec<_> =
        members.iter().map(|m| (get(m, "variableName").unwrap(), get(m, "memberName").unwrap())).collect();
    assert_eq!(pairs, [("wheel[2].force", "force"), ("length", "length"), ("phase", "phase")]);
}

#[test]
fn property_the_date_is_written_but_no_part_of_the_token() {
    let mut dated = description();
    dated.date = Some("2026-11-21T19:00:00Z".into());
    assert_eq!(dated.token(), description().token());
    for text in [dated.fmi2(&Abilities::default()).unwrap(), dated.fmi3(&Abilities::default()).unwrap()] {
        assert_eq!(get(&elements(&text, "fmiModelDescription")[0], "generationDateAndTime"), dated.date.as_deref());
    }
    let undated = description().fmi3(&Abilities::default()).unwrap();
    assert_eq!(get(&elements(&undated, "fmiModelDescription")[0], "generationDateAndTime"), None);
}

#[test]
fn property_structure_lists_every_output_twice() {
    let text = description().fmi3(&Abilities::default()).unwrap();
    for element in ["Output", "InitialUnknown"] {
        let listed = elements(&text, element);
        let references: Vec<_> = listed.iter().map(|e| get(e, "valueReference").unwrap()).collect();
        assert_eq!(references, ["3", "5"], "{element}");
    }
}

#[test]
fn property_the_token_follows_the_content() {
    let first = description();
    let token = first.token().unwrap();
    assert_eq!(
        get(&elements(&first.fmi3(&Abilities::default()).unwrap(), "fmiModelDescription")[0], "instantiationToken"),
        Some(&*token)
    );
    assert_eq!(description().token().unwrap(), token);
    let mut start = description();
    start.entries[1].start = 100.0_f64.next_up();
    let mut content = description();
    content.content.push(' ');
    for changed in [start, content] {
        assert_ne!(changed.token().unwrap(), token);
    }
}

#[test]
fn property_names_decide_the_convention() {
    let convention = |description: &Description| {
        let text = description.fmi3(&Abilities::default()).unwrap();
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
        description.fmi3(&Abilities::default()).unwrap_err()
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

/// Two springs in a row: the second feels the force that is the length of the first, by name.
#[test]
fn property_a_system_is_wired_by_name() {
    let mut second = description();
    second.entries[2].variable.name = "length".into();
    second.entries[3].variable.name = "deflection".into();
    let first = description();
    let components = [
        Component { name: "a", source: "resources/a.fmu", description: &first },
        Component { name: "b", source: "resources/b.fmu", description: &second },
    ];
    let system = System {
        name: "springs",
        experiment: first.experiment,
        components: &components,
        inputs: true,
        shared: Some(Shared { group: "stiffness", source: "resources/shared.ssv" }),
    };
    let text = system.structure().unwrap();
    let wires: Vec<_> = elements(&text, "ssd:Connection")
        .iter()
        .map(|wire| {
            ["startElement", "startConnector", "endElement", "endConnector"]
                .map(|key| get(wire, key).map(str::to_owned))
        })
        .collect();
    let named = |texts: [Option<&str>; 4]| texts.map(|text| text.map(str::to_owned));
    assert_eq!(
        wires,
        [
            named([None, Some("force"), Some("a"), Some("force")]),
            named([Some("a"), Some("length"), Some("b"), Some("length")]),
        ],
        "what nobody feeds becomes an input of the system"
    );
    assert_eq!(elements(&text, "ssd:Component").len(), 2);
    let closed = System { inputs: false, ..system }.structure().unwrap();
    assert_eq!(elements(&closed, "ssd:Connection").len(), 1, "or stays an input of its component alone");
    assert_eq!(elements(&closed, "ssd:Connector").len() + 1, elements(&text, "ssd:Connector").len());
    let connectors = elements(&closed, "ssc:Real");
    assert_eq!(connectors.iter().map(|real| get(real, "unit").unwrap()).collect::<Vec<_>>(), ["N", "m", "N", "m"]);
    let units: Vec<_> =
        elements(&closed, "ssc:Unit").iter().map(|unit| get(unit, "name").unwrap().to_owned()).collect();
    assert_eq!(units, ["N", "m"]);
    let step = &elements(&closed, "osp:FixedStepAlgorithm")[0];
    assert_eq!(get(step, "baseStepSize"), Some("0.01"));
    let wrong = [Component { name: "a\0", ..components[0] }];
    assert!(System { components: &wrong, ..system }.structure().is_err());
}

#[test]
fn property_components_with_the_same_parameters_are_bound_to_one_set() {
    let (first, mut second) = (description(), description());
    let system = |second: &Description| {
        let components = [
            Component { name: "a", source: "resources/a.fmu", description: &first },
            Component { name: "b", source: "resources/b.fmu", description: second },
        ];
        let system = System {
            name: "springs",
            experiment: first.experiment,
            components: &components,
            inputs: false,
            shared: Some(Shared { group: "stiffness", source: "resources/shared.ssv" }),
        };
        (system.structure().unwrap(), system.parameter_set().unwrap())
    };
    let (text, set) = system(&second);
    let bound = elements(&text, "ssd:ParameterBinding");
    assert_eq!(bound.len(), 2);
    assert_eq!(get(&bound[0], "source"), Some("resources/shared.ssv"));
    let set = set.unwrap();
    assert_eq!(get(&elements(&set, "ssv:Parameter")[0], "name"), Some("stiffness"));
    let value = &elements(&set, "ssv:Real")[0];
    assert_eq!((get(value, "value"), get(value, "unit")), (Some("100.0"), Some("N/m")));
    assert_eq!(get(&elements(&set, "ssc:BaseUnit")[0], "s"), Some("-2"));
    // A component that starts with another value keeps it.
    second.entries[1].start = 200.0;
    let (text, set) = system(&second);
    assert_eq!(elements(&text, "ssd:ParameterBinding").len(), 1);
    assert!(set.unwrap().contains("200.0"));
}

#[test]
fn property_dependencies_integers_and_owners_are_written_in_both_versions() {
    let mut description = description();
    description.entries[3] = description.entries[3].clone().depending_on(vec![2], vec![]);
    let mut count = description.entries[1].variable.clone();
    (count.name, count.min, count.max) = ("count".into(), 0.0, 7.0);
    description.entries.push(Entry::integer_parameter(count.clone(), 5.0));
    count.name = "code".into();
    description.entries.push(Entry::integer(count));
    let (old, new) =
        (description.fmi2(&Abilities::default()).unwrap(), description.fmi3(&Abilities::default()).unwrap());
    for (text, integer, unknown, place) in [(&old, "Integer", "Unknown", 1), (&new, "Int32", "Output", 0)] {
        let head = &elements(text, "fmiModelDescription")[0];
        assert_eq!((get(head, "author"), get(head, "copyright")), (Some("a modeller"), Some("(c) a modeller")));
        let integers = elements(text, integer);
        assert_eq!((integers.len(), get(&integers[0], "start"), get(&integers[1], "start")), (2, Some("5"), None));
        assert_eq!((get(&integers[0], "min"), get(&integers[0], "max")), (Some("0"), Some("7")));
        // FMI 2.0 counts variables from 1 on here.
        let unknowns = elements(text, unknown);
        assert_eq!(get(&unknowns[0], "dependencies"), Some(&*(2 + place).to_string()));
        assert_eq!(get(&unknowns[1], "dependencies"), None, "everything");
    }
    let initial = elements(&new, "InitialUnknown");
    assert_eq!(get(&initial[0], "dependencies"), Some("1 4 6"), "the parameters");
}
