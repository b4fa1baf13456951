//! A system of the System Structure and Parameterization standard (SSP 1.0, <https://ssp-standard.org>): FMUs wired by the
//! names of their variables, and a set of parameters that several of them share.

mod parameter_set;

use super::fmi3::unit_content;
use super::quantity::distinct;
use super::writer::{Attributes, Xml, number};
use super::{Causality, Description, DescriptionError, Entry, Experiment, Kind, writable};
use crate::Unit;

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

/// FMUs wired by the names of their variables.
///
/// An input is wired to the output of the same name of another component, as its sensors measure it where they do
/// (`measured.` before the name).
#[derive(Clone, Copy, Debug)]
pub struct System<'a> {
    /// Its name.
    pub name: &'a str,
    /// Default experiment; the step is the one that a master is to make.
    pub experiment: Experiment,
    /// The FMUs.
    pub components: &'a [Component<'a>],
    /// Whether an input that no component feeds also becomes an input of the system, once for each name. Some importers set
    /// inputs there only; others refuse a system that has inputs of its own.
    pub inputs: bool,
    /// Parameters that components share.
    pub shared: Option<Shared<'a>>,
}

/// Parameters that components share: a parameter set in a file of its own.
#[derive(Clone, Copy, Debug)]
pub struct Shared<'a> {
    /// First part of the parameters' names (`soil`), also the name of the set.
    pub group: &'a str,
    /// Its place in the package (`resources/soil.ssv`).
    pub source: &'a str,
}

/// What a component's sensors make of a signal has this before the signal's name.
const MEASURED: &str = "measured.";

/// Namespaces of a system's structure; that of the Open Simulation Platform's annotations is declared here, for its
/// libcosim takes an `xmlns` further inside for an unknown algorithm.
const NAMESPACES: [(&str, &str); 3] = [
    ("xmlns:ssd", "http://ssp-standard.org/SSP1/SystemStructureDescription"),
    ("xmlns:ssc", "http://ssp-standard.org/SSP1/SystemStructureCommon"),
    ("xmlns:osp", "http://opensimulationplatform.com/SSP/OSPAnnotations"),
];

impl System<'_> {
    /// `SystemStructure.ssd`.
    ///
    /// # Errors
    /// A [`DescriptionError`] where a name cannot be written.
    pub fn structure(&self) -> Result<String, DescriptionError> {
        let Self { name, components, .. } = *self;
        for text in components.iter().flat_map(|component| [component.name, component.source]).chain([name]) {
            writable(text)?;
        }
        let mut root: Attributes = NAMESPACES.iter().map(|(key, value)| (*key, (*value).to_owned())).collect();
        root.extend([("version", "1.0".to_owned()), ("name", name.to_owned())]);
        let mut xml = Xml::new();
        xml.element("ssd:SystemStructureDescription", &root, |xml| {
            xml.element("ssd:System", &vec![("name", name.into())], |xml| {
                if self.inputs {
                    connectors(xml, open_inputs(components).into_iter().map(|entry| (entry, "input")).collect());
                }
                xml.element("ssd:Elements", &vec![], |xml| {
                    components.iter().for_each(|component| self.element(xml, component));
                });
                self.connections(xml);
            });
            units(xml, "ssd:Units", components.iter().flat_map(|component| wired_any(component.description)));
            experiment(xml, self.experiment);
        });
        Ok(xml.finish())
    }

    fn element(&self, xml: &mut Xml, component: &Component) {
        let attributes = vec![
            ("name", component.name.to_owned()),
            ("type", "application/x-fmu-sharedlibrary".to_owned()),
            ("source", component.source.to_owned()),
        ];
        xml.element("ssd:Component", &attributes, |xml| {
            let inputs = wired(component.description, Causality::Input).map(|entry| (entry, "input"));
            let outputs = wired(component.description, Causality::Output).map(|entry| (entry, "output"));
            connectors(xml, inputs.chain(outputs).collect());
            if let Some(shared) = self.shared.filter(|shared| self.shares(*shared, component)) {
                xml.element("ssd:ParameterBindings", &vec![], |xml| {
                    xml.empty("ssd:ParameterBinding", &vec![("source", shared.source.into())]);
                });
            }
        });
    }

    fn connections(&self, xml: &mut Xml) {
        let mut wires: Vec<Attributes> = Vec::new();
        for component in self.components {
            for entry in wired(component.description, Causality::Input) {
                let name = entry.variable.name.clone();
                let mut wire: Attributes = Vec::new();
                match source(self.components, component.name, &name) {
                    Some((from, output)) => {
                        wire.push(("startElement", from.name.to_owned()));
                        wire.push(("startConnector", output));
                    }
                    None if self.inputs => wire.push(("startConnector", name.clone())),
                    None => continue,
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
}

/// Times, and for libcosim, which has no step of its own, the step of its master.
fn experiment(xml: &mut Xml, experiment: Experiment) {
    let times = vec![("startTime", number(experiment.start)), ("stopTime", number(experiment.stop))];
    xml.element("ssd:DefaultExperiment", &times, |xml| {
        xml.element("ssd:Annotations", &vec![], |xml| {
            let kind = vec![("type", "com.opensimulationplatform".to_owned())];
            xml.element("ssc:Annotation", &kind, |xml| {
                xml.element("osp:Algorithm", &vec![], |xml| {
                    xml.empty("osp:FixedStepAlgorithm", &vec![("baseStepSize", number(experiment.step))]);
                });
            });
        });
    });
}

/// The units of `entries`, each once.
fn units<'a>(xml: &mut Xml, element: &str, entries: impl Iterator<Item = &'a Entry>) {
    let found: Vec<Unit> = distinct(entries.map(|entry| entry.variable.unit));
    if found.is_empty() {
        return;
    }
    xml.element(element, &vec![], |xml| {
        for unit in &found {
            xml.element("ssc:Unit", &vec![("name", unit.symbol.into())], |xml| unit_content(xml, "ssc:BaseUnit", unit));
        }
    });
}

/// Numbers only: enumerations and integers are read from an FMU, not wired.
fn wired(description: &Description, causality: Causality) -> impl Iterator<Item = &Entry> {
    description.entries.iter().filter(move |entry| entry.causality == causality && entry.kind == Kind::Real)
}

fn wired_any(description: &Description) -> impl Iterator<Item = &Entry> {
    wired(description, Causality::Input).chain(wired(description, Causality::Output))
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

/// Inputs that no component feeds, each name once.
fn open_inputs<'a>(components: &[Component<'a>]) -> Vec<&'a Entry> {
    let mut open: Vec<&Entry> = Vec::new();
    for component in components {
        for entry in wired(component.description, Causality::Input) {
            let name = &entry.variable.name;
            if source(components, component.name, name).is_none()
                && open.iter().all(|other| other.variable.name != *name)
            {
                open.push(entry);
            }
        }
    }
    open
}

fn connectors(xml: &mut Xml, entries: Vec<(&Entry, &str)>) {
    if entries.is_empty() {
        return;
    }
    xml.element("ssd:Connectors", &vec![], |xml| {
        for (entry, kind) in entries {
            let attributes = vec![("name", entry.variable.name.clone()), ("kind", kind.to_owned())];
            let unit = vec![("unit", entry.variable.unit.symbol.to_owned())];
            xml.element("ssd:Connector", &attributes, |xml| xml.empty("ssc:Real", &unit));
        }
    });
}
