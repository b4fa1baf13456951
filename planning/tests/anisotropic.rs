//! Costs by direction, and any-angle paths.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker::soil::Soil;
use bekker::wheel::Wheel;
use bekker_planning::anisotropic::{
    DirectionalCost, FieldError, Grid, GroundEnergy, SlopeEnergy, arrival, path_cost, path_from,
};
use bekker_planning::map::{ElevationMap, Interpolation, Surface};
use bekker_planning::plan::{Measure, Request};
use bekker_planning::robot::fsrl;
use bekker_planning::site::{Site, SiteError};

/// What the issue asks of a path: its cost within 1 % of the reference.
const PATH: f64 = 0.01;

/// Rise and fall on a way around a mound, of the energy of level ground.
const NEARLY_LEVEL: f64 = 0.1;

/// The field itself is of first order in the spacing.
const FIELD: f64 = 0.02;

fn square(nodes: usize, cell: f64, origin: [f64; 2]) -> Grid {
    Grid { columns: nodes, rows: nodes, cell, origin }
}

fn far(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// A drift as of a current: going with it is cheaper (a Randers metric, whose cheapest paths are straight).
fn drift([x, y]: [f64; 2]) -> f64 {
    1.0 + 0.6 * (0.8 * x + 0.6 * y)
}

/// An ellipse: along (0.6, 0.8) a metre costs a third of one across.
fn ellipse([x, y]: [f64; 2]) -> f64 {
    let (along, across) = (0.6 * x + 0.8 * y, 0.8 * x - 0.6 * y);
    along.hypot(3.0 * across)
}

#[test]
fn analytic_uniform_costs_of_any_shape_give_straight_paths() {
    let start = [3.0, 4.0];
    for (name, shape) in [("one", (|_| 1.0) as fn([f64; 2]) -> f64), ("drift", drift), ("ellipse", ellipse)] {
        let cost = |_: [f64; 2], direction: [f64; 2]| shape(direction);
        let field = arrival(&cost, square(101, 0.1, [0.0, 0.0]), start).unwrap();
        for goal in [[9.5, 9.0], [0.5, 9.3], [9.0, 1.1], [3.05, 9.5], [0.3, 3.1]] {
            let length = far(goal, start);
            let exact = length * shape([(goal[0] - start[0]) / length, (goal[1] - start[1]) / length]);
            let path = path_from(&field, &cost, goal).unwrap();
            assert!(
                path.cost < exact * (1.0 + PATH) && path.cost > exact * (1.0 - 1e-9),
                "{name} {goal:?}: {} {exact}",
                path.cost
            );
            assert!((field.at(goal) / exact - 1.0).abs() < FIELD, "{name} {goal:?}: {} {exact}", field.at(goal));
        }
    }
}

/// Cost that grows with x: isotropic, with circles as paths (the hyperbolic half-plane x > 0 has 1/x).
#[test]
fn analytic_the_hyperbolic_plane_gives_its_distance() {
    let cost = |place: [f64; 2], _: [f64; 2]| 1.0 / place[0];
    let start = [2.0, 1.0];
    let field = arrival(&cost, square(181, 0.05, [1.0, 0.0]), start).unwrap();
    for goal in [[2.0, 8.0], [8.0, 6.0], [1.5, 5.0]] {
        let exact = (1.0 + far(start, goal).powi(2) / (2.0 * start[0] * goal[0])).acosh();
        let path = path_from(&field, &cost, goal).unwrap();
        assert!((path.cost / exact - 1.0).abs() < PATH, "{goal:?}: {} {exact}", path.cost);
    }
}

#[test]
fn agreement_a_path_over_a_hill_is_that_of_a_grid_four_times_as_fine() {
    // Up costs four times as much as level ground, down half: a smooth asymmetric cost over a hill.
    let slope = |[x, y]: [f64; 2]| {
        let hill = 1.5 * (-((x - 5.0).powi(2) + (y - 5.0).powi(2)) / 4.0).exp();
        [-(x - 5.0) / 2.0 * hill, -(y - 5.0) / 2.0 * hill]
    };
    let cost = |place: [f64; 2], d: [f64; 2]| {
        let [gx, gy] = slope(place);
        let along = gx * d[0] + gy * d[1];
        1.0 + 2.0 * (along + along.hypot(0.3)) - 0.5
    };
    let solve = |nodes: usize| {
        let field = arrival(&cost, square(nodes, 10.0 / (nodes - 1) as f64, [0.0, 0.0]), [1.0, 4.5]).unwrap();
        path_from(&field, &cost, [9.0, 5.5]).unwrap()
    };
    let (coarse, fine) = (solve(81), solve(321));
    assert!((coarse.cost / fine.cost - 1.0).abs() < PATH, "{} {}", coarse.cost, fine.cost);
    let straight = path_cost(&cost, &[[1.0, 4.5], [9.0, 5.5]], 0.01);
    assert!(fine.cost < straight, "{} {straight}", fine.cost);
    // The other way over the same hill costs another amount.
    let back = arrival(&cost, square(81, 0.125, [0.0, 0.0]), [9.0, 5.5]).unwrap();
    assert!(path_from(&back, &cost, [1.0, 4.5]).unwrap().cost.is_finite());
}

#[test]
fn property_walls_are_walked_around_and_islands_are_out_of_reach() {
    let wall = |place: [f64; 2], _: [f64; 2]| {
        if (4.0..4.5).contains(&place[0]) && place[1] < 8.0 { f64::INFINITY } else { 1.0 }
    };
    let field = arrival(&wall, square(101, 0.1, [0.0, 0.0]), [1.0, 1.0]).unwrap();
    let path = path_from(&field, &wall, [8.0, 1.0]).unwrap();
    let around = far([1.0, 1.0], [4.0, 8.0]) + 0.5 + far([4.5, 8.0], [8.0, 1.0]);
    assert!((path.cost / around - 1.0).abs() < PATH, "{} {around}", path.cost);
    let moat = |place: [f64; 2], _: [f64; 2]| {
        let r = far(place, [7.0, 7.0]);
        if (1.0..1.6).contains(&r) { f64::INFINITY } else { 1.0 }
    };
    let field = arrival(&moat, square(101, 0.1, [0.0, 0.0]), [1.0, 1.0]).unwrap();
    assert_eq!(path_from(&field, &moat, [7.0, 7.0]), None);
}

#[test]
fn property_wrong_costs_and_starts_are_told() {
    let negative = |_: [f64; 2], d: [f64; 2]| d[0];
    let grid = square(21, 1.0, [0.0; 2]);
    assert!(matches!(arrival(&negative, grid, [5.0, 5.0]), Err(FieldError::Cost { .. })));
    let one = |_: [f64; 2], _: [f64; 2]| 1.0;
    assert_eq!(arrival(&one, grid, [50.0, 5.0]), Err(FieldError::Start { x: 50.0, y: 5.0 }));
}

fn sand() -> Soil {
    bekker::rover::Rover::fsrl().soil
}

#[test]
fn analytic_energy_of_a_slope_grows_by_more_than_the_lift() {
    let wheel = Wheel { radius: 0.064, width: 0.06, ..Wheel::default() };
    let weight = 6.1 * 9.81;
    let energy = SlopeEnergy::new(&sand(), &wheel, weight, 6, 0.6).unwrap();
    let (level, up) = (energy.at(0.0), energy.at(0.15));
    // The wheels must lift the weight, and slip costs beside.
    assert!(level > 0.0 && up - level > weight * 0.15_f64.sin(), "{level} {up}");
    assert!(energy.at(-0.15) < level && energy.at(-0.15) >= 0.0);
    assert!(energy.slip(0.15) > energy.slip(0.0));
    assert!(energy.at(0.6).is_infinite() && energy.slip(0.6).is_nan(), "loose sand is not climbed at 34 degrees");
    assert!(SlopeEnergy::new(&Soil { k_phi: 1000.0, ..sand() }, &wheel, weight, 6, 0.6).is_err());
}

#[test]
fn property_a_steep_dune_is_gone_around_and_left_straight_down() {
    let wheel = Wheel { radius: 0.064, width: 0.06, ..Wheel::default() };
    let energy = SlopeEnergy::new(&sand(), &wheel, 6.1 * 9.81, 6, 0.6).unwrap();
    let dune = |x: f64, y: f64| 1.8 * (-((x - 5.0).powi(2) + (y - 5.0).powi(2)) / 3.0).exp();
    let map = ElevationMap::from_formula(101, 101, 0.1, [0.0, 0.0], dune).unwrap();
    let surface = Surface::new(map, Interpolation::Smooth);
    let cost = GroundEnergy::new(&surface, &energy, 0.5);
    let field = arrival(&cost, square(101, 0.1, [0.0, 0.0]), [1.0, 4.8]).unwrap();
    let path = path_from(&field, &cost, [9.0, 5.2]).unwrap();
    let straight = path_cost(&cost, &[[1.0, 4.8], [9.0, 5.2]], 0.05);
    assert!(straight.is_infinite() && path.cost.is_finite() && path.length > 8.1, "{straight} {}", path.length);
    assert!(cost.per_metre([5.0, 2.5], [0.0, 1.0]) > cost.per_metre([5.0, 2.5], [0.0, -1.0]));
}

#[test]
fn property_a_plan_by_energy_goes_around_a_mound_and_all_its_stands_are_safe() {
    let mound = |x: f64, y: f64| 0.9 * (-((x - 3.0).powi(2) + (y - 3.0).powi(2)) / 1.2).exp();
    let map = ElevationMap::from_formula(61, 61, 0.1, [0.0, 0.0], mound).unwrap();
    let mut site = Site::new(map, fsrl(), Interpolation::Smooth);
    let request = Request { start: [0.8, 3.0], heading: None, goal: [5.2, 3.1], most_evaluations: 20_000 };
    assert!(matches!(site.plan_by_energy(&request), Err(SiteError::NoSoil)));
    site.on_soil(&sand()).unwrap();
    let plan = site.plan_by_energy(&request).unwrap();
    let ends = [&plan.points[0], plan.points.last().unwrap()].map(|point| [point.x, point.y]);
    assert_eq!((ends, plan.measure), ([request.start, request.goal], Measure::Energy));
    let evaluator = site.evaluator(request.start).unwrap();
    for point in &plan.points {
        assert!(evaluator.assess([point.x, point.y], point.heading, None).is_ok(), "{} {}", point.x, point.y);
    }
    assert!(plan.points.windows(2).all(|pair| far([pair[0].x, pair[0].y], [pair[1].x, pair[1].y]) < 0.1 + 1e-9));
    // Straight over the mound no wheel pulls enough; around it the ground is nearly level.
    let (robot, weight) = (fsrl(), fsrl().total_mass() * site.settings.environment.gravity);
    let wheel = Wheel { radius: robot.wheel_radius, width: robot.wheel_width, ..Wheel::default() };
    let energy = SlopeEnergy::new(&sand(), &wheel, weight, 6, site.settings.energy.most_slip).unwrap();
    let cost = GroundEnergy::new(site.surface(), &energy, weight * site.settings.energy.resistance);
    assert!(path_cost(&cost, &[request.start, request.goal], 0.05).is_infinite());
    let level = energy.at(0.0) + weight * site.settings.energy.resistance;
    assert!(plan.length > 4.6 && plan.length < 6.5, "{} m", plan.length);
    assert!((plan.cost / (level * plan.length) - 1.0).abs() < NEARLY_LEVEL, "{} J, {level} J/m", plan.cost);
    let island = Request { goal: [20.0, 3.0], ..request };
    assert!(matches!(site.plan_by_energy(&island), Err(SiteError::Plan(_))));
}
