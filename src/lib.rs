//! Rough-terrain rovers on deformable soil, from physics to insight.
//!
//! The whole in one line: a rover with generalised coordinates q, mass matrix M and wheels k obeys
//!
//! ```text
//! M(q) q'' = weight + inertia + sum_k [ n_k^T N_k + t_k^T DP_k + a_k^T T_k ],    I w_k' = T_drive - T_k
//! ```
//!
//! where N, DP and T are the integrals of the soil's stresses over the rim (Bekker, Wong-Reece,
//! Janosi-Hanamoto; (2.7)-(2.9) of Iagnemma's thesis, MIT 2001).
//!
//! | module | what it holds | may use |
//! |---|---|---|
//! | [`scalar`], [`snapshot`], `toml_text` | numbers, plain, with derivatives or in SIMD lanes; moving state as bytes; reading of TOML | for all |
//! | [`soil`], [`terrain`], [`wheel`] | what the wheel rolls on, and the wheel | |
//! | `vehicle`, `linear` | a vehicle's data sheet; matrices over its coordinates | |
//! | [`contact`] | the forces between wheel and soil | soil, wheel |
//! | [`linear_stress`] | the thesis's closed forms, a named alternative with its measured error | contact, soil, wheel |
//! | [`motor`] | drives | |
//! | [`signals`], [`sensors`] | commands, true signals, what sensors make of them | |
//! | [`effects`] | missing physics to be switched on, one file an effect; others register their own | contact, motor, signals, soil, vehicle, wheel |
//! | [`rover`] | bodies, joints, equations of motion | contact, effects, linear, motor, signals, soil, terrain, vehicle, wheel |
//! | [`carriage`] | steady points of one wheel under a load | contact, effects, motor, rover, soil, vehicle, wheel |
//! | [`soil_test`] | a soil under a plate and in a shear box, and what may be wrong there | effects, rover, soil |
//! | `integrator`, `recording` | a step of the equations of motion; lags between signals and their record | contact, effects, linear, rover, signals |
//! | [`simulation`] | a rover at rest and in motion, with a fixed step | contact, effects, integrator, linear, recording, rover, signals, terrain, vehicle |
//! | [`equations`] | the same as explicit differential equations, for other integrators, and their derivatives | motor, rover, signals, simulation, terrain |
//! | [`obstacle`], `rigid` | rocks and ledges; the plant of rigid bodies that feels them | contact, integrator, linear, motor, recording, rover, signals, simulation, terrain |
//! | [`control`] | controllers: they see measurements, never the true state | contact, motor, signals, soil, vehicle, wheel |
//! | [`estimation`] | what a rover finds out from measurements: contact angles, soil | contact, control, linear, linear_stress, signals, soil, vehicle, wheel |
//! | [`model`] | all of it in one value; TOML in and out; a run | all above |
//! | `batch` | many runs stepped together (feature `batch`) | all above |
//! | [`soil_class`], [`known_soil`], [`parallel`] | what is believable for a class of soil before anything is measured, and what was found of a soil; work on all cores, with the same bits for any number of them | |
//! | [`measurement`] | experiments: folders, columns, units, import | contact, effects, model, signals, soil_class, soil_test, vehicle, wheel |
//! | [`diagnosis`] | comparison, calibration, what physics is missing | batch, carriage, effects, known_soil, measurement, model, parallel, rover, signals, simulation, soil_class, soil_test, terrain |
//! | [`report`] | pages | diagnosis, effects, measurement, signals, soil_test |
//!
//! A module uses what stands in its row, what stands before it in its row, and the first row; `tests/rooms.rs` holds the
//! imports to that, so no circle runs through modules.
//!
//! Below this crate are `bekker-scalar` (what [`scalar`] gives on) and `bekker-modeldescription` (here [`modeldescription`]: the
//! vocabulary of parameters and signals). Four crates use this one as any other would: `bekker-planning` (where a rover should go,
//! and in which pose), `bekker-reproduction` (the thesis's results beside ours), `bekker-script` (drives written down with what
//! they must give, for every door) and `bekker-studio` (the workbench, a page in the browser).
//!
//! ```
//! use bekker::model::Model;
//! use bekker::modeldescription::Lookup;
//!
//! let mut model = Model::preset("gentle_rtc")?;
//! model.set("soil.shear_modulus", 0.01)?;
//! let mut run = model.start()?;
//! run.inputs_mut().set("velocity_command", 0.2)?;
//! run.advance(500)?; // inner steps of 2 ms
//! assert!(run.signals().body.x > 0.05);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(not(feature = "batch"), allow(dead_code, reason = "what only a batch uses of the modules that it shares"))]

#[cfg(feature = "batch")]
pub mod batch;
pub mod carriage;
pub mod contact;
pub mod control;
#[cfg(feature = "experiments")]
pub mod diagnosis;
pub mod effects;
pub mod equations;
pub mod estimation;
mod integrator;
pub mod known_soil;
mod linear;
pub mod linear_stress;
#[cfg(feature = "experiments")]
pub mod measurement;
pub mod model;
pub mod motor;
pub mod obstacle;
#[cfg(feature = "experiments")]
pub mod parallel;
mod recording;
#[cfg(feature = "report")]
pub mod report;
#[cfg(feature = "rigid")]
pub mod rigid;
pub mod rover;
pub mod scalar;
pub mod sensors;
pub mod signals;
pub mod simulation;
pub mod snapshot;
pub mod soil;
pub mod soil_class;
pub mod soil_test;
pub mod terrain;
mod toml_text;
mod vehicle;
pub mod wheel;

pub use bekker_modeldescription as modeldescription;
