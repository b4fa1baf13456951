//! The search for a pose: damped Newton steps within bounds, then a bracketed search.

use super::{Hang, Method, Placing, PoseError, TOUCHING};
use crate::robot::{Attitude, Frames};
use nalgebra::{DMatrix, DVector, Vector3};

/// Newton's method takes 3 to 8 steps on smooth ground.
const NEWTON_STEPS: usize = 30;

/// Halvings of a step before Newton's method gives up.
const HALVINGS: usize = 8;

/// Roll, pitch and turning joints are looked for within this to each side, rad: a rover that leans more has fallen over. Joint
/// limits are judged afterwards, so that a violation can be told.
const LEAN: f64 = 1.2;

/// Rounds over all coordinates in the bracketed search; each halves the error or better unless wheels fight over a coordinate.
const ROUNDS: usize = 60;

/// A round gets on where it lowers the gaps by this share at least; the search ends after so many rounds in a row that do not: two wheels
/// then fight over a coordinate.
const GETS_ON: f64 = 0.02;
const IDLE_ROUNDS: usize = 3;

/// Halvings of a bracket: 2.4 rad to 1e-9.
const BISECTIONS: usize = 32;

/// A pose that has all wheels on the ground.
pub struct Found {
    pub attitude: Attitude,
    pub method: Method,
    pub evaluations: usize,
}

/// Looks for the pose at a place.
pub fn search(placing: &Placing, place: [f64; 2], heading: f64, start: Option<&Attitude>) -> Result<Found, PoseError> {
    let mut attitude = first(placing, place, heading, start)?;
    let mut evaluations = 0;
    if newton(placing, &mut attitude, &mut evaluations) {
        return Ok(Found { attitude, method: Method::Newton, evaluations });
    }
    // From level ground again: where Newton's method has stopped is no good place.
    let mut attitude = first(placing, place, heading, None)?;
    let hangs = bracketed(placing, &mut attitude, &mut evaluations)?;
    let worst = hangs.iter().enumerate().max_by(|a, b| a.1.gap.abs().total_cmp(&b.1.gap.abs()));
    match worst.filter(|(_, hang)| hang.gap.abs() > TOUCHING) {
        None => Ok(Found { attitude, method: Method::Bracketed, evaluations }),
        Some((wheel, hang)) => {
            let wheel = placing.robot.wheels[wheel].name.clone();
            Err(PoseError::NotFound { x: place[0], y: place[1], wheel, gap: hang.gap })
        }
    }
}

/// Where the search begins: as `start`, or level, with the lowest wheel on the ground.
fn first(placing: &Placing, [x, y]: [f64; 2], heading: f64, start: Option<&Attitude>) -> Result<Attitude, PoseError> {
    let passive = placing.robot.passive();
    let level =
        Attitude { position: Vector3::new(x, y, 0.0), heading, roll: 0.0, pitch: 0.0, passive: vec![0.0; passive] };
    let mut attitude = match start.filter(|start| start.passive.len() == passive) {
        Some(start) => Attitude { position: Vector3::new(x, y, start.position.z), heading, ..start.clone() },
        None => level,
    };
    let lowest = hangs(placing, &attitude)?.iter().fold(f64::INFINITY, |low, hang| low.min(hang.gap));
    attitude.position.z -= lowest;
    Ok(attitude)
}

fn hangs(placing: &Placing, attitude: &Attitude) -> Result<Vec<Hang>, PoseError> {
    let frames = Frames::new(placing.robot, attitude, &placing.active);
    (0..placing.robot.wheels.len()).map(|wheel| placing.hang(&frames, wheel)).collect()
}

fn size(hangs: &[Hang]) -> f64 {
    hangs.iter().map(|hang| hang.gap * hang.gap).sum::<f64>().sqrt()
}

