//! A* over stands (node and heading).

use super::index::CostField;
use super::{HEADINGS, Stand};
use std::cmp::Ordering;
use std::collections::{BinaryHeap, HashMap};

/// What a search needs to know beside the cost field.
pub struct Task<'a> {
    pub field: &'a CostField,
    pub start: Stand,
    /// Whether the rover may leave the start in any heading without a turn.
    pub any_heading: bool,
    /// Node of the goal.
    pub goal: (usize, usize),
    /// Costs added to stands; infinite where the rover fails.
    pub raised: &'a HashMap<Stand, f64>,
}

/// What a search gives.
pub struct Found {
    /// Stands from start to goal; to the nearest reached node where the goal is out of reach.
    pub path: Vec<Stand>,
    pub cost: f64,
    pub reached: bool,
}

/// An entry of the queue, smallest estimate first, ties by the stand's number, so that the same input gives the same path.
#[derive(PartialEq)]
struct Entry {
    estimate: f64,
    stand: u32,
}

impl Eq for Entry {}

impl Ord for Entry {
    fn cmp(&self, other: &Self) -> Ordering {
        other.estimate.total_cmp(&self.estimate).then(other.stand.cmp(&self.stand))
    }
}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Finds the cheapest path. `fit` is asked for every stand that is taken from the queue; what it refuses is not passed.
pub fn search(task: &Task, mut fit: impl FnMut(Stand) -> bool) -> Found {
    let (columns, rows) = task.field.size();
    let number = |stand: Stand| (task.field.node(stand) * HEADINGS + stand.heading) as u32;
    let stand_of = |number: u32| {
        let (node, heading) = (number as usize / HEADINGS, number as usize % HEADINGS);
        Stand { column: node % columns, row: node / columns, heading }
    };
    let remaining = |stand: Stand| (stand.column.abs_diff(task.goal.0), stand.row.abs_diff(task.goal.1));
    let least = |stand: Stand| {
        let (dc, dr) = remaining(stand);
        task.field.least(dc, dr)
    };
    let raised = |stand: Stand| task.raised.get(&stand).copied().unwrap_or(0.0);
    let mut cost = vec![f64::INFINITY; columns * rows * HEADINGS];
    let mut from = vec![u32::MAX; cost.len()];
    let mut closed = vec![false; cost.len()];
    let mut queue = BinaryHeap::new();
    let headings = if task.any_heading { 0..HEADINGS } else { task.start.heading..task.start.heading + 1 };
    for heading in headings {
        let start = Stand { heading, ..task.start };
        cost[number(start) as usize] = 0.0;
        queue.push(Entry { estimate: least(start), stand: number(start) });
    }
    let (mut nearest, mut reached) = ((f64::INFINITY, number(task.start)), false);
    while let Some(Entry { stand, .. }) = queue.pop() {
        let here = stand_of(stand);
        if std::mem::replace(&mut closed[stand as usize], true) || !fit(here) {
            continue;
        }
        let (dc, dr) = remaining(here);
        let distance = (dc as f64).hypot(dr as f64);
        if distance < nearest.0 {
            nearest = (distance, stand);
        }
        if distance == 0.0 {
            reached = true;
            break;
        }
        for heading in 0..HEADINGS {
            let Some(next) = here.ahead(heading, columns, rows) else { continue };
            let place = number(next) as usize;
            if closed[place] {
                continue;
            }
            // The rover turns where it stands, so it must be able to stand there in the new heading.
            let turned = Stand { heading, ..here };
            let turning = if heading == here.heading { 0.0 } else { raised(turned) };
            let total = cost[stand as usize] + task.field.step(here, next) + raised(next) + turning;
            if total < cost[place] {
                cost[place] = total;
                from[place] = stand;
                queue.push(Entry { estimate: total + least(next), stand: place as u32 });
            }
        }
    }
    let mut path = vec![stand_of(nearest.1)];
    let mut at = nearest.1;
    while from[at as usize] != u32::MAX {
        at = from[at as usize];
        path.push(stand_of(at));
    }
    path.reverse();
    Found { path, cost: cost[nearest.1 as usize], reached }
}
