//! The simulation of 2.6.1: figures 2.22 and 2.23.

use super::wave::{Tracking, Wave};
use super::{ContactAnglesError, spread};
use crate::{Finding, LinePlot, Row, Series, Spread};
use bekker::estimation::consistency::chi_square_interval;
use bekker::parallel::map_in_order;

/// RMS errors of the thesis's filter, deg.
const PUBLISHED: [(&str, f64); 2] = [("front", 0.98), ("rear", 1.32)];

/// Ways over which the ground is taken as smooth for the bounds, m; the wave itself is smooth over more.
const KNOTS: [f64; 4] = [0.25, 0.5, 1.0, 2.0];

/// Points of a plotted line, about.
const POINTS: usize = 1600;

/// Contact angles of a two-wheeled vehicle on undulating ground, over `trials` seeds of noise; variations of the
/// assumptions over a tenth of them.
///
/// # Errors
/// [`ContactAnglesError::NoValue`] without trials.
pub fn undulating(trials: u32) -> Result<Finding, ContactAnglesError> {
    let wave = Wave::default();
    let tracked = track(&wave, trials);
    let mut rows = published(&tracked)?;
    rows.extend(beside(&wave, &tracked)?);
    for (what, varied) in variations() {
        let tracked = track(&varied, trials.div_ceil(10));
        for (side, name) in [(1, "front"), (0, "rear")] {
            let quantity = format!("RMS error of the {name} contact angle, {what}, deg");
            let ours = spread(&quantity, tracked.iter().map(|t| t.filter[side].to_degrees()))?;
            rows.push(Row { quantity, thesis: None, ours, reason: "Sensitivity to an assumption.".to_owned() });
        }
    }
    rows.extend(bound_rows(&wave));
    let mut plots = tracked.first().map(|tracking| plots(&wave, tracking)).unwrap_or_default();
    plots.push(bound_plot(&wave));
    Ok(Finding {
        id: "contact_angles_undulating".to_owned(),
        section: "2.6.1, figures 2.22 and 2.23".to_owned(),
        title: "Contact angles of a two-wheeled vehicle on undulating ground, from noisy pitch and speeds".to_owned(),
        rows,
        plots,
        assumptions: assumptions(&wave),
    })
}

fn track(wave: &Wave, trials: u32) -> Vec<Tracking> {
    let truth = wave.truth();
    let seeds: Vec<u64> = (0..u64::from(trials)).collect();
    map_in_order(&seeds, |seed| {
        let tracking = wave.track(&truth, *seed);
        // One course is plotted.
        if *seed == 0 { tracking } else { Tracking { course: Vec::new(), ..tracking } }
    })
}

