//! Poses on a map: appendix A's kinematics.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker_planning::map::{ElevationMap, GroundShape, Interpolation, Surface, generated};
use bekker_planning::pose::{Method, Placing, Pose, PoseError, TOUCHING, Violation};
use bekker_planning::robot::{RobotError, RockerBogie, fsrl, sample_return};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::PI;

/// Wheels touch to a micrometre; angles follow over arms of 10 cm and more.
const ANGLE: f64 = 2e-5;

/// Twice what wheels touch by, over the difference of two.
const HEIGHT: f64 = 4.0 * TOUCHING;

fn surface(height: impl Fn(f64, f64) -> f64) -> Surface {
    let map = ElevationMap::from_formula(121, 121, 0.04, [-2.4, -2.4], height).unwrap();
    Surface::new(map, Interpolation::Smooth)
}

fn rough(seed: u64, interpolation: Interpolation) -> Surface {
    let shape = GroundShape { nodes: 121, cell: 0.04, feature: 0.12, roughness: 0.05, swell: 0.08 };
    Surface::new(generated(&shape, seed).unwrap(), interpolation)
}

#[test]
fn analytic_flat_ground_gives_the_flat_pose() {
    let ground = surface(|_, _| 1.5);
    let robot = fsrl();
    let pose = Placing::new(&robot, &ground, &[]).unwrap().pose([0.1, -0.2], 0.7, None).unwrap();
    assert!(pose.attitude.roll.abs() < ANGLE && pose.attitude.pitch.abs() < ANGLE);
    assert!(pose.joints.iter().all(|joint| joint.abs() < ANGLE) && pose.violations.is_empty());
    for contact in &pose.contacts {
        assert!((contact.point.z - 1.5).abs() < HEIGHT && (contact.normal.z - 1.0).abs() < ANGLE);
        assert!((contact.forward.y.atan2(contact.forward.x) - 0.7).abs() < ANGLE);
    }
}

#[test]
fn analytic_a_plane_gives_its_own_roll_and_pitch() {
    let (gx, gy) = (0.3, -0.2);
    let ground = surface(|x, y| gx * x + gy * y);
    let robot = fsrl();
    for heading in [0.0, 0.5, 2.0, -2.8] {
        let pose = Placing::new(&robot, &ground, &[]).unwrap().pose([0.0, 0.0], heading, None).unwrap();
        // The body's axes lie in the plane: its lateral axis has the plane's slope across the heading, and so on.
        let across = -gx * heading.sin() + gy * heading.cos();
        let along = gx * heading.cos() + gy * heading.sin();
        // Roll is taken about the level forward axis first, so pitch is seen in the rolled plane.
        assert!((pose.attitude.roll - across.atan()).abs() < ANGLE, "heading {heading}");
        assert!((pose.attitude.pitch - (along * pose.attitude.roll.cos()).atan()).abs() < ANGLE, "heading {heading}");
        let normal = nalgebra::Vector3::new(-gx, -gy, 1.0).normalize();
        assert!(pose.contacts.iter().all(|contact| (contact.normal - normal).norm() < ANGLE));
    }
}

/// Angles theta of figure A.1 in a pose: the joint's value, the flat angle, and the pitch, which the planes share.
fn thesis_angles(pose: &Pose) -> [f64; 4] {
    let [rocker, bogie] = RockerBogie::<f64>::default().flat_angles();
    let (left, right) = (pose.attitude.pitch + rocker + pose.joints[0], pose.attitude.pitch + rocker + pose.joints[1]);
    let bogies = (bogie - rocker + pose.joints[2] + left, bogie - rocker + pose.joints[3] + right);
    [left, right, bogies.0, bogies.1]
}

