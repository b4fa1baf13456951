//! What the C borders of both versions share: instances behind handles, the guard around every call, checked
//! arguments, messages, saved states.

pub(crate) mod arguments;
pub(crate) mod instance;
pub(crate) mod logger;
pub(crate) mod state;

use std::ffi::CStr;

/// `fmi2Status` and `fmi3Status`; `fmi2Pending` never happens here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub enum Status {
    /// All well.
    Ok,
    /// Carried out with a reservation; see the log.
    Warning,
    /// Not carried out; the importer may try otherwise.
    Discard,
    /// Not carried out; see the log.
    Error,
    /// The library is unusable.
    Fatal,
}

impl From<()> for Status {
    fn from((): ()) -> Self {
        Self::Ok
    }
}

/// The model of an FMU whose files are in the folder that the importer names or, where it names none, beside the
/// library.
///
/// # Errors
/// A sentence where the instance has no name, the files cannot be read, or `token` belongs to others.
pub(crate) fn load(
    name: Option<&CStr>,
    token: Option<&CStr>,
    resources: Option<&CStr>,
) -> Result<Box<dyn crate::model::FmuModel>, String> {
    if name.is_none_or(CStr::is_empty) {
        return Err("instanceName is NULL or empty".into());
    }
    let token = token.ok_or("instantiationToken is NULL")?.to_string_lossy();
    let folder = crate::resources::folder(resources)?;
    let model = crate::load(&folder)?;
    let expected = model.description().token().map_err(|error| error.to_string())?;
    if *token == expected {
        return Ok(model);
    }
    Err(format!(
        "the instantiation token `{token}` does not belong to the model in `{}`, whose token is `{expected}`: \
         modelDescription.xml and the resources are not from the same export, or the library is another version",
        folder.display()
    ))
}
