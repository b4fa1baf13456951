//! Sensors: noise, bias, resolution and sample period of every channel; at neutral values nothing changes.

use bekker::model::Model;
use bekker::modeldescription::{Lookup, Parameters};
use bekker::sensors::{SensorSuite, Sensors};
use bekker::signals::{LinkSignals, Measurement, Signals};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// Channels by the stem of their parameters' names.
const CHANNELS: [&str; 8] =
    ["wheel_speed", "pitch", "velocity", "contact_angle", "pitch_rate", "torque", "link_angle", "link_rate"];

/// Readings of 20 000 samples: their standard deviation is known to 0.5 %, their mean to 0.7 % of it; four times that.
const SAMPLES: usize = 20_000;
const DEVIATION_ERROR: f64 = 0.02;
const MEAN_ERROR: f64 = 0.03;

/// True signals of two wheels and a link, each another number.
fn signals() -> Signals {
    let mut signals = Signals::of(2, 1);
    let mut next = 0.1;
    signals.visit("", &mut |_, value| {
        *value = next;
        next += 0.17;
    });
    signals
}

/// The channel's reading (of the last wheel or link) in a measurement, and its truth.
fn channel(name: &str, measured: &Measurement, truth: &Signals) -> (f64, f64) {
    let (wheel, true_wheel) = (&measured.wheels[1], &truth.wheels[1]);
    match name {
        "wheel_speed" => (wheel.speed, true_wheel.speed),
        "pitch" => (measured.pitch, truth.body.pitch),
        "velocity" => (measured.velocity, truth.body.velocity),
        "contact_angle" => (wheel.contact_angle, true_wheel.contact_angle),
        "pitch_rate" => (measured.pitch_rate, truth.body.pitch_rate),
        "torque" => (wheel.torque, true_wheel.torque),
        "link_angle" => (measured.links[0].angle, truth.links[0].angle),
        _ => (measured.links[0].rate, truth.links[0].rate),
    }
}

fn sensors(values: &[(String, f64)]) -> Sensors {
    let mut sensors = Sensors::default();
    values.iter().for_each(|(name, value)| sensors.set(name, *value).expect("a parameter of the sensors"));
    sensors
}

#[test]
fn property_neutral_sensors_read_the_signals_to_the_last_bit() {
    let (truth, mut measured) = (signals(), Measurement::default());
    let mut suite = SensorSuite::new(Sensors::default(), 3);
    for k in 0..5 {
        suite.read(f64::from(k), &truth, &mut measured);
        assert_eq!(measured.time, f64::from(k));
        for name in CHANNELS {
            let (reading, truth) = channel(name, &measured, &truth);
            assert_eq!(reading.to_bits(), truth.to_bits(), "{name}");
        }
    }
}

#[test]
fn regress_the_first_noises_keep_their_bits_whatever_else_is_set() {
    // Pitch, velocity, then speed and contact angle wheel by wheel: the order in which they have always been drawn.
    let noises =
        [("pitch_noise", 0.01), ("velocity_noise", 0.02), ("wheel_speed_noise", 0.3), ("contact_angle_noise", 0.04)];
    let noises: Vec<(String, f64)> = noises.map(|(name, value)| (name.to_owned(), value)).to_vec();
    let further = ["pitch_rate_noise", "torque_noise", "link_angle_noise", "link_rate_noise"];
    let with_further = noises.iter().cloned().chain(further.map(|name| (name.to_owned(), 0.5))).collect::<Vec<_>>();
    for values in [&noises, &with_further] {
        let (truth, mut measured) = (signals(), Measurement::default());
        let mut suite = SensorSuite::new(sensors(values), 42);
        let mut stream = ChaCha8Rng::seed_from_u64(42);
        let mut unit = || -> f64 { StandardNormal.sample(&mut stream) };
        for k in 0..20 {
            suite.read(f64::from(k) * 0.01, &truth, &mut measured);
            assert_eq!(measured.pitch, truth.body.pitch + 0.01 * unit());
            assert_eq!(measured.velocity, truth.body.velocity + 0.02 * unit());
            for (wheel, truth) in measured.wheels.iter().zip(&truth.wheels) {
                assert_eq!(wheel.speed, truth.speed + 0.3 * unit());
                assert_eq!(wheel.contact_angle, truth.contact_angle + 0.04 * unit());
            }
        }
    }
}

#[test]
fn property_noise_and_bias_of_every_channel_are_those_set() {
    for name in CHANNELS {
        let (noise, bias) = (0.05, -0.2);
        let mut suite =
            SensorSuite::new(sensors(&[(format!("{name}_noise"), noise), (format!("{name}_bias"), bias)]), 7);
        let (truth, mut measured) = (signals(), Measurement::default());
        let mut errors = Vec::with_capacity(SAMPLES);
        for k in 0..SAMPLES {
            suite.read(k as f64 * 0.01, &truth, &mut measured);
            let (reading, truth) = channel(name, &measured, &truth);
            errors.push((reading - truth - bias) / noise);
            for other in CHANNELS.iter().filter(|other| **other != name) {
                let (reading, truth) = channel(other, &measured, &signals());
                assert_eq!(reading, truth, "{name} changes {other}");
            }
        }
        let mean = errors.iter().sum::<f64>() / SAMPLES as f64;
        let deviation = (errors.iter().map(|e| e * e).sum::<f64>() / SAMPLES as f64).sqrt();
        assert!(mean.abs() < MEAN_ERROR, "{name}: mean {mean} deviations");
        assert!((deviation - 1.0).abs() < DEVIATION_ERROR, "{name}: deviation {deviation} of what was set");
    }
}

