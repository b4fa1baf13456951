//! Letters of straight strokes, as on a technical drawing. By hand: a font file and the crate that draws it would add some
//! hundred kilobytes and a licence of their own for the 45 letters of a frame.

use super::canvas::{Canvas, Colour};

/// Widths of a letter and the gap behind it, and its height, in units of the strokes.
const WIDTH: f32 = 4.0;
const GAP: f32 = 2.0;
const HEIGHT: f32 = 6.0;

/// Strokes of a letter, separated by blanks: pairs of digits, x from the left and y from the top, the line at 6.
fn strokes(letter: char) -> &'static str {
    match letter {
        '0' => "1030414536160501 0110",
        '1' => "012026 0646",
        '2' => "01103041420646",
        '3' => "0110304142334445361605 3323",
        '4' => "300444 3036",
        '5' => "4000023343453616 1605",
        '6' => "4130100105163645433303",
        '7' => "004026",
        '8' => "1030414233130201 0110 1304051636454433",
        '9' => "0516364541301001021343",
        '.' => "2526",
        '-' => "0343",
        '+' => "0343 2125",
        '/' => "4006",
        '%' => "4006 0010110100 3545463635",
        ':' => "2222 2525",
        '=' => "0242 0444",
        'a' => "12324346 4414051646",
        'b' => "0006364543321202",
        'c' => "43321203051636 3645",
        'd' => "4046 461605031232 3242",
        'e' => "044443321203051636",
        'f' => "16113040 0333",
        'g' => "4247381808 424616050312 1242",
        'h' => "0006 0312324346",
        'i' => "2226 2020",
        'k' => "0006 420446",
        'l' => "20252636",
        'm' => "0602 031222232623 233242 4346",
        'n' => "0602 0312324346",
        'o' => "123243453616050312",
        'p' => "0208 0312324345361605",
        'r' => "0602 04123242",
        's' => "433212031434453616 1605",
        't' => "10152646 0232",
        'u' => "0205163645 4246",
        'v' => "022642",
        'w' => "0216233642",
        'x' => "0246 4206",
        'y' => "0226 42260818",
        'z' => "02420646",
        'D' => "00063645413000",
        'N' => "06004640",
        'W' => "0016233640",
        _ => "",
    }
}

/// Width of a text of letters `size` pixels high.
pub fn width(text: &str, size: f32) -> f32 {
    let letters = text.chars().count() as f32;
    (letters * (WIDTH + GAP) - GAP).max(0.0) * size / HEIGHT
}

/// Writes a text; `place` is the upper left corner of its first letter.
pub fn write(canvas: &mut Canvas, text: &str, place: [f32; 2], size: f32, colour: Colour) {
    let unit = size / HEIGHT;
    let pen = (0.15 * size).max(1.2);
    for (k, letter) in text.chars().enumerate() {
        let left = place[0] + k as f32 * (WIDTH + GAP) * unit;
        for stroke in points(letter) {
            let pixels: Vec<[f32; 2]> = stroke.iter().map(|[x, y]| [left + x * unit, place[1] + y * unit]).collect();
            match pixels[..] {
                [only] => canvas.disc(only, 0.75 * pen, colour),
                [first, second] if first == second => canvas.disc(first, 0.75 * pen, colour),
                _ => canvas.line(&pixels, pen, colour),
            }
        }
    }
}

/// Writes a text below `place`, around its column.
pub fn centred(canvas: &mut Canvas, text: &str, place: [f32; 2], size: f32, colour: Colour) {
    write(canvas, text, [place[0] - 0.5 * width(text, size), place[1]], size, colour);
}

/// Strokes of a letter as points. A blank inside a pair joins nothing: pairs are read within each word.
fn points(letter: char) -> Vec<Vec<[f32; 2]>> {
    strokes(letter)
        .split(' ')
        .map(|stroke| {
            let digits: Vec<f32> = stroke.chars().filter_map(|c| c.to_digit(10)).map(|d| d as f32).collect();
            digits.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{points, strokes};

    #[test]
    fn property_every_letter_has_whole_strokes_inside_its_box() {
        for letter in ('!'..='~').filter(|letter| !strokes(*letter).is_empty()) {
            let digits = strokes(letter).split(' ').map(str::len);
            assert!(digits.clone().all(|length| length % 2 == 0 && length >= 4), "{letter}: {:?}", strokes(letter));
            assert!(points(letter).iter().flatten().all(|[x, y]| *x <= 4.0 && *y <= 8.0), "{letter}");
        }
    }
}
