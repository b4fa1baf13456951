//! `terminalsAndIcons.xml` of FMI 3.0: which variables belong together, and the place of the icon.

use super::writer::Xml;
use super::{Causality, Description};

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
    /// Name in the terminal and name of the variable.
    members: Vec<(String, String)>,
}

/// Name of the terminal of variables that belong to no numbered part.
const WHOLE: &str = "rover";

fn groups(description: &Description) -> Vec<Group<'_>> {
    let mut groups: Vec<Group> = Vec::new();
    for (reference, entry) in description.shown() {
        if !matches!(entry.causality, Causality::Input | Causality::Output) {
            continue;
        }
        let (name, shown) = (entry.variable.name.as_str(), description.arrays.name(reference, entry));
        let (group, member) = match name.split_once("].").filter(|_| shown == name) {
            Some((part, member)) => (&name[..part.len() + 1], member.to_owned()),
            None => (WHOLE, shown.clone()),
        };
        match groups.iter_mut().find(|other| other.name == group) {
            Some(found) => found.members.push((member, shown)),
            None => groups.push(Group { name: group, members: vec![(member, shown)] }),
        }
    }
    groups
}

fn terminal(xml: &mut Xml, group: &Group) {
    let attributes = vec![("name", group.name.into()), ("matchingRule", "bus".into())];
    xml.element("Terminal", &attributes, |xml| {
        for (member, variable) in &group.members {
            let attributes = vec![
                ("variableName", variable.clone()),
                ("memberName", member.clone()),
                ("variableKind", "signal".to_owned()),
            ];
            xml.empty("TerminalMemberVariable", &attributes);
        }
    });
}
