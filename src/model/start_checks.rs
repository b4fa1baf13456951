//! What a model must have before it starts.

use super::{Model, ModelKind, RunError};
use bekker_modeldescription::Lookup;

/// A control period must be a whole number of inner steps, to this relative tolerance (a decimal
/// fraction such as 0.01/0.001 is off by rounding only).
const WHOLE: f64 = 1e-9;

impl Model {
    /// Checks what [`Model::start`] needs: every parameter within its bounds, a vehicle that the control can drive.
    pub(crate) fn check_start(&self) -> Result<(), RunError> {
        match self.kind {
            ModelKind::Carriage => return Err(RunError::Carriage { name: self.name.clone() }),
            ModelKind::SoilTest => return Err(RunError::SoilTest { name: self.name.clone() }),
            ModelKind::Rover => {}
        }
        self.check_plant()?;
        self.clone().check()?;
        check_vehicle(self)
    }
}

/// Refuses vehicles that the rest of the code does not expect.
fn check_vehicle(model: &Model) -> Result<(), RunError> {
    let wheels = &model.rover.wheels;
    if let Some(k) = wheels.windows(2).position(|pair| pair[1].mount.x <= pair[0].mount.x) {
        let (before, x) = (wheels[k].mount.x, wheels[k + 1].mount.x);
        return Err(RunError::WheelOrder { wheel: k + 2, x, before });
    }
    Ok(())
}

/// How many inner steps make `period`.
pub(super) fn whole_multiple(period: f64, step_size: f64) -> Result<u64, RunError> {
    let ratio = period / step_size;
    let whole = ratio.round();
    if whole >= 1.0 && (ratio - whole).abs() <= WHOLE * whole {
        Ok(whole as u64)
    } else {
        Err(RunError::Period { period, step_size })
    }
}
