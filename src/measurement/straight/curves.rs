//! Where a vehicle turns.

use super::super::around::{filled, means, slopes};
use super::super::grid::{Grid, GridColumn};
use super::gentle::Need;
use super::route::Route;
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// Rows within this time of a row tell how the vehicle moves there, s, and at least its neighbours, in usual times between rows.
const AROUND: f64 = 0.5;
const NEIGHBOURS: f64 = 1.5;

/// Slip angle of the end wheels, rad, from which on a vehicle counts as turning: 6 degrees, reached in a curve whose radius is five times
/// the distance between the end axles. The value is a judgement, not a measurement.
pub(super) const SLIP_ANGLE: f64 = 0.1;

/// Least speed, m/s, with which a yaw rate is compared: noise of a gyroscope is no turn of a vehicle that hardly moves.
const SLOWEST: f64 = 0.02;

/// Share of its usual speed under which a vehicle stands.
const STANDS: f64 = 0.1;

/// Distance of an end wheel from the middle of a vehicle of which nothing is stated, m.
pub(super) const USUAL_LEVER: f64 = 0.3;

/// Time from a row within which rows tell how the vehicle moves there, s.
pub(super) fn within(time: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).map_or(AROUND, |usual| AROUND.max(NEIGHBOURS * usual))
}

/// What tells how a vehicle turns.
pub(super) struct Turning<'a> {
    pub time: &'a [f64],
    /// Time over which values are averaged, s.
    pub within: f64,
    pub yaw_rate: Option<&'a GridColumn>,
    pub heading: Option<&'a GridColumn>,
    pub route: Option<&'a Route>,
    /// Distance of an end wheel from the middle, m.
    pub lever: f64,
    /// Slip angle of the end wheels from which on the vehicle turns, rad.
    pub limit: f64,
}

/// How a vehicle moves, row by row.
struct Motion {
    /// How fast, m/s, as far as it is known.
    speeds: Vec<f64>,
    /// Yaw rate, rad/s.
    rates: Vec<f64>,
    /// Whether it stands.
    stands: Vec<bool>,
    /// Share [`STANDS`] of the usual speed of the rims.
    slow: f64,
}

/// Rows in which a vehicle drives straight.
pub(super) struct Straight {
    pub rows: Vec<bool>,
    /// How fast it drives, m/s.
    speeds: Vec<f64>,
    /// Whether its wheels turn in the row itself.
    turning_wheels: Vec<bool>,
}

impl Straight {
    /// The rows less those at both ends in which the wheels stand. Whether a vehicle drives is told by speeds that are averaged over a
    /// second, so that a stretch begins and ends with some of these; a wheel that stands while the vehicle moves on slides in the model.
    pub fn trimmed(&self, rows: Range<usize>) -> Range<usize> {
        let turns = |row: &usize| self.turning_wheels[*row];
        let start = rows.clone().find(turns).unwrap_or(rows.end);
        let end = rows.rev().find(turns).map_or(start, |row| row + 1);
        start..end
    }

    /// How far it drives over these rows, m.
    pub fn way(&self, time: &[f64], rows: &Range<usize>) -> f64 {
        rows.clone().skip(1).map(|row| self.speeds[row] * (time[row] - time[row - 1])).sum()
    }
}