#[test]
fn published_loop_closures_hold_in_every_pose() {
    let robot = fsrl();
    let RockerBogie { rear_arm: l1, front_arm: l2, bogie_rear_arm: l3, bogie_front_arm: l4, track: w, .. } =
        RockerBogie::<f64>::default();
    let mut random = ChaCha8Rng::seed_from_u64(1);
    for seed in 0..20 {
        let ground = rough(seed, Interpolation::Smooth);
        let place = [random.random_range(1.0..3.8), random.random_range(1.0..3.8)];
        let placing = Placing::new(&robot, &ground, &[]).unwrap();
        let Ok(pose) = placing.pose(place, random.random_range(-PI..PI), None) else { continue };
        // Heights of the wheels' centres, left rear, middle, front, then right.
        let frames = bekker_planning::robot::Frames::new(&robot, &pose.attitude, &[]);
        let z: Vec<f64> = robot.wheels.iter().map(|wheel| frames.point(wheel.link, wheel.centre).z).collect();
        let [t1l, t1r, t2l, t2r] = thesis_angles(&pose);
        let roll = pose.attitude.roll;
        // Our roll is positive with the left side up, the thesis's with the right.
        let across = -w * roll.sin();
        let closures = [
            z[0] + l1 * roll.cos() * (t1r.sin() - t1l.sin()) + across,
            z[1] + roll.cos() * (l1 * t1r.sin() - l2 * t1l.cos() - l3 * t2l.sin()) + across,
            z[2] + roll.cos() * (l1 * t1r.sin() - l2 * t1l.cos() - l4 * t2l.cos()) + across,
            z[4] + roll.cos() * (l1 * t1r.sin() - l2 * t1r.cos() - l3 * t2r.sin()),
            z[5] + roll.cos() * (l1 * t1r.sin() - l2 * t1r.cos() - l4 * t2r.cos()),
        ];
        // (A.1)-(A.5)
        assert!(closures.iter().all(|closure| (z[3] - closure).abs() < 1e-12), "seed {seed}: {closures:?}, {}", z[3]);
        // (A.6) with the sign of errata 13.
        let flat = RockerBogie::<f64>::default().flat_angles()[0];
        assert!((pose.attitude.pitch - (0.5 * (t1r + t1l) - flat)).abs() < 1e-12);
    }
}

#[test]
fn property_all_wheels_touch_whatever_the_map() {
    let robot = fsrl();
    let (mut found, mut bracketed, mut tried) = (0, 0, 0);
    let mut random = ChaCha8Rng::seed_from_u64(2);
    for seed in 0..30 {
        for interpolation in [Interpolation::Smooth, Interpolation::Bilinear] {
            let ground = rough(seed, interpolation);
            let placing = Placing::new(&robot, &ground, &[]).unwrap();
            for _ in 0..5 {
                tried += 1;
                let place = [random.random_range(1.0..3.8), random.random_range(1.0..3.8)];
                let Ok(pose) = placing.pose(place, random.random_range(-PI..PI), None) else { continue };
                found += 1;
                bracketed += usize::from(pose.method == Method::Bracketed);
                for contact in &pose.contacts {
                    let height = ground.height([contact.point.x, contact.point.y]).unwrap();
                    assert!((contact.point.z - height).abs() <= TOUCHING);
                    let axes = [contact.normal, contact.forward, contact.left];
                    assert!(axes.iter().all(|axis| (axis.norm() - 1.0).abs() < 1e-12));
                    assert!(contact.normal.dot(&contact.forward).abs() < 1e-12 && contact.normal.z > 0.0);
                }
            }
        }
    }
    println!("{found} of {tried} poses found, {bracketed} by the bracketed search");
    assert!(found * 100 >= tried * 97, "{found} of {tried}");
}

#[test]
fn property_a_start_nearby_leads_to_the_same_pose() {
    let (ground, robot) = (rough(4, Interpolation::Smooth), fsrl());
    let placing = Placing::new(&robot, &ground, &[]).unwrap();
    let near = placing.pose([2.0, 2.0], 0.3, None).unwrap();
    let cold = placing.pose([2.01, 2.0], 0.3, None).unwrap();
    let warm = placing.pose([2.01, 2.0], 0.3, Some(&near.attitude)).unwrap();
    assert!((cold.attitude.position - warm.attitude.position).norm() < 10.0 * TOUCHING);
    assert!(warm.evaluations <= cold.evaluations);
}

#[test]
fn property_joint_limits_and_belly_are_told_with_place() {
    let robot = fsrl();
    // A wall along the node at x = 0 under the belly, which hangs 0.13 m over the ground.
    let ridge = surface(|x, y| if x.abs() < 0.03 && y.abs() < 0.1 { 0.3 } else { 0.0 });
    let pose = Placing::new(&robot, &ridge, &[]).unwrap().pose([0.0, 0.0], 0.0, None).unwrap();
    let belly = pose.violations.iter().find(|violation| matches!(violation, Violation::Belly { .. }));
    assert!(
        matches!(belly, Some(Violation::Belly { depth, .. }) if (*depth - 0.17).abs() < 0.02),
        "{:?}",
        pose.violations
    );
    // A wall under the left front wheel only.
    let wall = surface(|x, y| if x > 0.2 && y > 0.0 { 0.3 } else { 0.0 });
    let pose = Placing::new(&robot, &wall, &[]).unwrap().pose([0.05, 0.0], 0.0, None).unwrap();
    let joint = pose.violations.iter().any(|violation| matches!(violation, Violation::Joint { .. }));
    assert!(joint, "{:?}", pose.joints);
}

