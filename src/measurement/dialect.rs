//! How a file of columns is written: separator, decimal mark, comments, lines before the header.

use serde::Deserialize;
use std::collections::BTreeMap;
use toml::Spanned;

/// `where`: what the cells of these columns must be.
pub(super) type Filters = BTreeMap<String, Spanned<toml::Value>>;

/// What starts a comment line where nothing else is said.
const COMMENTS: [&str; 3] = ["#", "%", "//"];

/// `[file]` of `experiment.toml`: what is not given is found out from the file.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Dialect {
    pub separator: Option<Separator>,
    pub decimal: Option<Decimal>,
    /// What starts a comment line.
    pub comment: Option<Vec<String>>,
    /// Line of the column names, counted from 1; what stands above it is skipped.
    pub header_line: Option<u64>,
    /// Whether the row under the header holds units.
    pub units_row: Option<bool>,
    /// Texts of cells that mean a missing value, beside the empty cell.
    #[serde(default)]
    pub missing: Vec<String>,
    /// Which rows count, in every file.
    #[serde(default, rename = "where")]
    pub filters: Filters,
}

/// What stands between two cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub(super) enum Separator {
    #[serde(rename = ",", alias = "comma")]
    Comma,
    #[serde(rename = ";", alias = "semicolon")]
    Semicolon,
    #[serde(rename = "\t", alias = "tab")]
    Tab,
    /// One or more blanks.
    #[serde(rename = " ", alias = "space")]
    Space,
}

/// The decimal mark of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub(super) enum Decimal {
    #[serde(rename = ".", alias = "point")]
    Point,
    #[serde(rename = ",", alias = "comma")]
    Comma,
}

impl Separator {
    /// As messages name it.
    pub fn shown(self) -> &'static str {
        match self {
            Self::Comma => "`,`",
            Self::Semicolon => "`;`",
            Self::Tab => "a tab",
            Self::Space => "blanks",
        }
    }

    /// The byte between cells, once [`Kept::text`] has replaced blanks.
    pub fn byte(self) -> u8 {
        match self {
            Self::Comma => b',',
            Self::Semicolon => b';',
            Self::Tab | Self::Space => b'\t',
        }
    }
}

/// Lines of a file without comments, and where they stood.
pub(super) struct Kept {
    pub lines: Vec<(u64, String)>,
}

impl Kept {
    /// Leaves out blank lines, comment lines and what stands above the header.
    pub fn of(text: &str, dialect: &Dialect) -> Self {
        let comments: Vec<&str> = match &dialect.comment {
            Some(own) => own.iter().map(String::as_str).filter(|mark| !mark.is_empty()).collect(),
            None => COMMENTS.to_vec(),
        };
        let mut lines = Vec::new();
        let mut quoted = false;
        for (number, line) in (1..).zip(text.lines()) {
            let header = dialect.header_line == Some(number);
            if dialect.header_line.is_some_and(|header| number < header) {
                continue;
            }
            let mark = comments.iter().find(|mark| line.trim_start().starts_with(**mark)).filter(|_| !quoted);
            match mark {
                // The names may stand in a comment line, as `numpy.savetxt` writes them.
                Some(mark) if header => lines.push((number, line.trim_start()[mark.len()..].trim().to_owned())),
                Some(_) => continue,
                None if line.trim().is_empty() => continue,
                None => lines.push((number, line.to_owned())),
            }
            quoted ^= line.matches('"').count() % 2 == 1;
        }
        Self { lines }
    }

    /// The lines as a text whose cells the separator's byte parts.
    pub fn text(&self, separator: Separator) -> String {
        let cells = |line: &String| match separator {
            Separator::Space => line.split_whitespace().collect::<Vec<_>>().join("\t"),
            _ => line.clone(),
        };
        self.lines.iter().map(|(_, line)| cells(line) + "\n").collect()
    }

    /// The separator: the one given, or the only one that parts the header and gives every row as many cells.
    ///
    /// # Errors
    /// A message that names the separators between which the file does not decide.
    pub fn separator(&self, dialect: &Dialect) -> Result<Separator, String> {
        if let Some(given) = dialect.separator {
            return Ok(given);
        }
        let candidates = [Separator::Comma, Separator::Semicolon, Separator::Tab];
        let Some((_, header)) = self.lines.first() else { return Ok(Separator::Comma) };
        let parts: Vec<_> = candidates.into_iter().filter(|s| cells(header, *s) > 1).collect();
        let even = |s: &Separator| self.lines.iter().all(|(_, line)| cells(line, *s) == cells(header, *s));
        match parts.as_slice() {
            [one] => Ok(*one),
            // A single column, or words that blanks part: rows of numbers tell.
            [] if cells(header, Separator::Space) > 1 && even(&Separator::Space) => Ok(Separator::Space),
            [] => Ok(Separator::Comma),
            several => match several.iter().filter(|s| even(s)).collect::<Vec<_>>().as_slice() {
                [one] => Ok(**one),
                _ => Err(format!(
                    "the separator is not clear: {}; write it as `separator` under [file]",
                    several
                        .iter()
                        .map(|s| format!("{} gives the header {} cells", s.shown(), cells(header, *s)))
                        .collect::<Vec<_>>()
                        .join(", ")
                )),
            },
        }
    }
}

/// Number of cells of a line; a separator within quotes parts nothing.
fn cells(line: &str, separator: Separator) -> usize {
    if separator == Separator::Space {
        return line.split_whitespace().count();
    }
    let mut quoted = false;
    1 + line
        .bytes()
        .filter(|byte| {
            quoted ^= *byte == b'"';
            !quoted && *byte == separator.byte()
        })
        .count()
}

/// Which decimal mark a cell shows by its form: digits with one mark between or before them.
pub(super) fn decimal_of(cell: &str) -> Option<Decimal> {
    let plain = cell.trim_start_matches(['+', '-']);
    let mantissa = plain.split(['e', 'E']).next().unwrap_or_default();
    let digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    let of = |mark: char, decimal: Decimal| {
        let (whole, part) = mantissa.split_once(mark)?;
        (digits(whole) && digits(part) && !part.is_empty()).then_some(decimal)
    };
    of(',', Decimal::Comma).or_else(|| of('.', Decimal::Point))
}
