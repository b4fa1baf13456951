//! The thesis's planner on the performance index.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker_planning::force::Shear;
use bekker_planning::map::{ElevationMap, GroundShape, Interpolation, RangeError, Surface, generated};
use bekker_planning::plan::{
    CostField, Evaluator, Failure, HEADINGS, Limits, Localisation, PerformanceIndex, Plan, PlanError, Planner, Request,
    Stand, binary_path, obstacle_density, obstacles,
};
use bekker_planning::robot::{Robot, fsrl};
use pathfinding::directed::dijkstra::dijkstra;

/// Sums of some hundred costs, each rounded to 1e-9 for the peer, which counts in whole numbers.
const SUMS: f64 = 1e-6;

const GROUND: GroundShape = GroundShape { nodes: 60, cell: 0.08, feature: 0.2, roughness: 0.05, swell: 0.05 };

fn request(start: [f64; 2], goal: [f64; 2]) -> Request {
    Request { start, heading: None, goal, most_evaluations: 20_000 }
}

fn map(height: impl Fn(f64, f64) -> f64) -> ElevationMap {
    ElevationMap::from_formula(61, 61, 0.08, [0.0, 0.0], height).unwrap()
}

fn planned(robot: &Robot, map: &ElevationMap, request: &Request) -> Result<Plan, PlanError> {
    let surface = Surface::new(map.clone(), Interpolation::Smooth);
    let evaluator = Evaluator::new(robot, &surface, &[], Shear::firm(0.6)).unwrap();
    let field = CostField::new(map, robot, &PerformanceIndex::default());
    Planner::new(evaluator, field, Localisation::default()).plan(request)
}

#[test]
fn analytic_level_ground_is_crossed_straight() {
    let robot = fsrl();
    let plan = planned(&robot, &map(|_, _| 0.0), &request([0.8, 2.4], [4.0, 2.4])).unwrap();
    assert!((plan.length - 3.2).abs() < 1e-9 && plan.searches == 1 && plan.failures.is_empty());
    // k_3 L / d; no roughness, no turn.
    assert!((plan.cost - 0.1 * 3.2 / 0.128).abs() < SUMS, "{}", plan.cost);
    assert!(plan.points.iter().all(|point| point.heading == 0.0 && point.assessment.cases == 1));
    // Along the grid a way of 45 degrees is as straight.
    let plan = planned(&robot, &map(|_, _| 0.0), &request([0.8, 0.8], [4.0, 4.0])).unwrap();
    assert!((plan.length - 3.2 * 2.0_f64.sqrt()).abs() < 1e-9);
}

#[test]
fn analytic_roughness_of_a_plane_is_the_spread_of_its_heights_under_the_footprint() {
    let robot = fsrl();
    let ground = map(|x, _| 0.25 * x);
    let field = CostField::new(&ground, &robot, &PerformanceIndex::default());
    let at = |heading| field.roughness_at(Stand { column: 30, row: 30, heading });
    // Along x the footprint of 0.4 m by 0.3 m holds nodes at -2..=2 or -2..=3 spacings of 8 cm along, 3 across.
    let xs: Vec<f64> = robot.wheels.iter().map(|wheel| wheel.centre[0]).collect();
    let (low, high) = xs.iter().fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(*x), h.max(*x)));
    let inside: Vec<f64> = (-9..=9).map(|k| f64::from(k) * 0.08).filter(|x| (low..=high).contains(x)).collect();
    let mean = inside.iter().sum::<f64>() / inside.len() as f64;
    let deviation = (inside.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / inside.len() as f64).sqrt() * 0.25;
    // (3.1)-(3.2)
    assert!((at(0) - 5.0 * (deviation / 0.128).powi(3)).abs() < 1e-6, "{}", at(0));
    assert_eq!(at(0), at(4));
    assert!(at(2) < at(0), "across the slope less of it lies under the footprint");
}

