//! Energy of a metre on a slope, from the core's wheel on its soil.

use super::{DIRECTIONS, DirectionTable, DirectionalCost, FieldError, Grid};
use crate::map::{ElevationMap, Surface};
use bekker::carriage::{Rig, SteadyError, SteadyPoint, steady_point};
use bekker::effects::Effects;
use bekker::rover::Environment;
use bekker::soil::Soil;
use bekker::wheel::Wheel;

/// Slopes are tabulated this far to both sides, rad: 40 degrees, steeper than loose ground stands.
const STEEPEST: f64 = 0.7;
/// Entries of the table.
const ENTRIES: usize = 141;
/// Slip is looked for up to here: a wheel that slips more digs itself in.
const MOST_SLIP: f64 = 0.95;
/// Steps of the bisection in slip: 2 to 1e-9.
const BISECTIONS: usize = 31;

/// Why there is no table.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EnergyError {
    /// A number is out of its range.
    #[error("{name} is {value}; expected a positive number")]
    Number {
        /// What it is.
        name: &'static str,
        /// The value.
        value: f64,
    },
    /// The soil does not carry the rover forward on level ground.
    #[error("the soil does not carry a wheel under {load:.1} N forward on level ground within {:.0} % slip", 100.0 * slip)]
    Stuck {
        /// Load on a wheel, N.
        load: f64,
        /// Largest slip allowed.
        slip: f64,
    },
}

/// Energy and slip of a rover that drives steadily up or down a plane slope, by the slope's angle in the direction of travel.
#[derive(Clone, Debug, PartialEq)]
pub struct SlopeEnergy {
    /// J/m of all wheels along the ground, negative where they brake; infinite where the slip would be too high.
    per_metre: Vec<f64>,
    slip: Vec<f64>,
    /// Weight, N.
    weight: f64,
    /// Largest slope across the direction of travel, rad: where half of the friction holds the rover sideways.
    across: f64,
}

impl SlopeEnergy {
    /// The table of a rover of this weight (N) on `wheels` equal wheels, each with its share of the load, slip up to `most_slip`.
    ///
    /// At a slope a wheel carries W cos(a)/n and must pull W sin(a)/n; the slip at which its drawbar pull is that gives torque T and
    /// energy T / (r (1 - i)) a metre.
    ///
    /// # Errors
    /// [`EnergyError`] where level ground cannot be driven.
    pub fn new(soil: &Soil, wheel: &Wheel, weight: f64, wheels: usize, most_slip: f64) -> Result<Self, EnergyError> {
        let count = wheels as f64;
        for (name, value) in [("weight", weight), ("wheels", count), ("most_slip", most_slip)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(EnergyError::Number { name, value });
            }
        }
        let most = most_slip.min(MOST_SLIP);
        let rig = Rig { environment: Environment::default(), wheel: *wheel, soil: *soil, effects: Effects::default() };
        let mut table = Self { per_metre: Vec::new(), slip: Vec::new(), weight, across: 0.5 * soil.friction_angle };
        for entry in 0..ENTRIES {
            let angle = STEEPEST * (2.0 * entry as f64 / (ENTRIES - 1) as f64 - 1.0);
            let (load, pull) = (weight * angle.cos() / count, weight * angle.sin() / count);
            let found = slip_for(&rig, load, pull, most);
            let energy = found.map_or(f64::INFINITY, |(slip, point)| {
                // V = r omega (1 - i) driving, r omega / (1 + i) in skid.
                let speed = if slip >= 0.0 { 1.0 - slip } else { 1.0 / (1.0 + slip) };
                count * point.torque / (wheel.radius * speed)
            });
            table.per_metre.push(energy);
            table.slip.push(found.map_or(f64::NAN, |(slip, _)| slip));
        }
        let load = weight / count;
        if table.at(0.0).is_finite() { Ok(table) } else { Err(EnergyError::Stuck { load, slip: most }) }
    }

    /// Energy of a metre along the ground at a slope (rad, uphill positive), J/m; 0 where the wheels brake, infinite where the rover gets stuck, or slides.
    #[must_use]
    pub fn at(&self, slope: f64) -> f64 {
        self.signed(slope).max(0.0)
    }

    /// The same, negative where the wheels brake: what else resists the rover takes that up first.
    #[must_use]
    pub fn signed(&self, slope: f64) -> f64 {
        interpolated(&self.per_metre, slope)
    }

    /// Slip at a slope; NaN where the rover gets stuck.
    #[must_use]
    pub fn slip(&self, slope: f64) -> f64 {
        let slip = interpolated(&self.slip, slope);
        if slip.is_finite() { slip } else { f64::NAN }
    }
}

fn interpolated(table: &[f64], slope: f64) -> f64 {
    let place = (slope / STEEPEST + 1.0) * 0.5 * (ENTRIES - 1) as f64;
    if !(place >= 0.0 && place <= (ENTRIES - 1) as f64) {
        return f64::INFINITY;
    }
    let below = (place as usize).min(ENTRIES - 2);
    let share = place - below as f64;
    if share == 0.0 { table[below] } else { (1.0 - share) * table[below] + share * table[below + 1] }
}

