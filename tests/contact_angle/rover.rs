//! Contact angles of whole rovers: which wheels are paired, what is refused, and drives with perfect sensors.

use bekker::control::NominalLink;
use bekker::estimation::{ContactAngleEstimation, ContactAngles, EstimationError};
use bekker::model::{ControlKind, Model, nominal};
use bekker::modeldescription::Lookup;
use bekker::rover::Rover;
use bekker::signals::{LinkMeasurement, Measurement, WheelMeasurement};
use bekker::soil::Soil;
use bekker::terrain::{Profile, Terrain, Waves};

type Pairs = Vec<[Option<usize>; 2]>;
type Spoil = fn(&mut Measurement);

fn estimator(rover: &Rover) -> ContactAngles {
    ContactAngles::new(&nominal(rover), ContactAngleEstimation::default()).expect("every wheel has a pair")
}

#[test]
fn analytic_pairs_follow_from_the_structure() {
    assert_eq!(estimator(&Rover::two_wheeled()).pairs().collect::<Pairs>(), [[Some(1), Some(2)]]);
    let four = estimator(&Rover::rigid(&[-0.4, -0.1, 0.1, 0.4])).pairs().collect::<Pairs>();
    assert_eq!(four, [[Some(1), Some(2)], [Some(2), Some(3)], [Some(3), Some(4)], [Some(1), Some(4)]]);
    let bogie_ahead = estimator(&Rover::rocker_bogie()).pairs().collect::<Pairs>();
    assert_eq!(bogie_ahead, [[Some(2), Some(3)], [Some(1), None]]);
    // Bogie behind: the pivot is the rear point of the front wheel's pair.
    let mut rover = Rover::rocker_bogie();
    (rover.wheels[0].body, rover.wheels[1].body, rover.wheels[2].body) = (1, 1, 0);
    rover.links[0].parameters.x = -0.1;
    assert_eq!(estimator(&rover).pairs().collect::<Pairs>(), [[Some(1), Some(2)], [None, Some(3)]]);
    // A chain: the lone wheel of the chassis hangs on a link that hangs on the pair.
    let mut chain = nominal(&Rover::rigid(&[-0.4, -0.1, 0.1, 0.4]));
    let link = |parent: usize, x: f64| NominalLink {
        parent,
        x,
        ..NominalLink { parent: 0, x: 0.0, z: 0.05, mass: 0.5, centre_of_mass_x: 0.0, centre_of_mass_z: 0.0 }
    };
    chain.links = vec![link(0, -0.2), link(1, 0.0)];
    chain.wheel_bodies = vec![0, 1, 2, 2];
    let pairs = ContactAngles::new(&chain, ContactAngleEstimation::default()).expect("every wheel has a pair");
    assert_eq!(pairs.pairs().collect::<Pairs>(), [[Some(3), Some(4)], [Some(2), None], [Some(1), None]]);
}

#[test]
fn property_rovers_without_pairs_are_refused() {
    let mut alone = nominal(&Rover::rocker_bogie());
    alone.wheel_bodies = vec![0, 0, 1];
    // The front wheel is alone on the bogie, whose joint is told by the chassis: that is a pair. Without links it is not.
    assert!(ContactAngles::new(&alone, ContactAngleEstimation::default()).is_ok());
    let mut rover = Rover::rocker_bogie();
    rover.links.push(rover.links[0]);
    (rover.wheels[0].body, rover.wheels[1].body, rover.wheels[2].body) = (0, 1, 2);
    let refused =
        ContactAngles::new(&nominal(&rover), ContactAngleEstimation::default()).expect_err("no two wheels on one body");
    assert_eq!(refused, EstimationError::Alone { wheel: 1 });
    let mut wrong = nominal(&Rover::rocker_bogie());
    wrong.wheel_bodies[2] = 5;
    let refused = ContactAngles::new(&wrong, ContactAngleEstimation::default()).expect_err("no such body");
    assert!(refused.to_string().contains("body of a wheel"), "{refused}");
    let parameters = ContactAngleEstimation { pitch_noise: 0.0, ..ContactAngleEstimation::default() };
    let refused = ContactAngles::new(&nominal(&Rover::two_wheeled()), parameters).expect_err("out of bounds");
    assert!(refused.to_string().contains("pitch_noise"), "{refused}");
}

fn measurement(time: f64) -> Measurement {
    let wheel = WheelMeasurement { speed: 1.0, ..WheelMeasurement::default() };
    Measurement { time, wheels: vec![wheel; 3], links: vec![LinkMeasurement::default()], ..Measurement::default() }
}

