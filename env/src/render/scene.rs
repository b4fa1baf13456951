//! Where everything is, in metres, and how metres become pixels.

use bekker::rover::Rover;
use bekker::signals::Signals;

/// A body's place: a point of it, the same point in the vehicle's drawing, and its pitch, nose up.
#[derive(Clone, Copy)]
pub struct Frame {
    origin: [f64; 2],
    reference: [f64; 2],
    pub pitch: f64,
}

impl Frame {
    /// Where a point of the vehicle's drawing is.
    pub fn place(&self, point: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = self.pitch.sin_cos();
        let [x, z] = [point[0] - self.reference[0], point[1] - self.reference[1]];
        [self.origin[0] + cos * x - sin * z, self.origin[1] + sin * x + cos * z]
    }
}

/// A wheel and the foot on which it stands.
pub struct Wheel {
    pub centre: [f64; 2],
    pub foot: [f64; 2],
    pub tangent: [f64; 2],
    pub normal: [f64; 2],
    pub body: usize,
}

/// The rover's bodies and wheels.
pub struct Scene {
    /// The chassis, then the links.
    pub bodies: Vec<Frame>,
    /// Joints of the links.
    pub joints: Vec<[f64; 2]>,
    pub wheels: Vec<Wheel>,
    /// Centre and least and largest x of the wheels.
    pub middle: f64,
    pub length: f64,
    pub radius: f64,
}

impl Scene {
    pub fn new(rover: &Rover, signals: &Signals) -> Self {
        let body = &signals.body;
        let mut bodies = vec![Frame { origin: [body.x, body.z], reference: [0.0; 2], pitch: body.pitch }];
        let mut joints = Vec::new();
        for (link, state) in rover.links.iter().zip(&signals.links) {
            let parent = bodies.get(link.parent).copied().unwrap_or(bodies[0]);
            let reference = [link.parameters.x, link.parameters.z];
            let origin = parent.place(reference);
            joints.push(origin);
            bodies.push(Frame { origin, reference, pitch: parent.pitch + state.angle });
        }
        let wheels: Vec<Wheel> = rover
            .wheels
            .iter()
            .map(|mounted| {
                let frame = bodies.get(mounted.body).unwrap_or(&bodies[0]);
                wheel(rover, frame.place([mounted.mount.x, mounted.mount.z]), mounted.body)
            })
            .collect();
        let (low, high) = wheels
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), w| (low.min(w.centre[0]), high.max(w.centre[0])));
        let drawn = |k: usize| rover.wheels.get(k).map_or(0.0, |wheel| wheel.mount.x);
        let length = (drawn(rover.wheels.len().saturating_sub(1)) - drawn(0)).abs() + 2.0 * rover.wheel.radius;
        Self { bodies, joints, wheels, middle: 0.5 * (low + high), length, radius: rover.wheel.radius }
    }
}

/// The wheel at `centre`; beyond the known ground its foot is straight below.
fn wheel(rover: &Rover, centre: [f64; 2], body: usize) -> Wheel {
    match rover.terrain.foot(centre) {
        Ok(foot) => Wheel { centre, foot: foot.position, tangent: foot.tangent, normal: foot.normal, body },
        Err(_) => {
            let foot = [centre[0], rover.terrain.at(centre[0]).height];
            Wheel { centre, foot, tangent: [1.0, 0.0], normal: [0.0, 1.0], body }
        }
    }
}

/// Metres to pixels: the rover stands in the middle, a third of the picture is ground.
pub struct View {
    /// Pixels a metre.
    pub scale: f64,
    centre: [f64; 2],
    pub width: f64,
    pub height: f64,
}

/// Widths of the picture in lengths of the vehicle.
const LENGTHS: f64 = 3.0;
/// Heights of the picture, seen from the top, at which the ground below the rover is.
const GROUND: f64 = 0.66;

impl View {
    pub fn new(rover: &Rover, scene: &Scene, (width, height): (u32, u32)) -> Self {
        let (width, height) = (f64::from(width), f64::from(height));
        // The mean ground over the vehicle, so that a stone does not shake the picture.
        let points = 9;
        let span = scene.length.max(0.1);
        let heights =
            (0..points).map(|k| rover.terrain.at(scene.middle + span * (k as f64 / (points - 1) as f64 - 0.5)).height);
        let ground = heights.sum::<f64>() / points as f64;
        Self { scale: width / (LENGTHS * span), centre: [scene.middle, ground], width, height }
    }

    pub fn pixel(&self, [x, z]: [f64; 2]) -> [f32; 2] {
        [
            (0.5 * self.width + (x - self.centre[0]) * self.scale) as f32,
            (GROUND * self.height - (z - self.centre[1]) * self.scale) as f32,
        ]
    }

    /// Position along x of a column of pixels.
    pub fn x(&self, column: f64) -> f64 {
        self.centre[0] + (column - 0.5 * self.width) / self.scale
    }

    /// Height of a row of pixels.
    pub fn z(&self, row: f64) -> f64 {
        self.centre[1] + (GROUND * self.height - row) / self.scale
    }
}
