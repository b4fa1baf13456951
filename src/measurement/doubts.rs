//! What is unlikely in the files of an experiment, each doubt once.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Doubts in the order in which they arose.
#[derive(Debug, Default)]
pub(super) struct Doubts {
    found: Vec<Doubt>,
}

#[derive(Debug)]
struct Doubt {
    text: String,
    first: PathBuf,
    files: BTreeSet<PathBuf>,
}

impl Doubts {
    /// Adds a doubt about a file; where the same was said of another, but for its numbers, the files are counted.
    pub fn add(&mut self, file: &Path, text: String) {
        let same = |doubt: &&mut Doubt| without_numbers(&doubt.text) == without_numbers(&text);
        match self.found.iter_mut().find(same) {
            Some(doubt) => {
                doubt.files.insert(file.to_owned());
            }
            None => self.found.push(Doubt { text, first: file.to_owned(), files: BTreeSet::from([file.to_owned()]) }),
        }
    }

    /// One text a doubt, with the first file that it is about and the number of others.
    pub fn texts(&self) -> Vec<String> {
        let shown = |doubt: &Doubt| {
            let more = match doubt.files.len() {
                0 | 1 => String::new(),
                2 => " and 1 more file".to_owned(),
                many => format!(" and {} more files", many - 1),
            };
            format!("{}{more}: {}", doubt.first.display(), doubt.text)
        };
        self.found.iter().map(shown).collect()
    }
}

fn without_numbers(text: &str) -> String {
    text.chars().filter(|c| !c.is_ascii_digit() && !"+-.".contains(*c)).collect()
}
