//! What of `modelDescription.xml` an importer needs.

use crate::ImportError;
use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};
use std::collections::HashMap;

/// Version of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Version {
    /// FMI 2.0.
    Fmi2,
    /// FMI 3.0.
    Fmi3,
}

/// Type of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// `Real` or `Float64`.
    Real,
    /// `Enumeration` or `Integer` of FMI 2.0, `Enumeration` or `Int64` of FMI 3.0.
    Integer,
    /// Any other.
    Other,
}

impl Kind {
    /// For people.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Real => "a real number",
            Self::Integer => "an integer or enumeration",
            Self::Other => "neither a real number nor an integer",
        }
    }
}

/// A variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Variable {
    /// Its value reference.
    pub reference: u32,
    /// Its type.
    pub kind: Kind,
}

/// The parts of an FMU's `modelDescription.xml` that are used here.
#[derive(Clone, Debug)]
pub struct Description {
    /// Version of the standard.
    pub version: Version,
    /// Name of the model.
    pub name: String,
    /// `guid` or `instantiationToken`.
    pub token: String,
    /// Name of the library for co-simulation.
    pub identifier: String,
    /// Variables by name.
    pub variables: HashMap<String, Variable>,
}

impl Description {
    /// Reads the file's text.
    ///
    /// # Errors
    /// [`ImportError::Description`] where it is not XML, or of no FMU with co-simulation of FMI 2.0 or 3.0.
    pub fn parse(text: &str) -> Result<Self, ImportError> {
        let mut found = Found::default();
        let mut reader = Reader::from_str(text);
        loop {
            match reader.read_event().map_err(|error| ImportError::Description(error.to_string()))? {
                Event::Start(element) | Event::Empty(element) => found.element(&element)?,
                Event::Eof => break,
                _ => {}
            }
        }
        found.finish()
    }
}

/// What has been read so far.
#[derive(Default)]
struct Found {
    version: Option<Version>,
    name: String,
    token: String,
    identifier: Option<String>,
    variables: HashMap<String, Variable>,
    inside_variables: bool,
    /// The scalar variable of FMI 2.0 whose type, an element of its own, comes next.
    open: Option<(String, u32)>,
}

impl Found {
    fn element(&mut self, element: &BytesStart) -> Result<(), ImportError> {
        let name = element.name();
        match name.as_ref() {
            "fmiModelDescription" => self.head(element)?,
            "CoSimulation" => self.identifier = attribute(element, "modelIdentifier")?,
            "ModelVariables" => self.inside_variables = true,
            "ModelStructure" => self.inside_variables = false,
            "ScalarVariable" => self.open = reference(element)?,
            kind if self.inside_variables => self.variable(kind, element)?,
            _ => {}
        }
        Ok(())
    }

    fn head(&mut self, element: &BytesStart) -> Result<(), ImportError> {
        let version = attribute(element, "fmiVersion")?.unwrap_or_default();
        self.version = match version.as_str() {
            "2.0" => Some(Version::Fmi2),
            text if text.starts_with("3.") => Some(Version::Fmi3),
            other => return Err(ImportError::Description(format!("fmiVersion is `{other}`, expected 2.0 or 3.0"))),
        };
        self.name = attribute(element, "modelName")?.unwrap_or_default();
        let key = if self.version == Some(Version::Fmi2) { "guid" } else { "instantiationToken" };
        self.token = attribute(element, key)?.unwrap_or_default();
        Ok(())
    }

    fn variable(&mut self, kind: &str, element: &BytesStart) -> Result<(), ImportError> {
        let kind = match kind {
            "Real" | "Float64" => Kind::Real,
            "Integer" | "Enumeration" | "Int64" => Kind::Integer,
            _ => Kind::Other,
        };
        let named = match self.open.take() {
            Some(open) => Some(open),
            None => reference(element)?,
        };
        if let Some((name, reference)) = named {
            self.variables.insert(name, Variable { reference, kind });
        }
        Ok(())
    }

    fn finish(self) -> Result<Description, ImportError> {
        let missing = |what: &str| ImportError::Description(format!("expected {what}"));
        Ok(Description {
            version: self.version.ok_or_else(|| missing("the element fmiModelDescription"))?,
            name: self.name,
            token: self.token,
            identifier: self.identifier.ok_or_else(|| missing("co-simulation, with a modelIdentifier"))?,
            variables: self.variables,
        })
    }
}

/// Name and value reference of an element that has both.
fn reference(element: &BytesStart) -> Result<Option<(String, u32)>, ImportError> {
    let (Some(name), Some(text)) = (attribute(element, "name")?, attribute(element, "valueReference")?) else {
        return Ok(None);
    };
    match text.parse() {
        Ok(reference) => Ok(Some((name, reference))),
        Err(_) => Err(ImportError::Description(format!("valueReference of `{name}` is `{text}`, expected a number"))),
    }
}

fn attribute(element: &BytesStart, name: &str) -> Result<Option<String>, ImportError> {
    let refused = |message: String| ImportError::Description(message);
    let found = element.try_get_attribute(name).map_err(|error| refused(error.to_string()))?;
    let value =
        found.map(|attribute| attribute.normalized_value(XmlVersion::Implicit1_0).map(|text| text.into_owned()));
    value.transpose().map_err(|error| refused(error.to_string()))
}
