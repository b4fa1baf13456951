//! `SystemStructure.ssd` of the System Structure and Parameterization standard (SSP 1.0,
//! <https://ssp-standard.org>): FMUs wired by the names of their variables.

use super::writer::{Attributes, Xml, number};
use super::{Causality, Description, DescriptionError, Entry, Experiment, Kind, writable};

/// One FMU of a system.
#[derive(Clone, Copy, Debug)]
pub struct Component<'a> {
    /// Its name in the system.
    pub name: &'a str,
    /// Its place in the package (`resources/rover.fmu`).
    pub source: &'a str,
    /// Its variables.
    pub description: &'a Description,
}

/// What a component's sensors make of a signal has this before the signal's name.
const MEASURED: &str = "measured.";

/// The system of `components`: an input is wired to the output of the same name of another component, as its sensors
/// measure it where they do (`measured.` before the name); inputs that no component feeds become inputs of the system,
/// once for each name.
///
/// # Errors
/// A [`DescriptionError`] where a name cannot be written.
pub fn system(name: &str, experiment: Experiment, components: &[Component]) -> Result<String, DescriptionError> {
    for text in components.iter().flat_map(|component| [component.name, component.source]).chain([name]) {
        writable(text)?;
    }
    let mut xml = Xml::new();
    let root = vec![
        ("xmlns:ssd", "http://ssp-standard.org/SSP1/SystemStructureDescription".to_owned()),
        ("xmlns:ssc", "http://ssp-standard.org/SSP1/SystemStructureCommon".to_owned()),
        ("version", "1.0".to_owned()),
        ("name", name.to_owned()),
    ];
    xml.element("ssd:SystemStructureDescription", &root, |xml| {
        xml.element("ssd:System", &vec![("name", name.into())], |xml| {
            connectors(xml, open_inputs(components).into_iter().map(|(_, entry)| (entry, "input")).collect());
            xml.element("ssd:Elements", &vec![], |xml| {
                components.iter().for_each(|component| element(xml, component));
            });
            connections(xml, components);
        });
        let times = vec![("startTime", number(experiment.start)), ("stopTime", number(experiment.stop))];
        xml.empty("ssd:DefaultExperiment", &times);
    });
    Ok(xml.finish())
}

/// Numbers only: enumerations are read from an FMU, not wired.
fn wired(description: &Description, causality: Causality) -> impl Iterator<Item = &Entry> {
    description.entries.iter().filter(move |entry| entry.causality == causality && entry.kind == Kind::Real)
}

/// The component other than `own` that feeds the input called `name`, and the output by which it does.
fn source<'a>(components: &[Component<'a>], own: &str, name: &str) -> Option<(Component<'a>, String)> {
    let has = |component: &Component, wanted: &str| {
        component.name != own
            && wired(component.description, Causality::Output).any(|entry| entry.variable.name == wanted)
    };
    let names = [format!("{MEASURED}{name}"), name.to_owned()];
    names.into_iter().find_map(|wanted| {
        let found = components.iter().find(|component| has(component, &wanted)).copied()?;
        Some((found, wanted))
    })
}

/// Inputs that no component feeds, each name once, with a component that has it.
fn open_inputs<'a>(components: &[Component<'a>]) -> Vec<(Component<'a>, &'a Entry)> {
    let mut open: Vec<(Component, &Entry)> = Vec::new();
    for component in components {
        for entry in wired(component.description, Causality::Input) {
            let name = &entry.variable.name;
            if source(components, component.name, name).is_none() && open.iter().all(|(_, e)| e.variable.name != *name)
            {
                open.push((*component, entry));
            }
        }
    }
    open
}

fn element(xml: &mut Xml, component: &Component) {
    let attributes = vec![
        ("name", component.name.to_owned()),
        ("type", "application/x-fmu-sharedlibrary".to_owned()),
        ("source", component.source.to_owned()),
    ];
    xml.element("ssd:Component", &attributes, |xml| {
        let inputs = wired(component.description, Causality::Input).map(|entry| (entry, "input"));
        let outputs = wired(component.description, Causality::Output).map(|entry| (entry, "output"));
        connectors(xml, inputs.chain(outputs).collect());
    });
}

fn connectors(xml: &mut Xml, entries: Vec<(&Entry, &str)>) {
    if entries.is_empty() {
        return;
    }
    xml.element("ssd:Connectors", &vec![], |xml| {
        for (entry, kind) in entries {
            let attributes = vec![("name", entry.variable.name.clone()), ("kind", kind.to_owned())];
            xml.element("ssd:Connector", &attributes, |xml| xml.empty("ssc:Real", &vec![]));
        }
    });
}

fn connections(xml: &mut Xml, components: &[Component]) {
    let mut wires: Vec<Attributes> = Vec::new();
    for component in components {
        for entry in wired(component.description, Causality::Input) {
            let name = entry.variable.name.clone();
            let mut wire: Attributes = Vec::new();
            match source(components, component.name, &name) {
                Some((from, output)) => {
                    wire.push(("startElement", from.name.to_owned()));
                    wire.push(("startConnector", output));
                }
                None => wire.push(("startConnector", name.clone())),
            }
            wire.push(("endElement", component.name.to_owned()));
            wire.push(("endConnector", name));
            wires.push(wire);
        }
    }
    if !wires.is_empty() {
        xml.element("ssd:Connections", &vec![], |xml| {
            wires.iter().for_each(|wire| xml.empty("ssd:Connection", wire));
        });
    }
}
