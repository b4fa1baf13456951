//! A picture, and the few strokes of which ours are made.

use tiny_skia::{
    Color, FillRule, GradientStop, LineCap, LineJoin, LinearGradient, Paint, Path, PathBuilder, Pixmap, Point, Rect,
    Shader, SpreadMode, Stroke, StrokeDash, Transform,
};

/// Red, green, blue, opacity.
pub type Colour = [u8; 4];

/// Length of the shortest arrow in its widths: a head of 3.2, and a little of its shaft.
const SHORTEST: f32 = 4.0;

/// The picture.
pub struct Canvas {
    pixels: Pixmap,
}

fn paint<'a>([r, g, b, a]: Colour) -> Paint<'a> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(r, g, b, a);
    paint
}

impl Canvas {
    pub fn new((width, height): (u32, u32)) -> Option<Self> {
        Pixmap::new(width, height).map(|pixels| Self { pixels })
    }

    pub fn width(&self) -> f32 {
        self.pixels.width() as f32
    }

    pub fn height(&self) -> f32 {
        self.pixels.height() as f32
    }

    /// Bytes of the picture, three a pixel; the sky has made every pixel opaque.
    pub fn rgb(&self) -> Vec<u8> {
        self.pixels.data().chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
    }

    fn fill_path(&mut self, path: Option<Path>, paint: &Paint) {
        if let Some(path) = path {
            self.pixels.fill_path(&path, paint, FillRule::Winding, Transform::identity(), None);
        }
    }

    fn stroke_path(&mut self, path: Option<Path>, width: f32, colour: Colour, dash: Option<[f32; 2]>) {
        let dash = dash.and_then(|dash| StrokeDash::new(dash.to_vec(), 0.0));
        let stroke = Stroke { width, line_cap: LineCap::Round, line_join: LineJoin::Round, dash, ..Stroke::default() };
        if let Some(path) = path {
            self.pixels.stroke_path(&path, &paint(colour), &stroke, Transform::identity(), None);
        }
    }

    /// Fills a polygon from one colour at the row `top` to another at the row `bottom`.
    pub fn blend(&mut self, points: &[[f32; 2]], (top, from): (f32, Colour), (bottom, to): (f32, Colour)) {
        let colour = |[r, g, b, a]: Colour| Color::from_rgba8(r, g, b, a);
        let stops = vec![GradientStop::new(0.0, colour(from)), GradientStop::new(1.0, colour(to))];
        let (start, end) = (Point::from_xy(0.0, top), Point::from_xy(0.0, bottom));
        let shader = LinearGradient::new(start, end, stops, SpreadMode::Pad, Transform::identity());
        let shader = shader.unwrap_or(Shader::SolidColor(colour(from)));
        let paint = Paint { shader, anti_alias: true, ..Paint::default() };
        self.fill_path(closed(points), &paint);
    }

    pub fn polygon(&mut self, points: &[[f32; 2]], colour: Colour) {
        self.fill_path(closed(points), &paint(colour));
    }

    pub fn line(&mut self, points: &[[f32; 2]], width: f32, colour: Colour) {
        self.stroke_path(open(points), width, colour, None);
    }

    pub fn dashed(&mut self, points: &[[f32; 2]], width: f32, colour: Colour, dash: [f32; 2]) {
        self.stroke_path(open(points), width, colour, Some(dash));
    }

    pub fn outline(&mut self, points: &[[f32; 2]], width: f32, colour: Colour) {
        self.stroke_path(closed(points), width, colour, None);
    }

    pub fn disc(&mut self, [x, y]: [f32; 2], radius: f32, colour: Colour) {
        self.fill_path(PathBuilder::from_circle(x, y, radius), &paint(colour));
    }

    pub fn rectangle(&mut self, [x, y]: [f32; 2], [width, height]: [f32; 2], colour: Colour) {
        if let Some(rectangle) = Rect::from_xywh(x, y, width, height) {
            self.pixels.fill_rect(rectangle, &paint(colour), Transform::identity(), None);
        }
    }

    /// A rectangle with round corners.
    pub fn card(&mut self, [x, y]: [f32; 2], [width, height]: [f32; 2], radius: f32, colour: Colour) {
        let mut builder = PathBuilder::new();
        let (right, bottom) = (x + width, y + height);
        builder.move_to(x + radius, y);
        builder.line_to(right - radius, y);
        builder.quad_to(right, y, right, y + radius);
        builder.line_to(right, bottom - radius);
        builder.quad_to(right, bottom, right - radius, bottom);
        builder.line_to(x + radius, bottom);
        builder.quad_to(x, bottom, x, bottom - radius);
        builder.line_to(x, y + radius);
        builder.quad_to(x, y, x + radius, y);
        builder.close();
        self.fill_path(builder.finish(), &paint(colour));
    }

    /// An arrow; a short one is thinner, and one of a few pixels is left out.
    pub fn arrow(&mut self, [x, y]: [f32; 2], [dx, dy]: [f32; 2], width: f32, colour: Colour) {
        let length = dx.hypot(dy);
        let width = width.min(length / SHORTEST);
        let head = 3.2 * width;
        if width < 1.0 {
            return;
        }
        let [ux, uy] = [dx / length, dy / length];
        let tip = [x + dx, y + dy];
        let neck = [tip[0] - head * ux, tip[1] - head * uy];
        let half = 0.55 * head;
        // A pale rim first: arrows cross wheels and soil.
        let rim = [255, 255, 255, 150];
        self.line(&[[x, y], neck], width + 2.0, rim);
        self.line(&[[x, y], neck], width, colour);
        let points = [tip, [neck[0] - half * uy, neck[1] + half * ux], [neck[0] + half * uy, neck[1] - half * ux]];
        self.outline(&points, 2.0, rim);
        self.polygon(&points, colour);
    }
}

fn open(points: &[[f32; 2]]) -> Option<Path> {
    let ([first, rest @ ..], mut builder) = (points, PathBuilder::new()) else { return None };
    builder.move_to(first[0], first[1]);
    rest.iter().for_each(|point| builder.line_to(point[0], point[1]));
    builder.finish()
}

fn closed(points: &[[f32; 2]]) -> Option<Path> {
    let ([first, rest @ ..], mut builder) = (points, PathBuilder::new()) else { return None };
    builder.move_to(first[0], first[1]);
    rest.iter().for_each(|point| builder.line_to(point[0], point[1]));
    builder.close();
    builder.finish()
}