/// Newton's method with halved steps; whether all wheels touch.
fn newton(placing: &Placing, attitude: &mut Attitude, evaluations: &mut usize) -> bool {
    let Ok(mut here) = hangs(placing, attitude) else { return false };
    for _ in 0..NEWTON_STEPS {
        if here.iter().all(|hang| hang.gap.abs() <= TOUCHING) {
            return true;
        }
        let Some(step) = jacobian(placing, attitude, &here).lu().solve(&gaps(&here)) else { return false };
        let mut share = 1.0;
        let better = (0..HALVINGS).find_map(|_| {
            let next = moved(attitude, &step, -share);
            share *= 0.5;
            *evaluations += 1;
            let there = hangs(placing, &next).ok()?;
            (size(&there) < size(&here)).then_some((next, there))
        });
        let Some((next, there)) = better else { return false };
        (*attitude, here) = (next, there);
    }
    here.iter().all(|hang| hang.gap.abs() <= TOUCHING)
}

fn gaps(hangs: &[Hang]) -> DVector<f64> {
    DVector::from_iterator(hangs.len(), hangs.iter().map(|hang| hang.gap))
}

/// Slopes of the gaps in height, roll, pitch and passive coordinates. The rim's nearest point may be taken as fixed to the wheel
/// (the envelope theorem: sliding along the rim changes the smallest distance in second order only).
fn jacobian(placing: &Placing, attitude: &Attitude, hangs: &[Hang]) -> DMatrix<f64> {
    let frames = Frames::new(placing.robot, attitude, &placing.active);
    let rows = hangs.iter().map(|hang| frames.motion(hang.link, hang.rim).iter().map(|m| hang.rate(m)).collect());
    let rows: Vec<Vec<f64>> = rows.collect();
    DMatrix::from_fn(rows.len(), rows.len(), |i, j| rows[i][j])
}

/// The attitude moved by a share of a step, kept within the bounds.
fn moved(attitude: &Attitude, step: &DVector<f64>, share: f64) -> Attitude {
    let mut next = attitude.clone();
    for (k, change) in step.iter().enumerate() {
        add(&mut next, k, share * change);
    }
    next
}

/// Changes coordinate `k`: height, roll, pitch, passive ones.
fn add(attitude: &mut Attitude, k: usize, change: f64) {
    match k {
        0 => attitude.position.z += change,
        1 => attitude.roll = (attitude.roll + change).clamp(-LEAN, LEAN),
        2 => attitude.pitch = (attitude.pitch + change).clamp(-LEAN, LEAN),
        k => attitude.passive[k - 3] = (attitude.passive[k - 3] + change).clamp(-LEAN, LEAN),
    }
}

fn coordinate(attitude: &Attitude, k: usize) -> f64 {
    match k {
        0 => attitude.position.z,
        1 => attitude.roll,
        2 => attitude.pitch,
        k => attitude.passive[k - 3],
    }
}

/// One coordinate after the other is put where the sum of gaps, each weighted by how the coordinate moves its wheel, changes its
/// sign: the least squares of the gaps along that coordinate. No slope of the ground is needed, so creases and steps do no harm.
fn bracketed(placing: &Placing, attitude: &mut Attitude, evaluations: &mut usize) -> Result<Vec<Hang>, PoseError> {
    let (mut before, mut idle) = (f64::INFINITY, 0);
    for _ in 0..ROUNDS {
        for k in 0..3 + placing.robot.passive() {
            balance(placing, attitude, k, evaluations);
        }
        let here = hangs(placing, attitude)?;
        if here.iter().all(|hang| hang.gap.abs() <= TOUCHING) {
            return Ok(here);
        }
        // Near a solution Newton's method is faster, where the ground lets it.
        let mut polished = attitude.clone();
        if newton(placing, &mut polished, evaluations) {
            *attitude = polished;
            return hangs(placing, attitude);
        }
        let left = size(&here);
        idle = if left > before * (1.0 - GETS_ON) { idle + 1 } else { 0 };
        if idle == IDLE_ROUNDS {
            return Ok(here);
        }
        before = left;
    }
    hangs(placing, attitude)
}

