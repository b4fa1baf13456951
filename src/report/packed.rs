//! Arrays of a page: as lists of numbers, or in a saved file as the rounded values of the rows that it keeps.

use serde_json::{Value, json};
use std::ops::Range;

/// Shorter arrays are lists of numbers in a file too.
const SHORT: usize = 32;
/// The largest whole number of two bytes and of one; the one below zero beyond it stands for a value that is missing.
const WORD: f64 = 32767.0;
const BYTE: f64 = 127.0;

/// How arrays are written.
#[derive(Clone, Debug, Default)]
pub struct Form {
    /// Rows that are kept, by run; `None` where all are and nothing is packed.
    kept: Option<Vec<Vec<usize>>>,
}

impl Form {
    /// Lists of seven digits, all rows.
    #[must_use]
    pub fn plain() -> Self {
        Self::default()
    }

    /// Whether nothing is packed.
    #[must_use]
    pub fn is_plain(&self) -> bool {
        self.kept.is_none()
    }

    /// Packed, and of runs with these numbers of rows so many that all together are at most `most`.
    #[must_use]
    pub fn packed(rows: &[usize], most: usize) -> Self {
        let total: usize = rows.iter().sum();
        let every = total.div_ceil(most.max(1)).max(1);
        Self { kept: Some(rows.iter().map(|rows| (0..*rows).step_by(every).collect()).collect()) }
    }

    /// Where a row stands among those that are kept.
    #[must_use]
    pub fn place(&self, run: usize, row: usize) -> Option<usize> {
        match &self.kept {
            None => Some(row),
            Some(kept) => kept.get(run)?.binary_search(&row).ok(),
        }
    }

    /// The places of the rows of a range.
    #[must_use]
    pub fn rows(&self, run: usize, rows: Range<usize>) -> Range<usize> {
        match self.kept.as_ref().and_then(|kept| kept.get(run)) {
            None => rows,
            Some(kept) => kept.partition_point(|row| *row < rows.start)..kept.partition_point(|row| *row < rows.end),
        }
    }

    /// Values of the rows of a run.
    #[must_use]
    pub fn of_run(&self, run: usize, values: &[f64]) -> Value {
        match self.kept.as_ref().and_then(|kept| kept.get(run)) {
            None => self.of_all(values),
            Some(_) => self.of_all(&self.kept_of(run, values)),
        }
    }

    /// The values that are kept.
    #[must_use]
    pub fn kept_of(&self, run: usize, values: &[f64]) -> Vec<f64> {
        match self.kept.as_ref().and_then(|kept| kept.get(run)) {
            None => values.to_vec(),
            Some(kept) => kept.iter().filter_map(|row| values.get(*row).copied()).collect(),
        }
    }

    /// Values that belong to no run.
    #[must_use]
    pub fn of_all(&self, values: &[f64]) -> Value {
        if self.kept.is_none() || values.len() < SHORT { listed(values) } else { packed(values) }
    }
}

/// Seven digits, which take half the bytes of all; null where there is none.
fn listed(values: &[f64]) -> Value {
    json!(values.iter().map(|value| *value as f32).collect::<Vec<_>>())
}

/// `{"o": offset, "s": step, "w": base64}`: value = offset + step times a whole number of two bytes.
fn packed(values: &[f64]) -> Value {
    let (low, high) = range(values);
    let (offset, step) = (0.5 * (low + high), step(0.5 * (high - low), WORD));
    let word = |value: &f64| if value.is_finite() { ((value - offset) / step).round() as i16 } else { i16::MIN };
    let bytes: Vec<u8> = values.iter().flat_map(|value| word(value).to_le_bytes()).collect();
    json!({ "o": offset, "s": step, "w": base64(&bytes) })
}

/// Several arrays of the same length as their differences from one of them, each in one byte or, where that rounds by more than
/// `allowed`, in two; and the largest error of the rounding.
pub(super) fn differences(arrays: &[Vec<f64>], from: &[f64], allowed: f64) -> (Value, f64) {
    let of = |values: &Vec<f64>| values.iter().zip(from).map(|(value, base)| value - base).collect::<Vec<f64>>();
    let all: Vec<f64> = arrays.iter().flat_map(of).collect();
    let largest = all.iter().filter(|value| value.is_finite()).fold(0.0_f64, |most, value| most.max(value.abs()));
    let small = step(largest, BYTE);
    if largest == 0.0 || 0.5 * small <= allowed {
        let byte = |value: &f64| if value.is_finite() { (value / small).round() as i8 } else { i8::MIN };
        let bytes: Vec<u8> = all.iter().map(|value| byte(value) as u8).collect();
        return (json!({ "s": small, "b": base64(&bytes) }), if largest > 0.0 { 0.5 * small } else { 0.0 });
    }
    let fine = step(largest, WORD);
    let word = |value: &f64| if value.is_finite() { (value / fine).round() as i16 } else { i16::MIN };
    let bytes: Vec<u8> = all.iter().flat_map(|value| word(value).to_le_bytes()).collect();
    (json!({ "s": fine, "w": base64(&bytes) }), 0.5 * fine)
}

/// A step of which `most` reach the end; 1 where there is no end to reach.
fn step(end: f64, most: f64) -> f64 {
    if end > 0.0 && end.is_finite() { end / most } else { 1.0 }
}

fn range(values: &[f64]) -> (f64, f64) {
    let finite = values.iter().copied().filter(|value| value.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    if low <= high { (low, high) } else { (0.0, 0.0) }
}

/// RFC 4648, section 4.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let all = three.iter().fold(0_u32, |all, byte| all << 8 | u32::from(*byte)) << (8 * (3 - three.len()));
        for k in 0..4 {
            let letter = LETTERS[(all >> (18 - 6 * k) & 63) as usize];
            text.push(if k <= three.len() { char::from(letter) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_vectors_of_base64() {
        // RFC 4648, section 10.
        let known =
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg=="), ("foobar", "Zm9vYmFy")];
        for (bytes, text) in known {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }

    #[test]
    fn property_kept_rows_are_spread_and_found_again() {
        let form = Form::packed(&[10, 4], 5);
        assert_eq!(form.kept_of(0, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]), [0.0, 3.0, 6.0, 9.0]);
        assert_eq!((form.place(0, 6), form.place(0, 5), form.place(1, 3)), (Some(2), None, Some(1)));
        assert_eq!((form.rows(0, 1..7), form.rows(0, 4..6), form.rows(1, 0..4)), (1..3, 2..2, 0..2));
        let all = Form::plain();
        assert_eq!((all.place(0, 6), all.rows(0, 4..6)), (Some(6), 4..6));
    }

    #[test]
    fn property_the_rounding_of_differences_is_at_most_what_is_said() {
        let from: Vec<f64> = (0..50).map(|k| f64::from(k).sin()).collect();
        let arrays: Vec<Vec<f64>> = (1..4).map(|n| from.iter().map(|v| v + f64::from(n) * v * v).collect()).collect();
        let (packed, error) = differences(&arrays, &from, 1.0);
        let step = packed["s"].as_f64().expect("a step");
        assert!((error - 0.5 * step).abs() < 1e-15 && error < 3.0 / 200.0, "{error}");
        assert_eq!(packed["b"].as_str().expect("text").len(), 200);
        let (finer, error) = differences(&arrays, &from, 1e-3);
        assert!(error < 1e-4 && finer["w"].as_str().expect("text").len() == 400, "{error}");
        assert_eq!(differences(std::slice::from_ref(&from), &from, 1.0).1, 0.0);
    }
}
