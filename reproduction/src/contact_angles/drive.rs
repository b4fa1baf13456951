//! The rocker-bogie rover of 2.6.2 on a drive, estimating its contact angles from its sensors.

use super::{ContactAnglesError, MeanSquare};
use bekker::estimation::{ContactAngleEstimation, ContactAngles};
use bekker::model::{Model, Plant, nominal};
use bekker::modeldescription::Lookup;
use bekker::obstacle::Obstacle;
use bekker::parallel::map_in_order;
use bekker::sensors::Sensors;
use bekker::simulation::Status;
use bekker::soil::Soil;
use bekker::terrain::Terrain;

/// Speed of the drive, m/s; the rover's largest is 8 cm/s (appendix C).
const SPEED: f64 = 0.05;
/// Time over way/speed after which a drive counts as stuck.
const PATIENCE: f64 = 4.0;

/// Changes the settings of an estimator.
pub(super) type Belief = fn(&mut ContactAngleEstimation);

/// A drive over some ground.
#[derive(Clone, Debug)]
pub(super) struct Drive {
    pub terrain: Terrain,
    /// Rigid obstacle on it; with one the plant is that of rigid bodies.
    pub obstacle: Option<Obstacle>,
    /// Way of the chassis, m.
    pub way: f64,
    /// Whether the estimator reads a gyroscope.
    pub gyroscope: bool,
    /// Changes the settings of the estimator.
    pub believe: Belief,
    pub seed: u32,
}

/// What a drive gave, wheel by wheel from rear to front.
#[derive(Clone, Debug)]
pub(super) struct Driven {
    /// RMS errors of the contact angles, rad.
    pub errors: Vec<f64>,
    /// Mean squares of the errors over the estimated variances.
    pub nees: Vec<f64>,
    /// Mean normalised innovation squared over its degrees of freedom.
    pub nis: f64,
    /// Largest and mean slip of any wheel at any reading.
    pub slip: [f64; 2],
    pub restarts: u32,
    /// Time, s.
    pub time: Vec<f64>,
    /// True and estimated angles, rad, reading by reading.
    pub course: Vec<[Vec<f64>; 2]>,
}

/// Noise of the rover's sensors; the thesis measured it and does not state it.
pub(super) fn sensors() -> Sensors {
    let mut sensors = Sensors::default();
    sensors.body.pitch_noise = 0.5_f64.to_radians();
    sensors.body.pitch_resolution = 0.05_f64.to_radians();
    sensors.gyroscope.pitch_rate_noise = 0.01;
    sensors.joint.link_angle_noise = 0.3_f64.to_radians();
    sensors.joint.link_angle_resolution = 0.3_f64.to_radians();
    sensors.joint.link_rate_noise = 0.02;
    sensors.encoder.wheel_speed_noise = 0.05;
    sensors
}

/// Those sensors as [`sensors`] has them, in words.
pub(super) const SENSORS: &str = "Sensors, 100 readings a second (the thesis measured theirs and gives no figures): pitch \
     0.5 deg of noise and 0.05 deg of resolution, joint angle 0.3 deg each, wheel speeds 0.05 rad/s (6 %); where there is \
     a gyroscope 0.01 rad/s, and 0.02 rad/s for the joint's rate.";

impl Drive {
    fn model(&self) -> Result<Model, ContactAnglesError> {
        let mut model = Model::preset("rocker_bogie_velocity")?;
        model.rover.terrain = self.terrain.clone();
        model.rover.soil = firm(&model.rover.soil);
        model.sensors = sensors();
        model.stepping.seed = self.seed;
        if let Some(obstacle) = self.obstacle {
            model.stepping.plant = Plant::RigidBodies;
            model.obstacles.push(obstacle);
        }
        Ok(model)
    }

    fn parameters(&self) -> ContactAngleEstimation {
        let Sensors { encoder, body, gyroscope, joint, .. } = sensors();
        let mut parameters = ContactAngleEstimation {
            pitch_noise: body.pitch_noise,
            pitch_rate_noise: if self.gyroscope { gyroscope.pitch_rate_noise } else { 1e3 },
            link_angle_noise: joint.link_angle_noise,
            link_rate_noise: joint.link_rate_noise,
            wheel_speed_noise: encoder.wheel_speed_noise,
            ..ContactAngleEstimation::default()
        };
        (self.believe)(&mut parameters);
        parameters
    }

