//! How another route compares with the plan, in a sentence.

use super::{Judge, Route};
use crate::anisotropic::{GroundEnergy, path_cost};
use crate::plan::Measure;

/// Costs that differ by less than this share are called the same.
const SAME: f64 = 0.005;

impl Judge<'_> {
    /// Why the plan was chosen and not this route; what speaks for the route is told too.
    pub(super) fn verdict(&self, route: &Route, chosen: &Route) -> String {
        if let Some(first) = route.failures.first() {
            let [x, y] = first.place;
            return format!(
                "not safe: at {} of {} places the rover would fail, first at ({x:.2}, {y:.2}) m: {}",
                route.failures.len(),
                route.stands,
                first.reason
            );
        }
        let stuck = route.stuck.map_or(String::new(), |[x, y]| {
            format!("; at ({x:.2}, {y:.2}) m no slip is enough on the soil as it is stated, with an equal share of the load on each wheel")
        });
        format!("{}{stuck}", self.compared(route, chosen))
    }

    /// The comparison of a safe route in cost and length.
    fn compared(&self, route: &Route, chosen: &Route) -> String {
        let measure = match self.measure {
            Measure::Index => "performance index",
            Measure::Energy => "energy",
        };
        let (Some(cost), Some(least)) = (route.cost, chosen.cost) else {
            return format!("safe where the rover stands, but {}", self.not_allowed(route));
        };
        let more = cost / least - 1.0;
        let shorter = chosen.length - route.length;
        let length = match (100.0 * shorter / chosen.length).round() {
            percent if percent >= 1.0 => format!("{shorter:.2} m shorter"),
            percent if percent <= -1.0 => format!("{:.2} m longer", -shorter),
            _ => "as long".to_owned(),
        };
        if more > SAME {
            let and = if shorter > 0.0 { "but" } else { "and" };
            format!("safe and {length}, {and} its {measure} is {:.0} % higher", (100.0 * more).max(1.0))
        } else if more < -SAME {
            format!("safe and {length}; its {measure} is {:.0} % lower: {}", (-100.0 * more).max(1.0), self.bound())
        } else {
            format!("safe and {length}; its {measure} is the same within {} %", 100.0 * SAME)
        }
    }

    /// What keeps the planner from a cheaper path.
    fn bound(&self) -> &'static str {
        match self.measure {
            Measure::Index => "the plan is bound to eight headings, this path goes at any angle",
            Measure::Energy => "the plan keeps off the nodes beside places that have failed, which this path passes",
        }
    }

    /// The middle of the first piece of a path that the energy of the ground does not allow.
    fn first_barred(&self, points: &[[f64; 2]]) -> Option<[f64; 2]> {
        let ground = GroundEnergy::new(self.seen, self.energy?, self.site.resistance());
        let step = 0.5 * self.seen.map().cell();
        let barred = points.windows(2).find(|pair| path_cost(&ground, pair, step).is_infinite())?;
        Some([0, 1].map(|axis| 0.5 * (barred[0][axis] + barred[1][axis])))
    }

    fn not_allowed(&self, route: &Route) -> String {
        match self.measure {
            Measure::Index => "its footprint reaches over unknown ground".to_owned(),
            Measure::Energy => {
                let place =
                    self.first_barred(&route.points).map_or(String::new(), |[x, y]| format!(" at ({x:.2}, {y:.2}) m"));
                let slip = 100.0 * self.site.settings.energy.most_slip;
                format!(
                    "on the ground's slope{place} a wheel would slip by more than {slip:.0} %, or the rover slide sideways"
                )
            }
        }
    }
}

/// Whether two routes keep within `near` (m) of each other.
pub(super) fn same_path(a: &Route, b: &Route, near: f64) -> bool {
    let within = |one: &Route, other: &Route| one.points.iter().all(|at| distance(*at, &other.points) <= near);
    within(a, b) && within(b, a)
}

/// Distance of a place from a path, m.
fn distance(at: [f64; 2], path: &[[f64; 2]]) -> f64 {
    let to = |pair: &[[f64; 2]]| {
        let [dx, dy] = [0, 1].map(|axis| pair[1][axis] - pair[0][axis]);
        let [ax, ay] = [0, 1].map(|axis| at[axis] - pair[0][axis]);
        let square = dx * dx + dy * dy;
        let share = if square > 0.0 { ((ax * dx + ay * dy) / square).clamp(0.0, 1.0) } else { 0.0 };
        (ax - share * dx).hypot(ay - share * dy)
    };
    path.windows(2).map(to).fold(f64::INFINITY, f64::min)
}