#[test]
fn agreement_the_search_finds_the_cheapest_path_of_a_general_library() {
    let robot = fsrl();
    for seed in 0..5 {
        let ground = generated(&GROUND, seed).unwrap();
        let field = CostField::new(&ground, &robot, &PerformanceIndex::default());
        let surface = Surface::new(ground.clone(), Interpolation::Smooth);
        // Without limits, so that the first path is the plan.
        let mut evaluator = Evaluator::new(&robot, &surface, &[], Shear::firm(5.0)).unwrap();
        evaluator.limits = Limits { stability: 0.0, thrust: 0.0, clearance: -1.0 };
        let mut planner = Planner::new(evaluator, field.clone(), Localisation::default());
        let (start, goal) = ((8, 9), (50, 47));
        let Ok(plan) = planner.plan(&request(ground.place(8, 9), ground.place(50, 47))) else { continue };
        if !plan.failures.is_empty() {
            continue;
        }
        let steps: [(isize, isize); HEADINGS] = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];
        let next = |from: &(Stand, bool)| {
            let (from, started) = *from;
            let next = |heading: usize| {
                let column = from.column.checked_add_signed(steps[heading].0)?;
                let row = from.row.checked_add_signed(steps[heading].1)?;
                let to = Stand { column, row, heading };
                let from = if started { from } else { Stand { heading, ..from } };
                let cost = if column < 60 && row < 60 { field.step(from, to) } else { f64::INFINITY };
                cost.is_finite().then(|| ((to, true), (cost * 1e9).round() as u64))
            };
            (0..HEADINGS).filter_map(next).collect::<Vec<_>>()
        };
        let first = (Stand { column: start.0, row: start.1, heading: 0 }, false);
        let (_, theirs) = dijkstra(&first, next, |(at, _)| (at.column, at.row) == goal).unwrap();
        assert!((plan.cost - theirs as f64 * 1e-9).abs() < SUMS, "seed {seed}: {} {theirs}", plan.cost);
    }
}

#[test]
fn property_a_wall_is_passed_through_its_gap_and_the_failures_are_told() {
    let robot = fsrl();
    // A wall of 0.5 m with a gap of 1 m.
    let ground = map(|x, y| if (2.2..2.6).contains(&x) && !(3.2..4.3).contains(&y) { 0.5 } else { 0.0 });
    let plan = planned(&robot, &ground, &request([0.8, 1.6], [4.0, 1.6])).unwrap();
    let crossing = plan.points.iter().find(|point| point.x > 2.4).unwrap();
    assert!((3.2..4.3).contains(&crossing.y), "{}", crossing.y);
    assert!(plan.length > 4.0);
    let limits = Limits::<f64>::default();
    for point in &plan.points {
        assert!(point.assessment.pose.violations.is_empty() && point.assessment.stability >= limits.stability);
    }
}

#[test]
fn property_the_plan_is_the_same_every_time() {
    let robot = fsrl();
    let ground = generated(&GROUND, 11).unwrap();
    let once = || {
        let plan = planned(&robot, &ground, &request([0.8, 0.8], [4.0, 3.6])).unwrap();
        plan.points.iter().map(|point| (point.x, point.y, point.assessment.thrust)).collect::<Vec<_>>()
    };
    assert_eq!(once(), once());
}

#[test]
fn property_an_island_is_unreachable_and_the_nearest_point_is_told() {
    let robot = fsrl();
    // A plateau of 0.5 m around the goal.
    let plateau = |x: f64, y: f64| if (x - 1.9).abs().max((y - 1.2).abs()) < 0.5 { 0.5 } else { 0.0 };
    let ground = ElevationMap::from_formula(25, 21, 0.12, [0.0, 0.0], plateau).unwrap();
    let error = planned(&robot, &ground, &request([0.6, 1.2], [1.9, 1.2])).unwrap_err();
    let PlanError::Unreachable(unreachable) = &error else { panic!("{error}") };
    assert!((0.4..1.3).contains(&unreachable.distance), "{error}");
    assert!(!unreachable.failures.is_empty() && error.to_string().contains("the rover would fail by"));
}

#[test]
fn property_bad_starts_and_goals_are_told_with_place_and_reason() {
    let robot = fsrl();
    let ground = map(|x, y| if (x - 1.0).abs() < 0.2 && (y - 1.0).abs() < 0.2 { f64::NAN } else { 0.0 });
    let error = |start, goal| planned(&robot, &ground, &request(start, goal)).unwrap_err();
    assert!(
        error([9.0, 1.0], [4.0, 2.0]).to_string().contains("the start (9, 1) is off the map, which spans x 0.00..4.80")
    );
    assert!(matches!(error([1.0, 1.0], [4.0, 2.0]), PlanError::Hole { which: "start", .. }));
    let beside = error([1.36, 1.0], [4.0, 2.0]);
    let unknown =
        matches!(&beside, PlanError::CannotStand { which: "start", reason, .. } if reason.kind() == "unknown ground");
    assert!(unknown, "{beside}");
    assert!(matches!(error([2.4, 2.4], [4.78, 2.0]), PlanError::CannotStand { which: "goal", .. }));
    let steep = map(|x, _| 1.2 * x);
    let slides = planned(&robot, &steep, &request([1.6, 2.4], [3.2, 2.4])).unwrap_err();
    assert!(matches!(slides, PlanError::CannotStand { which: "start", .. }), "{slides}");
    let wall = map(|x, _| if (2.4..2.8).contains(&x) { 0.5 } else { 0.0 });
    let few = Request { most_evaluations: 30, ..request([0.8, 2.4], [4.0, 2.4]) };
    assert!(matches!(planned(&robot, &wall, &few), Err(PlanError::GivenUp { .. })));
}

