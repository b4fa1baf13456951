//! A rover and its controller as a system of two FMUs (SSP 1.0).

use crate::archive::Archive;
use crate::{ExportError, Kind, Options, Version, pack_part, undescribed};
use bekker::model::{ControlKind, Model};
use bekker_modeldescription::xml::{Component, Experiment, Shared, System};

/// The parameters that both FMUs have: the soil, which the controller knows and the rover drives on.
const SOIL: Shared<'_> = Shared { group: "soil", source: "resources/soil.ssv" };

/// `model` as a system of two FMUs of FMI 2.0, the controller and the rover, wired by the names of their variables. The
/// controller is the first: it decides on what was measured at the end of the rover's last step. Both are bound to one
/// parameter set, the soil; the step of the system is the control period.
///
/// # Errors
/// As [`export`](crate::export), but for writing.
pub fn pack_system(model: &Model, options: &Options) -> Result<Vec<u8>, ExportError> {
    check(model, options)?;
    let part = |kind: Kind| {
        let version = Some(Version::Fmi2);
        pack_part(model, &Options { version, kind: Some(kind), system_inputs: false, ..options.clone() })
    };
    let (controller, rover) = (part(Kind::Controller)?, part(Kind::Rover)?);
    let components = [
        Component { name: "controller", source: "resources/controller.fmu", description: &controller.1 },
        Component { name: "rover", source: "resources/rover.fmu", description: &rover.1 },
    ];
    let system = System {
        name: &model.name,
        experiment: Experiment { step: controller.1.inner_step, ..rover.1.experiment },
        components: &components,
        inputs: options.system_inputs,
        shared: Some(SOIL),
    };
    let mut archive = Archive::default();
    archive.file("SystemStructure.ssd", system.structure().map_err(undescribed)?.as_bytes())?;
    archive.file(components[0].source, &controller.0)?;
    archive.file(components[1].source, &rover.0)?;
    if let Some(parameters) = system.parameter_set().map_err(undescribed)? {
        archive.file(SOIL.source, parameters.as_bytes())?;
    }
    Ok(archive.finish()?)
}

/// Refuses what a system cannot be.
fn check(model: &Model, options: &Options) -> Result<(), ExportError> {
    let refused = |reason: String| Err(ExportError::System(reason));
    if options.version == Some(Version::Fmi3) {
        return refused("SSP 1.0 holds FMUs of FMI 2.0; expected FMI 2, or FMUs of FMI 3 by themselves".into());
    }
    if let Some(kind) = options.kind {
        return refused(format!(
            "it holds a rover and a controller, and the kind `{}` asks for one FMU; expected no kind, or an output that ends \
             in .fmu",
            kind.word()
        ));
    }
    if options.arrays {
        return refused("FMI 2.0 has no arrays; expected variables by wheel".into());
    }
    match model.control.kind {
        ControlKind::Torque | ControlKind::Speed | ControlKind::SpeedLoop | ControlKind::Slip => refused(format!(
            "control.kind = {:?} of `{}` is no controller that gives torques for measurements; expected velocity, \
             velocity_tuned or rtc",
            model.control.kind, model.name
        )),
        _ => Ok(()),
    }
}