impl Turning<'_> {
    /// Radius of the tightest curve that counts as straight, m.
    pub fn tightest(&self) -> f64 {
        self.lever / self.limit
    }

    /// The rows in which the vehicle drives straight; `rims` are the speeds of its wheels. A row that nothing tells of counts as
    /// straight.
    pub fn straight(&self, grid: &Grid, rims: &Rims) -> Straight {
        let Motion { speeds, rates, stands, slow } = self.motion(grid, rims);
        // Written so that NaN, of which nothing is known, turns nothing.
        let turns = |row: usize| self.lever * rates[row].abs() > self.limit * speeds[row].max(SLOWEST);
        let rows = (0..self.time.len()).map(|row| !turns(row) && !stands[row]).collect();
        let turning_wheels = rims.speed.iter().map(|speed| speed.abs() > slow).collect();
        Straight { rows, speeds, turning_wheels }
    }

    /// What the vehicle needs in the rows in which it drives, of which both the slip angle and the need are known.
    pub fn needs(&self, grid: &Grid, rims: &Rims) -> Vec<Need> {
        let Motion { speeds, rates, stands, .. } = self.motion(grid, rims);
        let Some(size) = of_the_drive(grid).map(|sizes| means(self.time, &sizes, self.within)) else {
            return Vec::new();
        };
        let need = |row: usize| Need {
            time: self.time[row],
            angle: self.lever * rates[row].abs() / speeds[row].max(SLOWEST),
            size: size[row],
        };
        let known = |need: &Need| need.angle.is_finite() && need.size.is_finite();
        (0..self.time.len()).filter(|row| !stands[*row]).map(need).filter(known).collect()
    }

    fn motion(&self, grid: &Grid, rims: &Rims) -> Motion {
        let velocity = grid.values("velocity").map(|values| means(self.time, values, self.within));
        let smooth = means(self.time, &rims.speed, self.within);
        let speed = |row: usize| {
            let measured = velocity.as_ref().map(|velocity| velocity[row]);
            let along = self.route.map(|route| route.speed(row));
            let known = [measured, along, Some(smooth[row]).filter(|_| rims.in_metres)];
            // Where nothing tells, no turn shows.
            known.into_iter().flatten().find(|speed| speed.is_finite()).map_or(f64::INFINITY, f64::abs)
        };
        let speeds: Vec<f64> = (0..self.time.len()).map(speed).collect();
        let mut sorted: Vec<f64> = smooth.iter().map(|v| v.abs()).filter(|v| *v > 0.0).collect();
        sorted.sort_by(f64::total_cmp);
        let slow = STANDS * sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
        let stands = smooth.iter().map(|speed| speed.abs() <= slow).collect();
        Motion { rates: self.rates(&speeds), speeds, stands, slow }
    }

    /// Yaw rates, rad/s, row by row: as measured, else by the heading, else by the positions.
    fn rates(&self, speeds: &[f64]) -> Vec<f64> {
        let measured = self.yaw_rate.map(|column| means(self.time, &column.values, self.within));
        let by_heading = self.heading.map(|column| {
            let heading = filled(self.time, &unwrapped(&column.values));
            slopes(self.time, &heading, self.within)
        });
        let rate = |row: usize| {
            let own = [&measured, &by_heading].into_iter().flatten().map(|rates| rates[row]);
            let by_route = self.route.map(|route| route.curvature(row) * speeds[row]);
            own.chain(by_route).find(|rate| rate.is_finite()).unwrap_or(f64::NAN)
        };
        (0..self.time.len()).map(rate).collect()
    }
}

/// A heading that does not jump where it passes the end of its range.
fn unwrapped(heading: &[f64]) -> Vec<f64> {
    let mut last = f64::NAN;
    let mut turns = 0.0;
    let next = |angle: &f64| {
        if angle.is_nan() {
            return *angle;
        }
        if last - angle > PI {
            turns += TAU;
        } else if angle - last > PI {
            turns -= TAU;
        }
        last = *angle;
        angle + turns
    };
    heading.iter().map(next).collect()
}

/// How fast the rims move, row by row.
pub(super) struct Rims {
    /// Mean over the wheels, m/s; rad/s where their radius is not stated, and 1 in all rows where no speed is recorded, as a vehicle under
    /// torques counts as moving.
    pub speed: Vec<f64>,
    /// Whether it is in m/s.
    pub in_metres: bool,
}

impl Rims {
    /// By the commands or, where there are none, the measured speeds; `radius` is the wheels', m.
    pub fn of(grid: &Grid, time: &[f64], radius: Option<f64>) -> Self {
        let of = |fields: [&str; 2]| -> Vec<&GridColumn> {
            let is_one = |column: &&GridColumn| {
                column.name.starts_with("wheel[") && fields.iter().any(|field| column.name.ends_with(field))
            };
            grid.columns.iter().filter(is_one).collect()
        };
        let commands = of(["].speed_command", "].rim_speed_command"]);
        let columns = if commands.is_empty() { of(["].speed", "].rim_speed"]) } else { commands };
        let factor = |column: &GridColumn| if column.name.contains("].rim_") { Some(1.0) } else { radius };
        let mean = |row: usize| {
            let present =
                columns.iter().map(|c| factor(c).unwrap_or(1.0) * c.values[row]).filter(|value| !value.is_nan());
            let (sum, count) = present.fold((0.0, 0_usize), |(sum, count), value| (sum + value, count + 1));
            if count > 0 { sum / count as f64 } else { f64::NAN }
        };
        let speed = if columns.is_empty() { vec![1.0; time.len()] } else { (0..time.len()).map(mean).collect() };
        let in_metres = !columns.is_empty() && columns.iter().all(|column| factor(column).is_some());
        Self { speed: filled(time, &speed), in_metres }
    }
}

/// What the drive needs, row by row: the mean size of the currents or, where there are none, of the torques; `None` without these.
fn of_the_drive(grid: &Grid) -> Option<Vec<f64>> {
    let of = |field: &str| -> Vec<&GridColumn> {
        grid.columns.iter().filter(|c| c.name.starts_with("wheel[") && c.name.ends_with(field)).collect()
    };
    let columns = [of("].current"), of("].torque")].into_iter().find(|columns| !columns.is_empty())?;
    let mean = |row: usize| columns.iter().map(|c| c.values[row].abs()).sum::<f64>() / columns.len() as f64;
    Some((0..grid.lines.len()).map(mean).collect())
}
