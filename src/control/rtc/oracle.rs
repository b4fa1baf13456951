//! What the best slips can do at one pose, for a reader of tables: a bound beside controllers, not a controller.
//!
//! The rover stands at a pose that is known exactly, on soil that is known exactly, and moves at a constant speed: forces
//! balance, nothing accelerates. Of all slips that balance it, those of the least electrical power are found, and of all slips
//! those of the largest pull, by the same wheel and the same soil as the simulation's. A drive may be below this energy where
//! it lets kinetic energy help it over a hill, and above this pull only while it slows down.

use super::belief::SoilBelief;
use super::kinematics::{Rolling, rolling};
use super::sharing::{Demand, Sharing, electrical};
use super::solver::Solver;
use super::switch::Criterion;
use crate::control::{ControlError, Nominal};
use crate::signals::Measurement;
use crate::soil::Soil;

/// Least load of a wheel, of the weight: wheels may lift off nearly.
const LEAST_LOAD: f64 = 1e-4;
/// Wanted acceleration of the first search for the largest pull, of g; pull above one weight is not looked for. With 10 g the search
/// ended below zero in some poses in which the rover balances.
const ALL: f64 = 1.0;
/// What the further searches want above the largest pull so far, of the weight. A wish far above what the soil gives leaves wheels with
/// little load short of their largest pull: by 1 % of the weight on level sand.
const LITTLE_MORE: f64 = 0.03;
/// Further searches at most.
const MOST_SEARCHES: usize = 4;
/// Largest error of the vertical force (in weights) and of moments (in weights times half the base) at which forces count as
/// balanced.
const LAW_TOLERANCE: f64 = 1e-3;

/// What is attainable at a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attainable {
    /// Whether some slips balance the rover at a constant speed.
    pub balanced: bool,
    /// Least electrical power of all drives at that speed, W; where the search for it fails, the power at the largest pull; infinite
    /// where nothing balances.
    pub electrical_power: f64,
}

/// Finds what is attainable, pose by pose.
#[derive(Clone)]
pub struct Oracle {
    nominal: Nominal,
    sharing: Sharing,
    rolling: Vec<Rolling>,
}

/// The largest pull that was found.
#[derive(Clone, Copy, Debug)]
struct Most {
    /// Horizontal force that is left over, N.
    pull: f64,
    /// Electrical power there, W; none where weight or moments are out of balance.
    power: Option<f64>,
}

impl Oracle {
    /// An oracle for a rover as it is, all of whose wheels roll as `wheel` says.
    ///
    /// # Errors
    /// [`ControlError`] where the rover makes no sense.
    pub fn new(nominal: Nominal, wheel: SoilBelief) -> Result<Self, ControlError> {
        nominal.check()?;
        let wheels = nominal.wheels();
        let belief = SoilBelief { sufficient: 1.0, ..wheel };
        let sharing = Sharing::new(&nominal, LEAST_LOAD * nominal.weight(), belief, Solver::ActiveSet);
        Ok(Self { sharing, rolling: vec![Rolling::default(); wheels], nominal })
    }

    /// What is attainable at the true pitch, joint and contact angles of `pose`, at `speed` m/s, where the soil `along` m ahead of
    /// the chassis reference point is `soil(along)`.
    ///
    /// # Errors
    /// [`ControlError`] where the contact points coincide or the optimiser gives up.
    pub fn at(
        &mut self,
        pose: &Measurement,
        speed: f64,
        soil: impl Fn(f64) -> Soil,
    ) -> Result<Attainable, ControlError> {
        self.place(pose, soil);
        let demand = Demand { acceleration: 0.0, speed, criterion: Criterion::ElectricalPower };
        let found = self.sharing.share(&self.nominal, pose.pitch, &self.rolling, &demand, |_| None)?;
        // Where the search for the least power fails but the largest pull is positive, smaller torques balance the rover. The power
        // at the largest pull is reported then; it is above the least.
        let power = if found.feasible {
            Some(self.power(speed))
        } else {
            let most = self.most(pose, speed)?;
            most.power.filter(|_| most.pull >= 0.0)
        };
        Ok(Attainable { balanced: power.is_some(), electrical_power: power.unwrap_or(f64::INFINITY) })
    }

