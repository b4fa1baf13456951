//! Poses, forces, costs and paths a second: `cargo bench -p bekker-planning`.
//!
//! Peers stand in the same run: `pathfinding`'s Dijkstra on the same grids as the any-angle field.

#![allow(clippy::unwrap_used, reason = "a benchmark may fail by panicking")]

use bekker_planning::anisotropic::{
    AnyAnglePath, DirectionTable, Grid, GroundEnergy, SlopeEnergy, arrival_over, path_from,
};
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

fn square(side: usize, cell: f64) -> Grid {
    Grid { columns: side, rows: side, cell, origin: [0.0; 2] }
}

/// A drift as of a current.
fn drift(_: [f64; 2], d: [f64; 2]) -> f64 {
    1.0 + 0.6 * (0.8 * d[0] + 0.6 * d[1])
}

/// A cost that changes by a factor of four and more with the place and jumps along lines, with walls that leave gaps.
fn uneven([x, y]: [f64; 2], d: [f64; 2]) -> f64 {
    if x % 200.0 < 4.0 && (y + 150.0 * (x / 200.0).floor()) % 300.0 > 60.0 {
        return f64::INFINITY;
    }
    let (a, b) = (((x + 2.0 * y) / 40.0).fract() - 0.5, ((x - y + 4000.0) / 57.0).fract() - 0.5);
    1.0 + 0.9 * (a * d[0] + b * d[1]) + 0.8 * a * b
}

/// Field and path from corner to corner.
fn crossed(table: &DirectionTable) -> AnyAnglePath {
    let (grid, near) = (table.grid(), 5.0 * table.grid().cell);
    let goal = grid.place(grid.columns - 6, grid.rows - 6);
    path_from(&arrival_over(table, [near, near]).unwrap(), table, goal).unwrap()
}

/// Any-angle field and path from corner to corner over a table of costs by direction.
#[divan::bench(args = SIDES, sample_count = 7, sample_size = 1)]
fn any_angle_given_cost(bencher: Bencher, side: usize) {
    let table = DirectionTable::of(&drift, square(side, 1.0)).unwrap();
    bencher.bench(|| crossed(&table));
}

/// The field alone.
#[divan::bench(args = SIDES, sample_count = 7, sample_size = 1)]
fn any_angle_field(bencher: Bencher, side: usize) {
    let table = DirectionTable::of(&drift, square(side, 1.0)).unwrap();
    bencher.bench(|| arrival_over(&table, [5.0, 5.0]));
}

/// Field and path where the cost is uneven and there are walls.
#[divan::bench(args = SIDES, sample_count = 7, sample_size = 1)]
fn any_angle_uneven_cost(bencher: Bencher, side: usize) {
    let table = DirectionTable::of(&uneven, square(side, 1.0)).unwrap();
    bencher.bench(|| crossed(&table));
}

/// The table of a formula.
#[divan::bench(args = SIDES, sample_count = 7, sample_size = 1)]
fn any_angle_table_of_a_formula(bencher: Bencher, side: usize) {
    bencher.bench(|| DirectionTable::of(&drift, square(side, 1.0)));
}

/// Energies of the wheel-soil model over generated ground.
fn with_energy<T>(side: usize, then: impl FnOnce(&GroundEnergy, Grid) -> T) -> T {
    let shape = GroundShape { nodes: side, cell: 0.1, feature: 0.8, roughness: 0.05, swell: 0.1 };
    let ground = Surface::new(generated(&shape, 1).unwrap(), Interpolation::Smooth);
    let rover = bekker::rover::Rover::fsrl();
    let energy = SlopeEnergy::new(&rover.soil, &rover.wheel, 6.1 * 9.81, 6, 0.6).unwrap();
    then(&GroundEnergy::new(&ground, &energy, 0.5), Grid::from(ground.map()))
}

/// The table of these energies: what the model adds.
#[divan::bench(args = SIDES, sample_count = 7, sample_size = 1)]
fn any_angle_table_of_energies(bencher: Bencher, side: usize) {
    with_energy(side, |cost, _| bencher.bench_local(|| cost.table()));
}

/// Field and path over that table; the path is drawn over the energies themselves.
#[divan::bench(args = SIDES, sample_count = 7, sample_size = 1)]
fn any_angle_energy(bencher: Bencher, side: usize) {
    with_energy(side, |cost, grid| {
        let table = cost.table().unwrap();
        let goal = grid.place(side - 11, side - 11);
        bencher.bench_local(|| path_from(&arrival_over(&table, [1.0, 1.0]).unwrap(), cost, goal));
    });
}

/// Peer: `pathfinding`'s Dijkstra over the same nodes, eight directions, costs in whole numbers as it needs them.
#[divan::bench(args = SIDES, sample_count = 7, sample_size = 1)]
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
