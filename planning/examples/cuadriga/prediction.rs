//! The model's force along the way over a map of hills, calibrated to a current on some drives and judged on others.

use bekker::soil::Soil;
use bekker::wheel::Wheel;
use bekker_planning::anisotropic::{EnergyError, SlopeEnergy};
use bekker_planning::map::{CsvGrid, ElevationMap, Interpolation, Surface};
use std::path::Path;

type Failure = Box<dyn std::error::Error>;

/// Length of a stretch, m, and how far from its straight line the drive may be.
const LENGTH: f64 = 10.0;
const BESIDE: f64 = 0.5;
/// The wheels turn faster than this (about rpm) in all but 2 % of a stretch's rows.
const TURNS: f64 = 3.0;
const TURNING: f64 = 0.98;
/// A row is not farther than this from the one before it, m: the satellite receiver jumps otherwise (10 rows a second at 0.5 m/s).
const JUMP: f64 = 1.0;
/// Rows by which the search goes on where no stretch begins.
const ONWARD: usize = 5;
/// The mass is not given; what is wrong in it is taken up by the calibration.
const WEIGHT: f64 = 400.0 * 9.81;

/// A straight stretch of a drive.
pub struct Stretch {
    /// The drive, in the order of time.
    pub drive: usize,
    pub from: [f64; 2],
    pub to: [f64; 2],
    /// Mean current of both sides, A.
    pub current: f64,
}

/// Which drives are calibrated on; the others are judged.
#[derive(Clone, Copy)]
pub enum Split {
    Even,
    Odd,
    January,
    June,
}

/// Drives of January 2019; those after them are of June.
const IN_JANUARY: usize = 7;

impl Split {
    pub const ALL: [Self; 4] = [Self::Even, Self::Odd, Self::January, Self::June];

    pub fn name(self) -> &'static str {
        match self {
            Self::Even => "even drives, judged on odd ones",
            Self::Odd => "odd drives, judged on even ones",
            Self::January => "January, judged on June",
            Self::June => "June, judged on January",
        }
    }

    /// Whether it is judged on drives of another season than it is calibrated on.
    pub fn crosses_seasons(self) -> bool {
        matches!(self, Self::January | Self::June)
    }

    fn calibrates(self, drive: usize) -> bool {
        match self {
            Self::Even => drive.is_multiple_of(2),
            Self::Odd => !drive.is_multiple_of(2),
            Self::January => drive < IN_JANUARY,
            Self::June => drive >= IN_JANUARY,
        }
    }
}

/// Mean and root of the mean square error, in % of the judged stretches' mean absolute current.
pub type Errors = [f64; 2];

/// What came of a split.
pub struct Judged {
    pub calibrated: usize,
    pub judged: usize,
    pub model: Errors,
    /// Of the line in the slope that fits the judged stretches themselves best.
    pub line: Errors,
    /// Of the calibration's mean current.
    pub distance: Errors,
    /// A/N.
    pub current_per_force: f64,
    /// N.
    pub resistance: f64,
}

pub fn hills(data: &Path) -> Result<Surface, Failure> {
    let map = ElevationMap::read(&data.join("uma_hills/uma_rescue_area_1m_dem.csv"), &CsvGrid::default())?;
    Ok(Surface::new(map.without_spikes(2.0)?.0, Interpolation::Smooth))
}

/// All stretches of all drives.
pub fn stretches(data: &Path) -> Result<Vec<Stretch>, Failure> {
    let folder = std::fs::read_dir(data.join("cuadriga_2019"))?;
    let files = folder.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>, std::io::Error>>()?;
    let mut files: Vec<_> =
        files.into_iter().filter(|file| file.extension().is_some_and(|kind| kind == "csv")).collect();
    files.sort();
    let mut all = Vec::new();
    for (drive, file) in files.iter().enumerate() {
        let rows = rows(&std::fs::read_to_string(file)?)?;
        all.extend(of_drive(drive, &rows));
    }
    Ok(all)
}

/// A row: easting, northing, left and right wheel, left and right current.
type Row = [f64; 6];
const COLUMNS: [&str; 6] = ["easting", "northing", "wheel_left", "wheel_right", "current_left", "current_right"];

fn rows(text: &str) -> Result<Vec<Row>, Failure> {
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().ok_or("an empty file")?.split(',').collect();
    let place = |name: &str| header.iter().position(|column| *column == name).ok_or(format!("no column `{name}`"));
    let places = COLUMNS.map(place).into_iter().collect::<Result<Vec<_>, _>>()?;
    let row = |line: &str| -> Result<Row, Failure> {
        let cells: Vec<&str> = line.split(',').collect();
        let mut row = [0.0; 6];
        for (value, place) in row.iter_mut().zip(&places) {
            *value = cells.get(*place).ok_or("a short row")?.trim().parse()?;
        }
        Ok(row)
    };
    lines.map(row).collect()
}

fn far(a: &Row, b: &Row) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn of_drive(drive: usize, rows: &[Row]) -> Vec<Stretch> {
    let (mut found, mut first) = (Vec::new(), 0);
    while let Some(last) = (first..rows.len()).find(|&k| far(&rows[k], &rows[first]) >= LENGTH) {
        let part = &rows[first..=last];
        if is_straight(part) {
            // The right motor is mounted the other way round.
            let current = part.iter().map(|row| row[4] - row[5]).sum::<f64>() / part.len() as f64;
            let place = |row: &Row| [row[0], row[1]];
            found.push(Stretch { drive, from: place(&rows[first]), to: place(&rows[last]), current });
            first = last;
        } else {
            first += ONWARD;
        }
    }
    found
}

