//! Rigid obstacles on the ground: rocks, ledges, blocks. The plant of rigid bodies (`plant = "rigid_bodies"`) feels
//! them; the joint-coordinate plant computes contact with soil only and refuses a model that has any.

use bekker_modeldescription::{Unit, parameters};
use serde::{Deserialize, Serialize};

/// Vertices of a rock's outline above the ground. The polygon stays inside the ellipse by at most 3e-4 of its half
/// axes.
const ROCK_VERTICES: usize = 64;

/// Form of an obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ObstacleKind {
    /// Upper half of an ellipse, `x` in its middle; a half circle where the width is twice the height.
    Rock,
    /// A box, `x` in its middle.
    Block,
    /// A box whose rear face stands at `x` and whose top goes on forward for its width: a step up, and down again.
    Ledge,
}

parameters! {
    /// Place, size and friction of an obstacle.
    pub struct ObstacleParameters {
        /// Middle of a rock or block, rear face of a ledge.
        x: [Unit::METRE] = 1.0, -1e4..=1e4, Fixed, "user";
        /// Height above the ground at `x`.
        height: [Unit::METRE] = 0.05, 0.001..=5.0, Fixed, "preset; half a wheel diameter in Iagnemma 2001, 2.6";
        /// Extent along x.
        width: [Unit::METRE] = 0.2, 0.005..=100.0, Fixed, "preset";
        /// Coefficient of Coulomb friction of wheels, links and chassis on it.
        friction: [Unit::ONE] = 0.7, 0.0..=3.0, Fixed, "assumption: metal or rubber rim on dry rock, 0.5-0.9";
    }
}

/// A rigid obstacle that does not move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obstacle {
    /// Form.
    pub kind: ObstacleKind,
    /// Place, size, friction.
    pub parameters: ObstacleParameters,
}

impl Obstacle {
    /// A rock of the given height and width (m) with its middle at `x`, of usual friction.
    #[must_use]
    pub fn rock(x: f64, height: f64, width: f64) -> Self {
        Self::new(ObstacleKind::Rock, x, height, width)
    }

    /// A box of the given height and width (m) with its middle at `x`, of usual friction.
    #[must_use]
    pub fn block(x: f64, height: f64, width: f64) -> Self {
        Self::new(ObstacleKind::Block, x, height, width)
    }

    /// A ledge of the given height and width (m) with its face at `x`, of usual friction.
    #[must_use]
    pub fn ledge(x: f64, height: f64, width: f64) -> Self {
        Self::new(ObstacleKind::Ledge, x, height, width)
    }

    fn new(kind: ObstacleKind, x: f64, height: f64, width: f64) -> Self {
        Self { kind, parameters: ObstacleParameters { x, height, width, ..Default::default() } }
    }

    /// First and last position along x that it covers, m.
    #[must_use]
    pub fn extent(&self) -> (f64, f64) {
        let ObstacleParameters { x, width, .. } = self.parameters;
        match self.kind {
            ObstacleKind::Rock | ObstacleKind::Block => (x - 0.5 * width, x + 0.5 * width),
            ObstacleKind::Ledge => (x, x + width),
        }
    }

    /// Height of its top at `x` above the ground at its own place, m; `None` beside it.
    #[must_use]
    pub fn height_at(&self, x: f64) -> Option<f64> {
        let (from, to) = self.extent();
        if !(from..=to).contains(&x) {
            return None;
        }
        let ObstacleParameters { height, .. } = self.parameters;
        Some(match self.kind {
            ObstacleKind::Block | ObstacleKind::Ledge => height,
            ObstacleKind::Rock => {
                let along = (2.0 * x - from - to) / (to - from);
                height * (1.0 - along * along).max(0.0).sqrt()
            }
        })
    }

    /// Outline as a convex polygon, counterclockwise [x, z], m: standing on ground of height `ground` at its `x` and
    /// going down to `bottom`, so that sunk wheels meet its flanks.
    #[must_use]
    pub fn outline(&self, ground: f64, bottom: f64) -> Vec<[f64; 2]> {
        let (from, to) = self.extent();
        let top = ground + self.parameters.height;
        let mut outline = vec![[from, bottom], [to, bottom]];
        match self.kind {
            ObstacleKind::Block | ObstacleKind::Ledge => outline.extend([[to, top], [from, top]]),
            ObstacleKind::Rock => {
                let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
                outline.extend((0..=ROCK_VERTICES).map(|k| {
                    let angle = std::f64::consts::PI * k as f64 / ROCK_VERTICES as f64;
                    [middle + half * angle.cos(), ground + self.parameters.height * angle.sin()]
                }));
            }
        }
        outline
    }
}

parameters! {
    /// Contact of the rover's bodies with the ground, where they are rigid bodies.
    pub struct BodyContact {
        /// Coefficient of Coulomb friction of chassis and links on the ground.
        belly_friction: [Unit::ONE] = 0.5, 0.0..=3.0, Fixed, "assumption: sheet metal on sand, about tan 27 deg";
    }
}
