//! The wheel on soil once more, written from the equations alone and integrated adaptively: shares no code with the model.

use super::quadrature::integrate;

/// A wheel, its soil and its contact; SI.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    pub r: f64,
    pub b: f64,
    pub k_c: f64,
    pub k_phi: f64,
    pub n: f64,
    pub c: f64,
    pub phi: f64,
    pub k: f64,
    pub c1: f64,
    pub c2: f64,
    /// lambda of the exit angle.
    pub exit: f64,
    pub z: f64,
    pub v: f64,
    pub omega: f64,
}

impl Case {
    /// Normal force (2.7), drawbar pull (2.8) and torque (2.9), to about 1e-11 of the stresses' integral.
    pub fn forces(&self) -> [f64; 3] {
        if self.z <= 0.0 {
            return [0.0; 3];
        }
        if self.v < 0.0 || (self.v == 0.0 && self.omega < 0.0) {
            let [normal, drawbar, torque] = Case { v: -self.v, omega: -self.omega, ..*self }.forces();
            return [normal, -drawbar, -torque];
        }
        let (theta_1, theta_m, theta_2) = self.angles();
        let points = |theta: f64| {
            let (sigma, tau) = (self.sigma(theta), self.tau(theta));
            [
                sigma * theta.cos() + tau * theta.sin(), // (2.7)
                tau * theta.cos() - sigma * theta.sin(), // (2.8)
                tau,                                     // (2.9)
            ]
        };
        let tolerance = 1e-12 * (self.c + self.sigma(theta_m)) * (theta_1 - theta_2);
        let rear = integrate(&points, theta_2, theta_m, tolerance);
        let front = integrate(&points, theta_m, theta_1, tolerance);
        let [normal, drawbar, torque] = [0, 1, 2].map(|i| self.r * self.b * (rear[i] + front[i]));
        [normal, drawbar, self.r * torque]
    }

    /// Entry, peak and exit angle.
    pub fn angles(&self) -> (f64, f64, f64) {
        let theta_1 = (1.0 - self.z / self.r).acos();
        let theta_2 = -(1.0 - self.exit * self.z / self.r).acos();
        let share = self.c1 + self.c2 * self.slip().abs().min(1.0);
        (theta_1, share.clamp(0.05, 0.95) * theta_1, theta_2)
    }

    pub fn slip(&self) -> f64 {
        let rim = self.r * self.omega;
        if rim.abs() >= self.v.abs() { 1.0 - self.v / rim } else { rim / self.v - 1.0 }
    }

    /// Normal stress (2.5), (2.6).
    pub fn sigma(&self, theta: f64) -> f64 {
        let (theta_1, theta_m, theta_2) = self.angles();
        let as_front = if theta >= theta_m {
            theta
        } else {
            theta_1 - (theta - theta_2) / (theta_m - theta_2) * (theta_1 - theta_m)
        };
        let depth = self.r * (as_front.cos() - theta_1.cos());
        (self.k_c / self.b + self.k_phi) * depth.max(0.0).powf(self.n)
    }

    /// Shear stress (2.1), for v >= 0; the rim slides fully where it does not turn forward.
    pub fn tau(&self, theta: f64) -> f64 {
        let strength = self.c + self.sigma(theta) * self.phi.tan();
        if self.omega <= 0.0 && self.v > 0.0 {
            return -strength;
        }
        let (theta_1, ..) = self.angles();
        let j = self.r * (theta_1 - theta) - self.v / self.omega * (theta_1.sin() - theta.sin());
        j.signum() * strength * (1.0 - (-j.abs() / self.k).exp())
    }
}
