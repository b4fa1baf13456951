//! Straight stretches of a drive: what a planar model can describe of a vehicle that also turns.
//!
//! A log of the field has curves, turns on the spot and pauses. Where it says how the vehicle's heading changes (`yaw_rate`, `heading`,
//! or positions `easting` and `northing`), rows in which the vehicle turns are left out, and each straight stretch between them is a run
//! of its own. Positions give the way `x` along the drive, `ground_height` the ground under it. What is left out is said among the
//! doubts.

mod curves;
mod ground;
mod route;

use super::around::lines;
use super::columns::{Column, Use, column};
use super::doubts::Doubts;
use super::error::{ExperimentError, Problem};
use super::grid::{Grid, GridColumn};
use super::reading::check_time;
use super::table::Table;
use bekker_modeldescription::Unit;
use curves::Rims;
use route::Route;
use std::ops::Range;
use std::path::Path;

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

/// Shortest way of a stretch, m: wheels that hardly roll tell of breaking loose alone.
const LEAST_WAY: f64 = 0.5;

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

/// How much of a file is left out.
#[derive(Default)]
pub(super) struct LeftOut {
    rows: usize,
    of: usize,
    stretches: usize,
    radius: f64,
}

impl LeftOut {
    /// Says it, where it is anything.
    ///
    /// # Errors
    /// [`ExperimentError`] where nothing is left.
    pub fn say(&self, file: &Path, doubts: &mut Doubts) -> Result<(), ExperimentError> {
        let Self { rows, of, stretches, radius } = self;
        if *rows == 0 {
            return Ok(());
        }
        if *stretches == 0 {
            let message = format!(
                "the vehicle nowhere drives straight for {SHORTEST} s and {LEAST_WAY} m (in no curve of a radius under {radius:.1} m), and the model is planar"
            );
            return Err(ExperimentError::in_file(file, Problem::Derived(message)));
        }
        let runs = if *stretches == 1 {
            "one straight stretch".to_owned()
        } else {
            format!("{stretches} straight stretches, each a run of its own")
        };
        doubts.add(
            file,
            format!(
                "{rows} of {of} rows are left out: the vehicle turns there (a curve of a radius under {radius:.1} m), stands, or drives \
                 straight for less than {SHORTEST} s or {LEAST_WAY} m in between, and the model is planar; the others are {runs}"
            ),
        );
        Ok(())
    }
}

