//! Section 3.3, table 3.1: paths of the rough-terrain planner beside those of the binary planner, on ground of three densities, each
//! driven by the core's planar rover.

use super::{Finding, LinePlot, ReproductionError, Row, Series, Spread};
use bekker::parallel::map_in_order;
use bekker_planning::map::Difficulty;
use bekker_planning::trial::{BINARY, Driven, FRICTION, Trial, trial};

/// Two-sided 95 % points of Student's distribution by degrees of freedom, 1 to 30; the normal distribution's beyond.
const STUDENT: [f64; 30] = [
    12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160, 2.145, 2.131, 2.120,
    2.110, 2.101, 2.093, 2.086, 2.080, 2.074, 2.069, 2.064, 2.060, 2.056, 2.052, 2.048, 2.045, 2.042,
];

/// A ground of table 3.1 and the thesis's numbers for it.
struct Ground {
    difficulty: Difficulty,
    name: &'static str,
    /// Mean lengths of the planner's and the binary planner's paths, m.
    lengths: [f64; 2],
    /// Mean time of planning, s.
    seconds: f64,
    /// Goals reached of ten by the planner and the binary planner.
    goals: [f64; 2],
}

const GROUNDS: [Ground; 3] = [
    Ground {
        difficulty: Difficulty::Benign,
        name: "benign",
        lengths: [6.02, 6.44],
        seconds: 35.5,
        goals: [10.0, 10.0],
    },
    Ground {
        difficulty: Difficulty::Moderate,
        name: "moderate",
        lengths: [6.34, 6.95],
        seconds: 40.5,
        goals: [10.0, 9.0],
    },
    Ground {
        difficulty: Difficulty::Difficult,
        name: "difficult",
        lengths: [6.95, 7.48],
        seconds: 118.1,
        goals: [9.0, 6.0],
    },
];

/// The comparison of table 3.1.
///
/// # Errors
/// Whatever a trial says.
pub fn paths(trials: usize) -> Result<Vec<Finding>, ReproductionError> {
    let seeds: Vec<u64> = (0..trials.max(1) as u64).collect();
    GROUNDS.iter().map(|ground| on_ground(ground, &seeds)).collect()
}

fn on_ground(ground: &Ground, seeds: &[u64]) -> Result<Finding, ReproductionError> {
    let done = map_in_order(seeds, |&seed| trial(ground.difficulty, seed, FRICTION, true));
    let done: Vec<Trial> = done.into_iter().collect::<Result<_, _>>()?;
    let mut rows = lengths(ground, &done);
    rows.extend(goals(ground, &done));
    rows.extend(safety(&done));
    let obstacles = ground.difficulty.density();
    Ok(Finding {
        id: format!("paths_{}", ground.name),
        section: "3.3, table 3.1".to_owned(),
        title: format!("Paths over {} ground ({obstacles} obstacles a rover's area)", ground.name),
        rows,
        plots: figures(ground.name, &done),
        assumptions: vec![
            "The thesis gives the density of obstacles and no ground. Here rocks and pits lie evenly over gentle swells, half of them \
             higher than a wheel's radius, as many as make that density. On hummocky ground of the same density, 35 degrees \
             steep on the average, the planner's path was longer by a quarter and a half in the two trials made."
                .to_owned(),
            format!("Coefficient of friction {FRICTION}; plans count on what of it the wheels transmit at 50 % slip."),
            "A path is driven from rest in each of its straight stretches by half of the robot, over the mean of the heights under its \
             left and right wheels, at 8 cm/s; turns in place are not driven."
                .to_owned(),
        ],
    })
}

