//! What is taken to be known of the ground before it is driven on: a smooth random slope along the way.

use nalgebra::SMatrix;

/// The slope and its derivatives along the way that a process has as its state.
pub(super) const ORDER: usize = 3;

/// lambda times the distance over which the autocorrelation falls to 1/e: (1 + u + u^2/3) exp(-u) = 1/e.
const DECAY: f64 = 2.904_6;

/// Square matrix over the slope and its derivatives.
pub(super) type Derivatives = SMatrix<f64, ORDER, ORDER>;

/// Slope along the way as a stationary Gaussian process with the autocorrelation (1 + u + u^2/3) exp(-u) in
/// u = lambda distance (Matern, smoothness 5/2): twice differentiable, so that heights are so three times. Sampled at equal
/// spacing, slope and derivatives are a Markov chain (Hartikainen and Sarkka 2010).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Process {
    /// From one place to the next.
    pub transition: Derivatives,
    /// Covariance of what is new at the next place.
    pub news: Derivatives,
    /// Covariance at one place.
    pub stationary: Derivatives,
    /// Correlation of the slopes at neighbouring places.
    pub correlation: f64,
}

impl Process {
    /// Of a slope with standard deviation `deviation`, rad, whose autocorrelation falls to 1/e over `length`, m, at places
    /// `spacing` (m) apart.
    pub fn new(deviation: f64, length: f64, spacing: f64) -> Self {
        let lambda = DECAY / length;
        // The companion matrix plus lambda is nilpotent: its exponential ends after the square.
        let nilpotent = Derivatives::new(
            lambda,
            1.0,
            0.0,
            0.0,
            lambda,
            1.0,
            -lambda.powi(3),
            -3.0 * lambda * lambda,
            -2.0 * lambda,
        ) * spacing;
        let decay = (-lambda * spacing).exp();
        let transition = decay * (Derivatives::identity() + nilpotent + 0.5 * nilpotent * nilpotent);
        let variance = deviation * deviation;
        let of_slope = variance * lambda * lambda / 3.0;
        let stationary =
            Derivatives::new(variance, 0.0, -of_slope, 0.0, of_slope, 0.0, -of_slope, 0.0, variance * lambda.powi(4));
        let news = stationary - transition * stationary * transition.transpose();
        let u = lambda * spacing;
        Self { transition, news, stationary, correlation: (1.0 + u + u * u / 3.0) * decay }
    }
}
