//! The columns of a route, and whether they go together.

use super::curves::Rims;
use super::route::Route;
use super::{EASTING, NORTHING, OF_ROUTE, Stated};
use crate::measurement::error::{ExperimentError, Problem};
use crate::measurement::grid::{Grid, GridColumn};

/// What a run records of its route.
pub(super) struct RouteColumns {
    pub heading: Option<GridColumn>,
    pub yaw_rate: Option<GridColumn>,
    pub easting: Option<GridColumn>,
    pub northing: Option<GridColumn>,
    /// Of the ground.
    pub height: Option<GridColumn>,
}

impl RouteColumns {
    /// Takes the columns out of the grid: they are no part of a planar model. `None` where there are none.
    pub fn take(grid: &mut Grid) -> Option<Self> {
        let [heading, yaw_rate, easting, northing, height] = OF_ROUTE.map(|(name, _)| grid.take(name));
        let all = Self { heading, yaw_rate, easting, northing, height };
        all.first().is_some().then_some(all)
    }

    /// The first of the columns that are there.
    fn first(&self) -> Option<&GridColumn> {
        let Self { heading, yaw_rate, easting, northing, height } = self;
        [heading, yaw_rate, easting, northing, height].into_iter().flatten().next()
    }

    /// Easting and northing.
    ///
    /// # Errors
    /// [`ExperimentError`] where one of them is missing, or `x` is recorded too.
    pub fn positions(&self, grid: &Grid) -> Result<Option<(&GridColumn, &GridColumn)>, ExperimentError> {
        let (east, north) = match (&self.easting, &self.northing) {
            (Some(east), Some(north)) => (east, north),
            (None, None) => return Ok(None),
            (Some(one), None) | (None, Some(one)) => {
                let missing = if one.name == EASTING { NORTHING } else { EASTING };
                let message = format!("a position needs `{EASTING}` and `{NORTHING}`; there is no `{missing}`");
                return Err(refused(grid, one, message));
            }
        };
        if grid.column("x").is_some() {
            let message = "positions give `x`, which another column gives too; list one of them under `ignore = [..]`";
            return Err(refused(grid, east, message.to_owned()));
        }
        Ok(Some((east, north)))
    }

    /// Whether it can be told where the vehicle turns and where the ground is.
    ///
    /// # Errors
    /// [`ExperimentError`] that names what is missing.
    pub fn check(
        &self,
        grid: &Grid,
        stated: &Stated,
        rims: &Rims,
        route: Option<&Route>,
    ) -> Result<(), ExperimentError> {
        let turns = self.yaw_rate.as_ref().or(self.heading.as_ref());
        if let (Some(column), None, None, false) = (turns, grid.column("velocity"), route, rims.in_metres) {
            let radius = if stated.radius.is_none() { ", or \"wheel.radius\" under [parameters]" } else { "" };
            let message = format!(
                "whether the vehicle turns shows beside its speed: give `velocity`, or `{EASTING}` and `{NORTHING}`{radius}"
            );
            return Err(refused(grid, column, message));
        }
        let Some(height) = &self.height else { return Ok(()) };
        if route.is_none() && grid.column("x").is_none() {
            let message = format!("the height of the ground needs a place: `{EASTING}` and `{NORTHING}`, or `x`");
            return Err(refused(grid, height, message));
        }
        if stated.has_ground {
            let message = "it gives the ground, as `terrain` of the run does; leave one of them out";
            return Err(refused(grid, height, message.to_owned()));
        }
        Ok(())
    }

    /// What is said where a stretch behind a turn has no place on the ground of a file.
    pub fn without_a_place(&self, grid: &Grid) -> ExperimentError {
        let message = format!("stretches on the ground of a file need a place: `{EASTING}` and `{NORTHING}`, or `x`");
        match self.first() {
            Some(column) => refused(grid, column, message),
            None => grid.error(Problem::Derived(message)),
        }
    }
}

pub(super) fn refused(grid: &Grid, column: &GridColumn, message: String) -> ExperimentError {
    grid.error(Problem::Derived(message)).at_line(grid.header_line).at_column(&column.source)
}