/// Lengths and times, and the paired difference where both planners find a path.
fn lengths(ground: &Ground, trials: &[Trial]) -> Vec<Row> {
    let [planner, binary] = ground.lengths;
    let mut rows = Vec::new();
    let mut add = |quantity: String, thesis, ours: Option<Spread>, reason: &str| {
        rows.extend(ours.map(|ours| Row { quantity, thesis, ours, reason: reason.to_owned() }));
    };
    let ours = Spread::of(trials.iter().filter_map(|trial| trial.length));
    add(
        "rough-terrain planner: length, m".to_owned(),
        Some(planner),
        ours,
        "Starts and goals are other ones, at least 5 m apart as there",
    );
    for (k, share) in BINARY.iter().enumerate() {
        let percent = 100.0 * share;
        let name = format!("binary planner, obstacles over {percent:.0} % of a wheel's diameter");
        let published = (k == 0).then_some(binary);
        let length = |trial: &Trial| trial.binary[k].length;
        let ours = Spread::of(trials.iter().filter_map(length));
        add(format!("{name}: length, m"), published, ours, "As above; it looks at single nodes, not at the rover");
        // Sums of the same steps in another order differ by rounding.
        let beyond =
            |ours: f64, theirs: f64| if (ours - theirs).abs() < 1e-9 { 0.0 } else { 100.0 * (ours / theirs - 1.0) };
        let both = trials.iter().filter_map(|trial| Some(beyond(trial.length?, length(trial)?)));
        let both: Vec<f64> = both.collect();
        let published = published.map(|binary| 100.0 * (planner / binary - 1.0));
        let reason = "Where both find a path. What the binary planner calls free includes flanks of 60 degrees, which the evaluation \
                      refuses; steps that it calls obstacles and the rover passes are rare on this ground";
        add(format!("planner's path beyond that of the {name}, %"), None, Spread::of(both.iter().copied()), reason);
        let interval = mean_with_interval(&both);
        add(
            format!("planner's path beyond that of the {name}, mean with its paired 95 % interval, %"),
            published,
            interval,
            "Student's interval of the mean difference, in place of quantiles",
        );
    }
    let ours = Spread::of(trials.iter().map(|trial| trial.seconds));
    add("time of planning, s".to_owned(), Some(ground.seconds), ours, "Theirs on a Pentium of 300 MHz");
    rows
}

/// Mean of paired differences with Student's 95 % interval; none of fewer than two.
fn mean_with_interval(values: &[f64]) -> Option<Spread> {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let point = STUDENT.get(values.len().checked_sub(2)?).copied().unwrap_or(1.96);
    let half = point * (variance / count).sqrt();
    Some(Spread { median: mean, low: mean - half, high: mean + half, trials: values.len() })
}

fn share_of(trials: &[Trial], of: f64, holds: impl Fn(&Trial) -> bool) -> Spread {
    let count = trials.iter().filter(|trial| holds(trial)).count();
    Spread { trials: trials.len(), ..Spread::exact(of * count as f64 / trials.len() as f64) }
}

fn goals(ground: &Ground, trials: &[Trial]) -> Vec<Row> {
    let [planner, binary] = ground.goals;
    let row = |quantity: String, thesis, ours, reason: &str| Row { quantity, thesis, ours, reason: reason.to_owned() };
    let safe = |k: usize| move |trial: &Trial| trial.binary[k].length.is_some() && trial.binary[k].unsafe_stands == 0;
    let mut rows = vec![row(
        "rough-terrain planner: goals reached, of 10".to_owned(),
        Some(planner),
        share_of(trials, 10.0, |trial| trial.length.is_some()),
        "Starts and goals on which the rover cannot stand count as not reached",
    )];
    for (k, share) in BINARY.iter().enumerate() {
        let name = format!("binary planner at {:.0} %", 100.0 * share);
        let reached = share_of(trials, 10.0, |trial| trial.binary[k].length.is_some());
        let reason = "With paths on which the rover would fail";
        rows.push(row(format!("{name}: goals reached, of 10"), (k == 0).then_some(binary), reached, reason));
        let reason = "Goals whose path keeps pose, stability and forces at each node";
        rows.push(row(format!("{name}: goals reached safely, of 10"), None, share_of(trials, 10.0, safe(k)), reason));
    }
    rows
}

