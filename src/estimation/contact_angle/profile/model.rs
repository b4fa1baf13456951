//! What the filter of a ground believes and reads.

use super::super::pairs::Pair;

/// What the filter of a ground believes.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileModel {
    /// Pairs of points that the wheels are in, each after those that it builds on.
    pub pairs: Vec<Pair>,
    /// Distance of every wheel's centre from the rearmost one, along the drawing, m.
    pub places: Vec<f64>,
    /// Standard deviation of the slope about its mean, rad.
    pub angle_deviation: f64,
    /// Way over which the autocorrelation of the slope falls to 1/e, m.
    pub correlation_length: f64,
    /// Standard deviation of the change of the speed within a second, a random walk, m/s.
    pub speed_drift: f64,
    /// Mean of the slips.
    pub slip: f64,
    /// Standard deviation of every wheel's slip about that.
    pub slip_deviation: f64,
    /// Way over which a slip lasts, m.
    pub slip_length: f64,
    /// Other error of the speeds, share of the speed, which lasts as long as a slope does.
    pub kinematic_error: f64,
    /// Standard deviation of the height of a wheel's centre over the path that the others take, m; it lasts as long.
    pub path_deviation: f64,
    /// White error of the rates that the path makes, standard deviation, rad/s.
    pub rate_error: f64,
}

/// A reading of all wheels and pairs, each a value with its variance.
#[derive(Clone, Copy, Debug)]
pub struct ProfileReading<'a> {
    /// Inclination of every pair, rad.
    pub inclinations: &'a [[f64; 2]],
    /// Rate of every pair, rad/s, where it is measured.
    pub rates: Option<&'a [[f64; 2]]>,
    /// Speed of every wheel's rim past its centre, m/s.
    pub speeds: &'a [[f64; 2]],
}