#[test]
fn analytic_readings_are_whole_steps_and_hold_between_samples() {
    for name in CHANNELS {
        let values =
            [(format!("{name}_resolution"), 0.05), (format!("{name}_period"), 0.1), (format!("{name}_noise"), 0.2)];
        let mut suite = SensorSuite::new(sensors(&values), 1);
        let (truth, mut measured) = (signals(), Measurement::default());
        let mut readings = Vec::new();
        for k in 0..100 {
            suite.read(f64::from(k) * 0.01, &truth, &mut measured);
            readings.push(channel(name, &measured, &truth).0);
        }
        for sample in readings.chunks(10) {
            assert!(sample.iter().all(|reading| *reading == sample[0]), "{name}: {sample:?}");
            assert!((sample[0] / 0.05 - (sample[0] / 0.05).round()).abs() < 1e-9, "{name}: {}", sample[0]);
        }
        assert!(readings.windows(2).filter(|pair| pair[0] != pair[1]).count() > 5, "{name} does not change");
    }
}

#[test]
fn analytic_an_encoder_of_few_counts_loses_no_way() {
    // 16 counts a turn read at 100 Hz: one count is 39 rad/s, far over the speed of 0.44 rad/s.
    let resolution = std::f64::consts::TAU / 16.0 / 0.01;
    let mut suite = SensorSuite::new(sensors(&[("wheel_speed_resolution".to_owned(), 0.1 * resolution)]), 0);
    let (truth, mut measured) = (signals(), Measurement::default());
    let (mut turned, mut counted) = (0.0, 0.0);
    for k in 0..1000 {
        suite.read(f64::from(k) * 0.01, &truth, &mut measured);
        turned += truth.wheels[0].speed * 0.01;
        counted += measured.wheels[0].speed * 0.01;
        assert!((counted - turned).abs() <= 0.05 * resolution * 0.01 + 1e-9, "{k}: {counted} for {turned} rad");
    }
}

#[test]
fn property_clones_read_the_same() {
    let values =
        [("pitch_noise", 0.1), ("torque_noise", 0.1), ("wheel_speed_resolution", 0.3), ("link_rate_period", 0.05)];
    let mut suite = SensorSuite::new(sensors(&values.map(|(name, value)| (name.to_owned(), value))), 9);
    let (truth, mut a, mut b) = (signals(), Measurement::default(), Measurement::default());
    (0..7).for_each(|k| suite.read(f64::from(k) * 0.01, &truth, &mut a));
    let mut clone = suite.clone();
    for k in 7..30 {
        suite.read(f64::from(k) * 0.01, &truth, &mut a);
        clone.read(f64::from(k) * 0.01, &truth, &mut b);
        assert_eq!(a, b);
    }
}

#[test]
fn property_only_vehicles_with_links_have_their_signals() {
    let names = |preset: &str| -> Vec<String> {
        let run = Model::preset(preset).expect("a preset").start().expect("starts");
        run.signals().clone().list().into_iter().map(|(variable, _)| variable.name).collect()
    };
    let rigid = names("two_wheeled");
    assert_eq!(rigid.len(), 13 + 2 * 8);
    assert!(rigid.iter().all(|name| !name.contains("link")));
    let links: Vec<String> = names("rocker_bogie").into_iter().filter(|name| name.contains("link")).collect();
    assert_eq!(links, ["link[1].angle", "link[1].rate"]);
}

/// Two rules of second order (integrator and trapezoids) over steps of 2 ms agree to 1 % of the motion asserted below.
const INTEGRATION: f64 = 2e-4;

#[test]
fn analytic_a_links_angle_is_the_integral_of_its_rate() {
    let mut model = Model::preset("rocker_bogie_velocity").expect("a preset");
    model.stepping.step_size = 0.002;
    let mut run = model.start().expect("starts");
    run.inputs_mut().set("velocity_command", 0.1).expect("an input");
    let LinkSignals { angle: start, rate: mut before } = run.signals().links[0];
    let (mut turned, mut least, mut most) = (0.0, 0.0_f64, 0.0_f64);
    for _ in 0..5000 {
        run.advance(1).expect("advances");
        let LinkSignals { angle, rate } = run.signals().links[0];
        turned += 0.5 * (before + rate) * 0.002;
        before = rate;
        (least, most) = (least.min(angle), most.max(angle));
        assert!((angle - start - turned).abs() < INTEGRATION, "{angle}, {}", start + turned);
    }
    assert!(most - least > 0.02, "the bogie turns on waves: {least} .. {most} rad");
    // What a controller is shown is the same, since its sensors are neutral.
    assert_eq!(run.measurement().links.len(), 1);
}
