//! Size of the space of solutions of (A.8) within (A.9)-(A.13), by its volume.
//!
//! The thesis counts points of a grid, which is possible in two or three dimensions only. Here the volume follows from a sequence
//! of balls around the point that is farthest from all limits, each with twice the volume of the one before: the share of the
//! bodies (space within ball) of neighbouring balls is estimated from a random walk (hit and run), and their product is the
//! volume over that of the inscribed ball (Dyer, Frieze and Kannan 1991; Lovasz 1999).

use super::{ForceError, Programme};
use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::PI;

/// Samples of each body.
const SAMPLES: usize = 1000;

/// Steps of the walk between two samples, for each dimension.
const STRIDE: usize = 2;

/// A body that stays within a ball after this many doublings is larger than any robot's.
const MOST_DOUBLINGS: usize = 400;

/// Directions of the equations' null space: singular values below this share of the largest count as 0.
const RANK: f64 = 1e-9;

/// The space of forces that hold the robot at one thrust.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct SolutionSpace {
    /// Dimension: unknowns less independent equations.
    pub dimension: usize,
    /// Distance of the best point from the nearest limit, as a share of the weight: 0 or less where there is no solution.
    pub inradius: f64,
    /// Volume in units of the weight to the power of the dimension; 0 where there is no solution.
    pub volume: f64,
    /// Relative standard error of the volume, from the spread of independent walks.
    pub relative_error: f64,
}

/// The limits over the null space: y gives x = centre + basis y.
struct Body<'a> {
    programme: &'a Programme,
    centre: DVector<f64>,
    basis: DMatrix<f64>,
}

impl Programme {
    /// Size of the space of solutions that leave `thrust` (N) in the direction of travel. `walks` independent walks (at least 2)
    /// of `seed`; the same seed gives the same bits.
    ///
    /// # Errors
    /// [`ForceError`] where the solver gives no answer.
    pub fn solution_space(&self, thrust: f64, walks: usize, seed: u64) -> Result<SolutionSpace, ForceError> {
        let basis = self.null_space();
        let dimension = basis.ncols();
        let mut cost = vec![0.0; self.variables + 1];
        cost[self.variables] = -1.0;
        let none = SolutionSpace { dimension, inradius: f64::NEG_INFINITY, volume: 0.0, relative_error: 0.0 };
        let Some(best) = self.minimised(&cost, Some(thrust))? else { return Ok(none) };
        let inradius = best[self.variables];
        if inradius <= RANK || dimension == 0 {
            return Ok(SolutionSpace { inradius, ..none });
        }
        let body = Body { programme: self, centre: DVector::from_column_slice(&best[..self.variables]), basis };
        let logs = (0..walks.max(2) as u64).map(|walk| {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            random.set_stream(walk);
            body.log_volume(inradius, &mut random)
        });
        let volumes: Vec<f64> = logs.map(f64::exp).collect();
        let count = volumes.len() as f64;
        let volume = volumes.iter().sum::<f64>() / count;
        let spread = volumes.iter().map(|v| (v - volume).powi(2)).sum::<f64>() / (count * (count - 1.0));
        Ok(SolutionSpace { dimension, inradius, volume, relative_error: spread.sqrt() / volume })
    }

    /// Orthonormal directions in which forces can change at a fixed thrust without breaking an equation.
    fn null_space(&self) -> DMatrix<f64> {
        // The thrust is fixed by an equation of its own. Square, so that all right singular vectors come out.
        let mut square = DMatrix::zeros(self.variables.max(self.equations.nrows() + 1), self.variables);
        square.view_mut((0, 0), self.equations.shape()).copy_from(&self.equations);
        square[(self.equations.nrows(), 3 * self.wheels)] = 1.0;
        let svd = square.svd(false, true);
        let largest = svd.singular_values.max();
        let rows = svd.v_t.iter().flat_map(|v| v.row_iter()).zip(svd.singular_values.iter());
        let free: Vec<_> = rows.filter(|(_, size)| **size <= RANK * largest).map(|(row, _)| row.transpose()).collect();
        if free.is_empty() { DMatrix::zeros(self.variables, 0) } else { DMatrix::from_columns(&free) }
    }
}

