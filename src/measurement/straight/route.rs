//! The way of a vehicle along its positions in the horizontal plane.

use super::super::around::{filled, lines, slopes};

/// Distance between two knots of the route, m: noise of a few centimetres turns the line between knots little, so that its length is
/// right to a part in a thousand, and a curve that counts as straight departs from it by centimetres.
const BETWEEN: f64 = 1.0;

/// Positions of a drive beside the line through some of them.
///
/// The place of a row along the route is its position's projection on that line, so that the noise of `x` is that of the position and
/// does not add up.
pub(super) struct Route {
    /// Way along the line at each row, m; NaN where there is no position.
    measured: Vec<f64>,
    /// The same of straight lines through the positions of a second, so that there is one also where rows have none.
    smooth: Vec<f64>,
    /// Speed along the line, m/s.
    speed: Vec<f64>,
    /// Curvature of the line, 1/m.
    curvature: Vec<f64>,
}

/// A knot of the line.
struct Knot {
    row: usize,
    at: [f64; 2],
    /// Way to it, m.
    way: f64,
}

impl Route {
    /// `within` is the time over which positions are averaged, s; `rims` has the signs of the wheels' speeds: a vehicle that drives backward
    /// goes back along its way.
    pub fn new(time: &[f64], [easting, northing]: [&[f64]; 2], rims: &[f64], within: f64) -> Self {
        let [easting, northing] = without_repeats(easting, northing);
        let [east, north] = [&easting, &northing].map(|values| lines(time, &filled(time, values), within));
        let smoothed: Vec<[f64; 2]> = east.into_iter().zip(north).map(|(e, n)| [e, n]).collect();
        let knots = knots(&smoothed, rims);
        let mut route = Self { measured: Vec::new(), smooth: Vec::new(), speed: Vec::new(), curvature: Vec::new() };
        let mut segment = 0;
        for row in 0..time.len() {
            while segment + 2 < knots.len() && row >= knots[segment + 1].row {
                segment += 1;
            }
            let along = |at: [f64; 2]| match knots.get(segment..segment + 2) {
                Some([from, to]) => from.way + projection(from, to, at),
                _ if at.iter().any(|x| x.is_nan()) => f64::NAN,
                // It stands.
                _ => 0.0,
            };
            route.measured.push(along([easting[row], northing[row]]));
            route.smooth.push(along(smoothed[row]));
            route.curvature.push(curvature(&knots, segment));
        }
        route.speed = slopes(time, &route.smooth, within);
        route
    }

    /// The measured place of each row, m, where the drive begins at `x0`; NaN where there is no position.
    pub fn measured_x(&self, x0: f64) -> Vec<f64> {
        self.measured.iter().map(|way| x0 + way).collect()
    }

    /// The place of each row without the noise of single positions, m.
    pub fn smooth_x(&self, x0: f64) -> Vec<f64> {
        self.smooth.iter().map(|way| x0 + way).collect()
    }

    pub fn speed(&self, row: usize) -> f64 {
        self.speed[row]
    }

    pub fn curvature(&self, row: usize) -> f64 {
        self.curvature[row]
    }
}

/// Positions without those that repeat the one before exactly: a receiver that is slower than the recorder holds its last one.
fn without_repeats(easting: &[f64], northing: &[f64]) -> [Vec<f64>; 2] {
    let mut last = [f64::NAN; 2];
    let mut all = [Vec::new(), Vec::new()];
    for at in easting.iter().zip(northing).map(|(east, north)| [*east, *north]) {
        let missing = at.iter().any(|x| x.is_nan()) || at == last;
        if !missing {
            last = at;
        }
        for (values, x) in all.iter_mut().zip(at) {
            values.push(if missing { f64::NAN } else { x });
        }
    }
    all
}

/// Knots of the line: each at least [`BETWEEN`] from the one before; on a shorter way its ends.
fn knots(at: &[[f64; 2]], rims: &[f64]) -> Vec<Knot> {
    let mut knots: Vec<Knot> = Vec::new();
    let mut driven = 0.0;
    for (row, at) in at.iter().enumerate() {
        let Some(last) = knots.last() else {
            knots.push(Knot { row, at: *at, way: 0.0 });
            continue;
        };
        driven += rims[row];
        let apart = distance(last.at, *at);
        if apart >= BETWEEN {
            let way = last.way + if driven < 0.0 { -apart } else { apart };
            knots.push(Knot { row, at: *at, way });
            driven = 0.0;
        }
    }
    if let ([first], Some(end)) = (knots.as_slice(), at.last()) {
        let apart = distance(first.at, *end);
        if apart > 0.0 {
            let way = if driven < 0.0 { -apart } else { apart };
            knots.push(Knot { row: at.len() - 1, at: *end, way });
        }
    }
    knots
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

/// How far along the way from one knot to the next a position is, m.
fn projection(from: &Knot, to: &Knot, at: [f64; 2]) -> f64 {
    let [east, north] = [to.at[0] - from.at[0], to.at[1] - from.at[1]];
    let share = ((at[0] - from.at[0]) * east + (at[1] - from.at[1]) * north) / east.hypot(north).powi(2);
    share * (to.way - from.way)
}

/// Curvature about a segment: the angle between its neighbours over the way between their middles, 1/m.
fn curvature(knots: &[Knot], segment: usize) -> f64 {
    let Some(four) = segment.checked_sub(1).and_then(|first| knots.get(first..first + 4)) else { return 0.0 };
    let direction = |from: &Knot, to: &Knot| {
        // Backward the vehicle points against its way.
        let turned = if to.way < from.way { -1.0 } else { 1.0 };
        [turned * (to.at[0] - from.at[0]), turned * (to.at[1] - from.at[1])]
    };
    let (a, b) = (direction(&four[0], &four[1]), direction(&four[2], &four[3]));
    let angle = (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1]);
    let length = |k: usize| (four[k + 1].way - four[k].way).abs();
    angle / (0.5 * length(0) + length(1) + 0.5 * length(2))
}
