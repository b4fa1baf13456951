//! The writer for FMI 3.0.

use super::names::is_structured;
use super::quantity::{displays, quantity, units as all_units};
use super::writer::{Attributes, Xml, number};
use super::{Abilities, Causality, Description, Entry, Item, Kind, indicator_name};
use crate::{Unit, Variable};

/// The whole file; the description must have been checked.
pub(super) fn write(description: &Description, abilities: &Abilities, token: &str) -> String {
    let mut xml = Xml::new();
    xml.element("fmiModelDescription", &head(description, token), |xml| {
        if abilities.exchange.is_some() {
            xml.empty("ModelExchange", &exchange(description, abilities));
        }
        xml.empty("CoSimulation", &cosimulation(description, abilities));
        units(xml, description);
        types(xml, description);
        log_categories(xml, description);
        xml.empty("DefaultExperiment", &experiment(description));
        xml.element("ModelVariables", &vec![], |xml| {
            for (reference, entry) in description.shown() {
                variable(xml, description, reference, entry);
            }
            indicators(xml, description, abilities);
        });
        xml.element("ModelStructure", &vec![], |xml| structure(xml, description, abilities));
    });
    xml.finish()
}

fn head<'a>(description: &Description, token: &str) -> Attributes<'a> {
    let structured = description.entries.iter().all(|entry| is_structured(&entry.variable.name));
    let mut attributes = vec![
        ("fmiVersion", "3.0".into()),
        ("modelName", description.name.clone()),
        ("instantiationToken", token.into()),
        ("description", description.description.clone()),
        ("version", description.version.clone()),
        ("author", description.author.clone()),
        ("copyright", description.copyright.clone()),
        ("license", description.license.clone()),
        ("generationTool", description.generation_tool.clone()),
    ];
    // Only where one was given: the same model gives the same bytes, whenever it is packed.
    attributes.extend(description.date.clone().map(|date| ("generationDateAndTime", date)));
    attributes.push(("variableNamingConvention", if structured { "structured" } else { "flat" }.into()));
    attributes
}

fn yes_no(yes: bool) -> String {
    if yes { "true" } else { "false" }.into()
}

/// What both interface types say.
fn interface<'a>(description: &Description, abilities: &Abilities) -> Attributes<'a> {
    vec![
        ("modelIdentifier", description.identifier.clone()),
        ("canGetAndSetFMUState", yes_no(true)),
        ("canSerializeFMUState", yes_no(abilities.states_as_bytes)),
        ("providesDirectionalDerivatives", yes_no(abilities.directional)),
        ("providesAdjointDerivatives", yes_no(abilities.adjoint)),
        ("providesPerElementDependencies", yes_no(true)),
    ]
}

fn exchange<'a>(description: &Description, abilities: &Abilities) -> Attributes<'a> {
    let mut attributes = interface(description, abilities);
    attributes.push(("needsCompletedIntegratorStep", yes_no(true)));
    attributes.push(("providesEvaluateDiscreteStates", yes_no(true)));
    attributes
}

fn cosimulation<'a>(description: &Description, abilities: &Abilities) -> Attributes<'a> {
    let mut attributes = interface(description, abilities);
    attributes.extend([
        ("canHandleVariableCommunicationStepSize", yes_no(true)),
        ("maxOutputDerivativeOrder", "1".into()),
        ("providesIntermediateUpdate", yes_no(true)),
        ("mightReturnEarlyFromDoStep", yes_no(true)),
        ("canReturnEarlyAfterIntermediateUpdate", yes_no(true)),
        ("hasEventMode", yes_no(true)),
        ("providesEvaluateDiscreteStates", yes_no(true)),
    ]);
    attributes
}

pub(super) fn experiment<'a>(description: &Description) -> Attributes<'a> {
    vec![
        ("startTime", number(description.experiment.start)),
        ("stopTime", number(description.experiment.stop)),
        ("stepSize", number(description.experiment.step)),
    ]
}

/// The same in both versions.
pub(super) fn units(xml: &mut Xml, description: &Description) {
    xml.element("UnitDefinitions", &vec![], |xml| {
        for unit in &all_units(description) {
            xml.element("Unit", &vec![("name", unit.symbol.into())], |xml| {
                unit_content(xml, "BaseUnit", unit);
                display_units(xml, unit);
            });
        }
    });
}

/// The SI exponents of a unit, in the element `base`.
pub(super) fn unit_content(xml: &mut Xml, base: &str, unit: &Unit) {
    if let Some(e) = unit.exponents {
        let exponents = [("kg", e.kg), ("m", e.m), ("s", e.s), ("A", e.a), ("K", e.k), ("rad", e.rad)];
        let used = exponents.iter().filter(|(_, power)| *power != 0);
        xml.empty(base, &used.map(|(name, power)| (*name, power.to_string())).collect());
    }
}

