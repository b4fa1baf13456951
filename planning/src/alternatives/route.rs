//! A path with what the rover meets on it.

use super::Judge;
use crate::anisotropic::{GroundEnergy, SlopeEnergy, path_cost};
use crate::plan::{Failure, Measure, PathPoint, Plan, Planner, Stand};
use crate::slip::SlipBand;

/// A place of a route at which the rover would fail.
#[derive(Clone, Debug)]
pub struct Unsafe {
    /// Place, m.
    pub place: [f64; 2],
    /// Heading, rad.
    pub heading: f64,
    /// Reason.
    pub reason: Failure,
}

/// A path to the goal.
#[derive(Clone, Debug)]
pub struct Route {
    /// What it is: "shortest safe path".
    pub name: String,
    /// From start to goal, m.
    pub points: Vec<[f64; 2]>,
    /// Length, m.
    pub length: f64,
    /// Cost in the plan's measure, index or J; none where the measure does not allow the path.
    pub cost: Option<f64>,
    /// Energy of the wheels by the slopes on which the rover stands, J; none on firm ground and where it cannot be driven.
    pub energy: Option<f64>,
    /// Least stability angle, rad; none where the rover has no pose at some place.
    pub stability: Option<f64>,
    /// Least thrust in reserve, N; none where the rover has no pose, or no forces hold it, at some place.
    pub thrust: Option<f64>,
    /// Largest slip, 0 or more; infinite where none is enough, none on firm ground and where the rover cannot stand at some place.
    pub slip: Option<f64>,
    /// The first place at which no slip is enough on the soil as it is stated, m.
    pub stuck: Option<[f64; 2]>,
    /// Places evaluated.
    pub stands: usize,
    /// Those at which the rover would fail, from start to goal.
    pub failures: Vec<Unsafe>,
    /// How it compares with the plan.
    pub verdict: String,
}

impl Judge<'_> {
    /// The route of a plan, whose stands are all safe.
    pub(super) fn planned(&self, name: &str, plan: &Plan) -> Route {
        let points: Vec<[f64; 2]> = plan.points.iter().map(|point| [point.x, point.y]).collect();
        let cost = self.cost(&points);
        self.route(name, points, cost, &plan.points, Vec::new())
    }

    /// The route of a path over nodes, evaluated here.
    pub(super) fn over_nodes(&self, name: &str, planner: &mut Planner, stands: &[Stand]) -> Route {
        let map = self.seen.map();
        let (points, failed) = planner.judged(stands);
        let failures = failed.into_iter().map(|(stand, reason)| Unsafe {
            place: stand.place(map),
            heading: stand.angle(),
            reason,
        });
        let places: Vec<[f64; 2]> = stands.iter().map(|stand| stand.place(map)).collect();
        let cost = self.cost(&places);
        self.route(name, places, cost, &points, failures.collect())
    }

    fn route(
        &self,
        name: &str,
        points: Vec<[f64; 2]>,
        cost: Option<f64>,
        stood: &[PathPoint],
        failures: Vec<Unsafe>,
    ) -> Route {
        let length = points.windows(2).map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1])).sum();
        let whole = failures.is_empty();
        Route {
            name: name.to_owned(),
            points,
            length,
            cost,
            energy: self
                .energy
                .filter(|_| whole)
                .and_then(|energy| energy_along(energy, self.site.resistance(), stood)),
            stability: least(stood.iter().map(|point| point.assessment.stability), &failures, |reason| match reason {
                Failure::Stability { margin, .. } => Some(*margin),
                // Stability is looked at before forces, and is kept where these fail.
                Failure::NoForces | Failure::Thrust { .. } | Failure::Slides { .. } => Some(f64::INFINITY),
                _ => None,
            }),
            thrust: least(stood.iter().map(|point| point.assessment.thrust), &failures, |reason| match reason {
                Failure::Thrust { largest, .. } => Some(*largest),
                _ => None,
            }),
            slip: self.slip.filter(|_| whole).map(|band| most_slip(band, stood)),
            stuck: self.slip.and_then(|band| {
                let first =
                    stood.iter().find(|point| band.stated(point.assessment.pose.attitude.slope()).is_infinite())?;
                Some([first.x, first.y])
            }),
            stands: stood.len() + failures.len(),
            failures,
            verdict: String::new(),
        }
    }

    /// Cost of a path in the plan's measure.
    fn cost(&self, points: &[[f64; 2]]) -> Option<f64> {
        let cost = match (self.measure, self.energy) {
            (Measure::Energy, Some(energy)) => {
                let ground = GroundEnergy::new(self.seen, energy, self.site.resistance());
                path_cost(&ground, points, 0.5 * self.seen.map().cell())
            }
            _ => self.field.along(self.seen.map(), points, self.request.heading),
        };
        cost.is_finite().then_some(cost)
    }
}

/// The least of the values of safe places and of what failures tell; none where one tells nothing.
fn least(safe: impl Iterator<Item = f64>, failures: &[Unsafe], told: impl Fn(&Failure) -> Option<f64>) -> Option<f64> {
    let failed: Option<Vec<f64>> = failures.iter().map(|failure| told(&failure.reason)).collect();
    let least = failed?.into_iter().chain(safe).fold(f64::INFINITY, f64::min);
    least.is_finite().then_some(least)
}

/// Energy (J) of a path by the slope of the direction of travel, by the trapezoid rule; `beside` (J/m) resists beside the soil. None where
/// the soil cannot be driven within the largest slip allowed.
pub(crate) fn energy_along(energy: &SlopeEnergy, beside: f64, points: &[PathPoint]) -> Option<f64> {
    // A metre in plan view is longer on the ground.
    let per_metre = |point: &PathPoint| {
        let slope = point.assessment.pose.attitude.slope();
        (energy.signed(slope) + beside).max(0.0) / slope.cos()
    };
    let piece = |pair: &[PathPoint]| {
        let length = pair[1].travelled - pair[0].travelled;
        // A turn where the rover stands costs nothing, whatever the slope.
        if length > 0.0 { 0.5 * length * (per_metre(&pair[0]) + per_metre(&pair[1])) } else { 0.0 }
    };
    let total: f64 = points.windows(2).map(piece).sum();
    total.is_finite().then_some(total)
}

/// The largest slip of a path on the soil as it is stated; minus infinity counts as infinity, for none is enough either.
fn most_slip(band: &SlipBand, points: &[PathPoint]) -> f64 {
    let slips = points.iter().map(|point| band.stated(point.assessment.pose.attitude.slope()));
    slips.fold(0.0, |most, slip| if slip == f64::NEG_INFINITY { f64::INFINITY } else { most.max(slip) })
}
