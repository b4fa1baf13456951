//! GeoTIFF with one band of heights, on a grid of metres.

use super::{Problem, Raw, from_north};
use std::io::Cursor;
use tiff::decoder::{Decoder, DecodingResult};
use tiff::tags::Tag;

/// Key of the GeoTIFF standard: whether coordinates are projected (1, metres) or geographic (2, degrees).
const MODEL_TYPE: u16 = 1024;
/// Key: 1 where a value stands for a cell, 2 where it stands for a point.
const RASTER_TYPE: u16 = 1025;
/// Width and height of a cell may differ by this share: they are written with few digits.
const SQUARE: f64 = 1e-6;

pub fn parse(bytes: Vec<u8>) -> Result<Raw, Problem> {
    let broken = |error: tiff::TiffError| Problem::new(format!("no GeoTIFF that can be read: {error}"));
    let mut file = Decoder::new(Cursor::new(bytes)).map_err(broken)?;
    let (columns, rows) = file.dimensions().map_err(broken)?;
    let (columns, rows) = (columns as usize, rows as usize);
    let scale = file.get_tag_f64_vec(Tag::ModelPixelScaleTag).ok();
    let tie = file.get_tag_f64_vec(Tag::ModelTiepointTag).ok();
    let (Some([width, height, ..]), Some([i, j, _, x, y, ..])) = (scale.as_deref(), tie.as_deref()) else {
        return Err(Problem::new(
            "no place or spacing (ModelPixelScale, ModelTiepoint); expected a GeoTIFF, not turned",
        ));
    };
    let keys = file.get_tag_u16_vec(Tag::GeoKeyDirectoryTag).unwrap_or_default();
    let key = |id: u16| keys.chunks_exact(4).skip(1).find(|key| key[0] == id && key[1] == 0).map(|key| key[3]);
    if key(MODEL_TYPE) == Some(2) {
        let text = format!("a grid in degrees (spacing {width}); expected one projected to metres, for example in UTM");
        return Err(Problem::new(text));
    }
    if (width - height).abs() > SQUARE * width.abs() {
        return Err(Problem::new(format!("cells of {width} x {height} m; expected squares")));
    }
    let no_data = file.get_tag_ascii_string(Tag::GdalNodata).ok();
    let no_data = no_data.and_then(|text| text.trim_end_matches('\0').trim().parse::<f64>().ok());
    let mut heights = values(file.read_image().map_err(broken)?)?;
    if heights.len() != columns * rows {
        let bands = heights.len() as f64 / (columns * rows) as f64;
        return Err(Problem::new(format!("{bands} bands; expected one, of heights")));
    }
    if let Some(none) = no_data {
        heights.iter_mut().filter(|z| **z == none).for_each(|z| *z = f64::NAN);
    }
    // The tie point is the corner of a cell, or the point itself.
    let half = if key(RASTER_TYPE) == Some(2) { 0.0 } else { 0.5 };
    let west = x + (half - i) * width;
    let north = y - (half - j) * width;
    let origin = [west, north - (rows as f64 - 1.0) * width];
    Ok(Raw { columns, rows, cell: *width, origin, heights: from_north(heights, columns) })
}

fn values(image: DecodingResult) -> Result<Vec<f64>, Problem> {
    Ok(match image {
        DecodingResult::U8(values) => values.into_iter().map(f64::from).collect(),
        DecodingResult::U16(values) => values.into_iter().map(f64::from).collect(),
        DecodingResult::U32(values) => values.into_iter().map(f64::from).collect(),
        DecodingResult::I8(values) => values.into_iter().map(f64::from).collect(),
        DecodingResult::I16(values) => values.into_iter().map(f64::from).collect(),
        DecodingResult::I32(values) => values.into_iter().map(f64::from).collect(),
        DecodingResult::F32(values) => values.into_iter().map(f64::from).collect(),
        DecodingResult::F64(values) => values,
        _ => return Err(Problem::new("heights of a type that is not read; expected whole or floating-point numbers")),
    })
}
