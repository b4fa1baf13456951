//! The vocabulary of the sensors: noise, bias, resolution and sample period of every channel.

use super::channel::Channel;
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// Encoders of the wheels.
    pub struct Encoder {
        /// White noise of a wheel speed, standard deviation.
        wheel_speed_noise: [Unit::RADIAN_PER_SECOND] = 0.0, 0.0..=10.0, Fixed, "0 is none; Iagnemma 2001, 4.4.1 has 5 % of the range";
        /// Constant bias of a wheel speed, added to the truth.
        wheel_speed_bias: [Unit::RADIAN_PER_SECOND] = 0.0, -1.0..=1.0, Fixed, "0 is none; data sheet";
        /// Wheel speed of one count a sample, 2 pi/(counts a turn x sample period); what is less than a count is carried over to the
        /// next sample, as a counter does. 0 is none.
        wheel_speed_resolution: [Unit::RADIAN_PER_SECOND] = 0.0, 0.0..=10.0, Fixed, "0 is none; data sheet";
        /// Time between samples of a wheel speed; 0 takes one at every reading.
        wheel_speed_period: [Unit::SECOND] = 0.0, 0.0..=10.0, Fixed, "0 is none; data sheet";
    }
}

parameters! {
    /// Sensors of the body's motion, and the contact angles.
    pub struct BodySensors {
        /// White noise of the pitch, standard deviation.
        pitch_noise: [Unit::RADIAN] = 0.0, 0.0..=1.0, Fixed, "0 is none; Iagnemma 2001, 4.4.1 has 5 % of the range";
        /// Constant bias of the pitch, added to the truth.
        pitch_bias: [Unit::RADIAN] = 0.0, -0.5..=0.5, Fixed, "0 is none; mounting of an inclinometer: 0.3-1 deg";
        /// Step to which the pitch is rounded; 0 is none.
        pitch_resolution: [Unit::RADIAN] = 0.0, 0.0..=1.0, Fixed, "0 is none; converter of 12 bits over 360 deg: 0.09 deg";
        /// Time between samples of the pitch; 0 takes one at every reading.
        pitch_period: [Unit::SECOND] = 0.0, 0.0..=10.0, Fixed, "0 is none; data sheet";
        /// White noise of the velocity, standard deviation.
        velocity_noise: [Unit::METRE_PER_SECOND] = 0.0, 0.0..=1.0, Fixed, "0 is none";
        /// Constant bias of the velocity, added to the truth.
        velocity_bias: [Unit::METRE_PER_SECOND] = 0.0, -1.0..=1.0, Fixed, "0 is none";
        /// Step to which the velocity is rounded; 0 is none.
        velocity_resolution: [Unit::METRE_PER_SECOND] = 0.0, 0.0..=1.0, Fixed, "0 is none";
        /// Time between samples of the velocity; 0 takes one at every reading.
        velocity_period: [Unit::SECOND] = 0.0, 0.0..=10.0, Fixed, "0 is none; data sheet";
        /// White noise of a contact angle, standard deviation.
        contact_angle_noise: [Unit::RADIAN] = 0.0, 0.0..=1.0, Fixed, "0 is none; an estimator's error is 1-2 degrees in Iagnemma 2001, 2.6";
        /// Constant bias of a contact angle, added to the truth.
        contact_angle_bias: [Unit::RADIAN] = 0.0, -0.5..=0.5, Fixed, "0 is none";
        /// Step to which a contact angle is rounded; 0 is none.
        contact_angle_resolution: [Unit::RADIAN] = 0.0, 0.0..=1.0, Fixed, "0 is none";
        /// Time between samples of a contact angle; 0 takes one at every reading.
        contact_angle_period: [Unit::SECOND] = 0.0, 0.0..=10.0, Fixed, "0 is none; data sheet";
    }
}

parameters! {
    /// Gyroscope of the chassis.
    pub struct Gyroscope {
        /// White noise of the pitch rate, standard deviation.
        pitch_rate_noise: [Unit::RADIAN_PER_SECOND] = 0.0, 0.0..=10.0, Fixed, "0 is none; 0.1-0.5 deg/s for a micromachined gyroscope";
        /// Constant bias of the pitch rate, added to the truth.
        pitch_rate_bias: [Unit::RADIAN_PER_SECOND] = 0.0, -1.0..=1.0, Fixed, "0 is none; 0.1-1 deg/s for a micromachined gyroscope";
        /// Step to which the pitch rate is rounded; 0 is none.
        pitch_rate_resolution: [Unit::RADIAN_PER_SECOND] = 0.0, 0.0..=1.0, Fixed, "0 is none; data sheet";
        /// Time between samples of the pitch rate; 0 takes one at every reading.
        pitch_rate_period: [Unit::SECOND] = 0.0, 0.0..=10.0, Fixed, "0 is none; data sheet";
    }
}

