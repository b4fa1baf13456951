//! An effect and a controller of one's own, in a crate of one's own: add them to a model, drive with them, and find the
//! effect in measurements.
//!
//! `cargo run --release --example 04_own_effect`

use bekker::contact::Forces;
use bekker::control::{ControlError, ControlLaw, Controller, History, Nominal};
use bekker::diagnosis::{Control, DiagnoseOptions, Diagnosis, SingleWheelPlan, diagnose, modelled};
use bekker::effects::{Advice, Effect, Facts, Local, Place};
use bekker::measurement::{Experiment, Table};
use bekker::model::Model;
use bekker::modeldescription::{Lookup, Unit, parameters};
use bekker::scalar::Scalar;
use bekker::signals::{Command, Measurement, Reference};
use bekker::snapshot::{Reader, SnapshotError, Writer};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use std::error::Error;

/// Speed over which the loss changes its sign, m/s.
const REVERSAL_SPEED: f64 = 0.001;

parameters! {
    /// A tyre that warms as it is kneaded: the rim's torque is larger by f N r (Wong 2008, 1.2).
    pub struct TyreHysteresis {
        /// Coefficient f of the rolling resistance.
        coefficient: [Unit::ONE] = 0.0, 0.0..=0.2, Effect, "Wong 2008, 1.2: 0.01-0.05 for rubber tyres";
    }
}

impl<S: Scalar> Effect<S> for TyreHysteresis<S> {
    fn facts(&self) -> Facts {
        Facts {
            seen_on_carriage: &["torque"],
            seen_on_rover: &["wheel[1].torque"],
            advice: const { &[Advice::carriage("roll the wheel over a hard plate under two loads and record its torque")] },
            ..Facts::USUAL
        }
    }

    fn forces(&self, place: &Place<S>, local: &Local<S>, forces: &mut Forces<S>) {
        if self.coefficient.is_exactly(0.0) {
            return;
        }
        let norm = (place.velocity * place.velocity + REVERSAL_SPEED * REVERSAL_SPEED).sqrt();
        forces.torque += self.coefficient * forces.normal * local.wheel.radius * place.velocity / norm;
    }
}

parameters! {
    /// A law that knows the slope: every wheel carries its share of the weight along the chassis, and the error of the speed
    /// adds to it.
    pub struct SlopeLaw {
        /// Gain on the error of the body's speed.
        gain: [Unit::NEWTON_SECOND_PER_METRE] = 100.0, 0.0..=1e4, Fixed, "half the weight at a step of 0.5 m/s";
        /// Gain on its integral.
        integral_gain: [Unit::NEWTON_PER_METRE] = 100.0, 0.0..=1e4, Fixed, "assumption: the soil's resistance is met within 1 s";
        /// Control period.
        period: [Unit::SECOND] = 0.01, 1e-3..=0.1, Fixed, "assumption: 100 Hz";
    }
}

/// The law at work.
#[derive(Clone)]
pub struct SlopeController {
    law: SlopeLaw,
    nominal: Nominal,
    /// Integral of the error of the speed, m.
    behind: f64,
}

impl ControlLaw for SlopeLaw {
    type Controller = SlopeController;

    fn period(&self) -> f64 {
        self.period
    }

    fn controller(&self, nominal: &Nominal) -> Result<SlopeController, ControlError> {
        Ok(SlopeController { law: *self, nominal: nominal.clone(), behind: 0.0 })
    }
}

impl Controller for SlopeController {
    fn command(&mut self, measured: &Measurement, goal: &Reference, command: &mut Command) -> Result<(), ControlError> {
        let error = goal.velocity - measured.velocity;
        if !error.is_finite() {
            return Err(ControlError::NotFinite { quantity: "error of the speed", wheel: None, value: error });
        }
        self.behind += error * self.law.period;
        let weight = self.nominal.mass * self.nominal.gravity * measured.pitch.sin();
        let force = weight + self.law.gain * error + self.law.integral_gain * self.behind;
        let wheels = self.nominal.wheel_centres.len();
        *command = Command::torque(vec![force * self.nominal.wheel.radius / wheels as f64; wheels]);
        Ok(())
    }

    fn reset(&mut self) {
        self.behind = 0.0;
    }
}

impl History for SlopeController {
    fn save(&self, to: &mut Writer) {
        to.real(self.behind);
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        self.behind = from.real()?;
        Ok(())
    }
}

/// A rover on the thesis's gentle ground with both of them.
fn model() -> Result<Model, Box<dyn Error>> {
    let mut model = Model::preset("gentle_velocity")?;
    model.set("soil.shear_modulus", 0.01)?;
    model.register_effect::<TyreHysteresis>(
        "tyre_hysteresis",
        "Tyre hysteresis: the rolling tyre itself takes torque.",
    )?;
    model.drive_by("slope_law", SlopeLaw::default())?;
    Ok(model)
}

