//! The simulation of 2.6.1: figures 2.22 and 2.23.

use super::bound::Bound;
use super::wave::{Tracking, Wave};
use super::{ContactAnglesError, spread};
use crate::{Finding, LinePlot, Row, Series, Spread};
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
    for (what, varied, share) in variations() {
        rows.extend(varied_rows(what, &track(&varied, trials.div_ceil(share)))?);
    }
    rows.extend(bound_rows(&wave, ""));
    rows.extend(bound_rows(&wave.speeds_in_range(), IN_RANGE));
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

/// The other reading of the speeds' noise, in words.
const IN_RANGE: &str = ", speed noise a tenth of the speeds' range";

/// What the thesis leaves open, and over which share of the trials.
fn variations() -> [(String, Wave, u32); 9] {
    let wave = Wave::default();
    let ranging = wave.speeds_in_range();
    let often = |wave: Wave, readings: f64| Wave { period: 1.0 / readings, ..wave };
    [
        (", 50 readings a second".to_owned(), often(wave, 50.0), 2),
        (IN_RANGE.to_owned(), ranging, 1),
        (format!("{IN_RANGE}, 50 readings a second"), often(ranging, 50.0), 1),
        (format!("{IN_RANGE}, 100 readings a second"), often(ranging, 100.0), 1),
        (", one reading a second".to_owned(), often(wave, 1.0), 10),
        (", a hundred readings a second".to_owned(), often(wave, 100.0), 10),
        (", waves of 3 m".to_owned(), Wave { wavelength: 3.0, ..wave }, 10),
        (", waves of 6 m".to_owned(), Wave { wavelength: 6.0, ..wave }, 10),
        (", ground half as smooth in the filter".to_owned(), Wave { correlation_factor: 0.5, ..wave }, 10),
    ]
}

fn varied_rows(what: String, tracked: &[Tracking]) -> Result<Vec<Row>, ContactAnglesError> {
    let error = |side: usize| tracked.iter().map(move |t| t.ground.errors[side].to_degrees()).collect::<Vec<f64>>();
    let rows = [
        (format!("RMS error of the front contact angle{what}, deg"), error(1)),
        (format!("RMS error of the rear contact angle{what}, deg"), error(0)),
        (
            format!("normalised estimation error squared of both angles{what} (2 is consistent)"),
            tracked.iter().map(|t| t.ground.nees).collect(),
        ),
    ];
    let row = |(quantity, values): (String, Vec<f64>)| {
        let ours = spread(&quantity, values)?;
        Ok(Row { quantity, thesis: None, ours, reason: "Sensitivity to an assumption.".to_owned() })
    };
    rows.into_iter().map(row).collect()
}

fn published(tracked: &[Tracking]) -> Result<Vec<Row>, ContactAnglesError> {
    let reason = "Decided by two things that the thesis does not state: how often it reads, and how smooth its filter takes the                   ground to be. Ours knows that both wheels cross one smooth ground, so that the rear angle, for which                   readings from before and behind are there, comes out better than the front one; the thesis's order is the                   reverse (bounds below and plot)."
        .to_owned();
    let row = |name: &str, side: usize, thesis: f64| {
        let quantity = format!("RMS error of the {name} contact angle, extended Kalman filter, deg");
        let ours = spread(&quantity, tracked.iter().map(|t| t.ground.errors[side].to_degrees()))?;
        Ok::<_, ContactAnglesError>(Row { quantity, thesis: Some(thesis), ours, reason: reason.clone() })
    };
    PUBLISHED.iter().zip([1, 0]).map(|((name, thesis), side)| row(name, side, *thesis)).collect()
}

