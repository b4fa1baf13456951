//! The test wheel of section 2.4 on a carriage over sand, and what its instruments read.
#![allow(dead_code)]

use bekker::diagnosis::Rig;
use bekker::estimation::soil::{Deviations, Reading};
use bekker::rover::Rover;
use bekker::soil::Soil;
use bekker::wheel::Wheel;
use bekker_reproduction::instruments::{Carriage, CarriagePoint, NormalNoise};

/// Noise of a carriage: 0.2 N, 10 mN m, 0.5 mm, 1 % slip.
pub const NOISE: Deviations = Deviations { load: 0.2, torque: 0.01, sinkage: 0.0005, slip: 0.01 };

/// Loads (N) and slips of an experiment.
pub const LOADS: [f64; 4] = [10.0, 20.0, 35.0, 50.0];
pub const SLIPS: [f64; 4] = [0.1, 0.25, 0.45, 0.7];

/// Diameter 14.6 cm, width 6 cm.
pub fn wheel() -> Wheel {
    Wheel { radius: 0.073, width: 0.06, ..Wheel::default() }
}

/// Dry sand (Wong 2008) with another strength.
pub fn sand(cohesion: f64, friction_angle_deg: f64, shear_modulus: f64) -> Soil {
    Soil {
        cohesion,
        friction_angle: friction_angle_deg.to_radians(),
        k_c: 990.0,
        k_phi: 1_528_430.0,
        exponent: 1.1,
        shear_modulus,
        ..Soil::default()
    }
}

pub fn carriage(soil: Soil, noise: Deviations) -> Carriage {
    let rover = Rover { wheel: wheel(), soil, ..Rover::two_wheeled() };
    Carriage { rig: Rig::of(&rover), noise, wheel_speed: 1.0 }
}

/// `rounds` times every load at every slip.
pub fn experiment(soil: Soil, noise: Deviations, seed: u64, rounds: usize) -> Vec<CarriagePoint> {
    let (carriage, mut stream) = (carriage(soil, noise), NormalNoise::new(seed));
    let points = (0..rounds).flat_map(|_| LOADS.into_iter().flat_map(|load| SLIPS.map(|slip| (load, slip))));
    points.map(|(load, slip)| carriage.read(load, slip, &mut stream).expect("the sand carries the wheel")).collect()
}

/// Readings without noise at these loads and slips.
pub fn truths(soil: Soil, loads: &[f64], slips: &[f64]) -> Vec<Reading> {
    let (carriage, mut stream) = (carriage(soil, NOISE), NormalNoise::new(0));
    let points = loads.iter().flat_map(|&load| slips.iter().map(move |&slip| (load, slip)));
    points
        .map(|(load, slip)| carriage.read(load, slip, &mut stream).expect("the sand carries the wheel").truth)
        .collect()
}
