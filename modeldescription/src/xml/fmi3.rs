//! The writer for FMI 3.0.

use super::names::is_structured;
use super::writer::{Attributes, Xml, number};
use super::{Causality, Description, Entry, Item, Kind};
use crate::Unit;

/// The whole file; the description must have been checked.
pub(super) fn write(description: &Description, token: &str) -> String {
    let mut xml = Xml::new();
    xml.element("fmiModelDescription", &head(description, token), |xml| {
        xml.empty("CoSimulation", &cosimulation(description));
        units(xml, description);
        types(xml, description);
        log_categories(xml, description);
        xml.empty("DefaultExperiment", &experiment(description));
        xml.element("ModelVariables", &vec![], |xml| {
            for (reference, entry) in description.entries.iter().enumerate() {
                variable(xml, reference, entry);
            }
        });
        xml.element("ModelStructure", &vec![], |xml| structure(xml, description));
    });
    xml.finish()
}

fn head<'a>(description: &Description, token: &str) -> Attributes<'a> {
    let structured = description.entries.iter().all(|entry| is_structured(&entry.variable.name));
    vec![
        ("fmiVersion", "3.0".into()),
        ("modelName", description.name.clone()),
        ("instantiationToken", token.into()),
        ("description", description.description.clone()),
        ("version", description.version.clone()),
        ("license", description.license.clone()),
        // No generationDateAndTime: the same model gives the same bytes, whenever it is packed.
        ("generationTool", description.generation_tool.clone()),
        ("variableNamingConvention", if structured { "structured" } else { "flat" }.into()),
    ]
}

fn cosimulation<'a>(description: &Description) -> Attributes<'a> {
    vec![
        ("modelIdentifier", description.identifier.clone()),
        ("canGetAndSetFMUState", "true".into()),
        ("canSerializeFMUState", "false".into()),
        ("canHandleVariableCommunicationStepSize", "true".into()),
        ("fixedInternalStepSize", number(description.inner_step)),
    ]
}

fn experiment<'a>(description: &Description) -> Attributes<'a> {
    vec![
        ("startTime", number(description.experiment.start)),
        ("stopTime", number(description.experiment.stop)),
        ("stepSize", number(description.experiment.step)),
    ]
}

/// Each unit once, in the order of first use.
fn units(xml: &mut Xml, description: &Description) {
    let mut seen: Vec<Unit> = Vec::new();
    for entry in description.entries.iter().filter(|entry| entry.kind == Kind::Real) {
        if seen.iter().all(|unit| unit.symbol != entry.variable.unit.symbol) {
            seen.push(entry.variable.unit);
        }
    }
    if seen.is_empty() {
        return;
    }
    xml.element("UnitDefinitions", &vec![], |xml| {
        for unit in &seen {
            xml.element("Unit", &vec![("name", unit.symbol.into())], |xml| unit_content(xml, unit));
        }
    });
}

fn unit_content(xml: &mut Xml, unit: &Unit) {
    if let Some(e) = unit.exponents {
        let exponents = [("kg", e.kg), ("m", e.m), ("s", e.s), ("A", e.a), ("K", e.k), ("rad", e.rad)];
        let used = exponents.iter().filter(|(_, power)| *power != 0);
        xml.empty("BaseUnit", &used.map(|(name, power)| (*name, power.to_string())).collect());
    }
    if let Some(display) = unit.display {
        let mut attributes = vec![("name", display.symbol.to_owned()), ("factor", number(display.factor))];
        if display.offset != 0.0 {
            attributes.push(("offset", number(display.offset)));
        }
        xml.empty("DisplayUnit", &attributes);
    }
}

fn types(xml: &mut Xml, description: &Description) {
    let mut seen: Vec<(&str, &[Item])> = Vec::new();
    for entry in &description.entries {
        if let Kind::Enumeration { name, items } = entry.kind
            && seen.iter().all(|(other, _)| *other != name)
        {
            seen.push((name, items));
        }
    }
    if seen.is_empty() {
        return;
    }
    xml.element("TypeDefinitions", &vec![], |xml| {
        for (name, items) in &seen {
            xml.element("EnumerationType", &vec![("name", (*name).into())], |xml| {
                for item in *items {
                    let value = item.value.to_string();
                    let description = item.doc.to_owned();
                    xml.empty(
                        "Item",
                        &vec![("name", item.name.into()), ("value", value), ("description", description)],
                    );
                }
            });
        }
    });
}

fn log_categories(xml: &mut Xml, description: &Description) {
    if description.log_categories.is_empty() {
        return;
    }
    xml.element("LogCategories", &vec![], |xml| {
        for (name, meaning) in description.log_categories {
            xml.empty("Category", &vec![("name", (*name).into()), ("description", (*meaning).into())]);
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
    match entry.kind {
        Kind::Real => {
            attributes.push(("unit", v.unit.symbol.to_owned()));
            attributes.extend(v.unit.display.map(|display| ("displayUnit", display.symbol.to_owned())));
            attributes.extend(v.min.is_finite().then(|| ("min", number(v.min))));
            attributes.extend(v.max.is_finite().then(|| ("max", number(v.max))));
            if matches!(entry.causality, Causality::Parameter | Causality::Input) {
                attributes.push(("start", number(entry.start)));
            }
            xml.empty("Float64", &attributes);
        }
        Kind::Enumeration { name, .. } => {
            attributes.push(("declaredType", name.to_owned()));
            if matches!(entry.causality, Causality::Parameter | Causality::Input) {
                attributes.push(("start", format!("{:.0}", entry.start)));
            }
            xml.empty("Enumeration", &attributes);
        }
    }
}

/// Every output, and as every output is calculated at the start, every output again as an initial
/// unknown. Without `dependencies` a tool must assume that each depends on everything, which is true.
fn structure(xml: &mut Xml, description: &Description) {
    for element in ["Output", "InitialUnknown"] {
        for (reference, entry) in description.entries.iter().enumerate() {
            if entry.causality == Causality::Output {
                xml.empty(element, &vec![("valueReference", reference.to_string())]);
            }
        }
    }
}
