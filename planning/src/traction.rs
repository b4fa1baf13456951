//! Reconfiguration for traction: active joints put where the largest thrust is possible, which section 5.2 suggests beside stability.
//!
//! Each set of joints is judged as a planner judges a stand: pose, joint limits, belly, stability, then the force programme. The thrust has
//! kinks where another wheel meets its limit, so it is climbed by a pattern search (Hooke and Jeeves 1961) that needs no slopes.

use crate::force::{Assumptions, ForceError, Load, Programme, Shear};
use crate::map::Surface;
use crate::pose::Placing;
use crate::robot::{Robot, RobotError};
use crate::stability::stability;

/// First and last step of the search, rad or m.
const STEP: f64 = 0.2;
const LAST_STEP: f64 = 0.005;

/// What the search works with.
#[derive(Clone, Copy, Debug)]
pub struct Traction<'a> {
    /// The robot.
    pub robot: &'a Robot,
    /// The ground.
    pub surface: &'a Surface,
    /// Load.
    pub load: &'a Load,
    /// Strength of the ground.
    pub shear: &'a Shear,
    /// What the force analysis assumes.
    pub assumptions: Assumptions,
    /// Smallest stability angle that a set of joints must keep, rad.
    pub stability: f64,
}

/// Joints found.
#[derive(Clone, Debug, PartialEq)]
pub struct MostThrust {
    /// Values of the active joints, rad or m.
    pub values: Vec<f64>,
    /// Largest thrust there, N.
    pub thrust: f64,
    /// Sets of joints judged.
    pub judged: usize,
}

impl Traction<'_> {
    /// Largest thrust (N) in the direction of travel at a place (m) and heading (rad) with the joints at `active`; `None` where the robot
    /// cannot stand so, or no forces hold it.
    ///
    /// # Errors
    /// [`ForceError`] where the solver gives no answer.
    pub fn thrust(&self, place: [f64; 2], heading: f64, active: &[f64]) -> Result<Option<f64>, ForceError> {
        let Ok(placing) = Placing::new(self.robot, self.surface, active) else { return Ok(None) };
        let Ok(pose) = placing.pose(place, heading, None) else { return Ok(None) };
        let weight = self.robot.total_mass() * self.load.gravity;
        let margin =
            stability(&pose, weight, self.load.force, self.load.moment).map_or(f64::NEG_INFINITY, |found| found.margin);
        if !pose.violations.is_empty() || margin < self.stability {
            return Ok(None);
        }
        let programme = Programme::new(&placing, &pose, self.load, self.shear, self.assumptions)?;
        Ok(programme.largest_thrust()?.map(|forces| forces.thrust))
    }

    /// The joints with the largest thrust, looked for from `active` on; `None` where the robot cannot stand with those.
    ///
    /// # Errors
    /// [`TractionError`] where the number of values is wrong, or the solver gives no answer.
    pub fn most(&self, place: [f64; 2], heading: f64, active: &[f64]) -> Result<Option<MostThrust>, TractionError> {
        let limits = self.robot.active_limits();
        if active.len() != limits.len() {
            return Err(RobotError::Active { got: active.len(), expected: limits.len() }.into());
        }
        let Some(thrust) = self.thrust(place, heading, active)? else { return Ok(None) };
        let mut best = MostThrust { values: active.to_vec(), thrust, judged: 1 };
        let mut step = STEP;
        while step >= LAST_STEP {
            let before = best.values.clone();
            let rises = self.around(place, heading, &limits, step, &mut best)?;
            if !rises {
                step *= 0.5;
                continue;
            }
            // On in the direction that has helped.
            let on: Vec<f64> = best.values.iter().zip(&before).map(|(now, before)| 2.0 * now - before).collect();
            self.take(place, heading, &limits, on, &mut best)?;
        }
        Ok(Some(best))
    }

    /// Tries a step of each joint to either side; whether one helped.
    fn around(
        &self,
        place: [f64; 2],
        heading: f64,
        limits: &[[f64; 2]],
        step: f64,
        best: &mut MostThrust,
    ) -> Result<bool, ForceError> {
        let mut helped = false;
        for joint in 0..limits.len() {
            for change in [step, -step] {
                let mut values = best.values.clone();
                values[joint] += change;
                if self.take(place, heading, limits, values, best)? {
                    helped = true;
                    break;
                }
            }
        }
        Ok(helped)
    }

    /// Takes values, kept within the limits, where they give more thrust.
    fn take(
        &self,
        place: [f64; 2],
        heading: f64,
        limits: &[[f64; 2]],
        mut values: Vec<f64>,
        best: &mut MostThrust,
    ) -> Result<bool, ForceError> {
        values.iter_mut().zip(limits).for_each(|(value, [least, most])| *value = value.clamp(*least, *most));
        best.judged += 1;
        // A rise within the solver's rounding is none.
        let least = best.thrust + 1e-6 * self.robot.total_mass() * self.load.gravity;
        let found = self.thrust(place, heading, &values)?.filter(|thrust| *thrust > least);
        if let Some(thrust) = found {
            (best.values, best.thrust) = (values, thrust);
        }
        Ok(found.is_some())
    }
}

/// Why no joints are found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TractionError {
    /// The joints.
    #[error(transparent)]
    Robot(#[from] RobotError),
    /// The force programme.
    #[error(transparent)]
    Force(#[from] ForceError),
}
