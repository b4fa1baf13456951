//! Where wheels and joints are on a path, with the derivatives by all that is estimated.

use super::pairs::{Pair, Point};
use super::process::ORDER;

/// Newton's iterations for the place of a wheel; from one reading to the next two are enough.
const ITERATIONS: usize = 8;
/// Error of a place at which they end, of the nodes' spacing.
const CLOSE: f64 = 1e-10;
/// Least share of a wheel's travel that changes its distance to the other point: a wheel that moves across the line could be
/// anywhere.
const LEAST_TURN: f64 = 0.1;

/// Places of the entries of the estimated vector: slopes at the nodes of the path, derivatives of the slope at the last node, the
/// slope's mean, place and speed of the first pair's rear wheel along the path, slips of the wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layout {
    pub nodes: usize,
    pub wheels: usize,
    /// Distance of two nodes along the path, m.
    pub spacing: f64,
}

impl Layout {
    /// Derivative number `order` (from 1) of the slope at the last node; number 0 is the slope there.
    pub fn head(&self, order: usize) -> usize {
        self.nodes + order - 1
    }

    pub fn mean(&self) -> usize {
        self.nodes + ORDER - 1
    }

    pub fn place(&self) -> usize {
        self.nodes + ORDER
    }

    pub fn speed(&self) -> usize {
        self.nodes + ORDER + 1
    }

    pub fn slip(&self, wheel: usize) -> usize {
        self.nodes + ORDER + 2 + wheel
    }

    pub fn size(&self) -> usize {
        self.nodes + ORDER + 2 + self.wheels
    }

    /// Node before a place, and the share of the way from there to the next one.
    pub fn split(&self, place: f64) -> (usize, f64) {
        let scaled = place / self.spacing;
        let node = (scaled.max(0.0) as usize).min(self.nodes - 2);
        (node, (scaled - node as f64).clamp(-1.0, 2.0))
    }
}

/// A quantity with its derivatives by the estimated vector.
#[derive(Clone, Debug, Default)]
pub(super) struct Quantity {
    pub value: f64,
    pub by: Vec<f64>,
}

impl Quantity {
    pub fn new(size: usize) -> Self {
        Self { value: 0.0, by: vec![0.0; size] }
    }

    /// Becomes `value`, with the sum of the parts' derivatives times their factors.
    fn combine<const N: usize>(&mut self, value: f64, parts: [(f64, &Quantity); N]) {
        self.value = value;
        for (k, by) in self.by.iter_mut().enumerate() {
            *by = parts.iter().map(|(factor, part)| factor * part.by[k]).sum();
        }
    }
}

/// The path between the nodes, each segment straight in the middle of its slopes.
#[derive(Clone, Debug)]
struct Path {
    layout: Layout,
    /// Slopes at the nodes, and x and z there.
    slopes: Vec<f64>,
    x: Vec<f64>,
    z: Vec<f64>,
}

impl Path {
    fn follow(&mut self, state: &[f64]) {
        let nodes = self.layout.nodes;
        self.slopes.copy_from_slice(&state[..nodes]);
        for node in 1..nodes {
            let (sin, cos) = (0.5 * (state[node - 1] + state[node])).sin_cos();
            self.x[node] = self.x[node - 1] + self.layout.spacing * cos;
            self.z[node] = self.z[node - 1] + self.layout.spacing * sin;
        }
    }

    /// Position at a place and its derivative along the path.
    fn at(&self, place: f64) -> ([f64; 2], [f64; 2]) {
        let (node, share) = self.layout.split(place);
        let change = self.slopes[node + 1] - self.slopes[node];
        let bend = 0.5 * share * change;
        let (sin, cos) = (self.slopes[node] + bend).sin_cos();
        let way = share * self.layout.spacing;
        ([self.x[node] + way * cos, self.z[node] + way * sin], [cos - bend * sin, sin + bend * cos])
    }