/// The smallest slip at which a wheel under `load` pulls `pull`, and the steady point there.
fn slip_for(rig: &Rig, load: f64, pull: f64, most: f64) -> Option<(f64, SteadyPoint)> {
    let at = |slip: f64| -> Result<SteadyPoint, SteadyError> { steady_point(rig, load, slip, 1.0) };
    let (mut low, mut high) = (-most, most);
    if at(high).ok()?.drawbar_pull < pull || at(low).ok()?.drawbar_pull > pull {
        return None;
    }
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if at(middle).ok()?.drawbar_pull < pull {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some((high, at(high).ok()?))
}

/// The energy of a metre over a map, by the slope in the direction of travel. Slopes are those of the surface at the map's nodes, bilinear
/// between them.
#[derive(Clone, Debug)]
pub struct GroundEnergy<'a> {
    map: &'a ElevationMap,
    energy: &'a SlopeEnergy,
    /// Slopes in x and y at every node; NaN beside unknown ground.
    slopes: Vec<[f64; 2]>,
    /// Largest slope across the way, as its tangent.
    across: f64,
    /// What resists beside the soil, J/m: friction of the drives, roughness. Downhill it takes up what the slope gives before nothing is
    /// left to pay.
    beside: f64,
}

impl<'a> GroundEnergy<'a> {
    /// The energy of `energy` over a surface; `beside` (J/m) is added to every metre.
    #[must_use]
    pub fn new(surface: &'a Surface, energy: &'a SlopeEnergy, beside: f64) -> Self {
        let map = surface.map();
        let nodes = (0..map.rows()).flat_map(|row| (0..map.columns()).map(move |column| (column, row)));
        let slope = |(column, row)| {
            let patch = surface.at(map.place(column, row));
            patch.map_or([f64::NAN; 2], |patch| [patch.slope_x, patch.slope_y])
        };
        Self { map, energy, slopes: nodes.map(slope).collect(), across: energy.across.tan(), beside }
    }

    /// Weight of the rover, N.
    #[must_use]
    pub fn weight(&self) -> f64 {
        self.energy.weight
    }

    /// The costs at the map's nodes in the directions of a table. Slopes are taken once a node, and a way and the way back share theirs.
    ///
    /// # Errors
    /// [`FieldError`] where a cost is no number.
    pub fn table(&self) -> Result<DirectionTable, FieldError> {
        let directions = DirectionTable::directions();
        DirectionTable::filled(Grid::from(self.map), |column, row| {
            let slopes = self.slopes[row * self.map.columns() + column];
            let mut costs = [f32::INFINITY; DIRECTIONS];
            for (k, direction) in directions[..DIRECTIONS / 2].iter().enumerate() {
                let [there, back] = self.there_and_back(slopes, *direction);
                (costs[k], costs[k + DIRECTIONS / 2]) = (there as f32, back as f32);
            }
            costs
        })
    }

    /// Costs of a metre in plan view in a direction and back, on a slope.
    fn there_and_back(&self, [slope_x, slope_y]: [f64; 2], direction: [f64; 2]) -> [f64; 2] {
        let along = slope_x * direction[0] + slope_y * direction[1];
        let across = slope_y * direction[0] - slope_x * direction[1];
        // Unknown ground has no slope that is less.
        if across.is_nan() || across.abs() > self.across {
            return [f64::INFINITY; 2];
        }
        // A metre in plan view is longer on the ground.
        let (angle, longer) = (along.atan(), (1.0 + along * along).sqrt());
        [angle, -angle].map(|angle| (self.energy.signed(angle) + self.beside).max(0.0) * longer)
    }

    /// Slopes in x and y at a place; NaN off the map and beside unknown ground.
    fn slopes(&self, place: [f64; 2]) -> [f64; 2] {
        let [u, v] = self.map.in_cells(place);
        let (columns, rows) = (self.map.columns(), self.map.rows());
        if !(u >= 0.0 && v >= 0.0 && u <= (columns - 1) as f64 && v <= (rows - 1) as f64) {
            return [f64::NAN; 2];
        }
        let (column, row) = ((u as usize).min(columns - 2), (v as usize).min(rows - 2));
        let (u, v) = (u - column as f64, v - row as f64);
        let first = row * columns + column;
        let [a, b, c, d] = [first, first + 1, first + columns, first + columns + 1].map(|node| self.slopes[node]);
        [0, 1].map(|axis| (1.0 - v) * ((1.0 - u) * a[axis] + u * b[axis]) + v * ((1.0 - u) * c[axis] + u * d[axis]))
    }
}

impl DirectionalCost for GroundEnergy<'_> {
    fn per_metre(&self, place: [f64; 2], direction: [f64; 2]) -> f64 {
        self.there_and_back(self.slopes(place), direction)[0]
    }
}
