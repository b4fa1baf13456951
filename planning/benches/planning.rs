//! Poses, forces, costs and paths a second: `cargo bench -p bekker-planning`.
//!
//! Peers stand in the same run: `pathfinding`'s Dijkstra on the same grids as the any-angle field.

#![allow(clippy::unwrap_used, reason = "a benchmark may fail by panicking")]

use bekker_planning::anisotropic::{GroundEnergy, Open, SlopeEnergy, arrival, path_from};
use bekker_planning::force::{Assumptions, Load, Programme, Shear};
use bekker_planning::map::{Difficulty, GroundShape, Interpolation, Surface, generated, rocky};
use bekker_planning::plan::{CostField, Evaluator, PerformanceIndex};
use bekker_planning::pose::Placing;
use bekker_planning::reconfigure::{Reconfiguration, Stance};
use bekker_planning::robot::{fsrl, sample_return};
use bekker_planning::trial::ground_shape;
use divan::{Bencher, black_box};

fn main() {
    divan::main();
}

fn moderate() -> Surface {
    Surface::new(rocky(&ground_shape(Difficulty::Moderate), 1).unwrap(), Interpolation::Smooth)
}

/// A pose of the rocker-bogie from level.
#[divan::bench]
fn pose(bencher: Bencher) {
    let (ground, robot) = (moderate(), fsrl());
    let placing = Placing::new(&robot, &ground, &[]).unwrap();
    bencher.bench(|| placing.pose(black_box([4.0, 4.0]), 0.3, None));
}

/// The largest thrust of a six-wheeled rover.
#[divan::bench]
fn force_programme(bencher: Bencher) {
    let (ground, robot) = (moderate(), fsrl());
    let placing = Placing::new(&robot, &ground, &[]).unwrap();
    let pose = placing.pose([4.0, 4.0], 0.3, None).unwrap();
    let shear = Shear::firm(0.6);
    bencher.bench(|| {
        let programme = Programme::new(&placing, black_box(&pose), &Load::default(), &shear, Assumptions::default());
        programme.unwrap().largest_thrust()
    });
}

/// Pose, stability and forces of one stand: what the model-based evaluation adds a place.
#[divan::bench]
fn assessment(bencher: Bencher) {
    let (ground, robot) = (moderate(), fsrl());
    let evaluator = Evaluator::new(&robot, &ground, &[], Shear::firm(0.6)).unwrap();
    bencher.bench(|| evaluator.assess(black_box([4.0, 4.0]), 0.3, None));
}

/// The performance index of 195 x 195 nodes.
#[divan::bench(sample_count = 20)]
fn performance_index(bencher: Bencher) {
    let (ground, robot) = (moderate(), fsrl());
    bencher.bench(|| CostField::new(black_box(ground.map()), &robot, &PerformanceIndex::default()));
}

/// One optimisation of the Sample Return Rover's joints; the stance is prepared before.
#[divan::bench]
fn reconfiguration(bencher: Bencher) {
    let (ground, robot) = (moderate(), sample_return());
    let placing = Placing::new(&robot, &ground, &[]).unwrap();
    let pose = placing.pose([4.0, 4.0], 0.3, None).unwrap();
    let stance = Stance::new(&placing, &pose, 2, Reconfiguration::default()).unwrap();
    bencher.bench(|| black_box(&stance).optimised());
}

/// Preparing that stance: contacts and centre of mass as functions of the joints.
#[divan::bench]
fn stance(bencher: Bencher) {
    let (ground, robot) = (moderate(), sample_return());
    let placing = Placing::new(&robot, &ground, &[]).unwrap();
    let pose = placing.pose([4.0, 4.0], 0.3, None).unwrap();
    bencher.bench(|| Stance::new(&placing, black_box(&pose), 2, Reconfiguration::default()));
}

/// Nodes along a side: 147,000 and 344,000 in all, and the 2000 x 2000.
const SIDES: [usize; 3] = [383, 586, 2000];

/// Any-angle field and path from corner to corner over a cost by direction that is given as a formula.
#[divan::bench(args = SIDES, sample_count = 3, sample_size = 1)]
fn any_angle_given_cost(bencher: Bencher, side: usize) {
    let cost = Open(|_: [f64; 2], d: [f64; 2]| 1.0 + 0.6 * (0.8 * d[0] + 0.6 * d[1]));
    let goal = [side as f64 - 6.0; 2];
    bencher.bench(|| path_from(&arrival(&cost, [side, side], 1.0, [0.0, 0.0], [5.0, 5.0]).unwrap(), &cost, goal));
}

/// The field alone on energy from the wheel-soil model over a map.
#[divan::bench(args = [383, 586], sample_count = 3, sample_size = 1)]
fn any_angle_energy(bencher: Bencher, side: usize) {
    let shape = GroundShape { nodes: side, cell: 0.1, feature: 0.8, roughness: 0.05, swell: 0.1 };
    let ground = Surface::new(generated(&shape, 1).unwrap(), Interpolation::Smooth);
    let rover = bekker::rover::Rover::fsrl();
    let energy = SlopeEnergy::new(&rover.soil, &rover.wheel, 6.1 * 9.81, 6, 0.6).unwrap();
    let cost = GroundEnergy::new(&ground, &energy, 0.5);
    bencher.bench(|| arrival(&cost, [side, side], 0.1, [0.0, 0.0], [1.0, 1.0]));
}

/// Peer: `pathfinding`'s Dijkstra over the same nodes, eight directions, costs in whole numbers as it needs them.
#[divan::bench(args = SIDES, sample_count = 3, sample_size = 1)]
fn peer_pathfinding_dijkstra(bencher: Bencher, side: usize) {
    let next = |&(c, r): &(i32, i32)| {
        let steps = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];
        let all = steps.into_iter().map(move |(dc, dr)| {
            let length = f64::from(dc * dc + dr * dr).sqrt();
            let cost = length + 0.6 * (0.8 * f64::from(dc) + 0.6 * f64::from(dr));
            ((c + dc, r + dr), (cost * 1e6) as u64)
        });
        let side = side as i32;
        all.filter(move |((c, r), _)| (0..side).contains(c) && (0..side).contains(r)).collect::<Vec<_>>()
    };
    bencher.bench(|| pathfinding::directed::dijkstra::dijkstra_all(&(5, 5), next));
}
