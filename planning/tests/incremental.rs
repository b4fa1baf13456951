//! D* Lite beside searches from scratch.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker_planning::incremental::{IncrementalError, IncrementalSearch};
use pathfinding::directed::dijkstra::dijkstra;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const SIDE: usize = 40;

/// Sums of a hundred costs, each rounded to 1e-9 for the peer.
const SUMS: f64 = 1e-6;

/// Cost of the cheapest way by a general library.
fn from_scratch(costs: &[f64], from: (usize, usize), goal: (usize, usize)) -> Option<f64> {
    let next = |&(c, r): &(usize, usize)| {
        let around =
            (-1..=1_isize).flat_map(|dr| (-1..=1_isize).map(move |dc| (dc, dr))).filter(|step| *step != (0, 0));
        let steps = around.filter_map(|(dc, dr)| {
            let column = c.checked_add_signed(dc).filter(|column| *column < SIDE)?;
            let row = r.checked_add_signed(dr).filter(|row| *row < SIDE)?;
            let length = if dc * dr == 0 { 1.0 } else { 2.0_f64.sqrt() };
            let cost = length * 0.5 * (costs[r * SIDE + c] + costs[row * SIDE + column]);
            cost.is_finite().then(|| ((column, row), (cost * 1e9).round() as u64))
        });
        steps.collect::<Vec<_>>()
    };
    dijkstra(&from, next, |at| *at == goal).map(|(_, cost)| cost as f64 * 1e-9)
}

#[test]
fn agreement_every_repair_gives_the_way_of_a_search_from_scratch() {
    let mut random = ChaCha8Rng::seed_from_u64(9);
    let mut expanded = (0, 0);
    for _ in 0..10 {
        let mut costs: Vec<f64> = (0..SIDE * SIDE).map(|_| random.random_range(1.0..5.0)).collect();
        let (mut rover, goal) = ((1, 2), (37, 36));
        let mut search = IncrementalSearch::new([SIDE, SIDE], costs.clone(), 1.0, rover, goal).unwrap();
        while rover != goal {
            let theirs = from_scratch(&costs, rover, goal);
            let Some((path, cost)) = search.path() else {
                assert_eq!(theirs, None);
                break;
            };
            assert!((cost - theirs.unwrap()).abs() < SUMS, "{cost} {theirs:?}");
            assert_eq!((path[0], *path.last().unwrap()), (rover, goal));
            // Three steps on, then rocks appear ahead, and some ground turns out easier.
            rover = path[path.len().min(4) - 1];
            search.move_to(rover).unwrap();
            for _ in 0..6 {
                let near = |at: usize, random: &mut ChaCha8Rng| (at + random.random_range(0..9)).clamp(4, SIDE + 3) - 4;
                let at = (near(rover.0, &mut random), near(rover.1, &mut random));
                if at == rover || at == goal {
                    continue;
                }
                let cost = if random.random_bool(0.4) { f64::INFINITY } else { random.random_range(1.0..9.0) };
                costs[at.1 * SIDE + at.0] = cost;
                search.change(at, cost).unwrap();
            }
            expanded.1 += 1;
        }
        expanded.0 += search.expanded();
    }
    // A search from scratch settles most of 1600 nodes each time.
    let mean = expanded.0 as f64 / f64::from(expanded.1);
    println!("{mean:.0} nodes a repair, the first searches included");
    assert!(mean < 0.5 * (SIDE * SIDE) as f64);
}

#[test]
fn property_a_closed_goal_has_no_way_until_it_is_opened() {
    let mut costs = vec![1.0; SIDE * SIDE];
    (0..SIDE).for_each(|row| costs[row * SIDE + 20] = f64::INFINITY);
    let mut search = IncrementalSearch::new([SIDE, SIDE], costs, 1.0, (5, 5), (35, 5)).unwrap();
    assert_eq!(search.path(), None);
    search.change((20, 30), 1.0).unwrap();
    let (path, _) = search.path().unwrap();
    assert!(path.contains(&(20, 30)));
}

#[test]
fn property_wrong_numbers_are_told() {
    let new = |costs: Vec<f64>, rover| IncrementalSearch::new([3, 3], costs, 1.0, rover, (2, 2)).map(|_| ());
    assert!(matches!(new(vec![1.0; 8], (0, 0)), Err(IncrementalError::Count { got: 8, .. })));
    assert!(matches!(new(vec![0.5; 9], (0, 0)), Err(IncrementalError::Cost { .. })));
    assert_eq!(new(vec![1.0; 9], (3, 0)), Err(IncrementalError::OffGrid { column: 3, row: 0 }));
}
