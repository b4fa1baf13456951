//! Functions of capabilities that the model description does not claim: an error with the reason.

use super::instances::call;
use crate::border::Status;
use crate::border::instance::Instance;
use crate::lifecycle::Refusal;

macro_rules! unsupported {
    ($($reason:literal: $($function:ident($($argument:ident: $type:ty),*);)*)*) => {$($(
        #[doc = concat!("`", stringify!($function), "`: refused, ", $reason, ".")]
        #[unsafe(no_mangle)]
        pub extern "C" fn $function(instance: Instance, $($argument: $type),*) -> Status {
            let _ = ($($argument,)*);
            call(instance, stringify!($function), |_| -> Result<(), Refusal> {
                Err(Refusal::Unsupported($reason.into()))
            })
        }
    )*)*};
}

unsupported! {
    "the FMU has no structural parameters, the number of wheels and links is that of the packed model":
        fmi3EnterConfigurationMode();
        fmi3ExitConfigurationMode();
    "the function is for scheduled execution, which the FMU does not offer":
        fmi3ActivateModelPartition(clockReference: u32, activationTime: f64);
}
