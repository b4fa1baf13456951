//! Who uses whom in `src/`: the imports are those that the table in `src/lib.rs` allows, and no circle runs through rooms.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// What a row may use where its last column says so: every row above it.
const ALL_ABOVE: &str = "all above";
/// What the last column of the first row says, whose modules every other may use.
const FOR_ALL: &str = "for all";

/// A row of the table: its modules and what they may use.
struct Row {
    modules: Vec<String>,
    may_use: String,
}

impl Row {
    /// The modules that the last column names.
    fn listed(&self) -> impl Iterator<Item = &str> {
        self.may_use.split(", ").filter(|name| !name.is_empty() && ![ALL_ABOVE, FOR_ALL].contains(name))
    }
}

fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// Every other piece between backquotes.
fn quoted(text: &str) -> Vec<String> {
    text.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

/// The rows of the table in `src/lib.rs`, from the top.
fn table() -> Vec<Row> {
    let text = fs::read_to_string(source().join("lib.rs")).unwrap();
    let cells = text.lines().filter_map(|line| line.strip_prefix("//! |")).map(|line| line.split('|').map(str::trim));
    let rows = cells.map(|mut cells| (quoted(cells.next().unwrap()), cells.nth(1).unwrap().to_owned()));
    rows.filter(|(modules, _)| !modules.is_empty()).map(|(modules, may_use)| Row { modules, may_use }).collect()
}

/// What the table allows each module: what its row lists, the modules before it in its row, and those of the first row,
/// which are for all.
fn allowed(table: &[Row]) -> BTreeMap<String, BTreeSet<String>> {
    let mut allowed = BTreeMap::new();
    let mut above: BTreeSet<String> = BTreeSet::new();
    assert_eq!(table[0].may_use, FOR_ALL, "the first row");
    for row in table {
        let listed = row.listed().map(str::to_owned);
        let mut own: BTreeSet<String> = if row.may_use == ALL_ABOVE { above.clone() } else { listed.collect() };
        assert!(own.is_subset(&above), "{:?}: a row may use rows above it: {:?}", row.modules, own.difference(&above));
        if row.may_use != FOR_ALL {
            own.extend(table[0].modules.iter().cloned());
        }
        for module in &row.modules {
            assert!(allowed.insert(module.clone(), own.clone()).is_none(), "{module} stands in the table twice");
            own.insert(module.clone());
        }
        above.extend(row.modules.iter().cloned());
    }
    allowed
}

/// All files of Rust below `folder`.
fn files(folder: &Path) -> Vec<PathBuf> {
    let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let below = |path: PathBuf| if path.is_dir() { files(&path) } else { vec![path] };
    paths.flat_map(below).filter(|path| path.extension().is_some_and(|extension| extension == "rs")).collect()
}

/// The code of a file without comments and without its own tests, which may use anything.
fn code(text: &str) -> String {
    let text = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
    text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

/// The names that a text takes from the crate's root: `a` and `b` of `crate::a::x`, `crate::{a, b::{c, d}}`.
fn taken_from_root(text: &str) -> BTreeSet<String> {
    let word = |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let mut names = BTreeSet::new();
    for after in text.split("crate::").skip(1) {
        let Some(group) = after.strip_prefix('{') else {
            names.insert(word(after));
            continue;
        };
        let (mut depth, mut starts) = (0, true);
        for (at, c) in group.char_indices() {
            match c {
                '{' => depth += 1,
                '}' if depth == 0 => break,
                '}' => depth -= 1,
                ',' if depth == 0 => starts = true,
                _ if starts && !c.is_whitespace() => {
                    names.insert(word(&group[at..]));
                    starts = false;
                }
                _ => {}
            }
        }
    }
    names
}

/// Whether a chain of `super::` in a file `depth` modules below the root leads to the root.
fn climbs_to_root(text: &str, depth: usize) -> bool {
    text.contains(&"super::".repeat(depth))
}

/// Crates that `src/lib.rs` gives on under a name of its own; they use nothing of this one, so all may use them.
fn crates() -> BTreeSet<String> {
    let text = fs::read_to_string(source().join("lib.rs")).unwrap();
    let names =
        text.lines().filter_map(|line| line.strip_prefix("pub use bekker_")?.strip_suffix(';')?.split_once(" as "));
    names.map(|(_, name)| name.to_owned()).collect()
}

/// What each module of the crate's root uses of the others.
fn used() -> BTreeMap<String, BTreeSet<String>> {
    let (mut used, crates): (BTreeMap<String, BTreeSet<String>>, _) = (BTreeMap::new(), crates());
    for path in files(&source()) {
        let inside = path.strip_prefix(source()).unwrap();
        let parts: Vec<String> =
            inside.with_extension("").iter().map(|part| part.to_string_lossy().into_owned()).collect();
        if parts == ["lib"] {
            continue;
        }
        let text = code(&fs::read_to_string(&path).unwrap());
        let depth = parts.len() - usize::from(parts.last().is_some_and(|part| part == "mod"));
        assert!(!climbs_to_root(&text, depth), "{}: `super` up to the root; expected `crate::`", inside.display());
        let of_others = taken_from_root(&text).into_iter().filter(|name| *name != parts[0] && !crates.contains(name));
        used.entry(parts[0].clone()).or_default().extend(of_others);
    }
    used
}

#[test]
fn analytic_names_are_found_alone_and_in_groups() {
    let text = "use crate::rover::{Body, Rover};\nuse crate::{soil, wheel::{self, Wheel}, terrain::Terrain};\n$crate::scalar::x!();";
    let names: Vec<String> = taken_from_root(text).into_iter().collect();
    assert_eq!(names, ["rover", "scalar", "soil", "terrain", "wheel"]);
    assert_eq!(taken_from_root(&code("/// [`crate::model`]\n// crate::rover")), BTreeSet::new());
    assert!(climbs_to_root("use super::super::soil;", 2) && !climbs_to_root("use super::super::soil;", 3));
}

#[test]
fn property_modules_use_what_the_table_allows() {
    let (allowed, used) = (allowed(&table()), used());
    assert!(allowed.keys().eq(used.keys()), "the table names {:?}, src has {:?}", allowed.keys(), used.keys());
    for (module, others) in &used {
        let beyond: Vec<&String> = others.difference(&allowed[module]).collect();
        assert!(beyond.is_empty(), "{module} uses {beyond:?}; the table in src/lib.rs allows {:?}", allowed[module]);
    }
}

#[test]
fn property_the_table_allows_what_is_used_only() {
    let used = used();
    for row in &table() {
        let by_row: BTreeSet<&str> =
            row.modules.iter().flat_map(|module| used[module].iter().map(String::as_str)).collect();
        let idle: Vec<&str> = row.listed().filter(|name| !by_row.contains(name)).collect();
        assert!(idle.is_empty(), "{:?} may use {idle:?} and does not", row.modules);
    }
}
