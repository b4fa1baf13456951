//! Section 4.4.2: the six-wheeled FSRL rover and a ditch of loose sand; go or no-go, and the normal forces.

use super::contender::{Contender, FIELD};
use super::drive::{Course, Drive, drive};
use super::{Finding, Plot, ReproductionError, Row, Series, Spread};
use crate::model::{Distribution, Model, Variation};
use crate::parallel::map_in_order;
use crate::rover::Rover;
use crate::terrain::{Ditch, LooseDitch};

/// Commanded speed, m/s: near the drives' 8 cm/s.
pub(super) const SPEED: f64 = 0.07;
/// Through the ditch and half a metre beyond.
pub(super) const COURSE: Course = Course { length: 1.8, time_limit: 90.0, sample: 0.02 };
/// Wheel diameter, m.
const DIAMETER: f64 = 0.128;
/// Where the deepest place is, m.
const POSITION: f64 = 0.8;
/// Depths that are tried, wheel diameters; the last is the thesis's.
const DEPTHS: [f64; 4] = [0.25, 0.5, 0.75, 1.0];
/// Go/no-go trials of the thesis: 14 and 6 of 20.
const PUBLISHED: [(&str, f64); 2] = [("RTC", 70.0), ("velocity control", 30.0)];

/// What differs from trial to trial: the thesis says that the ditch's width varied from two to four diameters and that its
/// depth was about one; the scatter of depth, soil and speed is assumed.
fn scatter(depth: f64) -> [Variation; 6] {
    let deep = depth * DIAMETER;
    [
        Variation::new("terrain.width", Distribution::Uniform { low: 2.0 * DIAMETER, high: 4.0 * DIAMETER }),
        Variation::new("terrain.depth", Distribution::Uniform { low: 0.8 * deep, high: 1.2 * deep }),
        Variation::new("soil.friction_angle", Distribution::Normal { deviation: 0.03 }),
        Variation::new("soil.k_phi", Distribution::Factor { low: 0.7, high: 1.4 }),
        Variation::new("soil.shear_modulus", Distribution::Factor { low: 0.7, high: 1.4 }),
        Variation::new("rover.centre_of_mass_x", Distribution::Normal { deviation: 0.005 }),
    ]
}

/// The rover before a ditch of about `depth` wheel diameters; everything that scatters is drawn from the stream of `seed`.
pub(super) fn model(contender: &Contender, depth: f64, seed: u32) -> Result<Model, ReproductionError> {
    let mut model = Model::new("fsrl_ditch", Rover::fsrl());
    let ditch = Ditch { depth: DIAMETER, width: 3.0 * DIAMETER, position: POSITION };
    let loose = |ditch| LooseDitch { ditch, cohesion: 180.0, modulus_factor: 0.5 };
    let firm = model.rover.soil.cohesion;
    model.rover.terrain = loose(ditch).terrain(firm)?;
    let (mut model, drawn) = model.varied(&scatter(depth), u64::from(seed))?;
    // The loose sand is as wide as the ditch that was drawn.
    let ditch = Ditch { width: drawn[0], depth: drawn[1], ..ditch };
    model.rover.terrain = loose(ditch).terrain(firm)?;
    model.stepping.seed = seed;
    model.control.lighten();
    (contender.apply)(&mut model);
    Ok(model)
}

/// Go/no-go trials by the ditch's depth, and the normal forces during one of them.
///
/// # Errors
/// Whatever a drive says.
pub fn ditch(trials: usize) -> Result<Vec<Finding>, ReproductionError> {
    let by_depth = DEPTHS.iter().map(|&depth| crossings(depth, trials.max(1)));
    let by_depth: Vec<Vec<Vec<Drive>>> = by_depth.collect::<Result<_, _>>()?;
    let crossed = |k: usize, done: &[Vec<Drive>]| {
        100.0 * done.iter().filter(|drives| drives[k].completed).count() as f64 / done.len() as f64
    };
    let last = DEPTHS[DEPTHS.len() - 1];
    let rows = FIELD.iter().enumerate().flat_map(|(k, contender)| {
        let published = PUBLISHED.iter().find(|(name, _)| *name == contender.name).map(|(_, share)| *share);
        DEPTHS.iter().zip(&by_depth).map(move |(&depth, done)| Row {
            quantity: format!("{}: ditches of {depth} wheel diameters crossed, %", contender.name),
            thesis: published.filter(|_| depth == last),
            ours: Spread { trials: done.len(), ..Spread::exact(crossed(k, done)) },
            reason:
                "20 trials each in the thesis; the ditch's shape, its soil, the scatter and the commands are not given"
                    .to_owned(),
        })
    });
    let mut rows: Vec<Row> = rows.collect();
    let deepest = by_depth.iter().rev().find(|done| done.iter().any(|drives| drives[1].completed));
    let shown = deepest.unwrap_or(&by_depth[0]);
    rows.extend(load_shares(&shown[0][0]));
    let lines = FIELD.iter().enumerate().map(|(k, contender)| Series {
        name: contender.name.to_owned(),
        x: DEPTHS.to_vec(),
        y: by_depth.iter().map(|done| crossed(k, done)).collect(),
    });
    let mut plots = vec![Plot {
        id: "ditch_crossed".to_owned(),
        title: "Ditches crossed, by depth".to_owned(),
        x_label: "depth, wheel diameters".to_owned(),
        y_label: "crossed, %".to_owned(),
        series: lines.collect(),
    }];
    plots.extend(time_histories(shown));
    Ok(vec![Finding {
        id: "ditch".to_owned(),
        section: "4.4.2, figures 4.11 to 4.13".to_owned(),
        title: "Go/no-go across a ditch of loose sand, FSRL rover".to_owned(),
        rows,
        plots,
        assumptions: assumptions(),
    }])
}