    /// The largest horizontal force that is left at any slips at a pose, N, as [`at`](Self::at) takes it; under zero where the rover
    /// cannot go on.
    ///
    /// # Errors
    /// As [`at`](Self::at).
    pub fn largest_pull(
        &mut self,
        pose: &Measurement,
        speed: f64,
        soil: impl Fn(f64) -> Soil,
    ) -> Result<f64, ControlError> {
        self.place(pose, soil);
        Ok(self.most(pose, speed)?.pull)
    }

    /// Places the contacts on their soil.
    fn place(&mut self, pose: &Measurement, soil: impl Fn(f64) -> Soil) {
        let Self { nominal, sharing, rolling: wheels } = self;
        let joints = pose.links.iter().map(|link| link.angle);
        let angles = pose.wheels.iter().map(|wheel| wheel.contact_angle);
        sharing.problem.distribution.place(nominal, pose.pitch, joints, angles);
        for (wheel, belief) in sharing.beliefs.iter_mut().enumerate() {
            belief.soil = soil(sharing.problem.distribution.foot(wheel));
        }
        rolling(&sharing.problem.distribution, nominal, &sharing.problem.lifted, wheels);
    }

    /// Searches for all at first, then a few times for a little more than was found, until that gives no more. A search whose forces do
    /// not carry the weight and balance the moments counts only where none does.
    fn most(&mut self, pose: &Measurement, speed: f64) -> Result<Most, ControlError> {
        let mut most = self.most_of(pose, speed, ALL)?;
        for _ in 0..MOST_SEARCHES {
            let wish = (most.pull / self.nominal.weight() + LITTLE_MORE).min(ALL);
            match self.most_of(pose, speed, wish) {
                Ok(here) if here.power.is_some() && (most.power.is_none() || here.pull > most.pull) => most = here,
                // Nothing more, or the optimiser gives up: what was found stands.
                _ => break,
            }
        }
        Ok(most)
    }

    /// The largest pull where `wish` is wanted, of the weight.
    fn most_of(&mut self, pose: &Measurement, speed: f64, wish: f64) -> Result<Most, ControlError> {
        let direction = if speed < 0.0 { -1.0 } else { 1.0 };
        let acceleration = wish * self.nominal.gravity * direction;
        let demand = Demand { acceleration, speed, criterion: Criterion::ElectricalPower };
        self.sharing.share(&self.nominal, pose.pitch, &self.rolling, &demand, |_| None)?;
        let pull = (self.nominal.mass * acceleration - missing(&self.sharing, 0)) * direction;
        Ok(Most { pull, power: keeps_laws(&self.sharing).then(|| self.power(speed)) })
    }

    /// Electrical power of all drives at the slips that were found, W.
    fn power(&self, speed: f64) -> f64 {
        let states = self.sharing.shares.iter().zip(&self.rolling).zip(&self.sharing.beliefs);
        states
            .map(|((share, wheel), belief)| {
                electrical(&self.nominal, speed.abs() * wheel.along, &belief.at(share.load, share.slip))
            })
            .sum()
    }
}

/// What the soil's forces at the slips that were found leave open in row `row` of the balance, N or N m.
fn missing(sharing: &Sharing, row: usize) -> f64 {
    sharing.problem.shortfall_beyond(row, &sharing.forces, |row| sharing.unforeseen(row))
}

/// Whether these forces carry the weight and balance all moments.
fn keeps_laws(sharing: &Sharing) -> bool {
    let problem = &sharing.problem;
    (1..problem.rows()).all(|row| missing(sharing, row).abs() <= LAW_TOLERANCE * problem.row_unit(row))
}
