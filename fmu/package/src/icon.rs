//! The icon of an FMU: a rover in profile on its ground, drawn here, as a picture of points and as one of shapes.

use flate2::write::ZlibEncoder;
use flate2::{Compression, Crc};
use std::fmt::Write as _;
use std::io::{self, Write as _};

/// Points along an edge of the picture.
const EDGE: u32 = 100;

/// Samples a point and direction, for smooth edges.
const SAMPLES: u32 = 4;

type Colour = [u8; 3];

const SAND: Colour = [0xC9, 0xA8, 0x72];
const STEEL: Colour = [0x3B, 0x45, 0x54];
const PANEL: Colour = [0x2F, 0x6F, 0xB3];

/// A shape in a square of 100 by 100, y downwards.
enum Shape {
    /// Centre and radius.
    Disc(f64, f64, f64),
    /// Left, top, width, height.
    Block(f64, f64, f64, f64),
    /// From one point to another, with a width.
    Bar([f64; 2], [f64; 2], f64),
}

/// Later ones cover earlier ones.
const PICTURE: &[(Shape, Colour)] = &[
    (Shape::Block(0.0, 80.0, 100.0, 20.0), SAND),
    (Shape::Bar([18.0, 68.0], [34.0, 48.0], 5.0), STEEL),
    (Shape::Bar([34.0, 48.0], [50.0, 68.0], 5.0), STEEL),
    (Shape::Bar([34.0, 48.0], [66.0, 42.0], 5.0), STEEL),
    (Shape::Bar([66.0, 42.0], [82.0, 68.0], 5.0), STEEL),
    (Shape::Block(24.0, 28.0, 54.0, 12.0), STEEL),
    (Shape::Block(20.0, 22.0, 62.0, 5.0), PANEL),
    (Shape::Bar([72.0, 22.0], [72.0, 10.0], 3.0), STEEL),
    (Shape::Block(66.0, 5.0, 14.0, 7.0), STEEL),
    (Shape::Disc(18.0, 70.0, 13.0), STEEL),
    (Shape::Disc(50.0, 70.0, 13.0), STEEL),
    (Shape::Disc(82.0, 70.0, 13.0), STEEL),
    (Shape::Disc(18.0, 70.0, 5.0), SAND),
    (Shape::Disc(50.0, 70.0, 5.0), SAND),
    (Shape::Disc(82.0, 70.0, 5.0), SAND),
];

impl Shape {
    fn has(&self, x: f64, y: f64) -> bool {
        match *self {
            Self::Disc(cx, cy, radius) => (x - cx).hypot(y - cy) <= radius,
            Self::Block(left, top, width, height) => {
                (left..left + width).contains(&x) && (top..top + height).contains(&y)
            }
            Self::Bar([x1, y1], [x2, y2], width) => {
                let (dx, dy) = (x2 - x1, y2 - y1);
                let along = ((x - x1) * dx + (y - y1) * dy) / (dx * dx + dy * dy);
                let along = along.clamp(0.0, 1.0);
                (x - x1 - along * dx).hypot(y - y1 - along * dy) <= 0.5 * width
            }
        }
    }

    fn svg(&self, colour: Colour) -> String {
        let [r, g, b] = colour;
        let colour = format!("#{r:02x}{g:02x}{b:02x}");
        match *self {
            Self::Disc(x, y, radius) => format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{colour}\"/>"),
            Self::Block(x, y, width, height) => {
                format!("<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"{colour}\"/>")
            }
            Self::Bar([x1, y1], [x2, y2], width) => format!(
                "<line x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\" stroke=\"{colour}\" stroke-width=\"{width}\" \
                 stroke-linecap=\"round\"/>"
            ),
        }
    }
}

/// The picture as SVG.
pub fn svg() -> String {
    let mut text = format!("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {EDGE} {EDGE}\">\n");
    for (shape, colour) in PICTURE {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "  {}", shape.svg(*colour));
    }
    text + "</svg>\n"
}

/// The picture as PNG (ISO 15948), 8 bit a channel with transparency.
///
/// # Errors
/// Never in memory.
pub fn png() -> io::Result<Vec<u8>> {
    let mut rows = Vec::new();
    for y in 0..EDGE {
        rows.push(0); // no filter
        for x in 0..EDGE {
            rows.extend(point(x, y));
        }
    }
    let mut pixels = ZlibEncoder::new(Vec::new(), Compression::best());
    pixels.write_all(&rows)?;
    let mut header = [EDGE.to_be_bytes(), EDGE.to_be_bytes()].concat();
    header.extend([8, 6, 0, 0, 0]); // bits a channel, red-green-blue-alpha, the only compression and filter, no interlace
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    chunk(&mut file, b"IHDR", &header);
    chunk(&mut file, b"IDAT", &pixels.finish()?);
    chunk(&mut file, b"IEND", &[]);
    Ok(file)
}

fn chunk(file: &mut Vec<u8>, name: &[u8; 4], content: &[u8]) {
    let mut sum = Crc::new();
    sum.update(name);
    sum.update(content);
    file.extend((content.len() as u32).to_be_bytes());
    file.extend(name);
    file.extend(content);
    file.extend(sum.sum().to_be_bytes());
}

/// Mean of the samples of a point; alpha is the share that a shape covers.
fn point(x: u32, y: u32) -> [u8; 4] {
    let place = |point: u32, sample: u32| f64::from(point) + (f64::from(sample) + 0.5) / f64::from(SAMPLES);
    let (mut sums, mut covered) = ([0_u32; 3], 0_u32);
    for sample in 0..SAMPLES * SAMPLES {
        let (x, y) = (place(x, sample % SAMPLES), place(y, sample / SAMPLES));
        if let Some((_, colour)) = PICTURE.iter().rev().find(|(shape, _)| shape.has(x, y)) {
            covered += 1;
            sums.iter_mut().zip(colour).for_each(|(sum, channel)| *sum += u32::from(*channel));
        }
    }
    let [r, g, b] = sums.map(|sum| sum.checked_div(covered).unwrap_or(0) as u8);
    [r, g, b, (255 * covered / (SAMPLES * SAMPLES)) as u8]
}
