//! Forces of one wheel over slip: the full stress integrals.
//!
//! `cargo run --example 02_single_wheel`

use bekker::contact::rolling;
use bekker::soil::Soil;
use bekker::wheel::Wheel;

fn main() {
    let wheel = Wheel::<f64>::default();
    let soil = Soil { shear_modulus: 0.01, ..Soil::default() };
    println!("sinkage 12 mm, rim speed 0.25 m/s\n{:>6} {:>8} {:>8} {:>8}", "slip", "N", "DP", "T");
    for percent in (-40..=80).step_by(10) {
        let slip = f64::from(percent) / 100.0;
        let spin = 2.5;
        let rim_speed = wheel.radius * spin;
        let velocity = if slip >= 0.0 { rim_speed * (1.0 - slip) } else { rim_speed / (1.0 + slip) };
        let forces = rolling(&wheel, &soil, 0.0, 0.012, velocity, spin);
        println!("{slip:>6.1} {:>8.2} {:>8.2} {:>8.3}", forces.normal, forces.drawbar, forces.torque);
    }
}
