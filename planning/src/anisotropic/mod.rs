//! Costs that depend on the direction of travel, and paths at any angle over them.
//!
//! The thesis's index (3.5) knows roughness and length; on soft ground what matters is whether a slope is taken up, across or down.
//! Here a metre costs what the core's wheel on its soil needs for it ([`SlopeEnergy`]), and the path is not bound to the grid's
//! directions: the cost-to-come solves the Hamilton-Jacobi-Bellman equation on the grid by a semi-Lagrangian scheme ([`arrival`]) over a
//! table of costs in sixteen directions a node ([`DirectionTable`]), which any formula can fill and any array of costs can be.

mod energy;
mod field;
mod path;
#[cfg(test)]
mod reference;
mod safe;
mod table;
mod tile;

pub use energy::{EnergyError, GroundEnergy, SlopeEnergy};
pub use field::{ArrivalField, FieldError, arrival, arrival_over};
pub use path::{AnyAnglePath, path_cost, path_from};
pub use safe::plan_over;
pub use table::{DIRECTIONS, DirectionTable, Grid};

/// Cost of a metre from a place in a direction.
pub trait DirectionalCost {
    /// Cost of a metre at `place` (m) in `direction` (a unit vector, east and north), 0 or more; infinite where the rover cannot go.
    fn per_metre(&self, place: [f64; 2], direction: [f64; 2]) -> f64;
}

/// A formula as a cost.
impl<F: Fn([f64; 2], [f64; 2]) -> f64> DirectionalCost for F {
    fn per_metre(&self, place: [f64; 2], direction: [f64; 2]) -> f64 {
        self(place, direction)
    }
}
