//! The model on the ground of a recorded run.

use crate::diagnosis::prediction::PredictionError;
use crate::measurement::Run as Measured;
use crate::model::{ControlKind, Model};
use crate::terrain::{Profile, Samples};

/// The model on a run's ground, commanded as the run was.
pub(super) fn place(mut model: Model, run: &Measured) -> Result<Model, PredictionError> {
    let (commands, wheels) = (run.inputs.len(), model.rover.wheels.len());
    if commands != wheels {
        return Err(PredictionError::Wheels { run: run.name.clone(), commands, wheels });
    }
    // Speed commands are followed exactly unless the model describes the drives' loop and limits. Measured speeds are what came
    // of loop and limits already.
    model.control.kind = match (run.imposes_speeds(), model.control.kind) {
        (true, ControlKind::SpeedLoop) if !run.follows_measured_speeds() => ControlKind::SpeedLoop,
        (true, _) => ControlKind::Speed,
        (false, _) => ControlKind::Torque,
    };
    model.rover.terrain.profile = match &run.terrain {
        None => Profile::Flat,
        Some(table) => {
            let column = |name| table.column(name).unwrap_or_default();
            let samples = Samples::new(column("x"), column("z"))
                .map_err(|source| PredictionError::Terrain { run: run.name.clone(), source })?;
            Profile::Samples(samples.into())
        }
    };
    if let Some(x0) = run.x0 {
        model.start.x0 = x0;
    }
    Ok(model)
}
