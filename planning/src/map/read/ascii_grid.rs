//! ESRI ASCII grid.

use super::{Problem, Raw, from_north};

/// Keys of the header.
const KEYS: [&str; 8] =
    ["ncols", "nrows", "xllcorner", "yllcorner", "xllcenter", "yllcenter", "cellsize", "nodata_value"];

/// Reads header and heights. Values stand for cells, whose centres become the nodes.
pub fn parse(text: &str) -> Result<Raw, Problem> {
    let mut header = [None::<f64>; KEYS.len()];
    let mut heights = Vec::new();
    let mut lines = 0;
    for (number, line) in text.lines().enumerate() {
        lines = number + 1;
        let mut words = line.split_whitespace();
        let Some(first) = words.next() else { continue };
        if let Some(key) = KEYS.iter().position(|key| first.eq_ignore_ascii_case(key)) {
            let value = words.next().and_then(|word| word.parse::<f64>().ok()).filter(|value| !value.is_infinite());
            let problem = || Problem::at(lines, format!("`{first}` without a number"));
            header[key] = Some(value.ok_or_else(problem)?);
            continue;
        }
        for word in line.split_whitespace() {
            let problem = || Problem::at(lines, format!("`{word}`; expected a height or one of {}", KEYS.join(", ")));
            heights.push(word.parse::<f64>().map_err(|_| problem())?);
        }
    }
    let need = |key: usize| header[key].ok_or_else(|| Problem::new(format!("the header has no `{}`", KEYS[key])));
    let count = |key: usize| {
        let value = need(key)?;
        let whole = (1.0..=1e9).contains(&value) && value.fract() == 0.0;
        if whole {
            Ok(value as usize)
        } else {
            Err(Problem::new(format!("`{}` is {value}; expected a count", KEYS[key])))
        }
    };
    let (columns, rows, cell) = (count(0)?, count(1)?, need(6)?);
    let low = |corner: usize, centre: usize| match (header[corner], header[centre]) {
        (Some(corner), _) => Ok(corner + 0.5 * cell),
        (None, Some(centre)) => Ok(centre),
        (None, None) => Err(Problem::new(format!("the header has no `{}` or `{}`", KEYS[corner], KEYS[centre]))),
    };
    let origin = [low(2, 4)?, low(3, 5)?];
    if Some(heights.len()) != columns.checked_mul(rows) {
        return Err(Problem::at(
            lines,
            format!("{} heights; expected {columns} x {rows} by the header", heights.len()),
        ));
    }
    if let Some(none) = header[7] {
        heights.iter_mut().filter(|z| **z == none).for_each(|z| *z = f64::NAN);
    }
    Ok(Raw { columns, rows, cell, origin, heights: from_north(heights, columns) })
}
