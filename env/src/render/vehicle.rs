//! Chassis, links, wheels, forces.

use super::canvas::{Canvas, Colour};
use super::scene::{Scene, View};
use bekker::rover::Rover;
use bekker::signals::Signals;
use std::f64::consts::TAU;

const BODY: Colour = [232, 234, 238, 255];
const BODY_EDGE: Colour = [70, 76, 88, 255];
const STRIPE: Colour = [224, 122, 48, 255];
const LINK: Colour = [96, 104, 118, 255];
const TYRE: Colour = [52, 55, 62, 255];
const DISC: Colour = [168, 174, 184, 255];
const SPOKE: Colour = [84, 90, 102, 255];
const HUB: Colour = [224, 122, 48, 255];
/// Force along the ground's normal, and along its tangent.
pub const NORMAL: Colour = [36, 104, 196, 255];
pub const DRAWBAR: Colour = [206, 44, 66, 255];

/// How much longer than a normal force a drawbar pull of the same size is drawn: on level ground a wheel pulls with a tenth of its load.
pub const PULL: f64 = 4.0;

const SPOKES: usize = 6;

pub fn draw(canvas: &mut Canvas, view: &View, rover: &Rover, scene: &Scene, turned: &[f64]) {
    links(canvas, view, rover, scene);
    chassis(canvas, view, rover, scene);
    for (k, wheel) in scene.wheels.iter().enumerate() {
        let pitch = scene.bodies.get(wheel.body).map_or(0.0, |body| body.pitch);
        // Forward is clockwise here; the encoder's angle is relative to the body.
        let angle = turned.get(k).copied().unwrap_or(0.0) - pitch;
        draw_wheel(canvas, view.pixel(wheel.centre), scene.radius * view.scale, angle);
    }
}

/// Bars from each link's joint to whatever sits on it.
fn links(canvas: &mut Canvas, view: &View, rover: &Rover, scene: &Scene) {
    let width = (0.28 * scene.radius * view.scale).max(3.0) as f32;
    for (j, joint) in scene.joints.iter().enumerate() {
        let own = scene.wheels.iter().filter(|wheel| wheel.body == j + 1).map(|wheel| wheel.centre);
        let carried = rover.links.iter().zip(&scene.joints).filter(|(link, _)| link.parent == j + 1);
        for end in own.chain(carried.map(|(_, joint)| *joint)) {
            let bar = [view.pixel(*joint), view.pixel(end)];
            canvas.line(&bar, width + 2.0, BODY_EDGE);
            canvas.line(&bar, width, LINK);
        }
    }
    for joint in &scene.joints {
        canvas.disc(view.pixel(*joint), 0.75 * width, BODY_EDGE);
        canvas.disc(view.pixel(*joint), 0.4 * width, BODY);
    }
}

/// A box around the centre of mass, above the belly, with struts to what the chassis carries.
fn chassis(canvas: &mut Canvas, view: &View, rover: &Rover, scene: &Scene) {
    let Some(frame) = scene.bodies.first() else { return };
    let radius = scene.radius;
    let pixels =
        |points: &[[f64; 2]]| -> Vec<[f32; 2]> { points.iter().map(|p| view.pixel(frame.place(*p))).collect() };
    let half = (0.5 * scene.length - 0.9 * radius).max(1.2 * radius);
    // In the vehicle's drawing: the box stands on the mounts' height or, with joints, on theirs.
    let carried = rover.wheels.iter().filter(|wheel| wheel.body == 0).map(|wheel| [wheel.mount.x, wheel.mount.z]);
    let joints = rover.links.iter().filter(|link| link.parent == 0).map(|link| [link.parameters.x, link.parameters.z]);
    let seats: Vec<[f64; 2]> = carried.chain(joints).collect();
    let (low, high) = seats
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), seat| (low.min(seat[1]), high.max(seat[1])));
    let middle = if rover.links.is_empty() {
        seats.iter().map(|seat| seat[0]).sum::<f64>() / seats.len().max(1) as f64
    } else {
        rover.body.centre_of_mass_x
    };
    let bottom = if rover.links.is_empty() { low + 0.35 * radius } else { high - 0.2 * radius };
    let top = bottom + (1.1 * radius).max(0.12 * scene.length);
    let half = if rover.links.is_empty() { half } else { 0.62 * half };
    let strut = (0.2 * radius * view.scale).max(2.5) as f32;
    for seat in &seats {
        let inside = seat[0].clamp(middle - 0.8 * half, middle + 0.8 * half);
        canvas.line(&pixels(&[*seat, [inside, bottom + 0.1 * radius]]), strut, BODY_EDGE);
    }
    let bevel = 0.3 * radius;
    let shape = pixels(&[
        [middle - half, bottom],
        [middle + half - bevel, bottom],
        [middle + half, bottom + bevel],
        [middle + half, top - bevel],
        [middle + half - bevel, top],
        [middle - half, top],
    ]);
    canvas.polygon(&shape, BODY);
    let stripe = bottom + 0.3 * (top - bottom);
    canvas.line(&pixels(&[[middle - half, stripe], [middle + half, stripe]]), 0.5 * strut, STRIPE);
    canvas.outline(&shape, 2.0, BODY_EDGE);
    mast(canvas, view, |points| pixels(points), [middle + 0.55 * half, top], radius);
}

