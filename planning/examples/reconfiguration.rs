//! Figure 3.15 again: the Sample Return Rover on rough ground with and without reconfiguration, ten grounds of 5 m:
//! `cargo run --release -p bekker-planning --example reconfiguration`.
//!
//! The thesis gives neither its ground nor weights nor the rover's lengths; those here were fixed before the first run.

use bekker_planning::map::{GroundShape, Interpolation, Surface, generated};
use bekker_planning::pose::{Placing, Pose};
use bekker_planning::reconfigure::{Reconfiguration, Stance};
use bekker_planning::robot::{Robot, sample_return};
use bekker_planning::stability::stability;
use nalgebra::Vector3;

const GROUND: GroundShape = GroundShape { nodes: 161, cell: 0.04, feature: 0.25, roughness: 0.08, swell: 0.15 };
/// From here to there along the middle of the ground, m, in steps of 5 cm (a second at the rover's 6 cm/s).
const WAY: [f64; 2] = [1.0, 5.4];
const STEP: f64 = 0.05;
/// The shoulders, which (3.24) draws to their nominal angles; the arm is free.
const SHOULDERS: usize = 2;

/// Pose and margin (rad) at a place; none where the rover cannot stand.
fn stand(robot: &Robot, ground: &Surface, active: &[f64], x: f64) -> Option<(Pose, f64)> {
    let pose = Placing::new(robot, ground, active).ok()?.pose([x, 3.2], 0.0, None).ok()?;
    let margin = stability(&pose, robot.total_mass() * 9.81, Vector3::zeros(), Vector3::zeros()).ok()?.margin;
    Some((pose, margin))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let robot = sample_return();
    for seed in 0..10 {
        let ground = Surface::new(generated(&GROUND, seed)?, Interpolation::Smooth);
        let (mut fixed, mut moved) = (Vec::new(), Vec::new());
        let mut active = vec![0.0; robot.active()];
        let steps = ((WAY[1] - WAY[0]) / STEP) as usize;
        for k in 0..=steps {
            let x = WAY[0] + STEP * k as f64;
            let (Some((_, without)), Some((pose, with))) =
                (stand(&robot, &ground, &[0.0; 5], x), stand(&robot, &ground, &active, x))
            else {
                continue;
            };
            fixed.push(without.to_degrees());
            moved.push(with.to_degrees());
            let placing = Placing::new(&robot, &ground, &active)?;
            let stance = Stance::new(&placing, &pose, SHOULDERS, Reconfiguration::default())?;
            active = stance.optimised().values;
        }
        let mean = |margins: &[f64]| margins.iter().sum::<f64>() / margins.len() as f64;
        let least = |margins: &[f64]| margins.iter().copied().fold(f64::INFINITY, f64::min);
        println!(
            "ground {seed}: {} of {} places; mean margin {:.1} to {:.1} deg ({:+.1} %), smallest {:.1} to {:.1} deg",
            fixed.len(),
            steps + 1,
            mean(&fixed),
            mean(&moved),
            100.0 * (mean(&moved) / mean(&fixed) - 1.0),
            least(&fixed),
            least(&moved),
        );
    }
    Ok(())
}