/// Drives over ditches of one depth: for every seed, one a contender.
fn crossings(depth: f64, trials: usize) -> Result<Vec<Vec<Drive>>, ReproductionError> {
    let seeds: Vec<u32> = (0..trials as u32).collect();
    let of_seed = |&seed: &u32| -> Result<Vec<Drive>, ReproductionError> {
        FIELD.iter().map(|contender| drive(&model(contender, depth, seed)?, SPEED, &COURSE)).collect()
    };
    map_in_order(&seeds, of_seed).into_iter().collect()
}

/// Static shares of the weight, and how far the loads vary during the crossing.
fn load_shares(drive: &Drive) -> Vec<Row> {
    let mut rows = Vec::new();
    let loads: Vec<&[f64]> = (1..=3).map(|k| drive.column(["", WHEEL_1, WHEEL_2, WHEEL_3][k])).collect();
    let weight: f64 = loads.iter().filter_map(|load| load.first()).sum();
    for ((load, wheel), thesis) in loads.iter().zip(["rear", "middle", "front"]).zip([49.0, 35.0, 16.0]) {
        let Some(first) = load.first() else { continue };
        rows.push(Row {
            quantity: format!("share of the weight on the {wheel} wheel at rest, %"),
            thesis: Some(thesis),
            ours: Spread::exact(100.0 * first / weight),
            reason: "Pivot and centre of mass are placed by these shares; unequal sinkage tilts the rover a little"
                .to_owned(),
        });
        let change = load.iter().map(|now| 100.0 * (now / first - 1.0).abs()).fold(0.0, f64::max);
        rows.push(Row {
            quantity: format!("largest change of the {wheel} wheel's load while crossing, %"),
            thesis: None,
            ours: Spread::exact(change),
            reason: "\"As much as 87 %\" in the thesis, for which wheel is not said; true forces of the first trial"
                .to_owned(),
        });
    }
    rows
}

const WHEEL_1: &str = "wheel[1].normal_force";
const WHEEL_2: &str = "wheel[2].normal_force";
const WHEEL_3: &str = "wheel[3].normal_force";

/// Figures 4.12 and 4.13 of the first trial that RTC completes, of the deepest ditches of which it crosses any.
fn time_histories(done: &[Vec<Drive>]) -> Vec<Plot> {
    let best = FIELD.len().min(2) - 1;
    let drive = done.iter().map(|drives| &drives[best]).find(|drive| drive.completed).unwrap_or(&done[0][best]);
    let lines = |signal: &str, factor: f64| -> Vec<Series> {
        let names = [(3, "front"), (2, "middle"), (1, "rear")];
        let line = |(k, name): (usize, &str)| {
            let y = drive.column(&format!("wheel[{k}].{signal}")).iter().map(|value| factor * value).collect();
            drive.series(name, "time", y)
        };
        names.into_iter().map(line).collect()
    };
    let plot = |id: &str, title: &str, y_label: &str, series: Vec<Series>| Plot {
        id: id.to_owned(),
        title: title.to_owned(),
        x_label: "time, s".to_owned(),
        y_label: y_label.to_owned(),
        series,
    };
    let angles = lines("contact_angle", 1f64.to_degrees());
    vec![
        plot("figure_4_12", "Figure 4.12: contact angles during the crossing (RTC)", "contact angle, degrees", angles),
        plot(
            "figure_4_13",
            "Figure 4.13: normal forces during the crossing (RTC)",
            "normal force, N",
            lines("normal_force", 1.0),
        ),
    ]
}

pub(super) fn assumptions() -> Vec<String> {
    let texts = [
        "One side of the rover in the plane with half the mass; geometry as `Rover::fsrl` states.",
        "Loose sand in the ditch: cohesion 0.18 kPa (the thesis's bevameter sand), half the stiffness of the dry sand around it.",
        "A cosine ditch of one diameter's depth and two to four diameters' width is up to 57 degrees steep, more than loose sand holds; the thesis does not give its shape.",
        "From trial to trial: width 2 to 4 and depth by 20 %, friction angle by 1.7 degrees, k_phi and K by 0.7 to 1.4, centre of mass by 5 mm.",
    ];
    texts.map(str::to_owned).to_vec()
}