parameters! {
    /// Current sensors of the drives, read as torques on the wheel's side of the gear.
    pub struct CurrentSensor {
        /// White noise of a torque, standard deviation.
        torque_noise: [Unit::NEWTON_METRE] = 0.0, 0.0..=100.0, Fixed, "0 is none; noise of the current times torque constant times gear ratio";
        /// Constant bias of a torque, added to the truth.
        torque_bias: [Unit::NEWTON_METRE] = 0.0, -100.0..=100.0, Fixed, "0 is none; data sheet";
        /// Step to which a torque is rounded; 0 is none.
        torque_resolution: [Unit::NEWTON_METRE] = 0.0, 0.0..=100.0, Fixed, "0 is none; step of the converter times torque constant times gear ratio";
        /// Time between samples of a torque; 0 takes one at every reading.
        torque_period: [Unit::SECOND] = 0.0, 0.0..=10.0, Fixed, "0 is none; data sheet";
    }
}

parameters! {
    /// Potentiometers or encoders of the links' joints.
    pub struct JointSensors {
        /// White noise of a link's angle, standard deviation.
        link_angle_noise: [Unit::RADIAN] = 0.0, 0.0..=1.0, Fixed, "0 is none; data sheet";
        /// Constant bias of a link's angle, added to the truth.
        link_angle_bias: [Unit::RADIAN] = 0.0, -0.5..=0.5, Fixed, "0 is none; mounting";
        /// Step to which a link's angle is rounded; 0 is none.
        link_angle_resolution: [Unit::RADIAN] = 0.0, 0.0..=1.0, Fixed, "0 is none; converter of 10 bits over 300 deg: 0.3 deg";
        /// Time between samples of a link's angle; 0 takes one at every reading.
        link_angle_period: [Unit::SECOND] = 0.0, 0.0..=10.0, Fixed, "0 is none; data sheet";
        /// White noise of a link's rate, standard deviation.
        link_rate_noise: [Unit::RADIAN_PER_SECOND] = 0.0, 0.0..=10.0, Fixed, "0 is none; data sheet";
        /// Constant bias of a link's rate, added to the truth.
        link_rate_bias: [Unit::RADIAN_PER_SECOND] = 0.0, -1.0..=1.0, Fixed, "0 is none; data sheet";
        /// Step to which a link's rate is rounded; 0 is none.
        link_rate_resolution: [Unit::RADIAN_PER_SECOND] = 0.0, 0.0..=1.0, Fixed, "0 is none; data sheet";
        /// Time between samples of a link's rate; 0 takes one at every reading.
        link_rate_period: [Unit::SECOND] = 0.0, 0.0..=10.0, Fixed, "0 is none; data sheet";
    }
}

/// Picks the four numbers of a channel out of its group.
macro_rules! channel {
    ($group:expr, $noise:ident, $bias:ident, $resolution:ident, $period:ident) => {
        Channel { noise: $group.$noise, bias: $group.$bias, resolution: $group.$resolution, period: $group.$period }
    };
}

impl Encoder {
    pub(super) fn wheel_speed(&self) -> Channel {
        channel!(self, wheel_speed_noise, wheel_speed_bias, wheel_speed_resolution, wheel_speed_period)
    }
}

impl BodySensors {
    pub(super) fn pitch(&self) -> Channel {
        channel!(self, pitch_noise, pitch_bias, pitch_resolution, pitch_period)
    }

    pub(super) fn velocity(&self) -> Channel {
        channel!(self, velocity_noise, velocity_bias, velocity_resolution, velocity_period)
    }

    pub(super) fn contact_angle(&self) -> Channel {
        channel!(self, contact_angle_noise, contact_angle_bias, contact_angle_resolution, contact_angle_period)
    }
}

impl Gyroscope {
    pub(super) fn pitch_rate(&self) -> Channel {
        channel!(self, pitch_rate_noise, pitch_rate_bias, pitch_rate_resolution, pitch_rate_period)
    }
}

impl CurrentSensor {
    pub(super) fn torque(&self) -> Channel {
        channel!(self, torque_noise, torque_bias, torque_resolution, torque_period)
    }
}

impl JointSensors {
    pub(super) fn link_angle(&self) -> Channel {
        channel!(self, link_angle_noise, link_angle_bias, link_angle_resolution, link_angle_period)
    }

    pub(super) fn link_rate(&self) -> Channel {
        channel!(self, link_rate_noise, link_rate_bias, link_rate_resolution, link_rate_period)
    }
}