fn display_units(xml: &mut Xml, unit: &Unit) {
    for display in displays(unit) {
        let mut attributes = vec![("name", display.symbol.to_owned()), ("factor", number(display.factor))];
        if display.offset != 0.0 {
            attributes.push(("offset", number(display.offset)));
        }
        xml.empty("DisplayUnit", &attributes);
    }
}

/// Each enumeration once.
pub(super) fn enumerations(description: &Description) -> Vec<(&'static str, &'static [Item])> {
    let mut seen: Vec<(&str, &[Item])> = Vec::new();
    for entry in &description.entries {
        if let Kind::Enumeration { name, items } = entry.kind
            && seen.iter().all(|(other, _)| *other != name)
        {
            seen.push((name, items));
        }
    }
    seen
}

fn types(xml: &mut Xml, description: &Description) {
    let measured: Vec<_> =
        all_units(description).into_iter().filter_map(|unit| Some((quantity(&unit)?, unit))).collect();
    let enumerations = enumerations(description);
    if measured.is_empty() && enumerations.is_empty() {
        return;
    }
    xml.element("TypeDefinitions", &vec![], |xml| {
        for (name, unit) in &measured {
            let mut attributes = vec![("name", (*name).to_owned())];
            attributes.extend(quantity_attributes(unit));
            xml.empty("Float64Type", &attributes);
        }
        for (name, items) in &enumerations {
            xml.element("EnumerationType", &vec![("name", (*name).into())], |xml| self::items(xml, items));
        }
    });
}

/// Quantity, unit and display unit of a declared type.
pub(super) fn quantity_attributes<'a>(unit: &Unit) -> Attributes<'a> {
    let mut attributes = Vec::new();
    attributes.extend(quantity(unit).map(|name| ("quantity", name.to_owned())));
    attributes.push(("unit", unit.symbol.to_owned()));
    attributes.extend(unit.display.map(|display| ("displayUnit", display.symbol.to_owned())));
    attributes
}

/// The values of an enumeration.
pub(super) fn items(xml: &mut Xml, items: &[Item]) {
    for item in items {
        let (value, description) = (item.value.to_string(), item.doc.to_owned());
        xml.empty("Item", &vec![("name", item.name.into()), ("value", value), ("description", description)]);
    }
}

pub(super) fn log_categories(xml: &mut Xml, description: &Description) {
    if description.log_categories.is_empty() {
        return;
    }
    xml.element("LogCategories", &vec![], |xml| {
        for (name, meaning) in description.log_categories {
            xml.empty("Category", &vec![("name", (*name).into()), ("description", (*meaning).into())]);
        }
    });
}

fn variable(xml: &mut Xml, description: &Description, reference: usize, entry: &Entry) {
    let v = &entry.variable;
    let mut attributes = vec![
        ("name", description.arrays.name(reference, entry)),
        ("valueReference", reference.to_string()),
        ("description", v.doc.to_string()),
        ("causality", entry.causality.word().to_owned()),
        ("variability", entry.variability.word().to_owned()),
    ];
    attributes.extend(is_calculated(entry).then(|| ("initial", "calculated".to_owned())));
    match entry.kind {
        Kind::Real => {
            attributes.extend(quantity(&v.unit).map(|name| ("declaredType", name.to_owned())));
            attributes.extend(real_attributes(entry));
            attributes.extend(entry.derivative_of.map(|state| ("derivative", state.to_string())));
            match description.arrays.elements(reference) {
                None => xml.empty("Float64", &attributes),
                Some(elements) => array(xml, description, attributes, elements),
            }
        }
        Kind::Integer => {
            attributes.extend(integer_attributes(entry));
            xml.empty("Int32", &attributes);
        }
        Kind::Enumeration { name, .. } => {
            attributes.push(("declaredType", name.to_owned()));
            attributes.extend(is_set(entry).then(|| ("start", format!("{:.0}", entry.start))));
            xml.empty("Enumeration", &attributes);
        }
    }
}

/// An array of constant size, with the start values of its elements.
fn array<'a>(xml: &mut Xml, description: &Description, mut attributes: Attributes<'a>, elements: &[usize]) {
    let starts = elements.iter().map(|reference| number(description.entries[*reference].start)).collect::<Vec<_>>();
    attributes.iter_mut().filter(|(name, _)| *name == "start").for_each(|(_, start)| *start = starts.join(" "));
    xml.element("Float64", &attributes, |xml| {
        xml.empty("Dimension", &vec![("start", elements.len().to_string())]);
    });
}

/// Whether the importer sets the variable, so that it has a start value.
pub(super) fn is_set(entry: &Entry) -> bool {
    matches!(entry.causality, Causality::Parameter | Causality::Input)
}

/// Whether the model computes the variable, from initialization on.
pub(super) fn is_calculated(entry: &Entry) -> bool {
    matches!(entry.causality, Causality::Output | Causality::Local)
}

