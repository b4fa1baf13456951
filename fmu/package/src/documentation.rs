//! The page that an FMU carries for people.

use bekker_modeldescription::xml::{Causality, Description, Entry, Kind};
use quick_xml::escape::escape;
use std::fmt::Write;

const STYLE: &str = "body{font:16px/1.5 sans-serif;max-width:70em;margin:2em auto;padding:0 1em}\
table{border-collapse:collapse}td,th{text-align:left;vertical-align:top;padding:.2em .8em;border-bottom:1px solid #ccc}";

/// `documentation/index.html`.
pub fn html(description: &Description) -> String {
    let name = escape(&description.name);
    let ends = description.entries.iter().any(|entry| entry.variable.name == "event");
    let steps = if ends {
        format!(
            "Any communication step is allowed; the inner steps lie at whole multiples of {:?} s, and points between two of \
             them are interpolated. Where the simulation ends on the way, the FMU asks to terminate it and the output \
             <code>event</code> says why.",
            description.inner_step
        )
    } else {
        "Outputs are those of the inputs and parameters at the end of a communication step, whatever its length."
            .to_owned()
    };
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{name}</title>\n\
         <style>{STYLE}</style>\n</head>\n<body>\n<h1>{name}</h1>\n<p>{}</p>\n<p>Made by {}. {steps}</p>\n",
        escape(&description.description),
        escape(&description.generation_tool),
    );
    for (title, causality) in [
        ("Inputs", Causality::Input),
        ("Outputs", Causality::Output),
        ("States and their derivatives", Causality::Local),
        ("Parameters", Causality::Parameter),
    ] {
        section(&mut page, title, description.entries.iter().filter(|entry| entry.causality == causality));
    }
    page.push_str("</body>\n</html>\n");
    page
}

fn section<'a>(page: &mut String, title: &str, entries: impl Iterator<Item = &'a Entry>) {
    let mut entries = entries.peekable();
    if entries.peek().is_none() {
        return;
    }
    let output = entries.peek().is_some_and(|entry| matches!(entry.causality, Causality::Output | Causality::Local));
    let head = if output { "" } else { "<th>Start</th><th>Range</th>" };
    page.push_str(&format!(
        "<h2>{title}</h2>\n<table>\n<tr><th>Name</th><th>Meaning</th>{head}<th>Unit</th><th>Source</th></tr>\n"
    ));
    for entry in entries {
        row(page, entry, output);
    }
    page.push_str("</table>\n");
}

fn row(page: &mut String, entry: &Entry, output: bool) {
    let v = &entry.variable;
    let mut cells = vec![format!("<code>{}</code>", escape(&v.name)), meaning(entry)];
    if !output {
        cells.push(format!("{:?}", entry.start));
        cells.push(format!("{:?} .. {:?}", v.min, v.max));
    }
    cells.push(escape(v.unit.symbol).into_owned());
    cells.push(escape(v.source.as_ref()).into_owned());
    // Writing to a String cannot fail.
    let _ = writeln!(page, "<tr><td>{}</td></tr>", cells.join("</td><td>"));
}

fn meaning(entry: &Entry) -> String {
    let text = escape(entry.variable.doc.as_ref()).into_owned();
    match entry.kind {
        Kind::Real | Kind::Integer => text,
        Kind::Enumeration { items, .. } => {
            let words: Vec<String> = items
                .iter()
                .map(|item| format!("{} {}: {}", item.value, escape(item.name), escape(item.doc)))
                .collect();
            format!("{text} {}", words.join(" "))
        }
    }
}
