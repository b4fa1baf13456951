//! Other paths beside a plan.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker_planning::alternatives::{Alternatives, Route};
use bekker_planning::answer::PlanAnswer;
use bekker_planning::map::{ElevationMap, GroundShape, Interpolation, generated};
use bekker_planning::page::plan_page;
use bekker_planning::plan::{CostField, Evaluator, Localisation, PerformanceIndex, Plan, Planner, Request};
use bekker_planning::robot::fsrl;
use bekker_planning::site::{Site, Source};

/// Costs are sums of some hundred numbers in single precision.
const SUMS: f64 = 1e-6;
const CELL: f64 = 0.1;

fn request(start: [f64; 2], goal: [f64; 2]) -> Request {
    Request { start, heading: None, goal, most_evaluations: 20_000 }
}

fn site(height: impl Fn(f64, f64) -> f64) -> Site {
    let map = ElevationMap::from_formula(61, 61, CELL, [0.0, 0.0], height).unwrap();
    Site::new(map, fsrl(), Interpolation::Smooth)
}

/// Two gaps in a wall across the way, one nearer to it.
fn gaps(x: f64, y: f64) -> f64 {
    let wall = (x - 3.0).abs() < 0.25 && !(2.6..=3.5).contains(&y) && !(0.4..=1.5).contains(&y);
    if wall { 0.5 } else { 0.0 }
}

fn rough() -> (Site, Request) {
    let shape = GroundShape { nodes: 80, cell: 0.08, feature: 0.2, roughness: 0.05, swell: 0.05 };
    let map = generated(&shape, 3).unwrap();
    let [start, goal] = [map.place(12, 12), map.place(66, 60)];
    (Site::new(map, fsrl(), Interpolation::Smooth), request(start, goal))
}

fn sought(site: &Site, request: &Request) -> (Plan, Alternatives) {
    let plan = site.plan(request).unwrap();
    let alternatives = site.alternatives(request, &plan).unwrap();
    (plan, alternatives)
}

fn named<'a>(alternatives: &'a Alternatives, name: &str) -> &'a Route {
    let all = || alternatives.others.iter().map(|route| &route.name).collect::<Vec<_>>();
    alternatives
        .others
        .iter()
        .find(|route| route.name.contains(name))
        .unwrap_or_else(|| panic!("{name} in {:?}", all()))
}

#[test]
fn property_a_different_route_goes_through_the_other_gap_of_a_wall() {
    let site = site(gaps);
    let request = request([1.0, 3.0], [5.0, 3.0]);
    let (plan, alternatives) = sought(&site, &request);
    let other = named(&alternatives, "different route");
    let crossing = |points: &[[f64; 2]]| points.iter().find(|at| (at[0] - 3.0).abs() < 0.5 * CELL).unwrap()[1];
    assert!((2.6..3.5).contains(&crossing(&alternatives.chosen.points)));
    assert!((0.4..1.5).contains(&crossing(&other.points)));
    // Its cost is that of the ground as it is, without what has driven it there.
    assert!(other.cost.unwrap() > plan.cost && other.length > plan.length + 1.0 && other.failures.is_empty());
    let more = 100.0 * (other.cost.unwrap() / plan.cost - 1.0);
    assert!(other.verdict.contains(&format!("{more:.0} % higher")), "{}", other.verdict);
    let evaluator = site.evaluator(request.start).unwrap();
    for pair in other.points.windows(2) {
        let heading = (pair[1][1] - pair[0][1]).atan2(pair[1][0] - pair[0][0]);
        assert!(evaluator.assess(pair[1], heading, None).is_ok(), "{pair:?}");
    }
}

#[test]
fn analytic_on_level_ground_the_shortest_path_is_the_plan_and_so_is_the_binary_planners() {
    let mut site = site(|_, _| 0.0);
    site.on_soil(&bekker::rover::Rover::fsrl().soil).unwrap();
    let request = request([1.0, 3.0], [5.0, 3.0]);
    let (plan, alternatives) = sought(&site, &request);
    for name in ["least energy", "shortest safe path", "from 80 %", "from 120 %"] {
        let told = alternatives.without.iter().find(|told| told.contains(name)).unwrap();
        assert!(told.contains("the same path as the plan"), "{told}");
    }
    // 4 m, each with the energy of level ground.
    let energy = site.slope_energy().unwrap().unwrap();
    let expected = 4.0 * (energy.at(0.0) + 0.02 * site.weight());
    assert!((alternatives.chosen.energy.unwrap() / expected - 1.0).abs() < SUMS);
    assert!((alternatives.chosen.cost.unwrap() - plan.cost).abs() < SUMS);
    assert_eq!(PlanAnswer::new(&site, &plan).energy, alternatives.chosen.energy);
}

