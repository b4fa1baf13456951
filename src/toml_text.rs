//! Reading of TOML.

use serde::de::DeserializeOwned;

/// What a TOML text says. An error names the line and the key.
///
/// # Errors
/// [`toml::de::Error`] where the text is not TOML, or says something else than `T` has.
#[cfg(feature = "experiments")]
pub(crate) fn read<T: DeserializeOwned>(text: &str) -> Result<T, toml::de::Error> {
    toml::from_str(text)
}

/// What a TOML text says. It takes the way over a table, which in the library of an FMU saves 55 kB; an error in a value names the
/// key without the line. The text there is the one that was packed.
///
/// # Errors
/// [`toml::de::Error`] where the text is not TOML, or says something else than `T` has.
#[cfg(not(feature = "experiments"))]
pub(crate) fn read<T: DeserializeOwned>(text: &str) -> Result<T, toml::de::Error> {
    text.parse::<toml::Table>()?.try_into()
}
