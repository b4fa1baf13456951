//! The cheapest path over a table of costs on which every stand is safe.

use super::{DirectionTable, arrival_over, path_from};
use crate::plan::{
    Assessment, Evaluator, Failure, Measure, PathPoint, Plan, PlanError, Request, Unreachable, ground_node,
};
use std::collections::BTreeMap;

/// Where a stand fails, directions within this angle of its heading are closed, rad: more than the 0.464 between two of the table, so that
/// no path takes the stand again.
const CLOSED: f64 = 0.5;

/// Stands along a path and what is known of them.
struct Search<'a, 'b> {
    evaluator: &'b Evaluator<'a>,
    table: DirectionTable,
    request: Request,
    evaluations: usize,
    /// Nodes that the cost alone closes in some direction.
    closed: usize,
    failures: Vec<([f64; 2], f64, Failure)>,
}

/// The cheapest path over a table on the map of `evaluator`. Pose, stability and forces are evaluated along it, at most a spacing apart;
/// where the rover would fail, the table is closed in the directions around the heading, and the path is sought again.
///
/// # Errors
/// [`PlanError`] names start or goal where the rover cannot stand there, or the nearest point that can be reached.
pub fn plan_over(evaluator: &Evaluator, table: DirectionTable, request: &Request) -> Result<Plan, PlanError> {
    let map = evaluator.placing().surface().map();
    ground_node(map, "start", request.start)?;
    ground_node(map, "goal", request.goal)?;
    let closed = table.costs().iter().filter(|costs| costs.iter().any(|cost| cost.is_infinite())).count();
    let mut search = Search { evaluator, table, request: *request, evaluations: 0, closed, failures: Vec::new() };
    if let Some(heading) = request.heading {
        let [x, y] = request.start;
        search.assess(request.start, heading).map_err(|reason| PlanError::CannotStand {
            which: "start",
            x,
            y,
            reason,
        })?;
    }
    let mut searches = 0;
    loop {
        searches += 1;
        let (points, cost) = search.path()?;
        if search.evaluations > request.most_evaluations {
            return Err(PlanError::GivenUp { searches, evaluations: search.evaluations });
        }
        if let Some(points) = points {
            let (length, evaluations) = (points.last().map_or(0.0, |last| last.travelled), search.evaluations);
            let (measure, failures) = (Measure::Energy, search.failures);
            return Ok(Plan { points, length, cost, measure, searches, evaluations, failures });
        }
    }
}

impl Search<'_, '_> {
    /// The cheapest path as the table is now with its cost; no points where one of its stands has failed.
    fn path(&mut self) -> Result<(Option<Vec<PathPoint>>, f64), PlanError> {
        // The start is on the map; no way may lead from it.
        let Ok(field) = arrival_over(&self.table, self.request.start) else {
            return Err(self.unreachable(self.request.start));
        };
        let Some(path) = path_from(&field, &self.table, self.request.goal) else {
            let goal = self.request.goal;
            let far = |place: [f64; 2]| (place[0] - goal[0]).hypot(place[1] - goal[1]);
            let reached = (0..field.cost.len()).filter(|node| field.cost[*node].is_finite());
            let places = reached.map(|node| field.grid.place(node % field.grid.columns, node / field.grid.columns));
            let nearest = places.min_by(|a, b| far(*a).total_cmp(&far(*b)));
            return Err(self.unreachable(nearest.unwrap_or(self.request.start)));
        };
        let stands = stands(&path.points, self.table.grid().cell, self.request.heading);
        let mut points = Vec::with_capacity(stands.len());
        let mut travelled = 0.0;
        let mut last = self.request.start;
        for (place, heading) in &stands {
            travelled += (place[0] - last[0]).hypot(place[1] - last[1]);
            last = *place;
            if let Ok(assessment) = self.assess(*place, *heading) {
                let slope = assessment.slope;
                points.push(PathPoint { x: place[0], y: place[1], heading: *heading, travelled, assessment, slope });
            }
        }
        Ok(((points.len() == stands.len()).then_some(points), path.cost))
    }

    /// Evaluates a stand; closes the table where it fails.
    fn assess(&mut self, place: [f64; 2], heading: f64) -> Result<Assessment, Failure> {
        self.evaluations += 1;
        let assessed = self.evaluator.assess(place, heading, None);
        if let Err(failure) = &assessed {
            self.table.close(place, heading, CLOSED);
            self.failures.push((place, heading, failure.clone()));
        }
        assessed
    }

    fn unreachable(&self, nearest: [f64; 2]) -> PlanError {
        let mut kinds: BTreeMap<&'static str, usize> = BTreeMap::new();
        for (.., failure) in &self.failures {
            *kinds.entry(failure.kind()).or_default() += 1;
        }
        if self.closed > 0 {
            kinds.insert("slip, slide or unknown ground", self.closed);
        }
        let mut failures: Vec<(&'static str, usize)> = kinds.into_iter().collect();
        failures.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        let goal = self.request.goal;
        let distance = (nearest[0] - goal[0]).hypot(nearest[1] - goal[1]);
        PlanError::Unreachable(Unreachable { nearest, distance, failures })
    }
}

/// Places at most a spacing apart with the heading of the path there; where it bends, one for either heading.
fn stands(points: &[[f64; 2]], cell: f64, first: Option<f64>) -> Vec<([f64; 2], f64)> {
    let mut stands: Vec<([f64; 2], f64)> = first.map(|heading| (points[0], heading)).into_iter().collect();
    for pair in points.windows(2) {
        let (dx, dy) = (pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]);
        let count = (dx.hypot(dy) / cell).ceil().max(1.0);
        let at = |k: usize| [pair[0][0] + dx * k as f64 / count, pair[0][1] + dy * k as f64 / count];
        stands.extend((0..=count as usize).map(|k| (at(k), dy.atan2(dx))));
    }
    stands
}
