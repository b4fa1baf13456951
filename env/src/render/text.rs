//! The rover in a terminal: a line of numbers, and the ground ahead in characters.

use super::scene::Scene;
use bekker::rover::Rover;
use bekker::signals::Signals;

/// Characters of the profile, lowest to highest.
const LEVELS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
const COLUMNS: usize = 64;
/// Length of the profile in lengths of the vehicle; the rover stands at a third of it.
const LENGTHS: f64 = 4.0;

/// The numbers, then the profile with `o` where a wheel stands.
pub fn text(scene: &Scene, rover: &Rover, time: f64, signals: &Signals, status: &str) -> String {
    let body = &signals.body;
    let slip = signals.wheels.iter().map(|wheel| wheel.slip).sum::<f64>() / signals.wheels.len().max(1) as f64;
    let sinkage = signals.wheels.iter().fold(0.0_f64, |deepest, wheel| deepest.max(wheel.sinkage));
    let numbers = format!(
        "t {time:7.2} s  x {:7.3} m  speed {:6.3} m/s  pitch {:5.1} deg  slip {:5.1} %  sinkage {:5.1} mm  {status}",
        body.x,
        body.velocity,
        body.pitch.to_degrees(),
        100.0 * slip,
        1e3 * sinkage,
    );
    let span = LENGTHS * scene.length;
    let start = scene.middle - span / 3.0;
    let column = |k: usize| start + span * (k as f64 + 0.5) / COLUMNS as f64;
    let heights: Vec<f64> = (0..COLUMNS).map(|k| rover.terrain.at(column(k)).height).collect();
    let low = heights.iter().copied().fold(f64::INFINITY, f64::min);
    let high = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    // Level ground stays level: what is less than half a wheel's radius high is not blown up.
    let range = (high - low).max(0.5 * scene.radius);
    let level = |height: f64| ((height - low) / range * (LEVELS.len() - 1) as f64).round() as usize;
    let mut profile: Vec<char> = heights.iter().map(|height| LEVELS[level(*height).min(LEVELS.len() - 1)]).collect();
    for wheel in &scene.wheels {
        let place = ((wheel.centre[0] - start) / span * COLUMNS as f64).floor();
        if let Some(character) = profile.get_mut(place.max(0.0) as usize).filter(|_| place >= 0.0) {
            *character = 'o';
        }
    }
    format!("{numbers}\n{}", profile.into_iter().collect::<String>())
}