/// Measurements of a wheel on a carriage whose tyre has this coefficient, with noise.
fn measurements(coefficient: f64) -> Result<Experiment, Box<dyn Error>> {
    let mut truth = model()?;
    truth.set("tyre_hysteresis.coefficient", coefficient)?;
    let plan = SingleWheelPlan { loads: vec![15.0, 40.0], wheel_speeds: vec![0.3, 1.0], ..SingleWheelPlan::of(&truth) };
    let mut experiment = plan.experiment()?;
    let mut values = modelled(&truth, &experiment)?.into_iter();
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(1);
    for run in &mut experiment.runs {
        let mut columns = Vec::new();
        for name in run.data.names() {
            let deviation = match name.as_str() {
                "drawbar_pull" => 0.1,
                "torque" => 0.005,
                "sinkage" => 0.0002,
                _ => {
                    columns.push(run.data.column(name).unwrap_or_default().to_vec());
                    continue;
                }
            };
            let mut error = || -> f64 { StandardNormal.sample(&mut random) };
            columns.push(values.by_ref().take(run.data.rows()).map(|x| x + deviation * error()).collect());
        }
        let mut table = Table::new(run.data.names().iter().cloned())?;
        for row in 0..run.data.rows() {
            table.push(&columns.iter().map(|column: &Vec<f64>| column[row]).collect::<Vec<_>>())?;
        }
        run.data = table;
    }
    Ok(experiment)
}

/// What a diagnosis makes of them, with the effect among the candidates.
fn diagnosis(experiment: &Experiment) -> Result<Diagnosis, Box<dyn Error>> {
    let candidates = ["tyre_hysteresis", "coulomb_friction", "slip_sinkage"].map(str::to_owned).to_vec();
    let options = DiagnoseOptions { candidates: Some(candidates), draws: 199, ..DiagnoseOptions::default() };
    Ok(diagnose(&model()?, experiment, &options, &Control::default())?)
}

fn main() -> Result<(), Box<dyn Error>> {
    for coefficient in [0.0, 0.05] {
        let mut model = model()?;
        model.set("tyre_hysteresis.coefficient", coefficient)?;
        let mut run = model.start()?;
        run.inputs_mut().set("velocity_command", 0.2)?;
        run.advance(5000)?; // 10 s
        let body = &run.signals().body;
        println!(
            "coefficient {coefficient}: {:.2} m at {:.2} m/s, {:.1} J",
            body.x, body.velocity, body.electrical_energy
        );
    }
    let diagnosis = diagnosis(&measurements(0.05)?)?;
    println!("found: {}", diagnosis.effects.join(", "));
    let mut improved = diagnosis.improved;
    println!("tyre_hysteresis.coefficient = {:.3}", improved.get("tyre_hysteresis.coefficient")?);
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]
    use super::*;

    const PLANTED: f64 = 0.05;
    /// Noise of the torque, 5 mN m, over the share f N r of it, 0.05 * 30 N * 0.1 m, and over the root of the rows.
    const FOUND: f64 = 0.01;

    #[test]
    fn property_the_planted_effect_is_found_and_named() {
        let found = diagnosis(&measurements(PLANTED).unwrap()).unwrap();
        assert_eq!(found.effects, ["tyre_hysteresis"], "{:?}", found.verdict);
        let mut improved = found.improved.clone();
        let value = improved.get("tyre_hysteresis.coefficient").unwrap();
        assert!((value - PLANTED).abs() < FOUND, "{value}");
    }

    #[test]
    fn property_the_law_holds_the_speed_and_goes_on_from_a_saved_state() {
        let model = model().unwrap();
        let mut run = model.start().unwrap();
        run.inputs_mut().set("velocity_command", 0.2).unwrap();
        run.advance(2000).unwrap();
        assert!((run.signals().body.velocity - 0.2).abs() < 0.02, "{} m/s", run.signals().body.velocity);
        let mut other = model.start().unwrap();
        other.restore(&run.snapshot().unwrap()).unwrap();
        run.advance(500).unwrap();
        other.advance(500).unwrap();
        assert_eq!(run.signals(), other.signals());
    }

    #[test]
    fn property_a_model_file_keeps_the_law_and_the_effect() {
        let mut model = model().unwrap();
        model.set("slope_law.gain", 80.0).unwrap();
        model.set("tyre_hysteresis.coefficient", 0.02).unwrap();
        let register = |model: &mut Model| {
            model.register_effect::<TyreHysteresis>("tyre_hysteresis", "")?;
            model.register_law("slope_law", SlopeLaw::default())
        };
        let text = model.to_toml().unwrap();
        let mut read = Model::from_toml_with(&text, None, register).unwrap();
        assert_eq!(read.list(), model.list());
        assert!(read.is_tunable("slope_law.gain") && !read.is_tunable("slope_law.period"));
    }
}
