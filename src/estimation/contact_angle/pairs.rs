//! Which points of a rover are paired.

use crate::control::Nominal;
use crate::estimation::EstimationError;

/// Shortest distance of two points, m.
const SHORTEST: f64 = 1e-3;

/// A point of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Point {
    /// Centre of a wheel, by its index.
    Wheel(usize),
    /// A joint whose motion follows from an earlier pair.
    Pivot {
        /// Index of that pair.
        pair: usize,
        /// Place of the joint from that pair's rear point, in the drawing, m.
        place: [f64; 2],
    },
}

/// Two points on one body, rear and front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// 0 the chassis, k link k.
    pub body: usize,
    /// Rear and front point.
    pub points: [Point; 2],
    /// Distance of the points, m.
    pub distance: f64,
    /// Inclination of the line from the rear to the front point in the drawing, rad.
    pub inclination: f64,
}

/// Whether all wheels stand on the ground wherever they are: a pair for every wheel but one. A body on three or more
/// wheels, or a second body on two, leaves some of them in the air on firm ground, and which ones is not measured.
pub(super) fn all_stand(pairs: &[Pair], wheels: usize) -> bool {
    pairs.len() + 1 == wheels
}

/// Pairs that contain every wheel, each after those that it builds on: the neighbours on a body and, from three wheels on,
/// its outer two (a ring: each wheel is in two pairs); a wheel that is alone on its body with a joint to a body whose
/// motion is determined already.
pub(super) fn pairs(nominal: &Nominal) -> Result<Vec<Pair>, EstimationError> {
    let mut builder = Builder { nominal, pairs: Vec::new(), told: vec![None; 1 + nominal.links.len()] };
    for body in 0..builder.told.len() {
        builder.ring(body)?;
    }
    while builder.through_a_joint()? {}
    let seen = |wheel: &usize| builder.pairs.iter().any(|pair| pair.points.contains(&Point::Wheel(*wheel)));
    match (0..nominal.wheels()).find(|wheel| !seen(wheel)) {
        Some(wheel) => Err(EstimationError::Alone { wheel: wheel + 1 }),
        None => Ok(builder.pairs),
    }
}

struct Builder<'a> {
    nominal: &'a Nominal,
    pairs: Vec<Pair>,
    /// For each body the pair that determines its motion.
    told: Vec<Option<usize>>,
}

impl Builder<'_> {
    /// Wheels of a body, rear to front.
    fn wheels(&self, body: usize) -> Vec<usize> {
        let mut wheels: Vec<usize> = (0..self.nominal.wheels()).collect();
        wheels.retain(|wheel| self.nominal.wheel_bodies[*wheel] == body);
        wheels.sort_by(|a, b| self.nominal.wheel_centres[*a][0].total_cmp(&self.nominal.wheel_centres[*b][0]));
        wheels
    }

    fn ring(&mut self, body: usize) -> Result<(), EstimationError> {
        let wheels = self.wheels(body);
        let outer = [wheels.first().copied(), wheels.last().copied()];
        for pair in wheels.windows(2) {
            self.add(body, [Point::Wheel(pair[0]), Point::Wheel(pair[1])])?;
        }
        if let ([Some(rear), Some(front)], true) = (outer, wheels.len() > 2) {
            self.add(body, [Point::Wheel(rear), Point::Wheel(front)])?;
        }
        Ok(())
    }

    /// Pairs one lone wheel with a joint; whether there was one.
    fn through_a_joint(&mut self) -> Result<bool, EstimationError> {
        for body in 0..self.told.len() {
            let wheels = self.wheels(body);
            let (None, [wheel]) = (self.told[body], wheels.as_slice()) else { continue };
            let Some(pivot) = self.joint_of(body) else { continue };
            let ahead = self.place(pivot)[0] >= self.nominal.wheel_centres[*wheel][0];
            let wheel = Point::Wheel(*wheel);
            self.add(body, if ahead { [wheel, pivot] } else { [pivot, wheel] })?;
            return Ok(true);
        }
        Ok(false)
    }

    /// A joint between `body` and one whose motion is determined.
    fn joint_of(&self, body: usize) -> Option<Point> {
        self.nominal.links.iter().enumerate().find_map(|(j, link)| {
            let other = match (link.parent == body, j + 1 == body) {
                (true, _) => j + 1,
                (_, true) => link.parent,
                _ => return None,
            };
            let pair = self.told[other]?;
            let origin = self.place(self.pairs[pair].points[0]);
            Some(Point::Pivot { pair, place: [link.x - origin[0], link.z - origin[1]] })
        })
    }

    /// Place of a point in the drawing, m.
    fn place(&self, point: Point) -> [f64; 2] {
        match point {
            Point::Wheel(wheel) => self.nominal.wheel_centres[wheel],
            Point::Pivot { pair, place } => {
                let origin = self.place(self.pairs[pair].points[0]);
                [origin[0] + place[0], origin[1] + place[1]]
            }
        }
    }

    fn add(&mut self, body: usize, points: [Point; 2]) -> Result<(), EstimationError> {
        let (rear, front) = (self.place(points[0]), self.place(points[1]));
        let (x, z) = (front[0] - rear[0], front[1] - rear[1]);
        let distance = x.hypot(z);
        if distance < SHORTEST {
            let wheel = points.iter().find_map(|point| if let Point::Wheel(k) = point { Some(k + 1) } else { None });
            return Err(EstimationError::Distance { wheel: wheel.unwrap_or(0), distance });
        }
        self.told[body].get_or_insert(self.pairs.len());
        self.pairs.push(Pair { body, points, distance, inclination: z.atan2(x) });
        Ok(())
    }
}
