//! `terminalsAndIcons.xml` of FMI 3.0: which variables belong together, and the place of the icon.

use super::writer::Xml;
use super::{Causality, Description, Entry};

/// Edge of the icon in the units of its coordinate system.
const EDGE: &str = "100";

/// The whole file: one bus for each numbered part (`wheel[2]`), with the inputs and outputs whose names begin so, and
/// one for those of the rover as a whole.
pub(super) fn write(description: &Description) -> String {
    let mut xml = Xml::new();
    xml.element("fmiTerminalsAndIcons", &vec![("fmiVersion", "3.0".into())], |xml| {
        xml.element("GraphicalRepresentation", &vec![], |xml| {
            let corners = || vec![("x1", "0".into()), ("y1", "0".into()), ("x2", EDGE.into()), ("y2", EDGE.into())];
            let mut system = corners();
            system.push(("suggestedScalingFactorTo_mm", "0.2".into()));
            xml.empty("CoordinateSystem", &system);
            xml.empty("Icon", &corners());
        });
        let groups = groups(description);
        if !groups.is_empty() {
            xml.element("Terminals", &vec![], |xml| groups.iter().for_each(|group| terminal(xml, group)));
        }
    });
    xml.finish()
}

struct Group<'a> {
    name: &'a str,
    members: Vec<(&'a str, &'a Entry)>,
}

/// Name of the terminal of variables that belong to no numbered part.
const WHOLE: &str = "rover";

fn groups(description: &Description) -> Vec<Group<'_>> {
    let mut groups: Vec<Group> = Vec::new();
    for entry in &description.entries {
        if !matches!(entry.causality, Causality::Input | Causality::Output) {
            continue;
        }
        let name = entry.variable.name.as_str();
        let (group, member) = match name.split_once("].") {
            Some((part, member)) => (&name[..part.len() + 1], member),
            None => (WHOLE, name),
        };
        match groups.iter_mut().find(|other| other.name == group) {
            Some(found) => found.members.push((member, entry)),
            None => groups.push(Group { name: group, members: vec![(member, entry)] }),
        }
    }
    groups
}

fn terminal(xml: &mut Xml, group: &Group) {
    let attributes = vec![("name", group.name.into()), ("matchingRule", "bus".into())];
    xml.element("Terminal", &attributes, |xml| {
        for (member, entry) in &group.members {
            let attributes = vec![
                ("variableName", entry.variable.name.clone()),
                ("memberName", (*member).to_owned()),
                ("variableKind", "signal".to_owned()),
            ];
            xml.empty("TerminalMemberVariable", &attributes);
        }
    });
}