    /// Derivatives of the position at a fixed place by the slopes.
    fn by_slopes(&self, place: f64, [x, z]: [&mut [f64]; 2]) {
        x.fill(0.0);
        z.fill(0.0);
        let (last, share) = self.layout.split(place);
        let mut add = |node: usize, [dx, dz]: [f64; 2], share: f64| {
            for (k, weight) in [(node, 1.0 - 0.5 * share), (node + 1, 0.5 * share)] {
                x[k] -= dz * weight;
                z[k] += dx * weight;
            }
        };
        for node in 0..last {
            add(node, [self.x[node + 1] - self.x[node], self.z[node + 1] - self.z[node]], 1.0);
        }
        let ([end_x, end_z], _) = self.at(place);
        add(last, [end_x - self.x[last], end_z - self.z[last]], share);
    }
}

/// The points of a rover and the lines of its pairs, on a path, as last evaluated.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    path: Path,
    /// Place of every wheel along the path, m.
    pub places: Vec<Quantity>,
    /// x and z of every wheel's centre from the first node on, and of the joint in every pair that has one.
    points: Vec<[Quantity; 2]>,
    /// Inclination of the line of every pair, rad.
    pub inclinations: Vec<Quantity>,
    /// The wheel that each pair puts on the path: of the first pair the front one, of the others the new one.
    puts: Vec<usize>,
    first: usize,
    scratch: [Vec<f64>; 2],
}

impl Shape {
    /// Of a rover whose first pair are two wheels, every other one having one wheel that is in none before it.
    pub fn new(layout: &Layout, pairs: &[Pair]) -> Self {
        let new = || Quantity::new(layout.size());
        let wheel = |point: Point| if let Point::Wheel(wheel) = point { Some(wheel) } else { None };
        let first = wheel(pairs[0].points[0]).unwrap_or(0);
        let mut known = vec![first];
        let mut puts = Vec::with_capacity(pairs.len());
        for pair in pairs {
            let put = pair.points.into_iter().filter_map(wheel).find(|wheel| !known.contains(wheel)).unwrap_or(first);
            puts.push(put);
            known.push(put);
        }
        let zeros = || vec![0.0; layout.nodes];
        Self {
            path: Path { layout: *layout, slopes: zeros(), x: zeros(), z: zeros() },
            places: (0..layout.wheels).map(|_| new()).collect(),
            points: (0..layout.wheels + pairs.len()).map(|_| [new(), new()]).collect(),
            inclinations: pairs.iter().map(|_| new()).collect(),
            puts,
            first,
            scratch: [vec![0.0; layout.size()], vec![0.0; layout.size()]],
        }
    }

    /// The wheel whose place is in the estimated vector.
    pub fn first(&self) -> usize {
        self.first
    }

    /// The pair that puts a wheel on the path; of the first wheel the first pair.
    pub fn pair_of(&self, wheel: usize) -> usize {
        self.puts.iter().position(|put| *put == wheel).unwrap_or(0)
    }

    /// Evaluates all at `state`, the first wheel moved on by `shift`, m. The other wheels are looked for from `starts` on.
    pub fn evaluate(&mut self, pairs: &[Pair], state: &[f64], shift: f64, starts: &[f64]) {
        let layout = self.path.layout;
        self.path.follow(state);
        let first = self.first;
        self.places[first].value = state[layout.place()] + shift;
        self.places[first].by.fill(0.0);
        self.places[first].by[layout.place()] = 1.0;
        self.put_on_path(first);
        for (k, pair) in pairs.iter().enumerate() {
            for point in pair.points {
                if let Point::Pivot { pair: base, place } = point {
                    self.put_joint(layout.wheels + k, layout.wheels + base, base, &pairs[base], place);
                }
            }
            let wheel = self.puts[k];
            if wheel != first {
                let other = pair.points.map(|point| index(point, layout.wheels + k)).into_iter().find(|p| *p != wheel);
                self.put_wheel(wheel, other.unwrap_or(first), pair.distance, starts[wheel]);
            }
            self.put_line(k, pair, layout.wheels);
        }
    }

