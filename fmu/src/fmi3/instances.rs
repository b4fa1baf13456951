//! The instances of FMI 3.0.

use super::types::Updates;
use crate::border::Status;
use crate::border::instance::{self, Component, Instance};
use crate::handles::Registry;
use crate::lifecycle::Refusal;

/// All instances of this process.
pub(super) static INSTANCES: Registry<Component<Updates>> = Registry::new();

/// A call on an instance, see [`instance::call`].
pub(super) fn call<R: Into<Status>>(
    instance: Instance,
    function: &str,
    body: impl FnOnce(&mut Component<Updates>) -> Result<R, Refusal>,
) -> Status {
    instance::call(&INSTANCES, instance, function, body)
}