#[test]
fn property_bad_readings_are_refused_and_change_nothing() {
    let mut estimator = estimator(&Rover::rocker_bogie());
    (0..5).for_each(|k| estimator.update(&measurement(f64::from(k) * 0.01)).expect("finite readings"));
    let before = (estimator.angles().to_vec(), estimator.deviations().to_vec());
    let spoil: [(&str, Spoil); 7] = [
        ("pitch is NaN", |m| m.pitch = f64::NAN),
        ("pitch rate is inf", |m| m.pitch_rate = f64::INFINITY),
        ("speed of wheel 2", |m| m.wheels[1].speed = f64::NAN),
        ("angle of link 1", |m| m.links[0].angle = f64::NAN),
        ("2 wheels", |m| m.wheels.truncate(2)),
        ("0 links", |m| m.links.clear()),
        ("t = 0.01 s comes after", |m| m.time = 0.01),
    ];
    for (named, spoil) in spoil {
        let mut bad = measurement(0.05);
        spoil(&mut bad);
        let said = estimator.update(&bad).expect_err("a bad reading has to be refused").to_string();
        assert!(said.contains(named), "`{said}` does not say `{named}`");
    }
    // The same instant again is nothing new.
    estimator.update(&Measurement { pitch: 0.3, ..measurement(0.04) }).expect("ignored");
    assert_eq!(before, (estimator.angles().to_vec(), estimator.deviations().to_vec()));
    estimator.reset();
    estimator.update(&measurement(0.0)).expect("a new beginning");
}

/// RMS errors of every wheel, rad, on firm waves with perfect sensors: of the estimate, and of the inclination of the body
/// that the wheel sits on.
fn errors(rover: Rover, wavelength: f64, steepest: f64, speed: f64) -> Vec<[f64; 2]> {
    let mut model = Model::new("waves", rover);
    let amplitude = steepest.tan() * wavelength / std::f64::consts::TAU;
    model.rover.terrain = Terrain::new(Profile::Waves(Waves { amplitude, wavelength, start: -50.0 }));
    let soil = model.rover.soil;
    model.rover.soil =
        Soil { cohesion: 20_000.0, friction_angle: 0.6, k_phi: 10.0 * soil.k_phi, shear_modulus: 0.003, ..soil };
    model.control.kind = ControlKind::Velocity;
    (model.control.velocity.kp, model.control.velocity.ki) = (0.1, 5.0);
    let mut run = model.start().expect("starts");
    run.inputs_mut().set("velocity_command", speed).expect("an input");
    let parameters = ContactAngleEstimation::default();
    let mut estimator = ContactAngles::new(&nominal(&model.rover), parameters).expect("every wheel has a pair");
    let mut squares = vec![[0.0; 2]; model.rover.wheels.len()];
    let readings = (1.5 * wavelength / speed / 0.01) as usize;
    for k in 0..readings {
        let truth: Vec<f64> = run.signals().wheels.iter().map(|wheel| wheel.contact_angle).collect();
        run.advance(5).expect("advances");
        estimator.update(run.measurement()).expect("finite readings");
        // After three eighths of a wave.
        if 4 * k > readings {
            let measured = run.measurement();
            for (k, truth) in truth.iter().enumerate() {
                let link = model.rover.wheels[k].body.checked_sub(1).map_or(0.0, |link| measured.links[link].angle);
                squares[k][0] += (estimator.angles()[k] - truth).powi(2);
                squares[k][1] += (measured.pitch + link - truth).powi(2);
            }
        }
    }
    assert_eq!(estimator.restarts(), 0);
    squares.iter().map(|sums| sums.map(|sum| (sum / (0.75 * readings as f64)).sqrt())).collect()
}

/// Share of the error of the body's inclination that is left. Rim speeds stand for speeds over ground, which an unknown slip of up to
/// 20 % that differs among the wheels makes wrong by that share: a fifth of the error has to go all the same.
const LEFT: f64 = 0.8;

#[test]
fn property_perfect_sensors_track_the_ground_under_every_wheel() {
    let twelve = 12.0_f64.to_radians();
    for (name, rover, wavelength) in [
        ("rocker-bogie", Rover::rocker_bogie(), 0.9),
        ("two wheels", Rover::two_wheeled(), 2.5),
        ("four wheels", Rover::rigid(&[-0.35, -0.1, 0.1, 0.35]), 2.5),
    ] {
        let errors = errors(rover, wavelength, twelve, 0.1);
        for (k, [estimated, inclined]) in errors.iter().enumerate() {
            println!("{name}, wheel {}: {:.2} of {:.2} deg", k + 1, estimated.to_degrees(), inclined.to_degrees());
            // Inner wheels of a stiff vehicle hang in the air over a trough: no ground tells their direction.
            let inner = name == "four wheels" && (k == 1 || k == 2);
            assert!(inner || *estimated < LEFT * inclined, "{name}, wheel {}: {estimated} of {inclined} rad", k + 1);
        }
    }
}
