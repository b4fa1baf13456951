//! Other paths to the goal of a plan, judged as the plan is: what was there to choose from, and why it was not chosen.
//!
//! Looked for are the paths of the binary planner (3.3) at both obstacle heights of table 3.1, the shortest safe path, the plan by the
//! other measure (energy, or the performance index), and a different route: the ground along the plan is made dearer and a path sought
//! again (the penalty method of alternative routes).

mod corridor;
mod route;
mod verdict;

pub use route::{Route, Unsafe};

use crate::anisotropic::{GroundEnergy, SlopeEnergy, plan_over};
use crate::map::{ElevationMap, Surface};
use crate::plan::{
    CostField, Measure, PathPoint, PerformanceIndex, Plan, PlanError, Planner, Request, Stand, binary_path,
};
use crate::site::{Site, SiteError};
use crate::slip::SlipBand;
use crate::trial::BINARY;
use corridor::Corridor;
use verdict::same_path;

/// Stands that the search for one alternative may evaluate, on a map that is exact. Where the map's error makes 2^n cases of each, as many
/// as the plan itself has taken.
const MOST_EVALUATIONS: usize = 4000;

/// Other paths than the plan's.
#[derive(Clone, Debug)]
pub struct Alternatives {
    /// The plan's own path, judged in the same numbers.
    pub chosen: Route,
    /// Paths that differ from it and from each other.
    pub others: Vec<Route>,
    /// What was looked for and is not there, or is the same path, in a sentence each.
    pub without: Vec<String>,
}

/// What judges routes: the plan's measure over the ground, and energy by the slopes on which the rover stands.
struct Judge<'a> {
    site: &'a Site,
    request: &'a Request,
    measure: Measure,
    /// The map as it was planned on.
    seen: &'a Surface,
    field: CostField,
    energy: Option<&'a SlopeEnergy>,
    slip: Option<&'a SlipBand>,
}

/// A candidate: its name, and its plan or the stands of a path over nodes.
enum Candidate {
    Planned(Plan),
    Nodes(Vec<Stand>),
}

impl Site {
    /// Energy (J) of the wheels along a path by the slopes on which the rover stands; none on firm ground, and where a slope cannot be
    /// driven within the largest slip.
    pub(crate) fn energy_of(&self, points: &[PathPoint]) -> Option<f64> {
        route::energy_along(&self.slope_energy()?.ok()?, self.resistance(), points)
    }

    /// Other paths to the goal of a plan that [`Site::plan`] or [`Site::plan_by_energy`] has made for this request.
    ///
    /// # Errors
    /// [`SiteError`] as the plan itself; an alternative that is not there is no error.
    pub fn alternatives(&self, request: &Request, plan: &Plan) -> Result<Alternatives, SiteError> {
        let cases = plan.points.iter().map(|point| point.assessment.cases).max().unwrap_or(1);
        let most = plan.evaluations.clamp(MOST_EVALUATIONS / cases, MOST_EVALUATIONS);
        let request = &Request { most_evaluations: request.most_evaluations.min(most), ..*request };
        let seen = Surface::new(self.seen(request)?, self.surface().interpolation());
        let energy = self.slope_energy().transpose()?;
        let slip = self.slip_band();
        let field = CostField::new(seen.map(), self.robot(), &self.settings.index);
        let (energy, slip, seen) = (energy.as_ref(), slip.as_ref(), &seen);
        let judge = Judge { site: self, request, measure: plan.measure, seen, field, energy, slip };
        let mut planner = Planner::new(self.evaluator(request.start)?, judge.field.clone(), self.settings.localisation);
        planner.learn(plan);
        let mut alternatives =
            Alternatives { chosen: judge.planned("the plan", plan), others: Vec::new(), without: Vec::new() };
        for (name, found) in judge.candidates(&mut planner, plan)? {
            let route = match found {
                Ok(Candidate::Planned(plan)) => judge.planned(&name, &plan),
                Ok(Candidate::Nodes(stands)) => judge.over_nodes(&name, &mut planner, &stands),
                Err(reason) => {
                    alternatives.without.push(format!("{name}: {reason}"));
                    continue;
                }
            };
            alternatives.add(route, self.surface().map());
        }
        let chosen = alternatives.chosen.clone();
        alternatives.others.iter_mut().for_each(|route| route.verdict = judge.verdict(route, &chosen));
        Ok(alternatives)
    }
}

impl Alternatives {
    /// Adds a route that none of the others takes.
    fn add(&mut self, route: Route, map: &ElevationMap) {
        let near = 0.5 * map.cell();
        let same = std::iter::once(&self.chosen).chain(&self.others).find(|other| same_path(other, &route, near));
        match same {
            Some(other) => self.without.push(format!("{}: the same path as {}", route.name, other.name)),
            None => self.others.push(route),
        }
    }
}