/// What the drives say.
fn safety(trials: &[Trial]) -> Vec<Row> {
    let with = |drive: &dyn Fn(&Trial) -> Option<&Driven>| -> Option<Spread> {
        let all: Vec<&Driven> = trials.iter().filter_map(drive).collect();
        let arrived = all.iter().filter(|driven| matches!(driven, Driven::Driven(drive) if drive.reached)).count();
        (!all.is_empty())
            .then(|| Spread { trials: all.len(), ..Spread::exact(100.0 * arrived as f64 / all.len() as f64) })
    };
    let energy = |driven: &Option<Driven>| match driven {
        Some(Driven::Driven(drive)) if drive.reached => Some(drive.energy / drive.length),
        _ => None,
    };
    let both = trials.iter().filter_map(|trial| Some(energy(&trial.rtc)? - energy(&trial.drive)?));
    let difference = Spread::of(both);
    let rows = [
        (
            "rough-terrain planner: paths driven to the end, velocity control, %",
            with(&|trial| trial.drive.as_ref()),
            "By the core's planar rover",
        ),
        (
            "rough-terrain planner: paths driven to the end, RTC, %",
            with(&|trial| trial.rtc.as_ref()),
            "With wheel-speed loops",
        ),
        (
            "binary planner at 80 %: paths driven to the end, %",
            with(&|trial| trial.binary[0].drive.as_ref()),
            "Velocity control",
        ),
        (
            "binary planner at 120 %: paths driven to the end, %",
            with(&|trial| trial.binary[1].drive.as_ref()),
            "Velocity control",
        ),
        (
            "planner's paths: electrical energy a metre, RTC less velocity control, J/m",
            difference,
            "Paired, at the same commanded speed",
        ),
    ];
    let row = |(quantity, ours, reason): (&str, Option<Spread>, &str)| {
        Some(Row { quantity: quantity.to_owned(), thesis: None, ours: ours?, reason: reason.to_owned() })
    };
    rows.into_iter().filter_map(row).collect()
}

/// Figure 3.9 for the trial in which the planners differ most, and the margins along the planner's path.
fn figures(ground: &str, trials: &[Trial]) -> Vec<LinePlot> {
    let differs = |trial: &Trial| Some((trial.length? - trial.binary[0].length?).abs());
    let most = trials.iter().filter_map(|trial| Some((differs(trial)?, trial))).max_by(|a, b| a.0.total_cmp(&b.0));
    let Some((_, trial)) = most else { return Vec::new() };
    let line = |name: String, places: Vec<[f64; 2]>| Series {
        name,
        x: places.iter().map(|place| place[0]).collect(),
        y: places.iter().map(|place| place[1]).collect(),
    };
    let mut series =
        vec![line("rough-terrain planner".to_owned(), trial.points.iter().map(|point| point.place).collect())];
    series.extend(
        BINARY
            .iter()
            .zip(&trial.binary)
            .filter(|(_, binary)| !binary.points.is_empty())
            .map(|(share, binary)| line(format!("binary planner, {:.0} %", 100.0 * share), binary.points.clone())),
    );
    let along = |name: &str, value: &dyn Fn(&bekker_planning::trial::TrialPoint) -> f64| Series {
        name: name.to_owned(),
        x: trial.points.iter().map(|point| point.travelled).collect(),
        y: trial.points.iter().map(value).collect(),
    };
    vec![
        LinePlot {
            id: format!("figure_3_9_{ground}"),
            title: format!("Figure 3.9: paths over {ground} ground, trial {}", trial.seed),
            x_label: "x, m".to_owned(),
            y_label: "y, m".to_owned(),
            series,
        },
        LinePlot {
            id: format!("margins_{ground}"),
            title: format!("Margins along the planner's path, {ground} ground, trial {}", trial.seed),
            x_label: "way, m".to_owned(),
            y_label: "stability angle, degrees; largest thrust, N".to_owned(),
            series: vec![
                along("stability angle", &|point| point.stability.to_degrees()),
                along("largest thrust", &|point| point.thrust),
            ],
        },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_student_interval_of_a_mean() {
        // 1, 2, 3: mean 2, standard error 1/sqrt 3, two degrees of freedom.
        let spread = mean_with_interval(&[1.0, 2.0, 3.0]).unwrap_or(Spread::exact(0.0));
        assert!((spread.high - 2.0 - 4.303 / 3.0_f64.sqrt()).abs() < 1e-9 && spread.median == 2.0, "{spread:?}");
        assert_eq!(mean_with_interval(&[1.0]), None);
    }

    #[test]
    fn property_one_trial_makes_rows_and_figures() -> Result<(), ReproductionError> {
        let finding = on_ground(&GROUNDS[0], &[1])?;
        assert!(finding.rows.iter().any(|row| row.thesis == Some(6.02)) && finding.plots.len() == 2, "{finding:?}");
        let driven = finding.rows.iter().find(|row| row.quantity.contains("velocity control, %"));
        assert_eq!(driven.map(|row| row.ours.median), Some(100.0));
        Ok(())
    }
}