#[test]
fn property_uncertain_ground_is_judged_in_all_its_worst_cases() {
    let robot = fsrl();
    let surface = Surface::new(map(|_, _| 0.0), Interpolation::Smooth);
    let mut evaluator = Evaluator::new(&robot, &surface, &[], Shear::firm(0.6)).unwrap();
    let exact = evaluator.assess([2.4, 2.4], 0.0, None).unwrap();
    evaluator.uncertainty = Some((RangeError { random: 0.002, systematic: 0.01 }, [0.8, 2.4]));
    let near = evaluator.assess([1.2, 2.4], 0.0, None).unwrap();
    let far = evaluator.assess([2.4, 2.4], 0.0, None).unwrap();
    assert_eq!((exact.cases, far.cases), (1, 65));
    assert!(exact.stability > near.stability && near.stability > far.stability, "{} {}", near.stability, far.stability);
    // At some range no pose is left, which bounds the planner's range (3.2.5).
    evaluator.uncertainty = Some((RangeError { random: 0.1, systematic: 0.0 }, [0.8, 2.4]));
    assert!(matches!(evaluator.assess([4.0, 2.4], 0.0, None), Err(Failure::Kinematic(_) | Failure::Stability { .. })));
}

#[test]
fn property_uncertain_localisation_keeps_away_from_the_wall() {
    let robot = fsrl();
    let ground = map(|_, y| if y > 3.0 { 0.5 } else { 0.0 });
    let surface = Surface::new(ground.clone(), Interpolation::Smooth);
    let highest = |position: f64| {
        let evaluator = Evaluator::new(&robot, &surface, &[], Shear::firm(0.6)).unwrap();
        // Roughness is not weighed, so that the shortest safe path is taken.
        let index = PerformanceIndex { roughness: 0.0, turning: 0.0, ..PerformanceIndex::default() };
        let field = CostField::new(&ground, &robot, &index);
        let mut planner = Planner::new(evaluator, field, Localisation { position, heading: 0.0 });
        let plan = planner.plan(&request([0.8, 2.72], [4.0, 2.72]));
        plan.map(|plan| plan.points.iter().map(|point| point.y).fold(0.0, f64::max))
    };
    assert!(highest(0.0).is_ok());
    // At the goal the rover may be 0.3 m off, and the wall is 0.28 m away.
    assert!(matches!(highest(0.1), Err(PlanError::Unreachable(_))));
}

#[test]
fn analytic_obstacles_are_nodes_with_a_step_to_a_neighbour() {
    let robot = fsrl();
    let ground = map(|x, y| if (x - 2.4).abs() < 0.01 && (y - 2.4).abs() < 0.01 { 0.2 } else { 0.0 });
    // The node and its eight neighbours.
    assert_eq!(obstacles(&ground, 0.1).iter().filter(|obstacle| **obstacle).count(), 9);
    assert_eq!(obstacles(&ground, 0.3).iter().filter(|obstacle| **obstacle).count(), 0);
    assert!(obstacle_density(&ground, &robot, 0.1) > 0.0);
    let straight = binary_path(&ground, &robot, 0.3, (10, 30), (50, 30)).unwrap();
    assert!((straight.length - 3.2).abs() < 1e-9);
    let around = binary_path(&ground, &robot, 0.1, (10, 30), (50, 30)).unwrap();
    assert!(
        around.length > 3.2
            && around.stands.iter().all(|stand| stand.column.abs_diff(30).max(stand.row.abs_diff(30)) > 1)
    );
    assert_eq!(binary_path(&ground, &robot, 0.1, (30, 30), (50, 30)), None);
}
