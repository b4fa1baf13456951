//! Section 3.5.1, figure 3.15: the Sample Return Rover over rough ground with and without reconfiguration.

use super::{Finding, LinePlot, ReproductionError, Row, Series, Spread};
use bekker::parallel::map_in_order;
use bekker_planning::map::{GroundShape, Interpolation, Surface, generated};
use bekker_planning::pose::{Placing, Pose};
use bekker_planning::reconfigure::{Reconfiguration, Stance};
use bekker_planning::robot::{Robot, sample_return};
use bekker_planning::stability::stability;
use nalgebra::Vector3;

/// The thesis gives neither ground nor weights nor the rover's lengths; those here were fixed before the first run.
const GROUND: GroundShape = GroundShape { nodes: 161, cell: 0.04, feature: 0.25, roughness: 0.08, swell: 0.15 };
/// From here to there along the middle of the ground, m, in steps of 5 cm: a second at the rover's 6 cm/s.
const WAY: [f64; 2] = [1.0, 5.4];
const STEP: f64 = 0.05;
/// The shoulders, which (3.24) draws to their nominal angles; the arm is free.
const SHOULDERS: usize = 2;
const GRAVITY: f64 = 9.81;

/// Margins over the way, degrees.
struct Margins {
    way: Vec<f64>,
    fixed: Vec<f64>,
    moved: Vec<f64>,
}

/// Figure 3.15.
///
/// # Errors
/// Whatever pose or optimisation say.
pub fn reconfiguration(trials: usize) -> Result<Vec<Finding>, ReproductionError> {
    let seeds: Vec<u64> = (0..trials.max(1) as u64).collect();
    let done: Vec<Margins> = map_in_order(&seeds, |&seed| drive(seed)).into_iter().collect::<Result<_, _>>()?;
    let mean = |margins: &[f64]| margins.iter().sum::<f64>() / margins.len() as f64;
    let least = |margins: &[f64]| margins.iter().copied().fold(f64::INFINITY, f64::min);
    let of = |value: &dyn Fn(&Margins) -> f64| Spread::of(done.iter().map(value));
    let published = [
        ("mean margin gained by reconfiguration, %", 37.1, of(&|m| 100.0 * (mean(&m.moved) / mean(&m.fixed) - 1.0))),
        ("smallest margin of the fixed rover, degrees", 1.1, of(&|m| least(&m.fixed))),
        ("smallest margin of the reconfigured rover, degrees", 12.5, of(&|m| least(&m.moved))),
    ];
    let reason = "The thesis's ground, weights and lengths are not known; with those assumed here the rover lowers its body and gains more";
    let rows = published.into_iter().filter_map(|(quantity, thesis, ours)| {
        Some(Row { quantity: quantity.to_owned(), thesis: Some(thesis), ours: ours?, reason: reason.to_owned() })
    });
    let first = &done[0];
    let series = |name: &str, y: &[f64]| Series { name: name.to_owned(), x: first.way.clone(), y: y.to_vec() };
    Ok(vec![Finding {
        id: "reconfiguration".to_owned(),
        section: "3.5.1, figure 3.15".to_owned(),
        title: "Sample Return Rover with and without reconfiguration".to_owned(),
        rows: rows.collect(),
        plots: vec![LinePlot {
            id: "figure_3_15".to_owned(),
            title: "Figure 3.15: stability margin (trial 0)".to_owned(),
            x_label: "way, m".to_owned(),
            y_label: "stability angle, degrees".to_owned(),
            series: vec![series("reconfigured", &first.moved), series("fixed", &first.fixed)],
        }],
        assumptions: vec![
            "Hummocky ground, another a trial; poses every 5 cm; weights of (3.24) 1 rad for each angle and 0.5 for the shoulders; a barrier \
             keeps the belly off the ground."
                .to_owned(),
        ],
    }])
}

/// Pose and margin (rad) at a place; none where the rover cannot stand.
fn stand(robot: &Robot, ground: &Surface, active: &[f64], x: f64) -> Option<(Pose, f64)> {
    let pose = Placing::new(robot, ground, active).ok()?.pose([x, 3.2], 0.0, None).ok()?;
    let weight = robot.total_mass() * GRAVITY;
    let margin = stability(&pose, weight, Vector3::zeros(), Vector3::zeros()).ok()?.margin;
    Some((pose, margin))
}

fn drive(seed: u64) -> Result<Margins, ReproductionError> {
    let robot = sample_return();
    let ground = Surface::new(generated(&GROUND, seed)?, Interpolation::Smooth);
    let nominal = vec![0.0; robot.active()];
    let mut active = nominal.clone();
    let mut margins = Margins { way: Vec::new(), fixed: Vec::new(), moved: Vec::new() };
    let steps = ((WAY[1] - WAY[0]) / STEP) as usize;
    for k in 0..=steps {
        let x = WAY[0] + STEP * k as f64;
        let (fixed, moved) = (stand(&robot, &ground, &nominal, x), stand(&robot, &ground, &active, x));
        let (Some((_, without)), Some((pose, with))) = (fixed, moved) else { continue };
        margins.way.push(x - WAY[0]);
        margins.fixed.push(without.to_degrees());
        margins.moved.push(with.to_degrees());
        let placing = Placing::new(&robot, &ground, &active)?;
        active = Stance::new(&placing, &pose, SHOULDERS, Reconfiguration::default())?.optimised().values;
    }
    Ok(margins)
}
