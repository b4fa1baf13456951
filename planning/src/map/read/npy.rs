//! NumPy's array format. The crates that read it bring a parser of Python's literals, which takes longer to compile than these
//! lines to read: a header of three keys, then the numbers.

use super::csv_grid::CsvGrid;
use super::{Problem, Raw};

const MAGIC: &[u8] = b"\x93NUMPY";

/// Reads a two-dimensional array of numbers, `heights[row, column]`.
pub fn parse(bytes: &[u8], grid: &CsvGrid) -> Result<Raw, Problem> {
    let short = || Problem::new("the file ends within its header");
    if !bytes.starts_with(MAGIC) {
        return Err(Problem::new("no NumPy array: expected a file by numpy.save"));
    }
    let (length, start) = match bytes.get(6) {
        Some(1) => (usize::from(u16::from_le_bytes(array(bytes, 8).ok_or_else(short)?)), 10),
        Some(2 | 3) => (u32::from_le_bytes(array(bytes, 8).ok_or_else(short)?) as usize, 12),
        _ => return Err(Problem::new("an unknown version of NumPy's format; expected 1, 2 or 3")),
    };
    let header = bytes.get(start..start + length).ok_or_else(short)?;
    let header = std::str::from_utf8(header).map_err(|_| Problem::new("the header is no text"))?;
    let kind = quoted_after(header, "'descr'").ok_or_else(|| Problem::new("the header has no `descr`"))?;
    let (rows, columns) = shape(header)?;
    let values = numbers(kind, &bytes[start + length..])?;
    if Some(values.len()) != rows.checked_mul(columns) {
        return Err(Problem::new(format!("{} numbers; expected {rows} x {columns} by the header", values.len())));
    }
    let values = if header.contains("'fortran_order': True") {
        (0..rows).flat_map(|r| (0..columns).map(move |c| c * rows + r)).map(|at| values[at]).collect()
    } else {
        values
    };
    Ok(grid.raw(columns, rows, values))
}

fn array<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..at + N)?.try_into().ok()
}

fn quoted_after<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    header.split_once(key)?.1.split('\'').nth(1)
}

fn shape(header: &str) -> Result<(usize, usize), Problem> {
    let inside = header.split_once("'shape'").and_then(|(_, rest)| rest.split_once('(')?.1.split_once(')'));
    let inside = inside.map(|(inside, _)| inside).unwrap_or_default();
    let sizes: Vec<Option<usize>> =
        inside.split(',').map(str::trim).filter(|size| !size.is_empty()).map(|size| size.parse().ok()).collect();
    match sizes[..] {
        [Some(rows), Some(columns)] => Ok((rows, columns)),
        _ => Err(Problem::new(format!("an array of shape ({inside}); expected two dimensions (rows, columns)"))),
    }
}

/// The numbers of an array of type `kind`.
fn numbers(kind: &str, bytes: &[u8]) -> Result<Vec<f64>, Problem> {
    macro_rules! read {
        ($type:ty, $convert:ident) => {{
            const SIZE: usize = size_of::<$type>();
            let whole = bytes.chunks_exact(SIZE);
            whole.map(|chunk| <$type>::$convert(chunk.try_into().unwrap_or([0; SIZE])) as f64).collect()
        }};
    }
    Ok(match kind {
        "<f8" => read!(f64, from_le_bytes),
        ">f8" => read!(f64, from_be_bytes),
        "<f4" => read!(f32, from_le_bytes),
        ">f4" => read!(f32, from_be_bytes),
        "<i8" => read!(i64, from_le_bytes),
        "<i4" => read!(i32, from_le_bytes),
        "<i2" => read!(i16, from_le_bytes),
        "<u2" => read!(u16, from_le_bytes),
        "|u1" => read!(u8, from_le_bytes),
        _ => {
            return Err(Problem::new(format!(
                "an array of type `{kind}`; expected numbers (float64, float32, int16, ..)"
            )));
        }
    })
}