#[test]
fn property_unknown_ground_is_told_with_wheel_and_place() {
    let robot = fsrl();
    let ground = surface(|x, y| if x > 0.32 && y < -0.1 { f64::NAN } else { 0.0 });
    let placing = Placing::new(&robot, &ground, &[]).unwrap();
    let error = placing.pose([0.1, 0.0], 0.0, None).unwrap_err();
    assert!(matches!(&error, PoseError::Unknown { part, .. } if part == "right front wheel"), "{error}");
    assert!(matches!(placing.pose([9.0, 0.0], 0.0, None), Err(PoseError::Unknown { .. })));
    assert!(matches!(placing.pose([f64::NAN, 0.0], 0.0, None), Err(PoseError::Input { .. })));
}

#[test]
fn analytic_closed_shoulders_lift_the_sample_return_rover() {
    let (ground, robot) = (surface(|_, _| 0.0), sample_return());
    let at = |active: &[f64]| Placing::new(&robot, &ground, active).unwrap().pose([0.0, 0.0], 0.0, None).unwrap();
    let (open, closed) = (at(&[]), at(&[0.3, 0.3, 0.0, 0.0, 0.0]));
    // Legs of 0.3 m at 0.6 rad, then at 0.9 rad to the level.
    let lift = 0.3 * (0.9_f64.sin() - 0.6_f64.sin());
    assert!((closed.attitude.position.z - open.attitude.position.z - lift).abs() < HEIGHT);
    assert!(closed.centre_of_mass.z > open.centre_of_mass.z);
    let tilted = at(&[0.3, -0.3, 0.0, 0.0, 0.0]);
    assert!(tilted.attitude.roll > 0.1, "the left side is up");
}

#[test]
fn property_a_prismatic_leg_stands_like_a_turning_one() {
    // A tricycle on a lift: the body of a robot with a sliding active joint rises by its value.
    let text = fsrl();
    let mut robot = text.clone();
    robot.links = vec![bekker_planning::robot::Link {
        parent: None,
        joint: bekker_planning::robot::Joint {
            name: "lift".into(),
            kind: bekker_planning::robot::JointKind::Prismatic,
            axis: [0.0, 0.0, -1.0],
            at: [0.0; 3],
            passive: None,
            active: Some((0, 1.0)),
            least: 0.0,
            most: 0.2,
        },
        mass: 1.0,
        centre_of_mass: [0.0, 0.0, -0.1],
    }];
    let wheel = |name: &str, x, y| bekker_planning::robot::RobotWheel {
        name: name.into(),
        link: Some(0),
        centre: [x, y, -0.1],
    };
    robot.wheels = vec![wheel("left", 0.0, 0.2), wheel("right", 0.0, -0.2), wheel("front", 0.4, 0.0)];
    let ground = surface(|_, _| 0.0);
    let height = |lift: f64| {
        Placing::new(&robot, &ground, &[lift]).unwrap().pose([0.0, 0.0], 0.0, None).unwrap().attitude.position.z
    };
    assert!((height(0.15) - height(0.0) - 0.15).abs() < HEIGHT);
}

#[test]
fn property_robots_that_the_ground_does_not_determine_are_refused() {
    let mut rigid = sample_return();
    rigid.links.iter_mut().for_each(|link| link.joint.passive = None);
    let ground = surface(|_, _| 0.0);
    let error = Placing::new(&rigid, &ground, &[]).unwrap_err();
    assert_eq!(error, RobotError::Undetermined { wheels: 4, passive: 0 });
    let mut bent = fsrl();
    bent.links[2].joint.axis = [0.0, -2.0, 0.0];
    assert!(Placing::new(&bent, &ground, &[]).unwrap_err().to_string().contains("axis of joint `left bogie` is 2"));
    let error = Placing::new(&sample_return(), &ground, &[0.0]).unwrap_err();
    assert_eq!(error, RobotError::Active { got: 1, expected: 5 });
}
