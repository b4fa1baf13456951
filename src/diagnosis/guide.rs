//! A hand that leads the simulated rover along at the measured velocity.
//!
//! With a wrong soil a simulated rover gets stuck, and what it then does says little about how the soil is wrong. Led along
//! it keeps the measured slip, and torques, currents and sinkages can be compared from the first row to the last. Its
//! velocity stays behind the measured one by the force that leads it, so that the balance of forces counts too: the
//! prediction-error method, with an observer of one gain (Ljung 1999, System Identification, chapter 7).

use crate::effects::custom::ParameterDefinition;
use crate::effects::{EffectDefinition, Effects};
use crate::measurement::Run as Measured;
use crate::model::Model;
use crate::scalar::Scalar;

/// Id of the effect that leads the rover; only the runs of a guided fit have it.
const ID: &str = "guide";

/// Time within which the rover follows, s: the force that a stuck rover lacks, about half its weight, then holds the
/// velocity to within 0.15 m/s, and a hundredth of its weight shows as 3 mm/s.
const TIME: f64 = 0.03;

/// The measured velocity row by row, m/s.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Guide {
    velocity: Vec<f64>,
}

impl Guide {
    /// The guide of a run, laid into its model; `None` where no velocity was measured or an effect of the user's own has its id.
    pub fn of(run: &Measured, model: &mut Model) -> Option<Self> {
        let mut last = *run.data.column("velocity")?.iter().find(|v| !v.is_nan())?;
        let mut held = |v: &f64| {
            last = if v.is_nan() { last } else { *v };
            last
        };
        let velocity = run.data.column("velocity")?.iter().map(&mut held).collect();
        model.rover.effects.add(definition()).ok()?;
        let gain = model.rover.total_mass() / TIME;
        let [force, _] = model.rover.effects.custom.values_of(ID)? else { return None };
        *force = gain;
        Some(Self { velocity })
    }

    /// Leads towards the velocity of a row from now on.
    pub fn lead<S: Scalar>(&self, row: usize, effects: &mut Effects<S>) {
        if let (Some([_, towards]), Some(velocity)) = (effects.custom.values_of(ID), self.velocity.get(row)) {
            *towards = S::from(*velocity);
        }
    }
}

fn definition() -> EffectDefinition {
    let parameter = |unit: &str, about: &str| ParameterDefinition {
        neutral: 0.0,
        min: -1e9,
        max: 1e9,
        unit: unit.to_owned(),
        about: about.to_owned(),
        source: String::new(),
        free: false,
    };
    let gain = parameter("N s/m", "Force for each m/s that is missing");
    let velocity = parameter("m/s", "Velocity towards which the rover is led");
    EffectDefinition {
        id: ID.to_owned(),
        about: "A hand that leads the rover at the measured velocity".to_owned(),
        target: "body.force_x".to_owned(),
        mode: None,
        expression: "gain * (towards - velocity)".to_owned(),
        parameters: [("gain".to_owned(), gain), ("towards".to_owned(), velocity)].into(),
    }
}