fn beside(wave: &Wave, tracked: &[Tracking]) -> Result<Vec<Row>, ContactAnglesError> {
    let alone = "The thesis's filter with a Gauss-Markov ground under each wheel by itself, R at 150 %: what was under the front                  wheel is not used for the rear one.";
    let unsolved = "Solved for means over a quarter of the distance; where the rate is within its noise or no triangle                     closes it reports that there is no solution.";
    let degrees = |of: fn(&Tracking) -> f64| tracked.iter().map(|t| of(t).to_degrees()).collect::<Vec<f64>>();
    let plain = |of: fn(&Tracking) -> f64| tracked.iter().map(of).collect::<Vec<f64>>();
    let rows: [(&str, Vec<f64>, String); 9] = [
        (
            "normalised estimation error squared of both angles (2 is consistent)",
            plain(|t| t.ground.nees),
            "Below 2: a wave is smoother than the process that the filter takes it for.".to_owned(),
        ),
        (
            "normalised innovation squared over its degrees of freedom (1 is consistent)",
            plain(|t| t.ground.nis),
            "Below 1: the variance of the speeds' second order counts as lasting.".to_owned(),
        ),
        (
            "RMS error of the front contact angle, filter of a pair, deg",
            degrees(|t| t.pair.errors[1]),
            alone.to_owned(),
        ),
        ("RMS error of the rear contact angle, filter of a pair, deg", degrees(|t| t.pair.errors[0]), alone.to_owned()),
        (
            "normalised estimation error squared of both angles, filter of a pair (2 is consistent)",
            plain(|t| t.pair.nees),
            "R at 150 %, and ground taken as rougher than a pure wave.".to_owned(),
        ),
        (
            "RMS error of the front contact angle, direct solution of means, where it has one, deg",
            degrees(|t| t.direct[1]),
            unsolved.to_owned(),
        ),
        (
            "RMS error of the rear contact angle, direct solution of means, where it has one, deg",
            degrees(|t| t.direct[0]),
            unsolved.to_owned(),
        ),
        (
            "instants at which the direct solution of means has one, %",
            plain(|t| 100.0 * t.direct_share),
            "Translation, where both angles are alike, has none (2.5).".to_owned(),
        ),
        (
            "readings at which the direct solution has one with the rate from two readings, %",
            plain(|t| 100.0 * t.raw_share),
            format!("The difference of two pitches {} s apart is noise.", wave.period),
        ),
    ];
    let row = |(quantity, values, reason): (&str, Vec<f64>, String)| {
        let ours = spread(quantity, values)?;
        Ok(Row { quantity: quantity.to_owned(), thesis: None, ours, reason })
    };
    rows.into_iter().map(row).collect()
}

/// Least errors that any filter can have, by how smooth the ground is known to be, and whether it is known to be one.
fn bound_rows(wave: &Wave, reading: &str) -> Vec<Row> {
    let mut rows = Vec::new();
    for (ground, of) in [
        (
            "one ground under both wheels, known to be smooth over",
            Wave::ground_bound as fn(&Wave, f64) -> Option<Bound>,
        ),
        ("ground known to be smooth over", Wave::bound),
    ] {
        for knots in KNOTS {
            let Some(bound) = of(wave, knots) else { continue };
            for (what, errors) in [("filter", bound.filter), ("smoother", bound.smoother)] {
                for (side, name) in [(1, "front"), (0, "rear")] {
                    rows.push(Row {
                        quantity: format!(
                            "least RMS error of the {name} contact angle that any {what} can reach, {ground} {knots} m{reading}, deg"
                        ),
                        thesis: None,
                        ours: Spread::exact(errors[side].to_degrees()),
                        reason: "Posterior Cramer-Rao bound; angles and speed are cubic splines with knots so far apart."
                            .to_owned(),
                    });
                }
            }
        }
    }
    rows
}

/// The bound over the smoothness of the ground at three rates of readings.
fn bound_plot(wave: &Wave) -> LinePlot {
    let line = |readings: f64| {
        let wave = Wave { period: 1.0 / readings, ..*wave };
        let of = |knots: &f64| wave.ground_bound(*knots).map_or(f64::NAN, |bound| bound.filter[1].to_degrees());
        Series { name: format!("{readings} readings a second"), x: KNOTS.to_vec(), y: KNOTS.iter().map(of).collect() }
    };
    let mut series: Vec<Series> = [1.0, 10.0, 100.0].into_iter().map(line).collect();
    let thesis = vec![PUBLISHED[0].1; KNOTS.len()];
    series.push(Series { name: "the thesis's filter".to_owned(), x: KNOTS.to_vec(), y: thesis });
    LinePlot {
        id: "contact_angle_bound".to_owned(),
        title: "Least error of the front contact angle that any filter can reach".to_owned(),
        x_label: "way over which the one ground is known to be smooth, m".to_owned(),
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
        "Q of the ground's filter: the slope is a process with the deviation of the wave's slope, whose autocorrelation falls to \
         1/e over 0.4 waves (chosen where its errors are as large as it believes, over other trials than these); the speed may \
         wander by its noise within that way. R as it is. The thesis's R at 150 % is in the filter of a pair, whose angles \
         forget over wavelength/(2 pi)."
            .to_owned(),
        format!(
            "Read as the pitch's 3 of 30 deg are, 10 % of the speeds' range ask for a speed of {:.1} cm/s, at which the wheels' \
             speeds range over 0.5 cm/s; rows with \"{}\".",
            wave.speeds_in_range().speed * 100.0,
            IN_RANGE.trim_start_matches(", "),
        ),
        "In the filter of a pair the kinematic equations are measurements of zero with 0.1 % of the speed as error, instead of angles from the direct \
         solution with a linearised R; the ground's filter has them built in, with 0.01 %."
            .to_owned(),
    ]
}
