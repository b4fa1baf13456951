//! Search, evaluation, raised cost, and again (figure 3.1).

use super::evaluate::{Assessment, Evaluator, Failure};
use super::index::CostField;
use super::outcome::{Measure, PathPoint, Plan, PlanError, Unreachable};
use super::search::{Found, Task, search};
use super::{HEADINGS, Stand};
use crate::map::ElevationMap;
use bekker_modeldescription::{Unit, parameters};
use std::collections::{BTreeMap, HashMap};
use std::f64::consts::FRAC_PI_4;

/// Searches with evaluation afterwards, as in the thesis. Beyond them every stand is evaluated when the search takes it from its
/// queue, which gives the same path and ends for certain.
const SEARCHES: usize = 40;

parameters! {
    /// Error of dead reckoning, as it grows with the way (3.16)-(3.17).
    pub struct Localisation {
        /// Error of position over distance travelled, K_pos of (3.16).
        position: [Unit::ONE] = 0.0, 0.0..=1.0, Fixed, "calibration of the odometry; 0 is perfect";
        /// Error of heading over change of heading, K_head of (3.17).
        heading: [Unit::ONE] = 0.0, 0.0..=1.0, Fixed, "calibration of the odometry; 0 is perfect";
    }
}

/// From where to where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// Start, m.
    pub start: [f64; 2],
    /// Heading at the start, rad from east to north; any where missing.
    pub heading: Option<f64>,
    /// Goal, m.
    pub goal: [f64; 2],
    /// Most stands to evaluate.
    pub most_evaluations: usize,
}

/// Plans paths of one robot on one map. Evaluations are kept between plans.
#[derive(Debug)]
pub struct Planner<'a> {
    evaluator: Evaluator<'a>,
    field: CostField,
    localisation: Localisation,
    known: HashMap<Stand, Result<Assessment, Failure>>,
}

impl<'a> Planner<'a> {
    /// A planner on the evaluator's surface; `field` may come from a filtered map of the same grid (3.18).
    #[must_use]
    pub fn new(evaluator: Evaluator<'a>, field: CostField, localisation: Localisation) -> Self {
        Self { evaluator, field, localisation, known: HashMap::new() }
    }

