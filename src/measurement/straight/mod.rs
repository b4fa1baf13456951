//! Straight stretches of a drive: what a planar model can describe of a vehicle that also turns.
//!
//! A log of the field has curves, turns on the spot and pauses. Where it says how the vehicle's heading changes (`yaw_rate`, `heading`,
//! or positions `easting` and `northing`), rows in which the vehicle turns or its wheels stand are left out, and each straight stretch
//! between them is a run of its own. Positions give the way `x` along the drive, `ground_height` the ground under it.
//! What is left out is said among the doubts.

mod curves;
mod gentle;
mod ground;
mod left_out;
mod route;
mod route_columns;

pub(super) use left_out::LeftOut;

use super::around::{filled, lines};
use super::columns::{Column, Use, column};
use super::error::ExperimentError;
use super::grid::{Grid, GridColumn};
use super::reading::check_time;
use super::table::Table;
use bekker_modeldescription::Unit;
use curves::{Rims, Straight, Turning, USUAL_LEVER};
use route::Route;
use route_columns::{RouteColumns, refused};
use std::ops::Range;

const HEADING: &str = "heading";
const YAW_RATE: &str = "yaw_rate";
const EASTING: &str = "easting";
const NORTHING: &str = "northing";
const GROUND: &str = "ground_height";

/// Signals that are no part of a planar model and tell where it holds, with their units.
pub(super) const OF_ROUTE: [(&str, Unit); 5] = [
    (HEADING, Unit::RADIAN),
    (YAW_RATE, Unit::RADIAN_PER_SECOND),
    (EASTING, Unit::METRE),
    (NORTHING, Unit::METRE),
    (GROUND, Unit::METRE),
];

/// The unit of a signal of the route.
pub(super) fn unit_of(name: &str) -> Option<Unit> {
    OF_ROUTE.into_iter().find(|(own, _)| *own == name).map(|(_, unit)| unit)
}

/// Shortest stretch, s: half of the windows into which a drive is cut.
const SHORTEST: f64 = 3.0;

/// Shortest way of a stretch, m: over a shorter one only the start of slip is seen.
const LEAST_WAY: f64 = 0.1;

/// The columns of a route, whose cells may be missing.
pub(super) fn columns() -> impl Iterator<Item = Column> {
    OF_ROUTE.into_iter().map(|(name, _)| column(name, Use::Intermediate, None))
}

/// What is stated of the vehicle and of where the run began.
pub(super) struct Stated {
    /// Of the wheels, m.
    pub radius: Option<f64>,
    /// Distance of the axle that is farthest from the middle, m.
    pub lever: Option<f64>,
    /// Where the run begins, m.
    pub x0: Option<f64>,
    /// Whether a file gives the ground.
    pub has_ground: bool,
    /// Fewest rows of a run.
    pub least_rows: usize,
    /// Whether the experiment may still have to be made, so that measured columns may be empty.
    pub planned: bool,
}

/// One stretch: a run of its own.
pub(super) struct Stretch {
    pub grid: Grid,
    /// Its rows among those that were read.
    pub rows: Range<usize>,
    /// Where it begins, m.
    pub x0: Option<f64>,
    /// The ground under it, where the rows give it.
    pub ground: Option<Table>,
}

/// What a run records of its way.
struct Course {
    recorded: RouteColumns,
    time: Vec<f64>,
    rims: Rims,
    /// Time over which values are averaged, s.
    within: f64,
    route: Option<Route>,
}

impl Course {
    /// Takes it out of the grid; `None` where nothing is said of the heading.
    ///
    /// # Errors
    /// [`ExperimentError`] where a column of the route lacks what it needs beside it.
    fn of(grid: &mut Grid, stated: &Stated) -> Result<Option<Self>, ExperimentError> {
        let (recorded, time) = (RouteColumns::take(grid), grid.values("time").map(<[f64]>::to_vec));
        let (Some(recorded), Some(time)) = (recorded, time) else { return Ok(None) };
        check_time(grid)?;
        let (rims, within) = (Rims::of(grid, &time, stated.radius), curves::within(&time));
        let positions = recorded.positions(grid)?;
        let route =
            positions.map(|(east, north)| Route::new(&time, [&east.values, &north.values], &rims.speed, within));
        recorded.check(grid, stated, &rims, route.as_ref())?;
        Ok(Some(Self { recorded, time, rims, within, route }))
    }

    fn turning(&self, stated: &Stated, limit: f64) -> Turning<'_> {
        Turning {
            time: &self.time,
            within: self.within,
            yaw_rate: self.recorded.yaw_rate.as_ref(),
            heading: self.recorded.heading.as_ref(),
            route: self.route.as_ref(),
            lever: stated.lever.or(stated.radius.map(|radius| 2.0 * radius)).unwrap_or(USUAL_LEVER),
            limit,
        }
    }

    /// The straight stretches.
    fn pieces(&self, grid: &Grid, stated: &Stated, limit: f64) -> Vec<Range<usize>> {
        let straight = self.turning(stated, limit).straight(grid, &self.rims);
        let mut pieces = pieces(&self.time, &straight, stated.least_rows);
        pieces.retain(|piece| straight.way(&self.time, piece) >= LEAST_WAY);
        pieces
    }
}

