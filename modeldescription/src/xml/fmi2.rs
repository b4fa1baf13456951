//! The writer for FMI 2.0. Units, log categories, bounds and start values are written as for FMI 3.0.

use super::fmi3::{
    enumerations, experiment, integer_attributes, is_calculated, is_initial_unknown, is_set, items, joined,
    log_categories, quantity_attributes, real_attributes, units,
};
use super::names::is_structured;
use super::quantity::{quantity, units as all_units};
use super::writer::{Attributes, Xml};
use super::{Abilities, Causality, Description, Entry, Kind};

/// The whole file; the description must have been checked.
pub(super) fn write(description: &Description, abilities: &Abilities, guid: &str) -> String {
    let mut xml = Xml::new();
    xml.element("fmiModelDescription", &head(description, abilities, guid), |xml| {
        if abilities.exchange.is_some() {
            xml.empty("ModelExchange", &interface(description, abilities));
        }
        xml.empty("CoSimulation", &cosimulation(description, abilities));
        units(xml, description);
        types(xml, description);
        log_categories(xml, description);
        xml.empty("DefaultExperiment", &experiment(description));
        xml.element("ModelVariables", &vec![], |xml| {
            for (reference, entry) in description.entries.iter().enumerate() {
                variable(xml, reference, entry);
            }
        });
        xml.element("ModelStructure", &vec![], |xml| structure(xml, description, abilities));
    });
    xml.finish()
}

fn head<'a>(description: &Description, abilities: &Abilities, guid: &str) -> Attributes<'a> {
    let structured = description.entries.iter().all(|entry| is_structured(&entry.variable.name));
    let mut attributes = vec![
        ("fmiVersion", "2.0".into()),
        ("modelName", description.name.clone()),
        ("guid", guid.into()),
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
    attributes.extend(abilities.exchange.map(|count| ("numberOfEventIndicators", count.to_string())));
    attributes
}

fn yes_no(yes: bool) -> String {
    if yes { "true" } else { "false" }.into()
}

/// What both interface types say. Memory is the library's own, not the importer's.
fn interface<'a>(description: &Description, abilities: &Abilities) -> Attributes<'a> {
    vec![
        ("modelIdentifier", description.identifier.clone()),
        ("canNotUseMemoryManagementFunctions", yes_no(true)),
        ("canGetAndSetFMUstate", yes_no(true)),
        ("canSerializeFMUstate", yes_no(abilities.states_as_bytes)),
        ("providesDirectionalDerivative", yes_no(abilities.directional)),
    ]
}

fn cosimulation<'a>(description: &Description, abilities: &Abilities) -> Attributes<'a> {
    let mut attributes = interface(description, abilities);
    attributes.extend([
        ("canHandleVariableCommunicationStepSize", yes_no(true)),
        ("canInterpolateInputs", yes_no(true)),
        ("maxOutputDerivativeOrder", "1".into()),
        ("canRunAsynchronuously", yes_no(false)),
    ]);
    attributes
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
            xml.element("SimpleType", &vec![("name", (*name).into())], |xml| {
                xml.empty("Real", &quantity_attributes(unit));
            });
        }
        for (name, values) in &enumerations {
            xml.element("SimpleType", &vec![("name", (*name).into())], |xml| {
                xml.element("Enumeration", &vec![], |xml| items(xml, values));
            });
        }
    });
}

fn variable(xml: &mut Xml, reference: usize, entry: &Entry) {
    let v = &entry.variable;
    let mut attributes = vec![
        ("name", v.name.clone()),
        ("valueReference", reference.to_string()),
        ("description", v.doc.to_string()),
        ("causality", entry.causality.word().to_owned()),
        ("variability", entry.variability.word().to_owned()),
    ];
    attributes.extend(is_calculated(entry).then(|| ("initial", "calculated".to_owned())));
    xml.element("ScalarVariable", &attributes, |xml| match entry.kind {
        Kind::Real => {
            let mut attributes = Vec::new();
            attributes.extend(quantity(&v.unit).map(|name| ("declaredType", name.to_owned())));
            attributes.extend(real_attributes(entry));
            attributes.extend(entry.derivative_of.map(|state| ("derivative", index(state))));
            xml.empty("Real", &attributes);
        }
        Kind::Integer => xml.empty("Integer", &integer_attributes(entry)),
        Kind::Enumeration { name, .. } => {
            let mut attributes = vec![("declaredType", name.to_owned())];
            attributes.extend(is_set(entry).then(|| ("start", format!("{:.0}", entry.start))));
            xml.empty("Enumeration", &attributes);
        }
    });
}

/// FMI 2.0 counts variables from 1 here, while value references count from 0.
fn index(reference: usize) -> String {
    (reference + 1).to_string()
}

/// Every output, every derivative of a state, and everything that is calculated at the start as an initial unknown.
/// Without `dependencies` a tool must assume that an unknown depends on everything.
fn structure(xml: &mut Xml, description: &Description, abilities: &Abilities) {
    let mut list = |element: &str,
                    belongs: &dyn Fn(usize, &Entry) -> bool,
                    of: &dyn Fn(&Entry) -> Option<Vec<usize>>| {
        let found = description.entries.iter().enumerate().filter(|(reference, entry)| belongs(*reference, entry));
        let unknowns: Vec<(usize, Option<Vec<usize>>)> =
            found.map(|(reference, entry)| (reference, of(entry))).collect();
        if unknowns.is_empty() {
            return;
        }
        xml.element(element, &vec![], |xml| {
            for (reference, known) in unknowns {
                let mut attributes = vec![("index", index(reference))];
                let indices = known.map(|known| known.into_iter().map(|reference| reference + 1).collect::<Vec<_>>());
                attributes.extend(indices.map(|indices| ("dependencies", joined(&indices))));
                xml.empty("Unknown", &attributes);
            }
        });
    };
    let at_any_instant = |entry: &Entry| entry.dependencies.clone();
    list("Outputs", &|_, entry| entry.causality == Causality::Output, &at_any_instant);
    if abilities.exchange.is_some() {
        list("Derivatives", &|_, entry| entry.derivative_of.is_some(), &at_any_instant);
    }
    let initial = |reference: usize, entry: &Entry| is_initial_unknown(description, abilities, reference, entry);
    list("InitialUnknowns", &initial, &|entry| description.initial_dependencies(entry));
}
