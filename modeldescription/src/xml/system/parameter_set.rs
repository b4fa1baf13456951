//! `*.ssv`: the parameters that components share, which an importer sets once for all of them.

use super::super::writer::{Xml, number};
use super::{Causality, Component, DescriptionError, Entry, Kind, Shared, System, units};

/// Namespaces of a parameter set.
const NAMESPACES: [(&str, &str); 2] = [
    ("xmlns:ssv", "http://ssp-standard.org/SSP1/SystemStructureParameterValues"),
    ("xmlns:ssc", "http://ssp-standard.org/SSP1/SystemStructureCommon"),
];

impl System<'_> {
    /// The parameters of a group as its last component has them, with their start values: the file that the components which
    /// share them are bound to. `None` where no group is shared.
    ///
    /// # Errors
    /// A [`DescriptionError`] where a start value is not finite.
    pub fn parameter_set(&self) -> Result<Option<String>, DescriptionError> {
        let Some((shared, entries)) = self.shared.and_then(|shared| Some((shared, self.group(shared)?))) else {
            return Ok(None);
        };
        entries.iter().try_for_each(|entry| entry.check())?;
        let mut root: Vec<(&str, String)> = NAMESPACES.iter().map(|(key, value)| (*key, (*value).to_owned())).collect();
        root.extend([("version", "1.0".to_owned()), ("name", shared.group.to_owned())]);
        let mut xml = Xml::new();
        xml.element("ssv:ParameterSet", &root, |xml| {
            xml.element("ssv:Parameters", &vec![], |xml| {
                for entry in &entries {
                    let value = vec![("value", number(entry.start)), ("unit", entry.variable.unit.symbol.to_owned())];
                    let name = vec![("name", entry.variable.name.clone())];
                    xml.element("ssv:Parameter", &name, |xml| xml.empty("ssv:Real", &value));
                }
            });
            units(xml, "ssv:Units", entries.iter().copied());
        });
        Ok(Some(xml.finish()))
    }

    /// Whether a component has every parameter of the shared group, with the same start value.
    pub(super) fn shares(&self, shared: Shared, component: &Component) -> bool {
        self.group(shared).is_some_and(|group| {
            group.iter().all(|entry| {
                let own = component.description.find(&entry.variable.name);
                own.is_some_and(|own| own.causality == Causality::Parameter && own.start == entry.start)
            })
        })
    }

    /// The group of the last component that has it.
    fn group(&self, shared: Shared) -> Option<Vec<&Entry>> {
        let of_group = |name: &str| name.split('.').next() == Some(shared.group);
        let belongs = |entry: &&Entry| {
            entry.causality == Causality::Parameter && entry.kind == Kind::Real && of_group(&entry.variable.name)
        };
        let has_it = |component: &&Component| component.description.entries.iter().any(|entry| belongs(&entry));
        let found = self.components.iter().rev().find(has_it)?;
        Some(found.description.entries.iter().filter(belongs).collect())
    }
}
