//! Sky, soil, ruts.

use super::canvas::{Canvas, Colour};
use super::letters;
use super::scene::{Scene, View};
use bekker::rover::Rover;
use bekker::signals::Signals;
use std::collections::BTreeMap;

/// Colours of a place.
pub struct Colours {
    sky: [Colour; 2],
    surface: Colour,
    depth: Colour,
    edge: Colour,
    /// Weaker soil, and soil that wheels have pressed.
    loose: Colour,
    pressed: Colour,
    grain: [Colour; 3],
    pub ink: Colour,
    pub card: Colour,
}

impl Colours {
    /// The Earth's sand, Mars or the Moon, whichever gravity is near, m/s^2.
    pub fn of(gravity: f64) -> Self {
        let day = |sky, surface, depth, edge: Colour, grain: [Colour; 3]| Self {
            sky,
            surface,
            depth,
            edge,
            loose: grain[0],
            pressed: edge,
            grain,
            ink: [38, 40, 46, 255],
            card: [255, 255, 255, 205],
        };
        if gravity > 6.0 {
            day(
                [[176, 208, 232, 255], [238, 244, 246, 255]],
                [219, 188, 136, 255],
                [160, 122, 74, 255],
                [128, 94, 54, 255],
                [[246, 224, 180, 150], [130, 96, 58, 130], [184, 146, 96, 160]],
            )
        } else if gravity > 2.5 {
            day(
                [[214, 178, 148, 255], [242, 224, 204, 255]],
                [200, 116, 72, 255],
                [122, 58, 36, 255],
                [98, 44, 28, 255],
                [[232, 160, 116, 150], [96, 44, 28, 130], [160, 84, 52, 160]],
            )
        } else {
            let night = day(
                [[8, 9, 14, 255], [32, 34, 44, 255]],
                [172, 172, 170, 255],
                [92, 92, 92, 255],
                [220, 220, 216, 255],
                [[214, 214, 210, 150], [72, 72, 74, 140], [130, 130, 130, 160]],
            );
            Self { ink: [236, 238, 242, 255], card: [16, 18, 24, 205], pressed: [70, 70, 72, 255], ..night }
        }
    }
}

/// How deep the ground has been pressed, m, by cells along x.
#[derive(Default)]
pub struct Ruts {
    cells: BTreeMap<i64, f64>,
    /// Where each wheel stood at the frame before: x and sinkage, m.
    before: Vec<Option<[f64; 2]>>,
}

/// Colour of rocks.
const STONE: Colour = [112, 104, 98, 255];
/// Soil that is weaker by less than this is drawn as the rest.
const LEAST_WEAKNESS: f64 = 0.02;
/// Length of a cell along x, m.
const CELL: f64 = 0.004;
/// A wheel that is further away than this, m, has been put there, not driven.
const JUMP: f64 = 0.5;

impl Ruts {
    /// Presses the ground that the wheels have passed since the frame before.
    pub fn press(&mut self, scene: &Scene, signals: &Signals) {
        self.before.resize(scene.wheels.len(), None);
        for ((wheel, signal), before) in scene.wheels.iter().zip(&signals.wheels).zip(&mut self.before) {
            if signal.sinkage <= 0.0 {
                *before = None;
                continue;
            }
            let now = [wheel.foot[0], signal.sinkage];
            let from = before.filter(|old| (old[0] - now[0]).abs() < JUMP).unwrap_or(now);
            let steps = (((now[0] - from[0]).abs() / CELL).ceil() as usize).max(1);
            for k in 0..=steps {
                let share = k as f64 / steps as f64;
                let x = from[0] + share * (now[0] - from[0]);
                let depth = from[1] + share * (now[1] - from[1]);
                let cell = self.cells.entry((x / CELL).round() as i64).or_insert(0.0);
                *cell = cell.max(depth);
            }
            *before = Some(now);
        }
    }

    fn depth(&self, x: f64) -> f64 {
        let place = x / CELL;
        let at = |cell: f64| self.cells.get(&(cell as i64)).copied().unwrap_or(0.0);
        let share = place - place.floor();
        (1.0 - share) * at(place.floor()) + share * at(place.floor() + 1.0)
    }
}

/// Height of the soil at x: the ground, its ruts, and the wheels that press it now.
fn surface(rover: &Rover, scene: &Scene, ruts: &Ruts, x: f64) -> f64 {
    let fresh = rover.terrain.at(x).height - ruts.depth(x);
    scene.wheels.iter().fold(fresh, |height, wheel| {
        let across = scene.radius.powi(2) - (x - wheel.centre[0]).powi(2);
        if across > 0.0 { height.min(wheel.centre[1] - across.sqrt()) } else { height }
    })
}

pub fn draw(canvas: &mut Canvas, view: &View, rover: &Rover, scene: &Scene, ruts: &Ruts, colours: &Colours) {
    let (width, height) = (canvas.width(), canvas.height());
    let sky = [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]];
    canvas.blend(&sky, (0.0, colours.sky[0]), (0.75 * height, colours.sky[1]));
    let columns = width as usize / 2 + 1;
    let positions: Vec<f64> = (0..=columns).map(|column| view.x(2.0 * column as f64)).collect();
    let top: Vec<[f32; 2]> = positions.iter().map(|x| view.pixel([*x, surface(rover, scene, ruts, *x)])).collect();
    let highest = top.iter().fold(f32::INFINITY, |least, point| least.min(point[1]));
    let mut soil = top.clone();
    soil.extend([[width + 4.0, height], [0.0, height]]);
    canvas.blend(&soil, (highest, colours.surface), (height, colours.depth));
    loose(canvas, view, rover, colours, &positions, &top);
    grains(canvas, view, colours, &top);
    rocks(canvas, view, rover, &positions, &top);
    let fresh: Vec<[f32; 2]> = positions.iter().map(|x| view.pixel([*x, rover.terrain.at(*x).height])).collect();
    let faint = [colours.edge[0], colours.edge[1], colours.edge[2], 120];
    canvas.dashed(&fresh, 1.0, faint, [5.0, 5.0]);
    canvas.line(&top, 2.0, colours.edge);
    tracks(canvas, ruts, colours, &positions, &top);
    marks(canvas, view, rover);
}

