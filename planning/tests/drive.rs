//! Planned paths driven by the core's planar rover.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker::model::ControlKind;
use bekker::rover::Rover;
use bekker_planning::drive::{DriveError, Half, Side, Track, driven, on_firm_ground, planar_side, profile, stretches};
use bekker_planning::force::Shear;
use bekker_planning::map::{ElevationMap, Interpolation, Surface};
use bekker_planning::plan::{CostField, Evaluator, Localisation, PerformanceIndex, Planner, Request};
use bekker_planning::robot::fsrl;

/// Speed of the thesis's rover, m/s.
const SPEED: f64 = 0.08;

fn ground(height: impl Fn(f64, f64) -> f64) -> Surface {
    let map = ElevationMap::from_formula(51, 41, 0.08, [0.0, 0.0], height).unwrap();
    Surface::new(map, Interpolation::Smooth)
}

/// A plan along y = 1.6 m.
fn straight(surface: &Surface) -> Vec<[f64; 2]> {
    let robot = fsrl();
    let evaluator = Evaluator::new(&robot, surface, &[], Shear::firm(0.9)).unwrap();
    let field = CostField::new(surface.map(), &robot, &PerformanceIndex::default());
    let request = Request { start: [0.8, 1.6], heading: Some(0.0), goal: [2.4, 1.6], most_evaluations: 5000 };
    let plan = Planner::new(evaluator, field, Localisation::default()).plan(&request).unwrap();
    plan.points.iter().map(|point| [point.x, point.y]).collect()
}

fn drive(surface: &Surface, base: &Rover, track: Track) -> bekker_planning::drive::Drive {
    let half = Half::new(&fsrl(), &[], base).unwrap();
    driven(&straight(surface), surface, &half, track, ControlKind::VelocityTuned, SPEED).unwrap()
}

#[test]
fn analytic_a_path_is_cut_where_it_turns_and_its_profile_lies_under_the_wheels() {
    let parts = stretches(&[[1.0, 1.0], [1.5, 1.0], [2.0, 1.0], [2.0, 1.0], [2.0, 2.0]]);
    assert_eq!(parts.len(), 2);
    assert!((parts[0].length - 1.0).abs() < 1e-12 && (parts[1].length - 1.0).abs() < 1e-12);
    assert!(parts[1].travelled == parts[0].length && (parts[1].heading - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    let surface = ground(|x, y| 0.1 * x + 0.2 * y);
    // Northward, the left wheels are west of the path.
    let height = |across: &[f64]| profile(&surface, &parts[1], across, [0.3, 0.4]).unwrap();
    for (across, offset) in [(&[0.15][..], -0.15), (&[0.15, -0.15], 0.0)] {
        let (way, z) = height(across);
        assert!(way[0] == -0.3 && (way[way.len() - 1] - 1.4).abs() < 1e-12);
        for (way, z) in way.iter().zip(z) {
            let expected = 0.1 * (2.0 + offset) + 0.2 * (1.0 + way);
            assert!((z - expected).abs() < 1e-9, "{way} {z} {expected}");
        }
    }
    let off = stretches(&[[1.0, 1.0], [9.0, 1.0]]);
    assert!(matches!(profile(&surface, &off[0], &[0.0], [0.3, 0.3]), Err(DriveError::Unknown { .. })));
}

#[test]
fn property_half_of_the_robot_is_the_robot_that_is_planned_for() {
    let robot = fsrl();
    let (rover, across) = planar_side(&robot, &[], Side::Left, &Rover::fsrl()).unwrap();
    assert!((rover.total_mass() - 0.5 * robot.total_mass()).abs() < 1e-12 && (across - 0.15).abs() < 1e-12);
    let moment = rover.body.mass * rover.body.centre_of_mass_x
        + rover.links.iter().map(|link| link.parameters.mass * link.parameters.centre_of_mass_x).sum::<f64>();
    assert!((moment / rover.total_mass() - robot.centre_of_mass[0]).abs() < 1e-12);
    // The rockers turn against each other and go with the body; the bogie is a joint of its own with two wheels.
    assert_eq!((rover.links.len(), rover.wheels.iter().filter(|wheel| wheel.body == 1).count()), (1, 2));
    let left: Vec<f64> = robot.wheels[..3].iter().map(|wheel| wheel.centre[0]).collect();
    let mounts: Vec<f64> = rover.wheels.iter().map(|wheel| wheel.mount.x).collect();
    assert!(left.iter().zip(&mounts).all(|(a, b)| (a - b).abs() < 1e-12), "{left:?} {mounts:?}");
}

#[test]
fn property_a_gentle_path_is_driven_to_its_end_and_uphill_costs_more() {
    let energy = |slope: f64| {
        let drive = drive(&ground(|x, _| slope * x), &on_firm_ground(Rover::fsrl(), 0.9), Track::Mean);
        assert!(drive.reached && drive.stops.is_empty() && drive.stretches == 1, "{drive:?}");
        drive.energy
    };
    let (level, up) = (energy(0.0), energy(0.1));
    // The rover's weight is lifted by 0.16 m.
    assert!(up - level > 6.1 * 9.81 * 0.15, "{level} {up}");
}

#[test]
fn property_a_ridge_under_one_side_stops_that_side_and_not_the_other() {
    // A wall of 8 cm along the left track from x = 1.6 m on.
    let surface = ground(|x, y| 0.08 / ((1.0 + (-(x - 1.6) / 0.02).exp()) * (1.0 + (-(y - 1.68) / 0.01).exp())));
    let line = [[0.8, 1.6], [2.4, 1.6]];
    let half = Half::new(&fsrl(), &[], &on_firm_ground(Rover::fsrl(), 0.3)).unwrap();
    let reached = |track| driven(&line, &surface, &half, track, ControlKind::VelocityTuned, SPEED).unwrap().reached;
    assert!(!reached(Track::Left) && reached(Track::Right));
}

#[test]
fn property_sand_that_the_plan_took_for_firm_ground_stops_the_drive() {
    // Firm ground of friction 0.9 is climbed at 25 degrees, the rover's sand is not.
    let drive = drive(&ground(|x, _| 0.47 * x), &Rover::fsrl(), Track::Mean);
    assert!(!drive.reached && drive.stops.len() == 1 && drive.stops[0].travelled < drive.length, "{drive:?}");
}

#[test]
fn property_strength_that_the_plan_counts_on_is_strength_that_the_drive_has() {
    // The steepest slope that the plan climbs on this ground is climbed.
    let base = on_firm_ground(Rover::fsrl(), 0.6);
    let robot = fsrl();
    let half = Half::new(&robot, &[], &base).unwrap();
    let shear = Shear::of(&half.rover.soil, &half.rover.wheel, robot.total_mass() * 9.81 / 6.0).unwrap();
    let (mut low, mut high) = (0.0, 0.7);
    for _ in 0..12 {
        let slope = 0.5 * (low + high);
        let surface = ground(|x, _| slope * x);
        let fits = Evaluator::new(&robot, &surface, &[], shear).unwrap().assess([1.6, 1.6], 0.0, None).is_ok();
        if fits { low = slope } else { high = slope }
    }
    assert!(low > 0.3 && low < 0.6, "{low}");
    let surface = ground(|x, _| low * x);
    let kind = ControlKind::VelocityTuned;
    let drive = driven(&[[0.8, 1.6], [2.4, 1.6]], &surface, &half, Track::Mean, kind, SPEED).unwrap();
    assert!(drive.reached && drive.slip < 0.5, "{drive:?}");
}