/// Unit, bounds, nominal and start value of a number, the same in both versions.
pub(super) fn real_attributes<'a>(entry: &Entry) -> Attributes<'a> {
    let v = &entry.variable;
    let mut attributes = vec![("unit", v.unit.symbol.to_owned())];
    attributes.extend(v.unit.display.map(|display| ("displayUnit", display.symbol.to_owned())));
    attributes.extend(v.min.is_finite().then(|| ("min", number(v.min))));
    attributes.extend(v.max.is_finite().then(|| ("max", number(v.max))));
    attributes.extend(nominal(entry).map(|nominal| ("nominal", number(nominal))));
    attributes.extend(is_set(entry).then(|| ("start", number(entry.start))));
    attributes
}

/// Bounds and start value of an integer, the same in both versions.
pub(super) fn integer_attributes<'a>(entry: &Entry) -> Attributes<'a> {
    let whole = |value: f64| format!("{value:.0}");
    let Variable { min, max, .. } = entry.variable;
    let mut attributes = Vec::new();
    attributes.extend(min.is_finite().then(|| ("min", whole(min))));
    attributes.extend(max.is_finite().then(|| ("max", whole(max))));
    attributes.extend(is_set(entry).then(|| ("start", whole(entry.start))));
    attributes
}

/// The nominal value: as the model says or, of a parameter, the size of its start value.
fn nominal(entry: &Entry) -> Option<f64> {
    let parameter = (entry.causality == Causality::Parameter).then_some(entry.start.abs());
    entry.nominal.or(parameter).filter(|nominal| nominal.is_finite() && *nominal > 0.0)
}

/// FMI 3.0 counts event indicators among the variables; their references follow those of the description.
fn indicators(xml: &mut Xml, description: &Description, abilities: &Abilities) {
    for number in 0..abilities.exchange.unwrap_or(0) {
        let attributes = vec![
            ("name", indicator_name(number)),
            ("valueReference", (description.entries.len() + number).to_string()),
            ("description", "Changes its sign at an event.".to_owned()),
            ("causality", "local".to_owned()),
            ("variability", "continuous".to_owned()),
            ("initial", "calculated".to_owned()),
        ];
        xml.empty("Float64", &attributes);
    }
}

/// Every output, every derivative of a state, and everything that is calculated at the start as an initial unknown.
/// Without `dependencies` a tool must assume that an unknown depends on everything.
fn structure(xml: &mut Xml, description: &Description, abilities: &Abilities) {
    let mut list = |element: &str,
                    belongs: &dyn Fn(usize, &Entry) -> bool,
                    of: &dyn Fn(&Entry) -> Option<Vec<usize>>| {
        for (reference, entry) in description.shown() {
            if belongs(reference, entry) {
                let mut attributes = vec![("valueReference", reference.to_string())];
                attributes.extend(of_array(description, reference, of).map(|known| ("dependencies", joined(&known))));
                xml.empty(element, &attributes);
            }
        }
    };
    let at_any_instant = |entry: &Entry| entry.dependencies.clone();
    list("Output", &|_, entry| entry.causality == Causality::Output, &at_any_instant);
    if abilities.exchange.is_some() {
        list("ContinuousStateDerivative", &|_, entry| entry.derivative_of.is_some(), &at_any_instant);
    }
    let initial = |reference: usize, entry: &Entry| is_initial_unknown(description, abilities, reference, entry);
    list("InitialUnknown", &initial, &|entry| description.initial_dependencies(entry));
    for number in 0..abilities.exchange.unwrap_or(0) {
        xml.empty("EventIndicator", &vec![("valueReference", (description.entries.len() + number).to_string())]);
    }
}

/// What an entry depends on or, of an array, any of its elements; `None` where one depends on everything.
fn of_array(
    description: &Description,
    reference: usize,
    of: &dyn Fn(&Entry) -> Option<Vec<usize>>,
) -> Option<Vec<usize>> {
    let alone = [reference];
    let elements = description.arrays.elements(reference).unwrap_or(&alone);
    let known: Option<Vec<Vec<usize>>> = elements.iter().map(|element| of(&description.entries[*element])).collect();
    known.map(|known| description.shown_references(&known.concat()))
}

/// Numbers with blanks between them.
pub(super) fn joined(numbers: &[usize]) -> String {
    numbers.iter().map(usize::to_string).collect::<Vec<_>>().join(" ")
}

/// Outputs and, where the importer integrates, the states and their derivatives.
pub(super) fn is_initial_unknown(
    description: &Description,
    abilities: &Abilities,
    reference: usize,
    entry: &Entry,
) -> bool {
    let state = || description.entries.iter().any(|other| other.derivative_of == Some(reference));
    entry.causality == Causality::Output || (abilities.exchange.is_some() && (entry.derivative_of.is_some() || state()))
}
