//! What the filters believe of the sensors and of the ground.

use bekker_modeldescription::{Unit, parameters};

/// Noise of a pitch rate from which on it counts as not measured, rad/s.
pub(super) const NO_GYROSCOPE: f64 = 100.0;

parameters! {
    /// Estimation of contact angles: what the filters believe of the sensors (R) and of ground and motion (Q).
    pub struct ContactAngleEstimation {
        /// White noise of the pitch, standard deviation.
        pitch_noise: [Unit::RADIAN] = 1.0_f64.to_radians(), 1e-6..=1.0, Fixed, "assumption: an inclinometer; 3 degrees in Iagnemma 2001, 2.6.1";
        /// White noise of the pitch rate, standard deviation; from 100 rad/s on the rate is not used.
        pitch_rate_noise: [Unit::RADIAN_PER_SECOND] = 0.01, 1e-6..=1e3, Fixed, "assumption: a micromachined gyroscope; none in Iagnemma 2001, 2.6";
        /// White noise of a link's angle, standard deviation.
        link_angle_noise: [Unit::RADIAN] = 0.5_f64.to_radians(), 1e-6..=1.0, Fixed, "assumption: a potentiometer";
        /// White noise of a link's rate, standard deviation.
        link_rate_noise: [Unit::RADIAN_PER_SECOND] = 0.02, 1e-6..=1e3, Fixed, "assumption: a filtered potentiometer";
        /// White noise of a wheel speed, standard deviation.
        wheel_speed_noise: [Unit::RADIAN_PER_SECOND] = 0.05, 1e-6..=10.0, Fixed, "assumption: a tachometer";
        /// Slip that all wheels are taken to have: a centre's speed is (1 - slip) r omega.
        slip: [Unit::ONE] = 0.0, -1.0..=0.95, Fixed, "neutral";
        /// Standard deviation of the slip about that.
        slip_deviation: [Unit::ONE] = 0.1, 0.0..=1.0, Fixed, "assumption: firm ground, slip about 10 %";
        /// Other error of the kinematic equations, share of the speed; it lasts as long as a contact angle does.
        kinematic_error: [Unit::ONE] = 0.05, 0.0..=1.0, Fixed, "assumption: slips change where wheels climb";
        /// Factor on the variances of all measurements.
        covariance_factor: [Unit::ONE] = 1.5, 0.01..=100.0, Fixed, "Iagnemma 2001, 2.6.1: 150 %";
        /// Standard deviation of the change of a pair's rate within a second, a random walk, beyond what the ground does; for
        /// rovers some of whose wheels may hang in the air.
        rate_drift: [Unit::RADIAN_PER_SECOND] = 0.05, 0.0..=1e3, Fixed, "assumption: small, the suspension hardly swings";
        /// Standard deviation of the change of a wheel centre's speed within a second, a random walk.
        speed_drift: [Unit::METRE_PER_SECOND] = 0.05, 1e-9..=100.0, Fixed, "assumption: control holds the speed";
        /// Way over which a slip lasts.
        slip_length: [Unit::METRE] = 1.0, 0.001..=1000.0, Fixed, "assumption: slips change with the grade";
        /// Standard deviation of the height of a wheel's centre over the path that the others take; it lasts as long as a slope.
        path_deviation: [Unit::METRE] = 0.001, 0.0..=1.0, Fixed, "assumption: firm ground, wheels sink by a millimetre";
        /// White error of the rates that the ground makes, standard deviation.
        rate_error: [Unit::RADIAN_PER_SECOND] = 0.01, 0.0..=1e3, Fixed, "assumption: the suspension hardly swings";
        /// Standard deviation of the contact angles about the ground's mean.
        angle_deviation: [Unit::RADIAN] = 15.0_f64.to_radians(), 0.001..=0.5, Fixed, "assumption: rough ground";
        /// Distance over which the autocorrelation of a contact angle falls to 1/e.
        correlation_length: [Unit::METRE] = 0.06, 0.001..=1000.0, Fixed, "assumption: features of the size of a wheel's radius";
    }
}