fn is_straight(part: &[Row]) -> bool {
    let (first, last) = (part[0], part[part.len() - 1]);
    let length = far(&first, &last);
    let ahead = [(last[0] - first[0]) / length, (last[1] - first[1]) / length];
    let on_line = |row: &Row| {
        let (x, y) = (row[0] - first[0], row[1] - first[1]);
        (x * ahead[1] - y * ahead[0]).abs() <= BESIDE && x * ahead[0] + y * ahead[1] > -BESIDE
    };
    let turning = part.iter().filter(|row| row[2].abs() > TURNS && row[3].abs() > TURNS).count();
    part.iter().all(on_line)
        && part.windows(2).all(|pair| far(&pair[0], &pair[1]) <= JUMP)
        && turning as f64 >= TURNING * part.len() as f64
}

/// Grass and dry soil, which hardly give way.
fn energy() -> Result<SlopeEnergy, EnergyError> {
    let soil = Soil {
        cohesion: 0.0,
        friction_angle: 0.7,
        k_c: 0.0,
        k_phi: 2e7,
        exponent: 1.0,
        shear_modulus: 0.003,
        ..Soil::default()
    };
    let wheel = Wheel { radius: 0.207, width: 0.15, ..Wheel::default() };
    SlopeEnergy::new(&soil, &wheel, WEIGHT, 4, 0.6)
}

/// Intercept and slope of the line through points that is best in squares.
fn line(points: &[(f64, f64)]) -> [f64; 2] {
    let count = points.len() as f64;
    let [x, y] = [points.iter().map(|p| p.0).sum::<f64>() / count, points.iter().map(|p| p.1).sum::<f64>() / count];
    let slope = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>()
        / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>();
    [y - slope * x, slope]
}

/// Pieces of a stretch by whose slopes its force is found: two spacings of the map, about as long as the vehicle, which bridges what is
/// shorter.
const PIECES: usize = 5;

/// Forces of the model along the pieces of a stretch, N, negative where the wheels brake; by the slope in the direction of travel.
fn forces(surface: &Surface, energy: &SlopeEnergy, stretch: &Stretch) -> Vec<f64> {
    let place = |share: f64| [0, 1].map(|axis| (1.0 - share) * stretch.from[axis] + share * stretch.to[axis]);
    let height = |k: usize| surface.height(place(k as f64 / PIECES as f64)).unwrap_or(f64::NAN);
    let piece = length(stretch) / PIECES as f64;
    let slope = |k: usize| ((height(k + 1) - height(k)) / piece).atan();
    (0..PIECES).map(|k| energy.signed(slope(k)) / slope(k).cos()).collect()
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    values.sum::<f64>() / count
}

fn length(stretch: &Stretch) -> f64 {
    (stretch.to[0] - stretch.from[0]).hypot(stretch.to[1] - stretch.from[1])
}

/// Calibrates on a split's drives and judges on the others.
pub fn judged(surface: &Surface, stretches: &[Stretch], split: Split) -> Result<Judged, Failure> {
    let energy = energy()?;
    let (known, held_out): (Vec<&Stretch>, Vec<&Stretch>) =
        stretches.iter().partition(|stretch| split.calibrates(stretch.drive));
    let model = |stretch: &Stretch| forces(surface, &energy, stretch);
    let points: Vec<(f64, f64)> =
        known.iter().map(|stretch| (mean(model(stretch).into_iter()), stretch.current)).collect();
    let [standing, current_per_force] = line(&points);
    let resistance = standing / current_per_force;
    // Downhill what pulls the rover is first taken by what resists it; below nothing no current flows.
    let predicted = |stretch: &Stretch| {
        current_per_force * mean(model(stretch).into_iter().map(|force| (force + resistance).max(0.0)))
    };
    let height = |at: [f64; 2]| surface.height(at).unwrap_or(f64::NAN);
    let slope = |stretch: &Stretch| (height(stretch.to) - height(stretch.from)) / length(stretch);
    let own: Vec<(f64, f64)> = held_out.iter().map(|stretch| (slope(stretch), stretch.current)).collect();
    let [level, steep] = line(&own);
    let mean_known = mean(known.iter().map(|stretch| stretch.current));
    let size = mean(held_out.iter().map(|stretch| stretch.current.abs()));
    let errors = |predicted: &dyn Fn(&Stretch) -> f64| -> Errors {
        let errors: Vec<f64> = held_out.iter().map(|stretch| predicted(stretch) - stretch.current).collect();
        let count = errors.len() as f64;
        let (sum, squares) = errors.iter().fold((0.0, 0.0), |(sum, squares), e| (sum + e.abs(), squares + e * e));
        [100.0 * sum / count / size, 100.0 * (squares / count).sqrt() / size]
    };
    Ok(Judged {
        calibrated: known.len(),
        judged: held_out.len(),
        model: errors(&predicted),
        line: errors(&|stretch| level + steep * slope(stretch)),
        distance: errors(&|_| mean_known),
        current_per_force,
        resistance,
    })
}
