//! A thin layer over the XML writer: writing to memory cannot fail, and numbers are exact.

use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, Event};

/// Writes elements to memory, indented.
pub(super) struct Xml(Writer<Vec<u8>>);

/// Attributes of an element, in order.
pub(super) type Attributes<'a> = Vec<(&'a str, String)>;

impl Xml {
    pub(super) fn new() -> Self {
        let mut xml = Self(Writer::new_with_indent(Vec::new(), b' ', 2));
        xml.event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)));
        xml
    }

    pub(super) fn finish(self) -> String {
        let mut text = String::from_utf8_lossy(&self.0.into_inner()).into_owned();
        text.push('\n');
        text
    }

    /// An element without content.
    pub(super) fn empty(&mut self, name: &str, attributes: &Attributes) {
        self.event(Event::Empty(start(name, attributes)));
    }

    /// An element with the content that `body` writes.
    pub(super) fn element(&mut self, name: &str, attributes: &Attributes, body: impl FnOnce(&mut Self)) {
        self.event(Event::Start(start(name, attributes)));
        body(self);
        self.event(Event::End(BytesEnd::new(name)));
    }

    fn event(&mut self, event: Event) {
        let written = self.0.write_event(event);
        debug_assert!(written.is_ok(), "a vector takes every byte");
    }
}

fn start<'a>(name: &'a str, attributes: &'a Attributes) -> BytesStart<'a> {
    BytesStart::new(name).with_attributes(attributes.iter().map(|(key, value)| (*key, value.as_str())))
}

/// The shortest decimal that reads back as the same number.
pub(super) fn number(value: f64) -> String {
    format!("{value:?}")
}