/// Puts coordinate `k` where its weighted sum of gaps is 0; leaves it where no bracket has a change of sign.
fn balance(placing: &Placing, attitude: &mut Attitude, k: usize, evaluations: &mut usize) {
    let weights: Vec<f64> = {
        let frames = Frames::new(placing.robot, attitude, &placing.active);
        let rate = |wheel: usize| {
            let robot_wheel = &placing.robot.wheels[wheel];
            frames.motion(robot_wheel.link, frames.point(robot_wheel.link, robot_wheel.centre))[k].z
        };
        (0..placing.robot.wheels.len()).map(rate).collect()
    };
    let here = coordinate(attitude, k);
    let mut sum_at = |value: f64| {
        let mut next = attitude.clone();
        add(&mut next, k, value - here);
        *evaluations += 1;
        let hangs = hangs(placing, &next).ok()?;
        Some(hangs.iter().zip(&weights).map(|(hang, weight)| hang.gap * weight).sum::<f64>())
    };
    let Some(start) = sum_at(here) else { return };
    let mut width = 1e-4_f64.max(0.5 * start.abs());
    let bracket = loop {
        let other = here - start.signum() * width;
        match sum_at(other) {
            Some(sum) if sum * start <= 0.0 => break Some((here, other)),
            Some(_) if width < 2.0 * LEAN => width *= 2.0,
            _ => break None,
        }
    };
    let Some((mut inside, mut beyond)) = bracket else { return };
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (inside + beyond);
        match sum_at(middle) {
            Some(sum) if sum * start > 0.0 => inside = middle,
            Some(_) => beyond = middle,
            None => break,
        }
    }
    add(attitude, k, 0.5 * (inside + beyond) - here);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{ElevationMap, Interpolation, Surface};
    use crate::robot::fsrl;

    /// Ground of cliffs: every node at a height of its own.
    fn cliffs(seed: u64, height: f64) -> Result<Surface, crate::map::MapError> {
        let at = |x: f64, y: f64| height * ((x * 127.1 + y * 311.7 + seed as f64).sin() * 43_758.545).fract().abs();
        Ok(Surface::new(ElevationMap::from_formula(81, 81, 0.04, [0.0, 0.0], at)?, Interpolation::Bilinear))
    }

    #[test]
    fn agreement_the_bracketed_search_finds_what_newtons_method_finds() -> Result<(), Box<dyn std::error::Error>> {
        let robot = fsrl();
        for seed in 0..10 {
            let ground = cliffs(seed, 0.02)?;
            let placing = Placing::new(&robot, &ground, &[])?;
            let mut by_newton = first(&placing, [1.5, 1.6], 0.4, None)?;
            let mut by_bracket = by_newton.clone();
            if !newton(&placing, &mut by_newton, &mut 0) {
                continue;
            }
            for _ in 0..ROUNDS {
                (0..6).for_each(|k| balance(&placing, &mut by_bracket, k, &mut 0));
            }
            let off = (by_newton.position - by_bracket.position).norm() + (by_newton.roll - by_bracket.roll).abs();
            assert!(off < 1e-4, "seed {seed}: {off}");
        }
        Ok(())
    }

    #[test]
    fn property_poses_on_cliffs_are_found_where_newtons_method_fails() -> Result<(), Box<dyn std::error::Error>> {
        let robot = fsrl();
        let (mut found, mut bracketed) = (0, 0);
        for seed in 0..60 {
            let ground = cliffs(seed, 0.12)?;
            let placing = Placing::new(&robot, &ground, &[])?;
            let Ok(pose) = search(&placing, [1.5, 1.6], 0.1 * seed as f64, None) else { continue };
            found += 1;
            bracketed += usize::from(pose.method == Method::Bracketed);
        }
        println!("{found} of 60 poses found, {bracketed} by the bracketed search");
        assert!(found >= 55 && bracketed >= 1, "{found} found, {bracketed} bracketed");
        Ok(())
    }
}
