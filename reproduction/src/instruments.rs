//! Virtual instruments of section 2.4 on the model's own soil, with noise: a bevameter, and a driven wheel on a carriage.

use bekker::diagnosis::{Rig, SteadyError, steady_point};
use bekker::estimation::soil::{AnnulusTest, Deviations, PlateTest, Reading};
use bekker::soil::Soil;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// Standard normal noise from a seed.
#[derive(Clone, Debug)]
pub struct NormalNoise(ChaCha8Rng);

impl NormalNoise {
    /// The stream of a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// One draw of the standard deviation `deviation`.
    pub fn draw(&mut self, deviation: f64) -> f64 {
        let unit: f64 = StandardNormal.sample(&mut self.0);
        deviation * unit
    }
}

/// Plates and a shear annulus on a soil.
#[derive(Clone, Copy, Debug)]
pub struct Bevameter {
    /// The soil.
    pub soil: Soil,
    /// Noise of every stress, of the stress.
    pub relative_noise: f64,
    /// Noise of every stress, Pa.
    pub noise: f64,
}

impl Bevameter {
    /// A plate of `width` (m) pressed in to `depth` (m) in `points` steps.
    pub fn press(&self, width: f64, depth: f64, points: usize, noise: &mut NormalNoise) -> PlateTest {
        let point = |i: usize| {
            let z = depth * (i + 1) as f64 / points as f64;
            [z, self.read(self.soil.pressure(z, width), noise)]
        };
        PlateTest { width, points: (0..points).map(point).collect() }
    }

    /// The annulus under `pressure` (Pa) turned by `travel` (m) in `points` steps.
    pub fn shear(&self, pressure: f64, travel: f64, points: usize, noise: &mut NormalNoise) -> AnnulusTest {
        let strength = self.soil.cohesion + pressure * self.soil.friction_angle.tan();
        let point = |i: usize| {
            let j = travel * (i + 1) as f64 / points as f64;
            [j, self.read(-strength * (-j / self.soil.shear_modulus).exp_m1(), noise)] // (2.1)
        };
        AnnulusTest { pressure, points: (0..points).map(point).collect() }
    }

    fn read(&self, stress: f64, noise: &mut NormalNoise) -> f64 {
        stress * (1.0 + noise.draw(self.relative_noise)) + noise.draw(self.noise)
    }
}

/// The driven wheel on a carriage of 2.4: steady points of the full stress integrals, read with noise.
#[derive(Clone, Debug)]
pub struct Carriage {
    /// Wheel, soil and effects.
    pub rig: Rig,
    /// Noise of the readings.
    pub noise: Deviations,
    /// Rate of the wheel, rad/s.
    pub wheel_speed: f64,
}

/// One steady point and its reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CarriagePoint {
    /// What the instruments show.
    pub reading: Reading,
    /// What is there.
    pub truth: Reading,
    /// Drawbar pull, N.
    pub drawbar_pull: f64,
}

impl Carriage {
    /// Imposes a load (N) and a slip (0..1) and reads.
    ///
    /// # Errors
    /// [`SteadyError`] where the wheel sinks to its axle.
    pub fn read(&self, load: f64, slip: f64, noise: &mut NormalNoise) -> Result<CarriagePoint, SteadyError> {
        let point = steady_point(&self.rig, load, slip, self.wheel_speed)?;
        let truth = Reading { load, torque: point.torque, sinkage: point.sinkage, slip };
        let radius = self.rig.wheel.radius;
        let reading = Reading {
            load: (load + noise.draw(self.noise.load)).max(f64::MIN_POSITIVE),
            torque: point.torque + noise.draw(self.noise.torque),
            sinkage: (point.sinkage + noise.draw(self.noise.sinkage)).clamp(1e-6, 0.99 * radius),
            slip: (slip + noise.draw(self.noise.slip)).clamp(0.0, 1.0),
        };
        Ok(CarriagePoint { reading, truth, drawbar_pull: point.drawbar_pull })
    }
}
