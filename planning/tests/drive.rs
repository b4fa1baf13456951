//! Planned paths driven by the core's planar rover.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker::model::ControlKind;
use bekker::rover::Rover;
use bekker_planning::drive::{DriveError, driven, on_firm_ground, profile};
use bekker_planning::force::Shear;
use bekker_planning::map::{ElevationMap, Interpolation, Surface};
use bekker_planning::plan::{CostField, Evaluator, Localisation, PerformanceIndex, Plan, Planner, Request};
use bekker_planning::robot::fsrl;

/// Speed of the thesis's rover, m/s.
const SPEED: f64 = 0.08;

fn ground(height: impl Fn(f64, f64) -> f64) -> Surface {
    let map = ElevationMap::from_formula(51, 41, 0.08, [0.0, 0.0], height).unwrap();
    Surface::new(map, Interpolation::Smooth)
}

/// A plan along y = 1.6 m.
fn straight(surface: &Surface) -> Plan {
    let robot = fsrl();
    let evaluator = Evaluator::new(&robot, surface, &[], Shear::firm(0.9)).unwrap();
    let field = CostField::new(surface.map(), &robot, &PerformanceIndex::default());
    let request = Request { start: [0.8, 1.6], heading: Some(0.0), goal: [2.4, 1.6], most_evaluations: 5000 };
    Planner::new(evaluator, field, Localisation::default()).plan(&request).unwrap()
}

#[test]
fn analytic_the_profile_of_a_path_is_the_height_over_the_way() {
    let surface = ground(|x, y| 0.1 * x + 0.2 * y);
    let (x, z) = profile(&surface, &[[1.0, 1.0], [2.0, 1.0], [2.0, 2.0]]).unwrap();
    for (way, height) in x.iter().zip(&z) {
        let expected = 0.3 + if *way < 1.0 { 0.1 * way.max(0.0) } else { 0.1 + 0.2 * (way.min(2.0) - 1.0) };
        assert!((height - expected).abs() < 1e-12, "{way}");
    }
    assert!(x.is_sorted() && *x.last().unwrap() > 2.0);
    assert!(matches!(profile(&surface, &[[1.0, 1.0], [9.0, 1.0]]), Err(DriveError::Unknown { .. })));
}

#[test]
fn property_a_gentle_path_is_driven_to_its_end_and_uphill_costs_more() {
    let energy = |slope: f64| {
        let surface = ground(|x, _| slope * x);
        let drive =
            driven(&straight(&surface), &surface, on_firm_ground(Rover::fsrl(), 0.9), ControlKind::Velocity, SPEED)
                .unwrap();
        assert!(drive.reached && drive.end == "reached" && drive.covered >= drive.length, "{drive:?}");
        drive.energy
    };
    let (level, up) = (energy(0.0), energy(0.1));
    // Half of the rover's weight is lifted by 0.16 m.
    assert!(up - level > 3.05 * 9.81 * 0.15, "{level} {up}");
}

#[test]
fn property_sand_that_the_plan_took_for_firm_ground_stops_the_drive() {
    // Firm ground of friction 0.9 is climbed at 25 degrees, the rover's sand is not.
    let surface = ground(|x, _| 0.47 * x);
    let drive = driven(&straight(&surface), &surface, Rover::fsrl(), ControlKind::Velocity, SPEED).unwrap();
    assert!(!drive.reached && drive.covered < drive.length, "{drive:?}");
}