/// Slip angle of the end wheels from which on the vehicle of these runs turns, rad: as gentle as its drive asks for, while straight
/// stretches are left.
pub(super) fn slip_angle<'a>(runs: impl Iterator<Item = (&'a Grid, &'a Stated)>) -> f64 {
    let mut all = Vec::new();
    for (grid, stated) in runs {
        let mut own = grid.clone();
        // What is wrong with a route is said where it is cut.
        if let Ok(Some(course)) = Course::of(&mut own, stated) {
            all.push((own, stated, course));
        }
    }
    let needs =
        all.iter().map(|(grid, stated, course)| course.turning(stated, curves::SLIP_ANGLE).needs(grid, &course.rims));
    let mut limit = gentle::limit(&needs.collect::<Vec<_>>());
    let is_left = |limit: f64| all.iter().any(|(grid, stated, course)| !course.pieces(grid, stated, limit).is_empty());
    while limit < curves::SLIP_ANGLE && !is_left(limit) {
        limit *= 2.0;
    }
    limit
}

/// The straight stretches of the rows of one run, of a vehicle that turns from a slip angle `limit` (rad) on; all of it where nothing is said
/// of its heading.
///
/// # Errors
/// [`ExperimentError`] where a column of the route lacks what it needs beside it.
pub(super) fn stretches(
    mut grid: Grid,
    stated: &Stated,
    limit: f64,
    left_out: &mut LeftOut,
) -> Result<Vec<Stretch>, ExperimentError> {
    let Some(course) = Course::of(&mut grid, stated)? else {
        let rows = 0..grid.lines.len();
        return Ok(vec![Stretch { grid, rows, x0: stated.x0, ground: None }]);
    };
    let mut pieces = course.pieces(&grid, stated, limit);
    let tightest = [limit, curves::SLIP_ANGLE].map(|limit| course.turning(stated, limit).tightest());
    let Course { recorded, time, within, route, .. } = course;
    let positions = recorded.positions(&grid)?;
    let x = places(&grid, &time, route.as_ref(), stated, within);
    if x.is_none() && stated.has_ground && pieces.iter().any(|piece| piece.start > 0) {
        return Err(recorded.without_a_place(&grid));
    }
    if let (Some(route), Some((east, _))) = (&route, positions) {
        let values = route.measured_x(stated.x0.unwrap_or(0.0));
        grid.columns.push(GridColumn::plain("x", &east.source, Use::Measured, values));
    }
    pieces.retain(|piece| stated.planned || grid.measures(piece.clone()));
    left_out.count(time.len(), &pieces, tightest);
    let one = |rows: Range<usize>| {
        let heights = recorded.height.as_ref().zip(x.as_ref());
        let ground = heights.map(|(height, x)| under(&grid, &time, x, height, rows.clone())).transpose()?;
        let place = x.as_ref().map(|x| x[rows.start]);
        // Behind a turn the vehicle is not where the run began.
        let x0 = if rows.start == 0 { stated.x0.or(place) } else { place };
        Ok(Stretch { grid: grid.part(rows.clone()), rows, x0, ground })
    };
    pieces.into_iter().map(one).collect()
}

/// The ground under a stretch.
fn under(
    grid: &Grid,
    time: &[f64],
    x: &[f64],
    height: &GridColumn,
    rows: Range<usize>,
) -> Result<Table, ExperimentError> {
    ground::under(x, &height.values, rows.clone()).ok_or_else(|| {
        let (from, to) = (time[rows.start], time[rows.end - 1]);
        refused(grid, height, format!("it has no value between {from:.1} and {to:.1} s to give the ground"))
    })
}

/// Where the vehicle is, row by row, m: by its route, or as recorded.
fn places(grid: &Grid, time: &[f64], route: Option<&Route>, stated: &Stated, within: f64) -> Option<Vec<f64>> {
    let places = match route {
        Some(route) => route.smooth_x(stated.x0.unwrap_or(0.0)),
        None => lines(time, &filled(time, grid.values("x")?), within),
    };
    places.iter().any(|x| x.is_finite()).then_some(places)
}

/// Straight rows that follow each other for long enough, from the first to the last in which the wheels turn.
fn pieces(time: &[f64], straight: &Straight, least_rows: usize) -> Vec<Range<usize>> {
    let mut all = Vec::new();
    let mut from = 0;
    for row in 0..=time.len() {
        if straight.rows.get(row) == Some(&true) {
            continue;
        }
        let piece = straight.trimmed(from..row);
        if piece.len() >= least_rows.max(1) && time[piece.end - 1] - time[piece.start] >= SHORTEST {
            all.push(piece);
        }
        from = row + 1;
    }
    all
}
