//! The soil: Bekker's pressure-sinkage curve, Mohr-Coulomb strength, Janosi-Hanamoto shear.

use crate::scalar::{Scalar, lanes};
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// Homogeneous soil under a wheel.
    pub struct Soil {
        /// Cohesion c of Mohr-Coulomb's strength c + sigma tan phi (2.1).
        cohesion: [Unit::PASCAL] = 1000.0, 0.0..=50_000.0, Calibrated, "Iagnemma 2001, 4.4.1";
        /// Internal friction angle phi (2.1).
        friction_angle: [Unit::RADIAN] = 29.0_f64.to_radians(), 0.0..=1.0, Calibrated, "Iagnemma 2001, 4.4.1";
        /// Cohesive modulus k_c of Bekker's p = (k_c/b + k_phi) z^n.
        k_c: [Unit::COHESIVE_MODULUS] = 0.0, 0.0..=1e6, Calibrated, "Bekker 1969; 0 in Iagnemma 2001, 4.4.1";
        /// Frictional modulus k_phi of Bekker's p = (k_c/b + k_phi) z^n.
        k_phi: [Unit::FRICTIONAL_MODULUS] = 850_000.0, 1e3..=1e8, Calibrated, "Iagnemma 2001, 4.4.1";
        /// Sinkage exponent n.
        exponent: [Unit::ONE] = 1.0, 0.3..=2.0, Calibrated, "Iagnemma 2001, 4.4.1";
        /// Shear modulus K of 1 - exp(-|j|/K) (2.1).
        shear_modulus: [Unit::METRE] = 0.03, 0.001..=0.2, Calibrated, "Iagnemma 2001, 4.4.1";
        /// Angle of maximum stress theta_m = (c1 + c2 |i|) theta_1: constant part.
        c1: [Unit::ONE] = 0.4, 0.0..=1.0, Calibrated, "Wong and Reece 1967: 0.18 loose to 0.43 compact sand";
        /// Angle of maximum stress theta_m = (c1 + c2 |i|) theta_1: part that grows with slip.
        c2: [Unit::ONE] = 0.2, 0.0..=1.0, Calibrated, "Wong and Reece 1967: 0.32";
        /// Damping of one wheel along the ground's normal, against the normal velocity; nothing in steady driving.
        damping: [Unit::NEWTON_SECOND_PER_METRE] = 300.0, 0.0..=1e5, Fixed, "assumption: about half critical for 5 kg on the thesis's soil";
        /// Displacement over which a contact's forces build up from standstill, and a standing wheel's friction is mobilised.
        hold_displacement: [Unit::METRE] = 0.0005, 1e-5..=0.01, Fixed, "assumption: small beside K, stiff enough to park on";
    }
}

#[lanes]
impl<S: Scalar> Soil<S> {
    /// Bekker's modulus k_c/b + k_phi for a contact of width `width`, N/m^(n+2).
    pub fn modulus(&self, width: S) -> S {
        self.k_c / width + self.k_phi
    }

    /// Normal stress under a plate of width `width` at depth `depth >= 0`: (k_c/b + k_phi) z^n, Pa.
    pub fn pressure(&self, depth: S, width: S) -> S {
        self.modulus(width) * depth.power(self.exponent)
    }

    /// Shear strength under a normal stress (Mohr-Coulomb): c + sigma tan phi, Pa.
    pub fn shear_strength(&self, normal_stress: S) -> S {
        self.cohesion + normal_stress * self.friction_angle.tan()
    }

    /// Multiplies Bekker's moduli k_c and k_phi by `factor`.
    pub(crate) fn scale_moduli(&mut self, factor: S) {
        self.k_c *= factor;
        self.k_phi *= factor;
    }

    /// Reece's moduli (k_1, k_2) of p = (k_1 + k_2 b)(z/b)^n (2.3) as Bekker's, for one width b:
    /// k_c/b + k_phi = (k_1 + k_2 b) b^-n, all of it put into k_phi (errata 15).
    #[must_use]
    pub fn with_reece_moduli(mut self, k_1: S, k_2: S, width: S) -> Self {
        self.k_c = S::from(0.0);
        self.k_phi = (k_1 + k_2 * width) / width.power(self.exponent);
        self
    }
}