type Sought = (String, Result<Candidate, String>);

fn sought(name: &str, found: Result<Plan, SiteError>) -> Sought {
    let reason = |error: SiteError| match error {
        // The limit is that of this search, which nobody has asked for.
        SiteError::Plan(PlanError::GivenUp { evaluations, .. }) => {
            format!("not found within {evaluations} places evaluated, which is as far as is looked")
        }
        error => error.to_string(),
    };
    (name.to_owned(), found.map(Candidate::Planned).map_err(reason))
}

impl Judge<'_> {
    /// All candidates in the order of the page. What the index planner finds and what is found by energy is looked for side by side.
    fn candidates(&self, planner: &mut Planner, plan: &Plan) -> Result<Vec<Sought>, SiteError> {
        let (by_energy, on_nodes) = rayon::join(|| self.by_energy(plan), || self.on_nodes(planner, plan));
        Ok(by_energy?.into_iter().chain(on_nodes?).chain(self.binary()).collect())
    }

    /// The plan by energy beside one by the index, or another route beside one by energy.
    fn by_energy(&self, plan: &Plan) -> Result<Option<Sought>, SiteError> {
        match (self.measure, self.energy) {
            (Measure::Index, Some(_)) => Ok(Some(sought("least energy", self.site.plan_by_energy(self.request)))),
            (Measure::Energy, Some(energy)) => {
                let corridor = self.corridor(plan);
                let mut table = GroundEnergy::new(self.seen, energy, self.site.resistance()).table()?;
                table.raise(corridor.marked(), corridor::DEARER as f32);
                let found = plan_over(&self.site.evaluator(self.request.start)?, table, self.request);
                Ok(Some(self.different(&corridor, found.map_err(SiteError::from))))
            }
            (_, None) => Ok(None),
        }
    }

    /// What the index planner finds: another route beside its own plan, its plan beside one by energy; the shortest safe path.
    fn on_nodes(&self, planner: &mut Planner, plan: &Plan) -> Result<Vec<Sought>, SiteError> {
        let first = match self.measure {
            Measure::Index => {
                let corridor = self.corridor(plan);
                let field = planner.exchange(self.field.clone().raised(corridor.marked(), corridor::DEARER));
                let found = planner.plan(self.request).map_err(SiteError::from);
                planner.exchange(field);
                self.different(&corridor, found)
            }
            Measure::Energy => sought("least performance index", planner.plan(self.request).map_err(SiteError::from)),
        };
        let length = PerformanceIndex { roughness: 0.0, turning: 0.0, ..self.site.settings.index };
        let field = planner.exchange(CostField::new(self.seen.map(), self.site.robot(), &length));
        let shortest = planner.plan(self.request).map_err(SiteError::from);
        planner.exchange(field);
        Ok(vec![first, sought("shortest safe path", shortest)])
    }

    /// The binary planner's paths, which nobody has evaluated.
    fn binary(&self) -> impl Iterator<Item = Sought> {
        let (map, robot) = (self.site.surface().map(), self.site.robot());
        let [start, goal] = [self.request.start, self.request.goal].map(|at| map.nearest(at).unwrap_or_default());
        BINARY.into_iter().map(move |share| {
            let found = binary_path(map, robot, share * 2.0 * robot.wheel_radius, start, goal);
            let none = || "its obstacles leave no path".to_owned();
            let found = found.map(|path| Candidate::Nodes(path.stands)).ok_or_else(none);
            (format!("binary planner, obstacles from {:.0} % of a wheel's diameter", 100.0 * share), found)
        })
    }

    fn corridor(&self, plan: &Plan) -> Corridor {
        Corridor::new(self.seen.map(), self.site.robot(), &places(plan))
    }

    /// A plan where the ground along the first path is dearer; the reason where that is no other route.
    fn different(&self, corridor: &Corridor, found: Result<Plan, SiteError>) -> Sought {
        let (name, found) = sought("different route", found);
        let other = |candidate: &Candidate| match candidate {
            Candidate::Planned(plan) => corridor.outside(self.seen.map(), &places(plan)),
            Candidate::Nodes(_) => 0.0,
        };
        let found = found.and_then(|candidate| {
            let outside = other(&candidate);
            let near = || {
                format!(
                    "even where the ground within {:.2} m of the path costs {} times as much, only {:.0} % of the way lead elsewhere",
                    corridor.width(),
                    corridor::DEARER,
                    100.0 * outside
                )
            };
            if outside >= corridor::DIFFERENT { Ok(candidate) } else { Err(near()) }
        });
        (name, found)
    }
}

fn places(plan: &Plan) -> Vec<[f64; 2]> {
    plan.points.iter().map(|point| [point.x, point.y]).collect()
}
