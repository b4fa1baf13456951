//! Costs that depend on the direction of travel, and paths at any angle over them.
//!
//! The thesis's index (3.5) knows roughness and length; on soft ground what matters is whether a slope is taken up, across or down.
//! Here a metre costs what the core's wheel on its soil needs for it ([`SlopeEnergy`]), and the path is not bound to the grid's
//! directions: the cost-to-come solves the Hamilton-Jacobi-Bellman equation on the grid by a semi-Lagrangian scheme.

mod energy;
mod field;
mod path;

pub use energy::{EnergyError, GroundEnergy, SlopeEnergy};
pub use field::{ArrivalField, FieldError, arrival};
pub use path::{AnyAnglePath, path_cost, path_from};

/// Cost of a metre from a place in a direction.
pub trait DirectionalCost {
    /// Cost of a metre at `place` (m) in `direction` (a unit vector, east and north), 0 or more; infinite where the rover cannot go.
    fn per_metre(&self, place: [f64; 2], direction: [f64; 2]) -> f64;

    /// Whether the rover can go everywhere. The cost of a way between nodes is then looked at in its middle alone, which is four times
    /// as fast; otherwise every half of a spacing, so that no way crosses a wall.
    fn open(&self) -> bool {
        false
    }
}

/// A cost that is finite everywhere, see [`DirectionalCost::open`].
#[derive(Clone, Copy, Debug)]
pub struct Open<C>(pub C);

impl<C: DirectionalCost> DirectionalCost for Open<C> {
    fn per_metre(&self, place: [f64; 2], direction: [f64; 2]) -> f64 {
        self.0.per_metre(place, direction)
    }

    fn open(&self) -> bool {
        true
    }
}

/// A formula as a cost.
impl<F: Fn([f64; 2], [f64; 2]) -> f64> DirectionalCost for F {
    fn per_metre(&self, place: [f64; 2], direction: [f64; 2]) -> f64 {
        self(place, direction)
    }
}