/// What the thesis leaves open, one at a time.
fn variations() -> [(&'static str, Wave); 6] {
    let wave = Wave::default();
    [
        ("one reading a second", Wave { period: 1.0, ..wave }),
        ("a hundred readings a second", Wave { period: 0.01, ..wave }),
        ("waves of 3 m", Wave { wavelength: 3.0, ..wave }),
        ("waves of 6 m", Wave { wavelength: 6.0, ..wave }),
        ("ground four times as smooth in the filter", Wave { correlation_factor: 4.0, ..wave }),
        ("R at 100 %", Wave { covariance_factor: 1.0, ..wave }),
    ]
}

fn published(tracked: &[Tracking]) -> Result<Vec<Row>, ContactAnglesError> {
    let reason = "Decided by two things that the thesis does not state: how often it reads, and how smooth its filter takes the \
                  ground to be. Ten times a second no filter reaches the thesis's figure for the front wheel, not even one that \
                  knows the ground to be smooth over half a wave; a hundred times a second one may (bounds below and \
                  plot). Ours takes the ground for rough."
        .to_owned();
    let row = |name: &str, side: usize, thesis: f64| {
        let quantity = format!("RMS error of the {name} contact angle, extended Kalman filter, deg");
        let ours = spread(&quantity, tracked.iter().map(|t| t.filter[side].to_degrees()))?;
        Ok::<_, ContactAnglesError>(Row { quantity, thesis: Some(thesis), ours, reason: reason.clone() })
    };
    PUBLISHED.iter().zip([1, 0]).map(|((name, thesis), side)| row(name, side, *thesis)).collect()
}

fn beside(wave: &Wave, tracked: &[Tracking]) -> Result<Vec<Row>, ContactAnglesError> {
    let interval = |degrees| {
        // Errors are independent after one correlation length, roughly 1/k = wavelength/(2 pi).
        let [low, high] = chi_square_interval(degrees, (tracked.len() * 11).max(1));
        format!("{low:.2} to {high:.2}")
    };
    let unsolved = "Solved for means over a quarter of the distance; where the rate is within its noise or no triangle \
                    closes it reports that there is no solution.";
    let rows: [(String, Vec<f64>, String); 6] = [
        (
            "RMS error of the front contact angle, direct solution of means, where it has one, deg".to_owned(),
            tracked.iter().map(|t| t.direct[1].to_degrees()).collect(),
            unsolved.to_owned(),
        ),
        (
            "RMS error of the rear contact angle, direct solution of means, where it has one, deg".to_owned(),
            tracked.iter().map(|t| t.direct[0].to_degrees()).collect(),
            unsolved.to_owned(),
        ),
        (
            "instants at which the direct solution of means has one, %".to_owned(),
            tracked.iter().map(|t| 100.0 * t.direct_share).collect(),
            "Translation, where both angles are alike, has none (2.5).".to_owned(),
        ),
        (
            "readings at which the direct solution has one with the rate from two readings, %".to_owned(),
            tracked.iter().map(|t| 100.0 * t.raw_share).collect(),
            format!("The difference of two pitches {} s apart is noise.", wave.period),
        ),
        (
            "normalised estimation error squared of both angles (2 is consistent)".to_owned(),
            tracked.iter().map(|t| t.nees).collect(),
            format!(
                "95 % of means of a consistent filter lie in {}, with about eleven independent errors a trial; below: \
                 R at 150 % and ground taken as rougher than a pure wave.",
                interval(2)
            ),
        ),
        (
            "normalised innovation squared over its degrees of freedom (1 is consistent)".to_owned(),
            tracked.iter().map(|t| t.nis).collect(),
            "Below 1: R at 150 %, and the variance that the equations' second order adds.".to_owned(),
        ),
    ];
    let row = |(quantity, values, reason): (String, Vec<f64>, String)| {
        let ours = spread(&quantity, values)?;
        Ok::<_, ContactAnglesError>(Row { quantity, thesis: None, ours, reason })
    };
    rows.into_iter().map(row).collect()
}

/// Least errors that any filter can have, by how smooth the ground is known to be.
fn bound_rows(wave: &Wave) -> Vec<Row> {
    let mut rows = Vec::new();
    for knots in KNOTS {
        let Some(bound) = wave.bound(knots) else { continue };
        for (what, errors) in [("filter", bound.filter), ("smoother", bound.smoother)] {
            for (side, name) in [(1, "front"), (0, "rear")] {
                rows.push(Row {
                    quantity: format!(
                        "least RMS error of the {name} contact angle that any {what} can reach, ground known to be smooth \
                         over {knots} m, deg"
                    ),
                    thesis: None,
                    ours: Spread::exact(errors[side].to_degrees()),
                    reason: "Posterior Cramer-Rao bound; angles and speed are cubic splines with knots so far apart."
                        .to_owned(),
                });
            }
        }
    }
    rows
}

/// The bound over the smoothness of the ground at three rates of readings.
fn bound_plot(wave: &Wave) -> LinePlot {
    let line = |readings: f64| {
        let wave = Wave { period: 1.0 / readings, ..*wave };
        let of = |knots: &f64| wave.bound(*knots).map_or(f64::NAN, |bound| bound.filter[1].to_degrees());
        Series { name: format!("{readings} readings a second"), x: KNOTS.to_vec(), y: KNOTS.iter().map(of).collect() }
    };
    let mut series: Vec<Series> = [1.0, 10.0, 100.0].into_iter().map(line).collect();
    let thesis = vec![PUBLISHED[0].1; KNOTS.len()];
    series.push(Series { name: "the thesis's filter".to_owned(), x: KNOTS.to_vec(), y: thesis });
    LinePlot {
        id: "contact_angle_bound".to_owned(),
        title: "Least error of the front contact angle that any filter can reach".to_owned(),
        x_label: "way over which the ground is known to be smooth, m".to_owned(),
        y_label: "RMS error, deg".to_owned(),
        series,
    }
}

fn plots(wave: &Wave, tracking: &Tracking) -> Vec<LinePlot> {
    let every = tracking.course.len().div_ceil(POINTS).max(1);
    let plot = |id: &str, name: &str, side: usize| {
        let series = |(which, name): (usize, &str)| Series {
            name: name.to_owned(),
            x: (0..tracking.course.len()).step_by(every).map(|k| k as f64 * wave.period).collect(),
            y: tracking.course.iter().step_by(every).map(|angles| angles[which][side].to_degrees()).collect(),
        };
        LinePlot {
            id: id.to_owned(),
            title: format!("Contact angle of the {name} wheel on undulating ground"),
            x_label: "time, s".to_owned(),
            y_label: "contact angle, deg".to_owned(),
            series: [(1, "extended Kalman filter"), (2, "direct solution"), (0, "true")].map(series).into(),
        }
    };
    vec![plot("figure_2_23a", "front", 1), plot("figure_2_23b", "rear", 0)]
}

fn assumptions(wave: &Wave) -> Vec<String> {
    let slope = (wave.amplitude() * std::f64::consts::TAU / wave.wavelength).atan().to_degrees();
    vec![
        format!(
            "Figure 2.22 gives no numbers: a sine of {} m, whose amplitude of {:.3} m (steepest slope {slope:.1} deg) \
             follows from the pitch's range of 30 deg, of which 3 deg are the stated 10 %.",
            wave.wavelength,
            wave.amplitude(),
        ),
        format!(
            "The middle moves at {} cm/s, of which 0.05 cm/s are the stated 10 %; points, not wheels, follow the ground.",
            wave.speed * 100.0
        ),
        format!("{} readings a second, over two waves; the first quarter of a wave is the transient.", 1.0 / wave.period),
        "The pitch rate is not measured: it is a state of the filter.".to_owned(),
        "Q by rule, not tuned: contact angles have the deviation of the wave's slope and forget it over wavelength/(2 pi); \
         speeds may wander by their noise within that way; the rate as the angles do."
            .to_owned(),
        "The kinematic equations are measurements of zero with 0.1 % of the speed as error (the simulation's kinematics are exact), instead of angles from the direct \
         solution with a linearised R."
            .to_owned(),
    ]
}
