//! What a saved page holds for its script, read as the script reads it.

use serde_json::Value;

/// The data of the page.
pub fn data(page: &str) -> Value {
    let opening = "<script type=\"application/json\" id=\"saved\">";
    let begin = page.find(opening).expect("the page has data") + opening.len();
    serde_json::from_str(&page[begin..begin + page[begin..].find("</script>").expect("an end")]).expect("JSON")
}

/// The text of the page: what stands below the plots, without the script and its data.
pub fn text(page: &str) -> &str {
    let begin = page.find("<article").expect("a text");
    &page[begin..page.find("</article>").expect("its end")]
}

/// The data of every figure in the text.
pub fn figures(page: &str) -> Vec<Value> {
    let all = text(page).split("data-plot=\"").skip(1);
    let one = |rest: &str| {
        serde_json::from_str(&rest[rest.find('>').expect("a tag") + 1..rest.find("</script>").expect("an end")])
    };
    all.map(|rest| one(rest).expect("JSON")).collect()
}

/// An array, NaN where a value is missing: a list, or offset + step times words of two bytes.
pub fn numbers(array: &Value) -> Vec<f64> {
    if let Some(list) = array.as_array() {
        return list.iter().map(|value| value.as_f64().unwrap_or(f64::NAN)).collect();
    }
    let (offset, step) = (array["o"].as_f64().expect("an offset"), array["s"].as_f64().expect("a step"));
    let bytes = bytes(array["w"].as_str().expect("words"));
    let word = |pair: &[u8]| i16::from_le_bytes([pair[0], pair[1]]);
    bytes
        .chunks(2)
        .map(word)
        .map(|word| if word == i16::MIN { f64::NAN } else { offset + step * f64::from(word) })
        .collect()
}

/// Differences in words of one byte or of two, NaN where one is missing.
pub fn differences(array: &Value) -> Vec<f64> {
    let step = array["s"].as_f64().expect("a step");
    let value = |word: i16, missing: i16| if word == missing { f64::NAN } else { step * f64::from(word) };
    match array["b"].as_str() {
        Some(text) => bytes(text).iter().map(|byte| value(i16::from(*byte as i8), i16::from(i8::MIN))).collect(),
        None => {
            let bytes = bytes(array["w"].as_str().expect("words"));
            bytes.chunks(2).map(|pair| value(i16::from_le_bytes([pair[0], pair[1]]), i16::MIN)).collect()
        }
    }
}

fn bytes(text: &str) -> Vec<u8> {
    let value = |letter: u8| match letter {
        b'A'..=b'Z' => letter - b'A',
        b'a'..=b'z' => letter - b'a' + 26,
        b'0'..=b'9' => letter - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let letters: Vec<u8> = text.bytes().filter(|letter| *letter != b'=').map(value).collect();
    let four = |four: &[u8]| {
        let all = four.iter().fold(0_u32, |all, six| all << 6 | u32::from(*six)) << (6 * (4 - four.len()));
        all.to_be_bytes()[1..four.len()].to_vec()
    };
    letters.chunks(4).flat_map(four).collect()
}
