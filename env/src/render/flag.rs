//! The goal.

use super::canvas::{Canvas, Colour};
use super::scene::View;
use bekker::rover::Rover;

const POLE: Colour = [70, 76, 88, 255];
const CLOTH: Colour = [58, 142, 92, 255];
const RIM: Colour = [255, 255, 255, 170];

/// Height of the pole, and width and height of the flag, in pixels.
const HEIGHT: f32 = 110.0;
const SIZE: [f32; 2] = [46.0, 28.0];

/// A flag where the chassis reference point is to come, x in metres; nothing where that is out of the picture.
pub fn draw(canvas: &mut Canvas, view: &View, rover: &Rover, x: f64) {
    let [column, ground] = view.pixel([x, rover.terrain.at(x).height]);
    if column < -SIZE[0] || column > canvas.width() {
        return;
    }
    let top = ground - HEIGHT;
    canvas.line(&[[column, ground], [column, top]], 6.0, RIM);
    canvas.line(&[[column, ground], [column, top]], 4.0, POLE);
    let cloth = [[column, top], [column + SIZE[0], top + 0.5 * SIZE[1]], [column, top + SIZE[1]]];
    canvas.polygon(&cloth, CLOTH);
    canvas.outline(&cloth, 1.5, POLE);
}