#[test]
fn agreement_the_index_along_a_plan_is_the_sum_of_the_searchs_steps() {
    let (mut site, request) = rough();
    let (plan, alternatives) = sought(&site, &request);
    assert!((alternatives.chosen.cost.unwrap() - plan.cost).abs() < SUMS * plan.cost);
    // With a heading at the start the first turn costs as well.
    site.settings.index.turning = 50.0;
    let turned = Request { heading: Some(std::f64::consts::PI), ..request };
    let (plan, alternatives) = sought(&site, &turned);
    assert!((alternatives.chosen.cost.unwrap() - plan.cost).abs() < SUMS * plan.cost);
}

#[test]
fn property_no_safe_path_over_nodes_costs_less_than_the_plan_and_what_is_not_safe_says_where() {
    let (site, request) = rough();
    let (plan, alternatives) = sought(&site, &request);
    assert!(alternatives.others.len() >= 2, "{:?}", alternatives.without);
    let evaluator = site.evaluator(request.start).unwrap();
    for route in &alternatives.others {
        if route.failures.is_empty() {
            assert!(route.cost.unwrap() >= plan.cost * (1.0 - SUMS), "{}", route.name);
            assert!(route.verdict.starts_with("safe"), "{}", route.verdict);
        } else {
            assert!(route.verdict.starts_with("not safe") && route.name.contains("binary"), "{}", route.verdict);
        }
        for place in &route.failures {
            assert_eq!(evaluator.assess(place.place, place.heading, None).unwrap_err(), place.reason);
        }
    }
    let binary = named(&alternatives, "binary");
    assert!(!binary.failures.is_empty(), "rough ground has places that the binary planner does not see");
    // The least thrust counts what failing places tell.
    let tells = binary.failures.iter().filter_map(|place| match place.reason {
        bekker_planning::plan::Failure::Thrust { largest, .. } => Some(largest),
        _ => None,
    });
    let told: Vec<f64> = tells.collect();
    let least = told.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(binary.thrust.is_none_or(|thrust| told.len() == binary.failures.len() && thrust <= least));
}

#[test]
fn property_what_one_plan_has_learnt_leaves_the_next_as_it_is() {
    let site = Site::open(&Source::new("difficult:3", "fsrl")).unwrap();
    let request = request([1.0, 1.0], [6.5, 6.0]);
    let plan = site.plan(&request).unwrap();
    assert!(!plan.failures.is_empty(), "nothing to learn from");
    let robot = fsrl();
    let evaluator: Evaluator = site.evaluator(request.start).unwrap();
    let field = CostField::new(site.surface().map(), &robot, &PerformanceIndex::default());
    let mut planner = Planner::new(evaluator, field, Localisation::default());
    planner.learn(&plan);
    let again = planner.plan(&request).unwrap();
    assert_eq!((again.searches, again.cost), (1, plan.cost));
    let places = |plan: &Plan| plan.points.iter().map(|point| [point.x, point.y]).collect::<Vec<_>>();
    assert_eq!(places(&again), places(&plan));
    // Start and goal are evaluated in all headings; along the path everything is known.
    assert!(again.evaluations <= 16, "{}", again.evaluations);
}

#[test]
fn property_the_page_holds_the_routes_and_needs_no_other_file() {
    let site = site(gaps);
    let request = request([1.0, 3.0], [5.0, 3.0]);
    let (plan, alternatives) = sought(&site, &request);
    let answer = PlanAnswer::new(&site, &plan).with_alternatives(&alternatives);
    let page = plan_page(&site, &plan, &answer, Some(&alternatives));
    for part in ["different route", "performance index", "cost_map", "Other paths to the goal"] {
        assert!(page.contains(part), "no {part}");
    }
    assert!(!page.contains("src=") && !page.contains("href=") && !page.contains("import "));
    assert!(plan_page(&site, &plan, &answer, None).contains("\"chosen\":null"));
}
