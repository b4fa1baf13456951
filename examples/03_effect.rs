//! Switch a missing effect on by its name, and see what it does.
//!
//! `cargo run --release --example 03_effect`

use bekker::model::Model;
use bekker::modeldescription::Lookup;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for (name, value) in [("slip_sinkage.n1", 0.0), ("slip_sinkage.n1", 0.4), ("coulomb_friction.torque", 0.2)] {
        let mut model = Model::preset("gentle_velocity")?;
        model.set("soil.shear_modulus", 0.01)?;
        model.set(name, value)?;
        let mut run = model.start()?;
        run.advance(5000)?; // 10 s
        let (body, rear) = (&run.signals().body, &run.signals().wheels[0]);
        println!(
            "{name} = {value}: {:.2} m, rear wheel sunk {:.1} mm, {:.2} N m, {:.1} J",
            body.x,
            1e3 * rear.sinkage,
            rear.torque,
            body.electrical_energy
        );
    }
    Ok(())
}