/// The straight stretches of the rows of one run; all of it where nothing is said of its heading.
///
/// # Errors
/// [`ExperimentError`] where a column of the route lacks its partner, or there is no straight stretch.
pub(super) fn stretches(
    mut grid: Grid,
    stated: &Stated,
    left_out: &mut LeftOut,
) -> Result<Vec<Stretch>, ExperimentError> {
    let [heading, yaw_rate, easting, northing, height] = OF_ROUTE.map(|(name, _)| grid.take(name));
    if [&heading, &yaw_rate, &easting, &northing, &height].iter().all(|column| column.is_none()) {
        let rows = 0..grid.lines.len();
        return Ok(vec![Stretch { grid, rows, x0: stated.x0, ground: None }]);
    }
    check_time(&grid)?;
    let Some(time) = grid.values("time").map(<[f64]>::to_vec) else {
        let (x0, rows) = (stated.x0, 0..grid.lines.len());
        return Ok(vec![Stretch { grid, rows, x0, ground: None }]);
    };
    let positions = match (&easting, &northing) {
        (Some(east), Some(north)) => Some((east, north)),
        (None, None) => None,
        (Some(one), None) | (None, Some(one)) => {
            let missing = if one.name == EASTING { NORTHING } else { EASTING };
            return Err(refused(
                &grid,
                one,
                format!("a position needs `{EASTING}` and `{NORTHING}`; there is no `{missing}`"),
            ));
        }
    };
    let rims = Rims::of(&grid, stated.radius);
    let route = positions.map(|(east, north)| Route::new(&time, &east.values, &north.values, &rims.speed));
    if let Some((east, _)) = positions.filter(|_| grid.column("x").is_some()) {
        return Err(refused(
            &grid,
            east,
            "positions give `x`, which another column gives too; list one of them under `ignore = [..]`".to_owned(),
        ));
    }
    let turns = [&yaw_rate, &heading].into_iter().flatten().next();
    if let (Some(column), None, None, false) = (turns, grid.column("velocity"), &route, rims.in_metres) {
        let message = format!(
            "whether the vehicle turns shows beside its speed: give `velocity`, `{EASTING}` and `{NORTHING}`, or \"wheel.radius\" under [parameters]"
        );
        return Err(refused(&grid, column, message));
    }
    let lever = stated.lever.or(stated.radius.map(|radius| 2.0 * radius)).unwrap_or(curves::USUAL_LEVER);
    let turning = curves::Turning {
        time: &time,
        yaw_rate: yaw_rate.as_ref(),
        heading: heading.as_ref(),
        route: route.as_ref(),
        lever,
    };
    let straight = turning.straight(&grid, &rims.speed);
    let mut pieces = pieces(&time, &straight.rows, stated.least_rows);
    pieces.retain(|piece| straight.way(&time, piece) >= LEAST_WAY);
    left_out.of += time.len();
    left_out.rows += time.len() - pieces.iter().map(Range::len).sum::<usize>();
    left_out.stretches += pieces.len();
    left_out.radius = turning.tightest();
    let told = [&yaw_rate, &heading, &easting, &height].into_iter().flatten().next();
    let x = places(&grid, route.as_ref(), stated);
    if let (Some(column), true, true) = (&height, route.is_none(), grid.column("x").is_none()) {
        return Err(refused(
            &grid,
            column,
            format!("the height of the ground needs a place: `{EASTING}` and `{NORTHING}`, or `x`"),
        ));
    }
    if let (Some(column), true) = (&height, stated.has_ground) {
        return Err(refused(
            &grid,
            column,
            "it gives the ground, as `terrain` of the run does; leave one of them out".to_owned(),
        ));
    }
    let several = pieces.len() > 1 || pieces.iter().any(|piece| piece.start > 0);
    if let (true, true, None, Some(column)) = (several, stated.has_ground, &x, told) {
        let message = format!("stretches on the ground of a file need a place: `{EASTING}` and `{NORTHING}`, or `x`");
        return Err(refused(&grid, column, message));
    }
    if let (Some(route), Some((east, _))) = (&route, positions) {
        let values = route.places(stated.x0.unwrap_or(0.0));
        grid.columns.push(GridColumn::plain("x", &east.source, Use::Measured, values));
    }
    let one = |rows: Range<usize>| {
        let ground = match (&height, &x) {
            (Some(height), Some(x)) => Some(ground::under(x, &height.values, rows.clone()).ok_or_else(|| {
                refused(
                    &grid,
                    height,
                    format!(
                        "it has too few values between {:.1} and {:.1} s to give the ground",
                        time[rows.start],
                        time[rows.end - 1]
                    ),
                )
            })?),
            _ => None,
        };
        let x0 = x.as_ref().map(|x| x[rows.start]).filter(|x| x.is_finite()).or(stated.x0);
        Ok(Stretch { grid: grid.part(rows.clone()), rows, x0, ground })
    };
    pieces.into_iter().map(one).collect()
}

/// Where the vehicle is, row by row, m: by its route, or as recorded.
fn places(grid: &Grid, route: Option<&Route>, stated: &Stated) -> Option<Vec<f64>> {
    let of_route = route.map(|route| route.way(stated.x0.unwrap_or(0.0)));
    of_route.or_else(|| {
        let time = grid.values("time")?;
        Some(lines(time, grid.values("x")?, curves::AROUND))
    })
}

/// Straight rows that follow each other for long enough.
fn pieces(time: &[f64], straight: &[bool], least_rows: usize) -> Vec<Range<usize>> {
    let mut all = Vec::new();
    let mut from = 0;
    for row in 0..=straight.len() {
        if straight.get(row) == Some(&true) {
            continue;
        }
        if row >= from + least_rows && time[row - 1] - time[from] >= SHORTEST {
            all.push(from..row);
        }
        from = row + 1;
    }
    all
}

fn refused(grid: &Grid, column: &GridColumn, message: String) -> ExperimentError {
    grid.error(Problem::Derived(message)).at_line(grid.header_line).at_column(&column.source)
}