    /// Slope under a wheel with its derivatives, linear between the nodes.
    pub fn slope(&self, wheel: usize, slope: &mut Quantity) {
        let place = &self.places[wheel];
        let (node, share) = self.path.layout.split(place.value);
        let change = self.path.slopes[node + 1] - self.path.slopes[node];
        slope.combine(self.path.slopes[node] + share * change, [(change / self.path.layout.spacing, place)]);
        slope.by[node] += 1.0 - share;
        slope.by[node + 1] += share;
    }

    /// The wheel's place where it is `distance` from another point.
    fn put_wheel(&mut self, wheel: usize, other: usize, distance: f64, start: f64) {
        let [from_x, from_z] = [self.points[other][0].value, self.points[other][1].value];
        let mut place = start;
        let mut along = [1.0, 0.0];
        let mut turn = 1.0;
        for _ in 0..ITERATIONS {
            let ([x, z], travel) = self.path.at(place);
            let (dx, dz) = (x - from_x, z - from_z);
            let found = dx.hypot(dz).max(f64::MIN_POSITIVE);
            along = [dx / found, dz / found];
            turn = along[0] * travel[0] + along[1] * travel[1];
            turn = turn.abs().max(LEAST_TURN).copysign(turn);
            let step = (distance - found) / turn;
            place += step.clamp(-distance, distance);
            if step.abs() < CLOSE * self.path.layout.spacing {
                break;
            }
        }
        let [by_x, by_z] = &mut self.scratch;
        self.path.by_slopes(place, [by_x, by_z]);
        let [other_x, other_z] = &self.points[other];
        let quantity = &mut self.places[wheel];
        quantity.value = place;
        for (k, by) in quantity.by.iter_mut().enumerate() {
            *by = -(along[0] * (by_x[k] - other_x.by[k]) + along[1] * (by_z[k] - other_z.by[k])) / turn;
        }
        self.put_on_path(wheel);
    }

    /// Position of a wheel whose place is known.
    fn put_on_path(&mut self, wheel: usize) {
        let place = &self.places[wheel];
        let (position, travel) = self.path.at(place.value);
        let [x, z] = &mut self.points[wheel];
        self.path.by_slopes(place.value, [&mut x.by, &mut z.by]);
        for (quantity, (value, along)) in [x, z].into_iter().zip(position.into_iter().zip(travel)) {
            quantity.value = value;
            quantity.by.iter_mut().zip(&place.by).for_each(|(by, of_place)| *by += along * of_place);
        }
    }

    /// The joint at `place` from the rear point of the pair `base`, on whose body it is.
    fn put_joint(&mut self, target: usize, base_joint: usize, base: usize, pair: &Pair, place: [f64; 2]) {
        let mut joint = std::mem::take(&mut self.points[target]);
        let origin = &self.points[index(pair.points[0], base_joint)];
        let inclination = &self.inclinations[base];
        let (sin, cos) = (inclination.value - pair.inclination).sin_cos();
        let [x, z] = [cos * place[0] - sin * place[1], sin * place[0] + cos * place[1]];
        joint[0].combine(origin[0].value + x, [(1.0, &origin[0]), (-z, inclination)]);
        joint[1].combine(origin[1].value + z, [(1.0, &origin[1]), (x, inclination)]);
        self.points[target] = joint;
    }

    fn put_line(&mut self, k: usize, pair: &Pair, wheels: usize) {
        let [rear, front] = pair.points.map(|point| &self.points[index(point, wheels + k)]);
        let (x, z) = (front[0].value - rear[0].value, front[1].value - rear[1].value);
        let square = (x * x + z * z).max(f64::MIN_POSITIVE);
        let (by_x, by_z) = (-z / square, x / square);
        self.inclinations[k]
            .combine(z.atan2(x), [(by_x, &front[0]), (-by_x, &rear[0]), (by_z, &front[1]), (-by_z, &rear[1])]);
    }
}

/// Which entry of the points a pair's point is, `joint` being the pair's own joint.
fn index(point: Point, joint: usize) -> usize {
    match point {
        Point::Wheel(wheel) => wheel,
        Point::Pivot { .. } => joint,
    }
}
