//! A grey picture of heights (PGM) and its description (YAML), as ROS's map server writes occupancy: here with the two keys
//! that turn grey into metres.

use super::{Problem, Raw, from_north};

/// The description: flat `key: value` lines, all that such files have.
pub struct Settings {
    pub image: String,
    resolution: f64,
    origin: [f64; 2],
    /// Heights of black and of white, m.
    heights: [f64; 2],
    /// Grey value that marks missing data.
    no_data: Option<f64>,
}

impl Settings {
    pub fn parse(text: &str) -> Result<Self, Problem> {
        let pairs = text.lines().filter_map(|line| line.split('#').next()?.split_once(':'));
        let pairs: Vec<(&str, &str)> = pairs.map(|(key, value)| (key.trim(), value.trim())).collect();
        let find = |key: &str| pairs.iter().find(|(known, _)| *known == key).map(|(_, value)| *value);
        let need = |key: &str| find(key).ok_or_else(|| Problem::new(format!("no `{key}`")));
        let number = |key: &str, text: &str| {
            let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
            value.ok_or_else(|| Problem::new(format!("`{key}: {text}`; expected a number")))
        };
        let height = |key: &str| match find(key) {
            Some(text) => number(key, text),
            None => Err(Problem::new(format!(
                "no `{key}`: a map of occupancy has no heights; expected `height_black` and `height_white` in metres"
            ))),
        };
        let origin = need("origin")?;
        let parts = origin.trim_matches(['[', ']']).split(',').map(|part| number("origin", part.trim()));
        let parts = parts.collect::<Result<Vec<f64>, Problem>>()?;
        if parts.len() < 2 || parts.get(2).is_some_and(|yaw| *yaw != 0.0) {
            return Err(Problem::new(format!("`origin: {origin}`; expected [x, y, 0]: turned maps are not read")));
        }
        Ok(Self {
            image: need("image")?.trim_matches(['"', '\'']).to_owned(),
            resolution: number("resolution", need("resolution")?)?,
            origin: [parts[0], parts[1]],
            heights: [height("height_black")?, height("height_white")?],
            no_data: find("no_data").map(|text| number("no_data", text)).transpose()?,
        })
    }

    /// The heights of a binary (P5) or plain (P2) PGM of 8 or 16 bits; pixels stand for cells, whose centres become nodes.
    pub fn heights(&self, bytes: &[u8]) -> Result<Raw, Problem> {
        let mut at = 0;
        let magic = word(bytes, &mut at);
        if magic != "P5" && magic != "P2" {
            return Err(Problem::new(format!("`{magic}`; expected a PGM (P5 or P2)")));
        }
        let mut size = || word(bytes, &mut at).parse::<usize>().ok().filter(|size| (1..1 << 24).contains(size));
        let (Some(columns), Some(rows), Some(white)) = (size(), size(), size()) else {
            return Err(Problem::new("a broken header; expected width, height and the largest grey value"));
        };
        let count = columns * rows;
        let grey: Vec<f64> = if magic == "P2" {
            (0..count).map_while(|_| word(bytes, &mut at).parse().ok()).collect()
        } else if white < 256 {
            bytes.get(at + 1..).unwrap_or_default().iter().take(count).map(|byte| f64::from(*byte)).collect()
        } else {
            let pairs = bytes.get(at + 1..).unwrap_or_default().chunks_exact(2).take(count);
            pairs.map(|pair| f64::from(u16::from_be_bytes([pair[0], pair[1]]))).collect()
        };
        if grey.len() != count {
            return Err(Problem::new(format!("{} pixels; expected {columns} x {rows}", grey.len())));
        }
        let [low, high] = self.heights;
        let metres = |grey: f64| {
            if Some(grey) == self.no_data { f64::NAN } else { low + (high - low) * grey / white as f64 }
        };
        let heights = from_north(grey.into_iter().map(metres).collect(), columns);
        let origin = self.origin.map(|corner| corner + 0.5 * self.resolution);
        Ok(Raw { columns, rows, cell: self.resolution, origin, heights })
    }
}

/// The next word of a header; comments run from # to the end of a line.
fn word(bytes: &[u8], at: &mut usize) -> String {
    while let Some(byte) = bytes.get(*at) {
        if *byte == b'#' {
            while bytes.get(*at).is_some_and(|byte| *byte != b'\n') {
                *at += 1;
            }
        } else if !byte.is_ascii_whitespace() {
            break;
        } else {
            *at += 1;
        }
    }
    let start = *at;
    while bytes.get(*at).is_some_and(|byte| !byte.is_ascii_whitespace()) {
        *at += 1;
    }
    String::from_utf8_lossy(&bytes[start..*at]).into_owned()
}
