//! The FSRL rover of section 4.4.2 before a ditch of loose sand, and the controllers that are compared there.

use super::ReproductionError;
use super::contender::{RTC, RTC_SPEED, SLIP, VELOCITY, as_in_the_thesis, by_wheel_speeds, holding_speed, with};
use bekker::model::{ControlKind, Distribution, Model, SoilSource, Variation};
use bekker::modeldescription::Lookup;
use bekker::rover::Rover;
use bekker::soil::Soil;
use bekker::terrain::{LooseDitch, Terrain};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::FRAC_PI_2;

/// Wheel diameter, m.
pub(super) const DIAMETER: f64 = 0.128;
/// Where the deepest place is, m.
pub(super) const POSITION: f64 = 0.8;
/// Largest speed of the drives, 12 rpm (appendix C), rad/s.
const LARGEST_SPEED: f64 = 12.0 * std::f64::consts::TAU / 60.0;
/// Weight of the side of the rover, N.
pub(super) const WEIGHT: f64 = 3.05 * 9.81;
/// Strength of the thesis's own sand by its bevameter (2.4): Pa, rad.
const COHESION: f64 = 180.0;
const FRICTION_ANGLE: f64 = 29.2 * std::f64::consts::PI / 180.0;
/// Radius of rims and bottom, of a wheel's: a sharper bottom would be one that no wheel touches.
const ROUNDING: f64 = 1.25;
/// Gain K at which the commanded body force m K (v_desired - v) hardly depends on the rover's speed, 1/s.
const OPEN_LOOP: f64 = 1.0;

/// Start of the seeds of what is drawn beside the model's parameters.
const OWN: u64 = 1 << 40;

/// Wheels and loose sand, of which the thesis says nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Traction {
    pub name: &'static str,
    /// Height of the lugs, m.
    pub lugs: f64,
    /// Growth of the sinkage exponent with slip.
    pub slip_sinkage: f64,
    /// Relaxation length with which the sinkage follows the slip, m; 0 at once.
    pub digging_length: f64,
}

pub(super) const SMOOTH: Traction =
    Traction { name: "smooth wheels", lugs: 0.0, slip_sinkage: 0.0, digging_length: 0.0 };
pub(super) const LUGS: Traction = Traction { name: "lugs of 10 mm", lugs: 0.01, ..SMOOTH };
pub(super) const DIGGING: Traction =
    Traction { name: "lugs of 10 mm, sand in which slip digs", slip_sinkage: 0.4, ..LUGS };
/// With about the length of a contact, 0.6 wheel radii.
pub(super) const DIGGING_ALONG: Traction =
    Traction { name: "lugs of 10 mm, sand in which slip digs along the way", digging_length: 0.04, ..DIGGING };

/// What differs from trial to trial; the thesis names irregular soil, the way taken and the commands.
#[derive(Clone, Debug)]
pub(super) struct Trial {
    pub model: Model,
    /// Width of the ditch, m.
    pub width: f64,
    /// Commanded speed, m/s.
    pub speed: f64,
    /// Commanded body force, of the weight.
    pub body_force: f64,
}

impl Trial {
    /// The trial of a seed. The width is stated as two to four diameters, the scatter of the rest assumed.
    pub fn new(seed: u32) -> Result<Self, ReproductionError> {
        let mut model = Model::new("fsrl_ditch", Rover::fsrl());
        model.rover.soil.friction_angle = FRICTION_ANGLE;
        let scatter = [
            Variation::new("soil.friction_angle", Distribution::Normal { deviation: 0.03 }),
            Variation::new("soil.k_phi", Distribution::Factor { low: 0.7, high: 1.4 }),
            Variation::new("soil.shear_modulus", Distribution::Factor { low: 0.7, high: 1.4 }),
            Variation::new("rover.centre_of_mass_x", Distribution::Normal { deviation: 0.005 }),
        ];
        let (mut model, _) = model.varied(&scatter, u64::from(seed))?;
        let mut own = ChaCha8Rng::seed_from_u64(u64::from(seed) + OWN);
        let mut uniform = |low: f64, high: f64| low + (high - low) * own.random::<f64>();
        model.stepping.seed = seed;
        model.control.lighten();
        let constant = model.rover.motor.gear_ratio * model.rover.motor.torque_constant;
        model.set("motor.inverse_voltage", 1.0 / (constant * LARGEST_SPEED))?;
        let width = uniform(2.0 * DIAMETER, 4.0 * DIAMETER);
        let (speed, body_force) = (uniform(0.04, 0.08), uniform(0.5, 1.0));
        Ok(Self { model, width, speed, body_force })
    }

    /// The ditch with walls of this slope, rad, but no steeper than the sand stands: its angle of repose, taken as its
    /// friction angle.
    fn ditch(&self, wall: f64) -> LooseDitch {
        let soil = &self.model.rover.soil;
        LooseDitch {
            width: self.width,
            wall: wall.min(soil.friction_angle),
            rounding: ROUNDING * self.model.rover.wheel.radius,
            position: POSITION,
            cohesion: COHESION,
            modulus_factor: 1.0,
        }
    }

    /// Depth of that ditch, m.
    pub fn depth(&self, wall: f64) -> f64 {
        self.ditch(wall).depth()
    }

    /// The same on level ground of the loose sand.
    pub fn level(&self, entrant: &Entrant, traction: &Traction) -> Result<(Model, f64), ReproductionError> {
        let mut trial = self.clone();
        trial.model.rover.soil.cohesion = COHESION;
        trial.level_outside(entrant, traction)
    }

