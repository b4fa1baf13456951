//! Stresses along a rim, point by point, for figures: (2.1)-(2.6).

use bekker::soil::Soil;
use bekker::wheel::Wheel;

/// A driven wheel's contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact {
    pub wheel: Wheel,
    pub soil: Soil,
    /// Entry angle, rad.
    pub theta_1: f64,
    pub slip: f64,
}

impl Contact {
    pub fn theta_m(&self) -> f64 {
        (self.soil.c1 + self.soil.c2 * self.slip).clamp(0.05, 0.95) * self.theta_1
    }

    /// Normal stress at `theta` (rad), Pa (2.5), (2.6).
    pub fn sigma(&self, theta: f64) -> f64 {
        let theta_m = self.theta_m();
        let front = if theta >= theta_m { theta } else { self.theta_1 - theta / theta_m * (self.theta_1 - theta_m) };
        let depth = self.wheel.radius * (front.cos() - self.theta_1.cos()); // (2.4)
        self.soil.pressure(depth.max(0.0), self.wheel.width)
    }

    /// Shear stress at `theta` (rad), Pa (2.1), (2.2).
    pub fn tau(&self, theta: f64) -> f64 {
        let j = self.wheel.radius * (self.theta_1 - theta - (1.0 - self.slip) * (self.theta_1.sin() - theta.sin()));
        let strength = self.soil.cohesion + self.sigma(theta) * self.soil.friction_angle.tan();
        -strength * (-j / self.soil.shear_modulus).exp_m1()
    }

    /// Sinkage, m.
    pub fn sinkage(&self) -> f64 {
        self.wheel.radius * (1.0 - self.theta_1.cos())
    }
}
