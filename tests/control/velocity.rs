//! Claims: the velocity loop is stable on soil and off the ground, keeps its limit, and does not wind up.

use crate::control_support::thesis_rover;
use bekker::control::{Controller, Nominal, VelocityControl, VelocityController};
use bekker::signals::{Command, Measurement, Reference, WheelMeasurement};

/// A wheel on a plant J domega/dt = tau - tau_0 - a omega, with the torque held over a period.
struct Plant {
    inertia: f64,
    slope: f64,
    offset: f64,
    speed: f64,
}

impl Plant {
    /// The exact solution over `period`.
    fn hold(&mut self, torque: f64, period: f64) {
        let net = torque - self.offset;
        if self.slope == 0.0 {
            self.speed += net / self.inertia * period;
        } else {
            let rest = net / self.slope;
            self.speed = rest + (self.speed - rest) * (-self.slope / self.inertia * period).exp();
        }
    }
}

struct Loop {
    controller: VelocityController,
    command: Command,
}

impl Loop {
    fn new(nominal: &Nominal, gains: VelocityControl) -> Self {
        let controller = VelocityController::new(nominal, gains).expect("valid gains");
        Self { controller, command: Command::torque(vec![0.0; 2]) }
    }

    /// Torque of the second wheel.
    fn torque(&mut self, speed: f64, goal: f64) -> f64 {
        let wheel = WheelMeasurement { speed, ..WheelMeasurement::default() };
        let measured = Measurement { wheels: vec![WheelMeasurement::default(), wheel], ..Measurement::default() };
        self.controller.command(&measured, &Reference { velocity: goal }, &mut self.command).expect("finite");
        self.command.values[1]
    }

    /// Speeds of the second wheel on `plant`, one a period.
    fn drive(&mut self, plant: &mut Plant, goal: f64, periods: usize) -> Vec<f64> {
        let period = self.controller.period();
        let step = |_| {
            let torque = self.torque(plant.speed, goal);
            plant.hold(torque, period);
            plant.speed
        };
        (0..periods).map(step).collect()
    }
}

fn limited(torque: f64) -> Nominal {
    let mut nominal = thesis_rover();
    nominal.motor.inverse_torque_limit = 1.0 / torque;
    nominal
}

#[test]
fn analytic_first_commands_follow_the_law() {
    let gains = VelocityControl { kd: 0.03, derivative_filter: 0.02, ..VelocityControl::default() };
    let mut wheel = Loop::new(&thesis_rover(), gains);
    // Goal 0.25 m/s at r = 0.1 m: 2.5 rad/s. First 0.5 * 2.5 + 20 * 0.01 * 2.5, no derivative yet.
    assert!((wheel.torque(0.0, 0.25) - 1.75).abs() < 1e-12);
    // Then error 1.5: 0.75 + 0.5 + 0.3, and the derivative -0.03 * 1 / (0.02 + 0.01).
    assert!((wheel.torque(1.0, 0.25) - (1.55 - 1.0)).abs() < 1e-12);
    // Error 1.5 again: 0.75 + 1.1, the derivative fades by 0.02 / 0.03.
    assert!((wheel.torque(1.0, 0.25) - (1.85 - 2.0 / 3.0)).abs() < 1e-12);
    wheel.controller.reset();
    assert!((wheel.torque(0.0, 0.25) - 1.75).abs() < 1e-12);
}

#[test]
fn property_defaults_settle_on_soil_and_off_the_ground() {
    for (slope, offset) in [(0.0, 0.0), (0.1, 0.5), (1.0, 1.0), (3.0, -2.0), (10.0, 5.0)] {
        let mut plant = Plant { inertia: 0.01, slope, offset, speed: 0.0 };
        let speeds = Loop::new(&thesis_rover(), VelocityControl::default()).drive(&mut plant, 0.25, 400);
        // 2 s are four time constants (10 + 0.5)/20 s of the slowest of these plants.
        let worst = speeds[200..].iter().map(|speed| (speed - 2.5).abs()).fold(0.0, f64::max);
        assert!(worst < 0.03 * 2.5, "dT/domega = {slope}: {worst} rad/s off after 2 s");
        assert!((speeds[399] - 2.5).abs() < 0.002 * 2.5, "dT/domega = {slope}: {} rad/s after 4 s", speeds[399]);
        let peak = speeds.iter().copied().fold(0.0, f64::max);
        assert!(peak < 2.0 * 2.5, "dT/domega = {slope}: overshoots to {peak} rad/s");
    }
}

#[test]
fn property_torque_keeps_the_nominal_limit() {
    let mut wheel = Loop::new(&limited(0.8), VelocityControl::default());
    for step in 0..500 {
        let speed = 30.0 * (f64::from(step) * 0.7).sin();
        assert!(wheel.torque(speed, 0.25).abs() <= 0.8);
    }
    // The current limit counts through gear and torque constant: 0.5 A * 100 * 0.0234 N m/A.
    let mut nominal = thesis_rover();
    nominal.motor.inverse_current_limit = 2.0;
    assert!((Loop::new(&nominal, VelocityControl::default()).torque(-100.0, 0.25) - 1.17).abs() < 1e-12);
}

#[test]
fn property_integral_does_not_wind_up_against_the_limit() {
    // The soil asks for 4 N m at the goal, the drive gives 2: the wheel is held back for 5 s, then freed.
    let gains = VelocityControl::default();
    let mut wheel = Loop::new(&limited(2.0), gains);
    let mut plant = Plant { inertia: 0.01, slope: 1.0, offset: 4.0 - 2.5, speed: 0.0 };
    let held = wheel.drive(&mut plant, 0.25, 500);
    assert!((held[499] - 0.5).abs() < 1e-9, "at the limit the soil leaves 0.5 rad/s, found {}", held[499]);
    let most = wheel.controller.integrals().nth(1).expect("two wheels");
    assert!(most <= 2.0, "the integral stands at {most} N m, beyond the limit");
    plant.offset = -1.5;
    let freed = wheel.drive(&mut plant, 0.25, 100);
    assert!((freed[50] - 2.5).abs() < 0.05, "half a second later {} rad/s", freed[50]);
    // The same law without the guard carries 5 s of error, 20 * 2 * 5 N m, and stays at the limit.
    let (mut integral, mut speed) = (20.0 * 2.0 * 5.0, held[499]);
    for _ in 0..51 {
        integral += gains.ki * gains.period * (2.5 - speed);
        let torque = (gains.kp * (2.5 - speed) + integral).clamp(-2.0, 2.0);
        let mut plant = Plant { inertia: 0.01, slope: 1.0, offset: -1.5, speed };
        plant.hold(torque, gains.period);
        speed = plant.speed;
    }
    assert!((speed - 2.5).abs() > 0.5, "the unguarded loop must show what the guard is for: {speed} rad/s");
}
