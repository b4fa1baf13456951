//! The rock of 2.6.2: figure 2.24.

use super::drive::{Drive, Driven, GROUND, SENSORS, drive_all};
use super::{ContactAnglesError, spread};
use crate::{Finding, LinePlot, Row, Series};
use bekker::obstacle::Obstacle;
use bekker::rover::Rover;
use bekker::terrain::Terrain;

/// Width of the rock over its height: half an ellipse, a little flatter than half a circle.
const WIDTH: f64 = 8.0 / 3.0;
/// Where its top is and how far the rover drives, m: all wheels get over it.
const POSITION: f64 = 0.6;
const WAY: f64 = 1.1;

/// Wheels from rear to front.
pub(super) const WHEELS: [&str; 3] = ["rear", "middle", "front"];

/// Contact angles of the six-wheeled rover over a rock of half a wheel diameter, over `trials` seeds of the sensors.
///
/// # Errors
/// [`ContactAnglesError`] where the drive or the estimator fails, or without trials.
pub fn rock(trials: u32) -> Result<Finding, ContactAnglesError> {
    let mut rows = Vec::new();
    let mut plots = Vec::new();
    for (gyroscope, with) in [(false, ""), (true, " with a gyroscope")] {
        let drive = Drive {
            terrain: Terrain::default(),
            obstacle: Some(stone()),
            way: WAY,
            gyroscope,
            believe: |_| (),
            seed: 0,
        };
        let driven = drive_all(&drive, trials)?;
        rows.extend(error_rows(&driven, with, [None; 3])?);
        rows.extend(consistency_rows(&driven, with)?);
        if let (false, Some(first)) = (gyroscope, driven.first()) {
            plots.push(plot(first));
        }
    }
    Ok(Finding {
        id: "contact_angles_rock".to_owned(),
        section: "2.6.2, figure 2.24".to_owned(),
        title: "Contact angles of the six-wheeled rover over a rock of half a wheel diameter".to_owned(),
        rows,
        plots,
        assumptions: vec![
            format!(
                "The rock is a rigid half ellipse as high as the wheel's radius and {WIDTH:.2} times as wide, of friction 0.7, \
                 on which the wheels of the plant of rigid bodies climb; the true angle is that of the contact force's normal."
            ),
            GROUND.to_owned(),
            SENSORS.to_owned(),
            "The filter's beliefs of ground and slip are the defaults of its vocabulary, R at 150 %.".to_owned(),
        ],
    })
}

/// A round rock as high as half a wheel diameter.
fn stone() -> Obstacle {
    let height = Rover::rocker_bogie().wheel.radius;
    Obstacle::rock(POSITION, height, WIDTH * height)
}

/// RMS errors wheel by wheel, front first, beside those of the thesis (rear, middle, front).
pub(super) fn error_rows(
    driven: &[Driven],
    with: &str,
    thesis: [Option<f64>; 3],
) -> Result<Vec<Row>, ContactAnglesError> {
    let most = driven.iter().map(|d| d.slip[0]).fold(0.0, f64::max);
    let mean = driven.iter().map(|d| d.slip[1]).sum::<f64>() / driven.len().max(1) as f64;
    let reason = format!(
        "Noise of the sensors is assumed; slip, taken as 0 with a deviation of 10 %, is {:.0} % on the average and {:.0} % at \
         most: where one wheel of a pair climbs alone, the difference of the speeds would tell which, and slip hides it.",
        100.0 * mean,
        100.0 * most
    );
    let row = |k: usize| {
        let quantity = format!("RMS error of the {} contact angle{with}, deg", WHEELS[k]);
        let ours = spread(&quantity, driven.iter().map(|d| d.errors[k].to_degrees()))?;
        Ok(Row { quantity, thesis: thesis[k], ours, reason: reason.clone() })
    };
    [2, 1, 0].into_iter().map(row).collect()
}

/// Whether errors are as large as the filters believe.
pub(super) fn consistency_rows(driven: &[Driven], with: &str) -> Result<Vec<Row>, ContactAnglesError> {
    let reason =
        "The filters reckon with lasting slip of 10 % and ground of 15 deg everywhere: below 1 where there is less.";
    let mut rows = Vec::new();
    for k in [2, 1, 0] {
        let quantity = format!("mean square of the {} error over its variance{with} (1 is consistent)", WHEELS[k]);
        let ours = spread(&quantity, driven.iter().map(|d| d.nees[k]))?;
        rows.push(Row { quantity, thesis: None, ours, reason: reason.to_owned() });
    }
    let quantity = format!("normalised innovation squared over its degrees of freedom{with} (1 is consistent)");
    let ours = spread(&quantity, driven.iter().map(|d| d.nis))?;
    rows.push(Row { quantity, thesis: None, ours, reason: "R at 150 %.".to_owned() });
    let quantity = format!("restarts of filters that had lost their way{with}");
    let ours = spread(&quantity, driven.iter().map(|d| f64::from(d.restarts)))?;
    rows.push(Row { quantity, thesis: None, ours, reason: "A linearised filter can lock in.".to_owned() });
    Ok(rows)
}

/// One line of a drive: true (0) or estimated (1) angle of wheel `k`.
pub(super) fn line(driven: &Driven, which: usize, k: usize, name: &str) -> Series {
    let y = driven.course.iter().step_by(5).map(|angles| angles[which][k].to_degrees()).collect();
    Series { name: name.to_owned(), x: driven.time.iter().step_by(5).copied().collect(), y }
}

fn plot(driven: &Driven) -> LinePlot {
    let mut series = Vec::new();
    for k in [2, 1, 0] {
        series.push(line(driven, 1, k, &format!("{} wheel, estimated", WHEELS[k])));
        series.push(line(driven, 0, k, &format!("{} wheel, true", WHEELS[k])));
    }
    LinePlot {
        id: "figure_2_24".to_owned(),
        title: "Contact angles over a rock of half a wheel diameter".to_owned(),
        x_label: "time, s".to_owned(),
        y_label: "contact angle, deg".to_owned(),
        series,
    }
}