    /// Drives, and compares estimates with the true slope under each wheel at every control period.
    pub fn run(&self) -> Result<Driven, ContactAnglesError> {
        let model = self.model()?;
        let mut estimator = ContactAngles::new(&nominal(&model.rover), self.parameters())?;
        let mut run = model.start()?;
        run.inputs_mut().set("velocity_command", SPEED).map_err(bekker::model::RunError::from)?;
        let steps = (model.control.velocity.period / run.step_size()).round() as u64;
        let wheels = model.rover.wheels.len();
        let mut errors = vec![MeanSquare::default(); wheels];
        let mut normalised = vec![MeanSquare::default(); wheels];
        let mut driven = Driven {
            errors: vec![],
            nees: vec![],
            nis: 0.0,
            slip: [0.0; 2],
            restarts: 0,
            time: vec![],
            course: vec![],
        };
        let start = run.signals().body.x;
        while run.signals().body.x - start < self.way {
            let truth: Vec<f64> = run.signals().wheels.iter().map(|wheel| wheel.contact_angle).collect();
            driven.note_slip(run.signals().wheels.iter().map(|wheel| wheel.slip));
            // The controller's measurement is taken at the start of its period: at the truth above.
            let status = run.advance(steps)?;
            estimator.update(run.measurement())?;
            for (k, truth) in truth.iter().enumerate() {
                let error = estimator.angles()[k] - truth;
                errors[k].add(error);
                normalised[k].add(error / estimator.deviations()[k]);
            }
            let innovation = estimator.innovation();
            driven.nis += innovation.nis / innovation.count.max(1) as f64;
            driven.time.push(run.measurement().time);
            driven.course.push([truth, estimator.angles().to_vec()]);
            self.still_going(run.signals().body.x - start, run.time(), status)?;
        }
        driven.errors = errors.iter().map(MeanSquare::root).collect();
        driven.nees = normalised.iter().map(MeanSquare::mean).collect();
        driven.nis /= driven.time.len() as f64;
        driven.slip[1] /= (driven.time.len() * wheels) as f64;
        driven.restarts = estimator.restarts();
        Ok(driven)
    }

    fn still_going(&self, x: f64, time: f64, status: Status) -> Result<(), ContactAnglesError> {
        let way = self.way;
        match status {
            Status::Ended(event) => Err(ContactAnglesError::Ended { x, way, event }),
            Status::Running if time > PATIENCE * way / SPEED => Err(ContactAnglesError::Slow { x, way, time }),
            Status::Running => Ok(()),
        }
    }
}

/// The same drive with the seeds 0..`trials`.
pub(super) fn drive_all(drive: &Drive, trials: u32) -> Result<Vec<Driven>, ContactAnglesError> {
    let seeds: Vec<u32> = (0..trials).collect();
    let of_seed = |seed: &u32| Drive { seed: *seed, ..drive.clone() }.run();
    map_in_order(&seeds, of_seed).into_iter().collect()
}

impl Driven {
    fn note_slip(&mut self, slips: impl Iterator<Item = f64>) {
        for slip in slips {
            self.slip[0] = self.slip[0].max(slip.abs());
            self.slip[1] += slip.abs();
        }
    }
}

/// Ground as firm as a laboratory's rock or board comes with the wheels' soil model: packed and cohesive.
fn firm(soil: &Soil) -> Soil {
    Soil { cohesion: 20_000.0, friction_angle: 35.0_f64.to_radians(), k_phi: 10.0 * soil.k_phi, ..*soil }
}

/// [`firm`] in words.
pub(super) const GROUND: &str = "The ground is packed and cohesive (c 20 kPa, phi 35 deg, ten times the stiffness of dry \
     sand) in place of the laboratory's rock and board, so wheels sink by a millimetre or less; the true angle is the \
     ground's slope at the wheel's foot.";