impl Body<'_> {
    /// Logarithm of the volume, by one walk.
    fn log_volume(&self, inradius: f64, random: &mut ChaCha8Rng) -> f64 {
        let dimension = self.basis.ncols();
        let growth = 2.0_f64.powf(1.0 / dimension as f64);
        let mut y = DVector::zeros(dimension);
        let (mut log, mut radius) = (log_ball(dimension) + dimension as f64 * inradius.ln(), inradius);
        for _ in 0..MOST_DOUBLINGS {
            let larger = radius * growth;
            let mut inside = 0;
            for _ in 0..SAMPLES {
                for _ in 0..STRIDE * dimension {
                    self.walk(&mut y, larger, random);
                }
                inside += usize::from(y.norm() <= radius);
            }
            // Nothing of the body is left outside.
            if inside == SAMPLES {
                break;
            }
            log += (SAMPLES as f64 / inside.max(1) as f64).ln();
            radius = larger;
        }
        log
    }

    /// One step of hit and run: a random direction, then a random place on the chord within limits and ball.
    fn walk(&self, y: &mut DVector<f64>, radius: f64, random: &mut ChaCha8Rng) {
        let direction = DVector::from_fn(y.len(), |_, _| normal(random)).normalize();
        let (low, high) = self.chord(y, &direction, radius);
        let place = low + (high - low) * random.random::<f64>();
        *y += direction * place;
    }

    /// Ends of the chord through y, along `direction`.
    fn chord(&self, y: &DVector<f64>, direction: &DVector<f64>, radius: f64) -> (f64, f64) {
        let along = y.dot(direction);
        let half = (along * along + radius * radius - y.norm_squared()).max(0.0).sqrt();
        let mut chord = (-along - half, -along + half);
        let programme = self.programme;
        let x = &self.centre + &self.basis * y;
        let d = &self.basis * direction;
        let mut cut = |value: f64, slope: f64| {
            // value + slope s >= 0.
            if slope > 0.0 {
                chord.0 = chord.0.max(-value / slope);
            } else if slope < 0.0 {
                chord.1 = chord.1.min(-value / slope);
            }
        };
        for wheel in 0..programme.wheels {
            let [n, t, _] = programme.columns(wheel);
            cut(x[n], d[n]);
            cut(programme.drive - x[t], -d[t]);
            cut(programme.drive + x[t], d[t]);
            // The cone's nappe that holds: its side A c + N tan phi >= 0 is implied by N >= 0.
        }
        for wheel in 0..programme.wheels {
            let [n, t, l] = programme.columns(wheel);
            let (side, rise) = (programme.adhesion + programme.friction * x[n], programme.friction * d[n]);
            // side(s)^2 - T(s)^2 - L(s)^2 = a s^2 + 2 b s + c >= 0.
            let a = rise * rise - d[t] * d[t] - d[l] * d[l];
            let b = side * rise - x[t] * d[t] - x[l] * d[l];
            let c = side * side - x[t] * x[t] - x[l] * x[l];
            let root = b * b - a * c;
            if root < 0.0 || c < 0.0 {
                continue;
            }
            for s in [(-b - root.sqrt()) / a, (-b + root.sqrt()) / a].into_iter().filter(|s| s.is_finite()) {
                if s < 0.0 { chord.0 = chord.0.max(s) } else { chord.1 = chord.1.min(s) }
            }
        }
        (chord.0.min(0.0), chord.1.max(0.0))
    }
}

/// Logarithm of the volume of the unit ball: pi^(d/2) / Gamma(d/2 + 1), by V_d = 2 pi / d V_(d-2).
fn log_ball(dimension: usize) -> f64 {
    match dimension {
        0 => 0.0,
        1 => 2.0_f64.ln(),
        d => (2.0 * PI / d as f64).ln() + log_ball(d - 2),
    }
}

/// A normal deviate by Box and Muller.
fn normal(random: &mut ChaCha8Rng) -> f64 {
    let (u, v): (f64, f64) = (random.random(), random.random());
    (-2.0 * (1.0 - u).ln()).sqrt() * (2.0 * PI * v).cos()
}
