//! The model's forces in a contact that the reference describes.

use super::wheel_reference::Case;
use bekker::contact::{Forces, rolling};
use bekker::soil::Soil;
use bekker::wheel::Wheel;

pub fn forces(case: &Case) -> Forces {
    let wheel = Wheel { radius: case.r, width: case.b, ..Wheel::default() };
    let soil = Soil {
        cohesion: case.c,
        friction_angle: case.phi,
        k_c: case.k_c,
        k_phi: case.k_phi,
        exponent: case.n,
        shear_modulus: case.k,
        c1: case.c1,
        c2: case.c2,
        ..Soil::default()
    };
    rolling(&wheel, &soil, case.exit, case.z, case.v, case.omega)
}