    /// The same on level ground of the soil outside the ditch.
    pub fn level_outside(&self, entrant: &Entrant, traction: &Traction) -> Result<(Model, f64), ReproductionError> {
        let (mut model, speed) = self.model(entrant, traction, 0.0)?;
        model.rover.terrain = Terrain::default();
        Ok((model, speed))
    }

    /// The model that `entrant` drives, and the speed to command, m/s.
    pub fn model(&self, entrant: &Entrant, traction: &Traction, wall: f64) -> Result<(Model, f64), ReproductionError> {
        let mut model = self.model.clone();
        model.rover.terrain = self.ditch(wall).terrain(model.rover.soil.cohesion)?;
        model.set("grousers.height", traction.lugs)?;
        model.set("slip_sinkage.n1", traction.slip_sinkage)?;
        model.set("slip_sinkage.length", traction.digging_length)?;
        model.control.nominal_soil = Some(as_felt(&model.rover, traction.lugs));
        (entrant.apply)(&mut model);
        model.sensors.encoder.wheel_speed_noise = 0.05 * LARGEST_SPEED;
        Ok((model, (entrant.command)(self)))
    }
}

/// A controller of section 4.4.2.
pub(super) struct Entrant {
    pub name: &'static str,
    pub apply: fn(&mut Model),
    /// The commanded speed, m/s.
    pub command: fn(&Trial) -> f64,
}

/// Velocity control first: the others are compared with it; then the thesis's RTC.
pub(super) const ENTRANTS: &[Entrant] = &[
    Entrant { name: VELOCITY, apply: |model| with(model, ControlKind::Velocity), command: |trial| trial.speed },
    Entrant { name: RTC, apply: by_body_force, command: wish },
    Entrant { name: "RTC that knows the soil's resistance", apply: by_body_force_with_resistance, command: wish },
    Entrant { name: "RTC holding its speed", apply: holding_speed, command: |trial| trial.speed },
    Entrant { name: RTC_SPEED, apply: mapped, command: |trial| trial.speed },
    Entrant { name: SLIP, apply: |model| with(model, ControlKind::Slip), command: |trial| trial.speed },
];

/// RTC with wheel-speed loops that has the ditch on its map and knows the height of the lugs and how much a steady slip digs. Its nominal soil
/// is the true one: the lugs' strength must not count twice.
fn mapped(model: &mut Model) {
    by_wheel_speeds(model);
    model.control.soil = SoilSource::Map;
    model.control.nominal_soil = None;
    model.control.rtc_speed.slip_sinkage = model.rover.effects.slip_sinkage.n1;
    model.control.rtc_speed.lug_height = model.rover.effects.grousers.height;
}

/// RTC as in 4.4.2: a body force is commanded, not a speed, and there is no loop around it.
fn by_body_force(model: &mut Model) {
    as_in_the_thesis(model);
    model.control.rtc.gain = OPEN_LOOP;
}

/// Without the soil's resistance the balance takes all torque for pull at the axles: it then believes that the pull tips the
/// bogie back, holds its front wheel for unloaded, and brakes it. With it a part of the lost thrust comes back.
fn by_body_force_with_resistance(model: &mut Model) {
    by_body_force(model);
    model.control.rtc.resistance = 1.0;
}

/// The desired speed at which m K v_desired is the body force, m/s.
fn wish(trial: &Trial) -> f64 {
    trial.body_force * trial.model.rover.environment.gravity / OPEN_LOOP
}

/// The strength that a wheel with lugs of a height (m) finds, which identification would give: Bekker's gains at the lugs'
/// longer lever.
fn as_felt(rover: &Rover, lugs: f64) -> Soil {
    let soil = rover.soil;
    let slenderness = lugs / rover.wheel.width;
    let lever = 1.0 + lugs / rover.wheel.radius;
    let friction = 1.0 + 0.64 * slenderness * (FRAC_PI_2 - slenderness.atan());
    Soil {
        cohesion: soil.cohesion * (1.0 + 2.0 * slenderness) * lever,
        friction_angle: (soil.friction_angle.tan() * friction * lever).atan(),
        ..soil
    }
}

pub(super) fn assumptions() -> Vec<String> {
    let texts = [
        "One side of the rover in the plane with half the mass; geometry as `Rover::fsrl` states; drives of 0.706 N m that reach 12 rpm.",
        "Sand in the ditch: cohesion 0.18 kPa and friction angle 29.2 degrees (the thesis's bevameter), moduli and K = 10 mm of Wong's dry sand; 1.04 kPa outside.",
        "Loose sand stands no steeper than its angle of repose, taken as its friction angle: with the stated width of two to four diameters the ditch is at most about one diameter deep, as stated. Rims and bottom are rounded to 1.25 wheel radii.",
        "Smooth wheels, or lugs of 10 mm (the thesis does not say); where slip digs, the sinkage exponent grows by 0.4 times the slip (Ding et al. 2011). RTC knows the strength that such wheels find.",
        "In 4.4.2 RTC is commanded a body force, not a speed: a constant one of 0.5 to 1 weights. Velocity control: 4 to 8 cm/s.",
        "From trial to trial also: friction angle by 1.7 degrees, k_phi and K by 0.7 to 1.4, centre of mass by 5 mm.",
    ];
    texts.map(str::to_owned).to_vec()
}
