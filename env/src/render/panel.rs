//! The numbers: time, speed, slip of each wheel, and what the arrows mean.

use super::Asked;
use super::canvas::{Canvas, Colour};
use super::ground::Colours;
use super::letters;
use super::vehicle::{DRAWBAR, NORMAL, PULL};
use bekker::signals::Signals;

const SIZE: f32 = 13.0;
const LINE: f32 = 24.0;
const EDGE: f32 = 14.0;
/// Slip beyond this is drawn in another colour: past the peak of most soils' pull.
const MUCH_SLIP: f64 = 0.4;
const LITTLE: Colour = [58, 142, 92, 255];
const MUCH: Colour = [206, 44, 66, 255];

pub fn draw(canvas: &mut Canvas, time: f64, signals: &Signals, status: &str, asked: Asked, colours: &Colours) {
    let wheels = signals.wheels.len();
    let bars = 8.0 + 9.0 * wheels as f32;
    let lines = lines(time, signals, asked);
    let count = lines.len() as f32;
    let widest = lines.iter().map(|line| letters::width(line, SIZE)).fold(0.0, f32::max);
    let size = [widest + 2.0 * EDGE, count * LINE + bars + 1.5 * EDGE];
    canvas.card([EDGE, EDGE], size, 8.0, colours.card);
    for (k, line) in lines.iter().enumerate() {
        letters::write(canvas, line, [2.0 * EDGE, 2.0 * EDGE + k as f32 * LINE], SIZE, colours.ink);
    }
    let top = 2.0 * EDGE + count * LINE;
    for (k, wheel) in signals.wheels.iter().enumerate() {
        bar(canvas, [2.0 * EDGE, top + 9.0 * k as f32], widest, wheel.slip);
    }
    legend(canvas, colours);
    if status != "running" {
        let text = status.replace('_', " ");
        let width = letters::width(&text, 1.6 * SIZE);
        let left = 0.5 * (canvas.width() - width);
        canvas.card([left - EDGE, EDGE], [width + 2.0 * EDGE, 1.6 * SIZE + 2.0 * EDGE], 8.0, MUCH);
        letters::write(canvas, &text, [left, 2.0 * EDGE], 1.6 * SIZE, [255, 255, 255, 255]);
    }
}

/// Time, what the task asks for beside what is, and slip last, above its bars.
fn lines(time: f64, signals: &Signals, asked: Asked) -> Vec<String> {
    let mut lines = vec![format!("time   {time:6.2} s")];
    lines.extend(asked.reward.map(|reward| format!("reward {reward:7.3}")));
    lines.extend(asked.goal.map(|x| format!("goal in {:5.2} m", x - signals.body.x)));
    lines.extend(asked.target.map(|target| format!("target{target:7.3} m/s")));
    lines.push(format!("speed {:7.3} m/s", signals.body.velocity));
    lines.push(slip(signals));
    lines
}

fn slip(signals: &Signals) -> String {
    let mean = signals.wheels.iter().map(|wheel| wheel.slip).sum::<f64>() / signals.wheels.len().max(1) as f64;
    format!("slip  {:7.1} %", 100.0 * mean)
}

/// Slip from -1 to 1, zero in the middle, of the wheels from rear to front.
fn bar(canvas: &mut Canvas, [x, y]: [f32; 2], width: f32, slip: f64) {
    let half = 0.5 * width;
    canvas.rectangle([x, y], [width, 6.0], [128, 132, 140, 70]);
    let length = slip.clamp(-1.0, 1.0) as f32 * half;
    let colour = if slip.abs() > MUCH_SLIP { MUCH } else { LITTLE };
    if length.abs() > 0.5 {
        canvas.rectangle([x + half + length.min(0.0), y], [length.abs(), 6.0], colour);
    }
    canvas.rectangle([x + half - 0.5, y - 1.0], [1.0, 8.0], [128, 132, 140, 255]);
}

fn legend(canvas: &mut Canvas, colours: &Colours) {
    let texts = [("normal force".to_owned(), NORMAL), (format!("{PULL} x drawbar pull"), DRAWBAR)];
    let widest = texts.iter().map(|(text, _)| letters::width(text, 0.85 * SIZE)).fold(0.0, f32::max);
    let size = [widest + 34.0 + 2.0 * EDGE, 2.0 * LINE + EDGE];
    let left = canvas.width() - size[0] - EDGE;
    canvas.card([left, EDGE], size, 8.0, colours.card);
    for (k, (text, colour)) in texts.into_iter().enumerate() {
        let row = 2.0 * EDGE + k as f32 * LINE;
        canvas.arrow([left + EDGE, row + 5.0], [24.0, 0.0], 3.0, colour);
        letters::write(canvas, &text, [left + EDGE + 34.0, row], 0.85 * SIZE, colours.ink);
    }
}