/// Rocks, from their surface down to the ground around them.
fn rocks(canvas: &mut Canvas, view: &View, rover: &Rover, positions: &[f64], top: &[[f32; 2]]) {
    for (x, [column, row]) in positions.iter().zip(top) {
        let height = (rover.terrain.rock_height(*x) * view.scale) as f32;
        if height > 0.0 {
            canvas.rectangle([*column, *row], [2.0, height], STONE);
        }
    }
}

/// Share by which the soil at x is weaker than the vehicle's nominal one, in stiffness or in cohesion, whichever is more; 0 on a
/// rock, which has no cohesion and is firm.
fn weakness(rover: &Rover, x: f64) -> f64 {
    if rover.terrain.rock_height(x) > 0.0 {
        return 0.0;
    }
    let (nominal, here) = (&rover.soil, rover.terrain.soil(&rover.soil, x));
    let share = |here: f64, nominal: f64| if nominal > 0.0 { 1.0 - here / nominal } else { 0.0 };
    share(here.k_phi, nominal.k_phi).max(share(here.cohesion, nominal.cohesion)).clamp(0.0, 1.0)
}

/// Soil that is weaker than the rest, paler down to a depth of a wheel's radius, and named.
fn loose(canvas: &mut Canvas, view: &View, rover: &Rover, colours: &Colours, positions: &[f64], top: &[[f32; 2]]) {
    let depth = (rover.wheel.radius * view.scale) as f32;
    let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
    let mut deepest: f32 = 0.0;
    for (x, [column, row]) in positions.iter().zip(top) {
        let weak = weakness(rover, *x);
        if weak < LEAST_WEAKNESS {
            continue;
        }
        let [r, g, b, _] = colours.loose;
        canvas.rectangle([*column, *row], [2.0, depth], [r, g, b, (190.0 * weak) as u8]);
        (low, high, deepest) = (low.min(*column), high.max(*column), deepest.max(*row));
    }
    if high - low > 60.0 {
        letters::centred(
            canvas,
            "loose soil",
            [0.5 * (low + high), deepest + depth + 14.0],
            12.0,
            [255, 255, 255, 220],
        );
    }
}

/// A dark edge where wheels have pressed the soil.
fn tracks(canvas: &mut Canvas, ruts: &Ruts, colours: &Colours, positions: &[f64], top: &[[f32; 2]]) {
    let mut pressed: Vec<[f32; 2]> = Vec::new();
    for (x, [column, row]) in positions.iter().zip(top) {
        if ruts.depth(*x) > 0.0 {
            // Below the surface, which stays where it is.
            pressed.push([*column, *row + 2.5]);
        } else if !pressed.is_empty() {
            canvas.line(&std::mem::take(&mut pressed), 5.0, colours.pressed);
        }
    }
    canvas.line(&pressed, 5.0, colours.pressed);
}

/// Grains that belong to the ground: the same at the same place in every frame.
fn grains(canvas: &mut Canvas, view: &View, colours: &Colours, top: &[[f32; 2]]) {
    // About nine pixels apart, on a grid that only changes with the size of the picture and the vehicle.
    let spacing = 9.0 / view.scale;
    let range = |from: f64, to: f64| (from / spacing).floor() as i64..=(to / spacing).ceil() as i64;
    for column in range(view.x(0.0), view.x(view.width)) {
        for row in range(view.z(view.height), view.z(0.0)) {
            let bits = scatter(column, row);
            let part = |shift: u32| f64::from((bits >> shift) as u8) / 255.0;
            let place = [(column as f64 + part(0)) * spacing, (row as f64 + part(8)) * spacing];
            let pixel = view.pixel(place);
            let Some(above) = top.get((pixel[0] / 2.0).max(0.0) as usize) else { continue };
            let radius = 0.6 + 1.1 * part(16) as f32;
            if pixel[1] > above[1] + radius + 1.5 {
                let kind = (bits >> 24) as usize % colours.grain.len();
                canvas.disc(pixel, radius, colours.grain[kind]);
            }
        }
    }
}

/// Bits that look random, from a place (the finaliser of SplitMix64, Steele, Lea and Flood 2014).
fn scatter(column: i64, row: i64) -> u64 {
    let mut bits = (column as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ (row as u64).rotate_left(32);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    bits ^ (bits >> 31)
}

/// Posts along the way with their place in metres, at most some eight in a picture.
fn marks(canvas: &mut Canvas, view: &View, rover: &Rover) {
    let span = view.width / view.scale;
    let spacing = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0].into_iter().find(|step| span / step <= 8.0).unwrap_or(20.0);
    let (first, last) = ((view.x(0.0) / spacing).ceil() as i64, (view.x(view.width) / spacing).floor() as i64);
    let base = canvas.height() - 30.0;
    let ink = [255, 255, 255, 190];
    for k in first..=last {
        let x = k as f64 * spacing;
        let [column, ground] = view.pixel([x, rover.terrain.at(x).height]);
        if ground < base - 14.0 {
            canvas.line(&[[column, base - 8.0], [column, base]], 1.5, ink);
        }
        let text = if spacing < 1.0 { format!("{x:.1} m") } else { format!("{x:.0} m") };
        letters::centred(canvas, &text, [column, base + 8.0], 11.0, ink);
    }
}
