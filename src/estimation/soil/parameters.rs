//! What the identification of the soil takes for granted.

use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// Identification of the soil on board.
    pub struct SoilIdentification {
        /// Prior standard deviation of the cohesion; its mean is the nominal soil's.
        cohesion_deviation: [Unit::PASCAL] = 1000.0, 0.0..=20_000.0, Fixed, "assumption: dry sand to sandy loam, 0..2 kPa";
        /// Prior standard deviation of the friction angle.
        friction_angle_deviation: [Unit::RADIAN] = 6.0_f64.to_radians(), 0.0..=0.5, Fixed, "assumption: sands lie in 25..37 degrees";
        /// Prior standard deviation of ln K; 0 takes K for known.
        shear_modulus_deviation: [Unit::ONE] = 0.5, 0.0..=2.0, Fixed, "assumption: 10..25 mm for one dry sand (Wong 2008)";
        /// Share of the gain for K: 1 estimates it, 0 only counts its uncertainty (Schmidt's considered parameter).
        shear_modulus_gain: [Unit::ONE] = 0.0, 0.0..=1.0, Fixed, "K is told apart only where slips differ";
        /// Forgetting with distance, one over the length along which the soil changes; 0 forgets nothing.
        forgetting: [Unit::PER_METRE] = 0.0, 0.0..=1e3, Fixed, "neutral";
        /// White noise of a torque, standard deviation.
        torque_noise: [Unit::NEWTON_METRE] = 0.02, 1e-6..=100.0, Fixed, "assumption: 1 % of the range of a small drive";
        /// Error of a load from the quasi-static balance, of the load.
        load_error: [Unit::ONE] = 0.05, 0.0..=1.0, Fixed, "assumption: accelerations and split of 5 %";
        /// Error of a sinkage from the load, of the sinkage.
        sinkage_error: [Unit::ONE] = 0.2, 0.0..=2.0, Fixed, "assumption: moduli of the soil known within 30 %";
        /// White noise of the body's velocity, standard deviation.
        velocity_noise: [Unit::METRE_PER_SECOND] = 0.002, 0.0..=1.0, Fixed, "assumption: visual odometry";
        /// White noise of a wheel speed, standard deviation.
        wheel_speed_noise: [Unit::RADIAN_PER_SECOND] = 0.01, 0.0..=10.0, Fixed, "assumption: encoder";
        /// White noise of pitch and of joint angles, standard deviation.
        angle_noise: [Unit::RADIAN] = 0.002, 0.0..=1.0, Fixed, "assumption: 0.1 degrees";
        /// Time over which the errors of load and sinkage stay the same.
        correlation_time: [Unit::SECOND] = 1.0, 0.0..=1e4, Fixed, "assumption: they follow the ground, not the sensors";
        /// Time over which a wheel's readings are averaged into one; 0 takes each by itself.
        averaging: [Unit::SECOND] = 0.2, 0.0..=100.0, Fixed, "assumption: slips change little in it";
        /// Slip below which a wheel tells nothing of the strength.
        minimum_slip: [Unit::ONE] = 0.05, 0.0..=1.0, Fixed, "assumption: the error of a slip is a few percent";
        /// Load below which a wheel counts as off the ground, of the mean load.
        minimum_load: [Unit::ONE] = 0.1, 0.0..=1.0, Fixed, "assumption";
        /// Rim speed below which a wheel counts as standing.
        minimum_speed: [Unit::METRE_PER_SECOND] = 0.005, 0.0..=1.0, Fixed, "assumption: ten times under the speed of small rovers";
        /// Standard deviations by which a torque may miss its prediction before the reading is refused.
        gate: [Unit::ONE] = 5.0, 1.0..=1e6, Fixed, "1 in 1.7 million for Gaussian errors";
        /// Spread of contact angles up to which ground counts as flat for the kinematic sinkage.
        flatness: [Unit::RADIAN] = 3.0_f64.to_radians(), 0.0..=1.0, Fixed, "Iagnemma 2001, 2.3.2: nearly flat terrain";
        /// Height by which the ground may leave its plane, a metre of travel.
        ground_error: [Unit::ONE] = 0.01, 0.0..=1.0, Fixed, "assumption: 1 cm in 1 m";
    }
}
