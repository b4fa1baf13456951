//! The incline of 2.6.2: figures 2.25 and 2.26.

use super::ContactAnglesError;
use super::drive::{Belief, Drive, Driven, GROUND, SENSORS, drive_all};
use super::rock::{WHEELS, consistency_rows, error_rows, line};
use crate::{Finding, LinePlot};
use bekker::rover::Rover;
use bekker::terrain::{Profile, Samples, SamplesError, Terrain};
use std::sync::Arc;

/// Slope of the incline, rad.
const SLOPE: f64 = 20.0 * std::f64::consts::PI / 180.0;
/// Where it begins and how far the rover drives, m: all wheels get onto it.
const START: f64 = 0.5;
const WAY: f64 = 1.0;
/// Spacing of the profile's samples, m.
const SPACING: f64 = 0.005;

/// What the filter may believe instead, one at a time.
const VARIATIONS: [(&str, Belief); 4] = [
    (", slip taken as known within 3 %", |belief| belief.slip_deviation = 0.03),
    (", ground taken as three times as smooth", |belief| belief.correlation_length *= 3.0),
    (", ground taken as a third as smooth", |belief| belief.correlation_length /= 3.0),
    (", ground taken as half as steep", |belief| belief.angle_deviation *= 0.5),
];

/// Contact angles of the six-wheeled rover from level ground up an incline of 20 degrees, over `trials` seeds of the
/// sensors.
///
/// # Errors
/// [`ContactAnglesError`] where the drive or the estimator fails, or without trials.
pub fn incline(trials: u32) -> Result<Finding, ContactAnglesError> {
    let terrain = ground()?;
    let mut rows = Vec::new();
    let mut plots = Vec::new();
    for (gyroscope, with, thesis) in
        [(false, "", [None, Some(1.84), Some(2.21)]), (true, " with a gyroscope", [None; 3])]
    {
        let drive = Drive { terrain: terrain.clone(), obstacle: None, way: WAY, gyroscope, believe: |_| (), seed: 0 };
        let driven = drive_all(&drive, trials)?;
        rows.extend(error_rows(&driven, with, thesis)?);
        rows.extend(consistency_rows(&driven, with)?);
        if let (false, Some(first)) = (gyroscope, driven.first()) {
            plots.extend([plot("figure_2_26a", first, 2), plot("figure_2_26b", first, 1)]);
        }
    }
    for (with, believe) in VARIATIONS {
        let drive = Drive { terrain: terrain.clone(), obstacle: None, way: WAY, gyroscope: false, believe, seed: 0 };
        rows.extend(error_rows(&drive_all(&drive, trials.div_ceil(10))?, with, [None; 3])?);
    }
    Ok(Finding {
        id: "contact_angles_incline".to_owned(),
        section: "2.6.2, figures 2.25 and 2.26".to_owned(),
        title: "Contact angles of the six-wheeled rover from level ground up an incline of 20 degrees".to_owned(),
        rows,
        plots,
        assumptions: vec![
            "The kink at the foot of the incline is rounded over one wheel radius, as a wheel rounds it.".to_owned(),
            GROUND.to_owned(),
            SENSORS.to_owned(),
            "The filter's beliefs of ground and slip are the defaults of its vocabulary, R at 150 %.".to_owned(),
            format!(
                "The error sits where a wheel passes the kink, so that its mean over the drive depends on how much level and \
                 incline there is: here {START} m and {} m; the thesis does not say.",
                WAY - START
            ),
        ],
    })
}

/// Level ground, an arc as long as the wheel's radius, and the incline.
fn ground() -> Result<Terrain, SamplesError> {
    let length = Rover::rocker_bogie().wheel.radius;
    let rise = SLOPE.tan();
    let height = |x: f64| match x - START {
        before if before <= 0.0 => 0.0,
        within if within < length => 0.5 * rise * within * within / length,
        beyond => rise * (beyond - 0.5 * length),
    };
    let x: Vec<f64> = (-200..=600).map(|k| f64::from(k) * SPACING).collect();
    let z: Vec<f64> = x.iter().map(|x| height(*x)).collect();
    Ok(Terrain::new(Profile::Samples(Arc::new(Samples::new(&x, &z)?))))
}

fn plot(id: &str, driven: &Driven, k: usize) -> LinePlot {
    LinePlot {
        id: id.to_owned(),
        title: format!("Contact angle of the {} wheel onto an incline of 20 degrees", WHEELS[k]),
        x_label: "time, s".to_owned(),
        y_label: "contact angle, deg".to_owned(),
        series: vec![line(driven, 1, k, "extended Kalman filter"), line(driven, 0, k, "true")],
    }
}
