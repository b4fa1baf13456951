//! Drive the thesis's two-wheeled rover over gentle ground and print what it costs.
//!
//! `cargo run --release --example 01_drive`

use bekker::model::{Model, SummaryBuilder};
use bekker::modeldescription::Lookup;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut model = Model::preset("gentle_velocity")?;
    model.set("soil.shear_modulus", 0.01)?; // K = 10 mm
    let mut run = model.start()?;
    run.inputs_mut().set("velocity_command", 0.2)?;

    let mut summary = SummaryBuilder::default();
    summary.push(&run);
    for _ in 0..1000 {
        run.advance(10)?; // 20 ms
        summary.push(&run);
    }

    let figures = summary.summary(&run);
    println!("{:.2} m in {:.0} s, slip {:.1} %", figures.distance, figures.time, 100.0 * figures.slip);
    println!("{:.2} W in the windings, {:.1} J/m", figures.power, figures.energy_per_metre);
    Ok(())
}