    fn map(&self) -> &'a ElevationMap {
        self.evaluator.placing().surface().map()
    }

    /// The cheapest path on which the rover is safe at every stand.
    ///
    /// # Errors
    /// [`PlanError`] names start or goal where the rover cannot stand there, or the nearest point that can be reached.
    pub fn plan(&mut self, request: &Request) -> Result<Plan, PlanError> {
        let [start, goal] =
            [("start", request.start), ("goal", request.goal)].map(|(which, at)| ground_node(self.map(), which, at));
        let ((column, row), goal) = (start?, goal?);
        let heading = request.heading.map(|angle| (angle / FRAC_PI_4).round().rem_euclid(HEADINGS as f64) as usize);
        let start = Stand { column, row, heading: heading.unwrap_or(0) };
        // A stand that has failed in an earlier plan would fail again.
        let failed = self.known.iter().filter(|(_, known)| known.is_err());
        let mut raised: HashMap<Stand, f64> = failed.map(|(stand, _)| (*stand, f64::INFINITY)).collect();
        self.must_stand("start", start, heading.is_none(), &mut raised)?;
        let anywhere = Stand { column: goal.0, row: goal.1, heading: 0 };
        self.must_stand("goal", anywhere, true, &mut raised)?;
        let before = self.known.len();
        for searches in 1.. {
            let task = Task { field: &self.field, start, any_heading: heading.is_none(), goal, raised: &raised };
            let spent = |known: usize| known - before > request.most_evaluations;
            let found = if searches <= SEARCHES {
                search(&task, |_| true)
            } else {
                let (evaluator, known) = (&self.evaluator, &mut self.known);
                search(&task, |stand| {
                    !spent(known.len()) && known.entry(stand).or_insert_with(|| assess(evaluator, stand)).is_ok()
                })
            };
            if spent(self.known.len()) {
                return Err(PlanError::GivenUp { searches, evaluations: self.known.len() - before });
            }
            let safe = self.evaluate(&found, &mut raised);
            if safe && found.reached {
                return Ok(self.finished(&found, searches, before));
            }
            if safe {
                return Err(PlanError::Unreachable(self.unreachable(&found, request.goal)));
            }
        }
        Err(PlanError::GivenUp { searches: 0, evaluations: 0 })
    }

    /// Evaluates the headings at start or goal; at least one must be fit.
    fn must_stand(
        &mut self,
        which: &'static str,
        stand: Stand,
        any: bool,
        raised: &mut HashMap<Stand, f64>,
    ) -> Result<(), PlanError> {
        let headings = if any { 0..HEADINGS } else { stand.heading..stand.heading + 1 };
        let mut first = None;
        let mut fit = 0;
        for heading in headings {
            let stand = Stand { heading, ..stand };
            match self.known_or_assessed(stand) {
                Ok(_) => fit += 1,
                Err(reason) => {
                    first = first.or_else(|| Some(reason.clone()));
                    raised.insert(stand, f64::INFINITY);
                }
            }
        }
        let [x, y] = stand.place(self.map());
        match first.filter(|_| fit == 0) {
            Some(reason) => Err(PlanError::CannotStand { which, x, y, reason }),
            None => Ok(()),
        }
    }

    fn known_or_assessed(&mut self, stand: Stand) -> Result<&Assessment, &Failure> {
        let evaluator = &self.evaluator;
        self.known.entry(stand).or_insert_with(|| assess(evaluator, stand)).as_ref()
    }

    /// Evaluates all stands of a path and those near it by the error of localisation; raises the cost of those at which the rover
    /// would fail. A stand that has failed would fail again, so its cost becomes infinite. Whether all are safe.
    fn evaluate(&mut self, found: &Found, raised: &mut HashMap<Stand, f64>) -> bool {
        let failed = self.failed(&found.path);
        raised.extend(failed.iter().map(|(stand, _)| (*stand, f64::INFINITY)));
        failed.is_empty()
    }

    /// The stands of a path at which, or within the error of localisation of which, the rover would fail, each with the first reason.
    fn failed(&mut self, path: &[Stand]) -> Vec<(Stand, Failure)> {
        let mut failed = Vec::new();
        for (stand, near) in self.with_near(path) {
            let reason = near.into_iter().find_map(|near| self.known_or_assessed(near).err().cloned());
            failed.extend(reason.map(|reason| (stand, reason)));
        }
        failed
    }

    /// The stands of a path and those after a turn, each with all within the error that dead reckoning has made up to there.
    fn with_near(&self, path: &[Stand]) -> Vec<(Stand, Vec<Stand>)> {
        let (mut travelled, mut turned) = (0.0, 0.0);
        let stands = with_turns(path);
        let mut all = Vec::with_capacity(stands.len());
        for (k, &stand) in stands.iter().enumerate() {
            if k > 0 {
                let before = stands[k - 1];
                let steps = (before.column.abs_diff(stand.column) as f64).hypot(before.row.abs_diff(stand.row) as f64);
                travelled += steps * self.map().cell();
                let eighths = before.heading.abs_diff(stand.heading);
                turned += eighths.min(HEADINGS - eighths) as f64 * FRAC_PI_4;
            }
            let near = self.around(stand, self.localisation.position * travelled, self.localisation.heading * turned);
            all.push((stand, near));
        }
        all
    }

    /// A path given by its stands, evaluated as those that are planned: the points at which the rover can stand, and the stands at which
    /// it would fail.
    pub fn judged(&mut self, path: &[Stand]) -> (Vec<PathPoint>, Vec<(Stand, Failure)>) {
        let failed = self.failed(path);
        (self.points(path), failed)
    }

    /// Takes over what a plan on the same ground and grid has found of stands: those that are safe, and those that fail.
    pub fn learn(&mut self, plan: &Plan) {
        let map = self.map();
        let eighth = |angle: f64| (angle / FRAC_PI_4).round().rem_euclid(HEADINGS as f64) as usize;
        let safe = plan.points.iter().map(|point| ([point.x, point.y], point.heading, Ok(point.assessment.clone())));
        let failed = plan.failures.iter().map(|(place, heading, failure)| (*place, *heading, Err(failure.clone())));
        for (place, heading, known) in safe.chain(failed) {
            let Some((column, row)) = map.nearest(place) else { continue };
            let stand = Stand { column, row, heading: eighth(heading) };
            // Plans at any angle stand between nodes too.
            if stand.place(map) == place && stand.angle() == heading {
                self.known.insert(stand, known);
            }
        }
    }

    /// Puts another field of costs in the place of the present one, which is given back; what is known of stands stays.
    pub fn exchange(&mut self, field: CostField) -> CostField {
        std::mem::replace(&mut self.field, field)
    }

    /// The stand and those within the error of position (m) and heading (rad): P' of figure 3.7.
    fn around(&self, stand: Stand, radius: f64, lean: f64) -> Vec<Stand> {
        let far = (radius / self.map().cell()).floor() as isize;
        let eighths = (lean / FRAC_PI_4).round() as usize;
        let mut stands = Vec::new();
        for (dr, dc) in (-far..=far).flat_map(|dr| (-far..=far).map(move |dc| (dr, dc))) {
            if dr * dr + dc * dc > far * far {
                continue;
            }
            let (Some(column), Some(row)) = (stand.column.checked_add_signed(dc), stand.row.checked_add_signed(dr))
            else {
                continue;
            };
            for turn in 0..=2 * eighths.min(HEADINGS / 2) {
                let heading = (stand.heading + HEADINGS + turn - eighths.min(HEADINGS / 2)) % HEADINGS;
                stands.push(Stand { column, row, heading });
            }
        }
        stands.retain(|near| near.column < self.map().columns() && near.row < self.map().rows());
        stands
    }

    fn finished(&self, found: &Found, searches: usize, before: usize) -> Plan {
        let points = self.points(&found.path);
        let length = points.last().map_or(0.0, |last| last.travelled);
        let evaluations = self.known.len() - before;
        Plan {
            points,
            length,
            cost: found.cost,
            measure: Measure::Index,
            searches,
            evaluations,
            failures: self.failures(),
        }
    }

    /// The points of a path of stands that are known to be safe.
    fn points(&self, path: &[Stand]) -> Vec<PathPoint> {
        let map = self.map();
        let mut points = Vec::new();
        let (mut travelled, mut last) = (0.0, None);
        for (stand, near) in self.with_near(path) {
            let [x, y] = stand.place(map);
            let [from_x, from_y] = last.replace([x, y]).unwrap_or([x, y]);
            travelled += (x - from_x).hypot(y - from_y);
            let Some(Ok(assessment)) = self.known.get(&stand) else { continue };
            let slopes = near.iter().filter_map(|near| Some(self.known.get(near)?.as_ref().ok()?.slope));
            let slope = slopes.fold(assessment.slope, |all, slope| [all[0].min(slope[0]), all[1].max(slope[1])]);
            points.push(PathPoint { x, y, heading: stand.angle(), travelled, assessment: assessment.clone(), slope });
        }
        points
    }

    /// All stands known to fail, in the order of the grid.
    fn failures(&self) -> Vec<([f64; 2], f64, Failure)> {
        let failed = self.known.iter().filter_map(|(stand, known)| Some((*stand, known.as_ref().err()?.clone())));
        let mut failed: Vec<(Stand, Failure)> = failed.collect();
        failed.sort_by_key(|(stand, _)| *stand);
        failed.into_iter().map(|(stand, failure)| (stand.place(self.map()), stand.angle(), failure)).collect()
    }

    fn unreachable(&self, found: &Found, goal: [f64; 2]) -> Unreachable {
        let nearest = found.path.last().map_or(goal, |stand| stand.place(self.map()));
        let mut kinds: BTreeMap<&'static str, usize> = BTreeMap::new();
        for (.., failure) in self.failures() {
            *kinds.entry(failure.kind()).or_default() += 1;
        }
        let mut failures: Vec<(&'static str, usize)> = kinds.into_iter().collect();
        failures.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        Unreachable { nearest, distance: (nearest[0] - goal[0]).hypot(nearest[1] - goal[1]), failures }
    }
}

/// The node of a place, where there is ground.
pub(crate) fn ground_node(
    map: &ElevationMap,
    which: &'static str,
    [x, y]: [f64; 2],
) -> Result<(usize, usize), PlanError> {
    let Some((column, row)) = map.nearest([x, y]) else {
        return Err(PlanError::OffMap { which, x, y, bounds: map.bounds() });
    };
    if map.height(column, row).is_nan() { Err(PlanError::Hole { which, x, y }) } else { Ok((column, row)) }
}

fn assess(evaluator: &Evaluator, stand: Stand) -> Result<Assessment, Failure> {
    evaluator.assess(stand.place(evaluator.placing().surface().map()), stand.angle(), None)
}

/// The stands of a path and those in which the rover stands after a turn.
fn with_turns(path: &[Stand]) -> Vec<Stand> {
    let mut stands: Vec<Stand> = Vec::with_capacity(path.len());
    for &stand in path {
        if let Some(last) = stands.last().copied().filter(|last| last.heading != stand.heading) {
            stands.push(Stand { heading: stand.heading, ..last });
        }
        stands.push(stand);
    }
    stands
}
