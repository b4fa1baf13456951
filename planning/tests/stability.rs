//! Margin against tipping over.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker_planning::stability::{Stability, StabilityError, about_axes};
use nalgebra::{Rotation3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Rounding of angles of order 1.
const ROUNDING: f64 = 1e-12;

/// Corners of a rectangle below the centre of mass, in an order that is no turn around it.
fn rectangle(length: f64, width: f64, height: f64) -> Vec<Vector3<f64>> {
    let corner = |x: f64, y: f64| Vector3::new(0.5 * x * length, 0.5 * y * width, -height);
    vec![corner(-1.0, 1.0), corner(1.0, 1.0), corner(-1.0, -1.0), corner(1.0, -1.0)]
}

fn under_weight(points: &[Vector3<f64>]) -> Stability {
    about_axes(points, -50.0 * Vector3::z(), Vector3::zeros()).unwrap()
}

#[test]
fn analytic_a_rectangle_tips_over_its_nearer_side() {
    let stability = under_weight(&rectangle(0.8, 0.5, 0.3));
    assert_eq!(stability.angles.len(), 4);
    assert!((stability.margin - (0.25_f64 / 0.3).atan()).abs() < ROUNDING);
    let largest = stability.angles.iter().copied().fold(0.0, f64::max);
    assert!((largest - (0.4_f64 / 0.3).atan()).abs() < ROUNDING);
}

#[test]
fn analytic_a_slope_takes_its_angle_from_the_margin_until_the_robot_tips() {
    for degrees in [0.0_f64, 10.0, 30.0, 39.0, 45.0, 60.0] {
        let tilt = Rotation3::from_axis_angle(&Vector3::x_axis(), degrees.to_radians());
        let points: Vec<_> = rectangle(0.8, 0.5, 0.3).iter().map(|p| tilt * p).collect();
        let expected = (0.25_f64 / 0.3).atan() - degrees.to_radians();
        let margin = under_weight(&points).margin;
        assert!((margin - expected).abs() < ROUNDING, "{degrees} degrees: {margin}, {expected}");
    }
}

#[test]
fn property_a_wheel_inside_the_hull_and_the_order_change_nothing() {
    let mut points = rectangle(0.8, 0.5, 0.3);
    let alone = under_weight(&points).margin;
    points.insert(1, Vector3::new(0.1, 0.05, -0.25));
    points.reverse();
    assert!((under_weight(&points).margin - alone).abs() < ROUNDING);
}

/// The robot tips over an axis where the moment of all forces about it turns it outward: the sign of the margin is that.
#[test]
fn property_the_margin_changes_its_sign_where_the_moment_about_an_axis_does() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let points = rectangle(0.8, 0.5, 0.3);
    let mut vector = |size: f64| Vector3::from_fn(|_, _| random.random_range(-size..size));
    let mut tipped = 0;
    for _ in 0..2000 {
        let (net, moment) = (vector(60.0) - 70.0 * Vector3::z(), vector(20.0));
        let stability = about_axes(&points, net, moment).unwrap();
        for ([from, to], angle) in stability.axes.iter().zip(&stability.angles) {
            let axis = (points[*to] - points[*from]).normalize();
            // Clockwise axes: a turn in their positive sense presses the robot onto its other wheels.
            let about = ((-points[*from]).cross(&net) + moment).dot(&axis);
            assert_eq!(*angle > 0.0, about > 0.0, "net {net:?}, moment {moment:?}");
            tipped += usize::from(*angle < 0.0);
        }
    }
    assert!(tipped > 100);
}

#[test]
fn analytic_a_moment_is_a_force_at_the_height_of_the_centre_of_mass() {
    // A moment M about the left axis as a force M/l across it: with l = 0.3 below a narrow robot both agree.
    let points = rectangle(0.8, 0.5, 0.3);
    let length = 0.25_f64.hypot(0.3);
    let (weight, moment) = (50.0, 4.0);
    let stability = about_axes(&points, -weight * Vector3::z(), Vector3::new(moment, 0.0, 0.0)).unwrap();
    // Of the two sides one loses and one gains, by the angle of a force M/l across l.
    let across = moment / length;
    let lean = (0.25_f64 / 0.3).atan();
    let angle = |sign: f64| (weight * lean.sin() + sign * across).atan2(weight * lean.cos());
    let mut sides: Vec<f64> = stability.angles.clone();
    sides.sort_by(f64::total_cmp);
    assert!((stability.margin - angle(-1.0)).abs() < ROUNDING, "{} {}", stability.margin, angle(-1.0));
    assert!(sides.iter().any(|side| (side - angle(1.0)).abs() < ROUNDING));
}

#[test]
fn property_contacts_on_a_line_are_refused() {
    let line: Vec<_> = (0..4).map(|k| Vector3::new(f64::from(k), 0.0, -0.3)).collect();
    assert_eq!(about_axes(&line, -Vector3::z(), Vector3::zeros()), Err(StabilityError::Line { contacts: 4 }));
}