/// A mast with a camera that looks ahead: it tells front from rear.
fn mast(
    canvas: &mut Canvas,
    view: &View,
    pixels: impl Fn(&[[f64; 2]]) -> Vec<[f32; 2]>,
    [x, z]: [f64; 2],
    radius: f64,
) {
    let head = z + 1.2 * radius;
    canvas.line(&pixels(&[[x, z], [x, head]]), (0.12 * radius * view.scale).max(2.0) as f32, BODY_EDGE);
    let shape = [
        [x - 0.25 * radius, head],
        [x + 0.45 * radius, head],
        [x + 0.45 * radius, head + 0.4 * radius],
        [x - 0.25 * radius, head + 0.4 * radius],
    ];
    let shape = pixels(&shape);
    canvas.polygon(&shape, BODY);
    canvas.outline(&shape, 1.5, BODY_EDGE);
    for eye in pixels(&[[x + 0.45 * radius, head + 0.2 * radius]]) {
        canvas.disc(eye, (0.11 * radius * view.scale).max(1.5) as f32, TYRE);
    }
}

/// `angle` rolls forward, rad; `radius` in pixels.
fn draw_wheel(canvas: &mut Canvas, centre: [f32; 2], radius: f64, angle: f64) {
    let rim = (0.13 * radius).max(2.0) as f32;
    let outer = radius as f32;
    canvas.disc(centre, outer, TYRE);
    canvas.disc(centre, outer - rim, DISC);
    let point = |turn: f64, at: f64| {
        let (sin, cos) = (angle + turn).sin_cos();
        // Rows count downwards: this turns clockwise as the angle grows.
        [centre[0] + (at * cos) as f32, centre[1] + (at * sin) as f32]
    };
    for k in 0..SPOKES {
        let turn = k as f64 / SPOKES as f64 * TAU;
        // One spoke is marked, so that turning can be seen.
        let colour = if k == 0 { HUB } else { SPOKE };
        canvas.line(&[point(turn, 0.18 * radius), point(turn, 0.82 * radius)], 0.75 * rim, colour);
    }
    for k in 0..3 * SPOKES {
        let turn = k as f64 / (3 * SPOKES) as f64 * TAU;
        canvas.line(&[point(turn, 0.93 * radius), point(turn, 0.99 * radius)], 1.5, [120, 124, 132, 255]);
    }
    canvas.disc(centre, 0.2 * outer, SPOKE);
    canvas.disc(centre, 0.11 * outer, HUB);
}

/// What the soil does to the wheels: a wheel's share of the weight is an arrow of one and a half radii. The pull starts at the
/// wheel's centre, on which it acts: at the rim the soil's edge would hide it.
pub fn forces(canvas: &mut Canvas, view: &View, rover: &Rover, scene: &Scene, signals: &Signals) {
    let share = rover.total_mass() * rover.environment.gravity / rover.wheels.len().max(1) as f64;
    let scale = 1.5 * scene.radius * view.scale / share.max(f64::MIN_POSITIVE);
    let width = (0.08 * scene.radius * view.scale).clamp(3.0, 6.0) as f32;
    // Forces beyond three shares (an impact) would hide the picture.
    let pixels = |[x, z]: [f64; 2], force: f64| {
        let length = (force.clamp(-3.0 * share, 3.0 * share)) * scale;
        [(x * length) as f32, (-z * length) as f32]
    };
    for (wheel, signal) in scene.wheels.iter().zip(&signals.wheels) {
        let rim = [0, 1].map(|axis| wheel.centre[axis] - scene.radius * wheel.normal[axis]);
        canvas.arrow(view.pixel(rim), pixels(wheel.normal, signal.normal_force), width, NORMAL);
        canvas.arrow(view.pixel(wheel.centre), pixels(wheel.tangent, PULL * signal.drawbar_pull), width, DRAWBAR);
    }
}
