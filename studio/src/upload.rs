//! Files that a browser brings. They stay in memory: their names are keys of a map and never paths, so that nothing is written and
//! nothing beside them can be read.

use crate::error::Refusal;
use bekker::diagnosis::Given;
use bekker::measurement::{Experiment, Kind, Meaning, Proposal, decoded};
use bekker::model::{Model, PRESETS};
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

/// Name of the settings in an experiment's folder.
pub const SETTINGS: &str = "experiment.toml";

/// Most files of an upload, and uploads that are kept.
const MOST_FILES: usize = 2000;
const MOST_UPLOADS: usize = 8;

/// Longest name of a file, bytes.
const LONGEST: usize = 240;

/// Files by their names below the folder.
#[derive(Default)]
pub struct Upload {
    texts: BTreeMap<String, String>,
    size: usize,
    proposal: Option<Proposal>,
}

/// All uploads that are not opened yet.
pub struct Uploads {
    limit: usize,
    count: u64,
    open: BTreeMap<u64, Upload>,
}

impl Uploads {
    pub fn new(limit: usize) -> Self {
        Self { limit, count: 0, open: BTreeMap::new() }
    }

    /// Most bytes of an upload.
    pub fn limit(&self) -> usize {
        self.limit
    }

    /// Begins an upload; the oldest goes where there are many.
    pub fn begin(&mut self) -> u64 {
        self.count += 1;
        self.open.insert(self.count, Upload::default());
        while self.open.len() > MOST_UPLOADS {
            self.open.pop_first();
        }
        self.count
    }

    pub fn get(&mut self, number: u64) -> Result<&mut Upload, Refusal> {
        self.open.get_mut(&number).ok_or_else(|| Refusal::missing("such upload any more: choose the files again"))
    }

    /// Ends an upload.
    pub fn end(&mut self, number: u64) {
        self.open.remove(&number);
    }

    /// Takes a file.
    pub fn take(&mut self, number: u64, name: &str, bytes: Vec<u8>) -> Result<(), Refusal> {
        let limit = self.limit;
        let upload = self.get(number)?;
        let name = checked(name)?;
        let before = upload.texts.get(&name).map_or(0, String::len);
        if upload.size - before + bytes.len() > limit {
            let limit = limit >> 20;
            return Err(Refusal::too_large(format!(
                "`{name}`: an upload may hold {limit} MB; start `bekker studio` with the folder"
            )));
        }
        if upload.texts.len() >= MOST_FILES && before == 0 {
            return Err(Refusal::too_large(format!("an upload may hold {MOST_FILES} files")));
        }
        upload.size = upload.size - before + bytes.len();
        let text = decoded(Path::new(&name), bytes).map_err(Refusal::bad)?;
        upload.texts.insert(name, text);
        upload.proposal = None;
        Ok(())
    }
}

/// A name below the folder: no way out of it.
fn checked(name: &str) -> Result<String, Refusal> {
    let plain = name.replace('\\', "/");
    let inside = Path::new(&plain).components().all(|part| matches!(part, Component::Normal(_)));
    let drive = plain.contains(':') || plain.contains('\0');
    if plain.is_empty() || plain.len() > LONGEST || !inside || drive {
        return Err(Refusal::bad(format!("`{name}` is no name of a file below a folder")));
    }
    Ok(plain)
}

impl Upload {
    /// Whether the files have settings of their own.
    pub fn has_settings(&self) -> bool {
        self.texts.contains_key(SETTINGS)
    }

    /// Names of the files.
    pub fn names(&self) -> impl Iterator<Item = &String> {
        self.texts.keys()
    }

    /// What is proposed for the columns of the files.
    pub fn proposal(&mut self, kind: Option<Kind>) -> Result<&mut Proposal, Refusal> {
        if self.proposal.as_ref().is_none_or(|known| kind.is_some_and(|kind| kind != known.kind)) {
            let tables: Vec<(PathBuf, String)> = self
                .texts
                .iter()
                .filter(|(name, _)| *name != SETTINGS)
                .map(|(name, text)| (name.into(), text.clone()))
                .collect();
            self.proposal = Some(Proposal::of_texts(&tables, kind).map_err(Refusal::bad)?);
        }
        self.proposal.as_mut().ok_or_else(|| Refusal::missing("proposal"))
    }

    /// Changes the proposal.
    pub fn choose(
        &mut self,
        kind: Option<Kind>,
        columns: &BTreeMap<String, Option<Meaning>>,
        filled: &BTreeMap<String, f64>,
    ) -> Result<&mut Proposal, Refusal> {
        let proposal = self.proposal(kind)?;
        for (column, meaning) in columns {
            proposal.choose(column, meaning.as_ref()).map_err(Refusal::bad)?;
        }
        for (name, value) in filled {
            proposal.fill(name, *value).map_err(Refusal::bad)?;
        }
        Ok(proposal)
    }

    /// The experiment, with `settings` in the place of its own.
    pub fn experiment(&self, settings: Option<&str>) -> Result<(Experiment, Given), Refusal> {
        let mut texts = self.texts.clone();
        if let Some(proposal) = &self.proposal {
            // The settings name the files as the proposal does.
            texts = self
                .texts
                .values()
                .cloned()
                .zip(proposal.names())
                .map(|(text, name)| (name.to_owned(), text))
                .collect();
        }
        if let Some(settings) = settings {
            texts.insert(SETTINGS.to_owned(), settings.to_owned());
        }
        let experiment = Experiment::from_texts(&texts).map_err(Refusal::bad)?;
        let given = self.model(&experiment)?;
        Ok((experiment, given))
    }

    /// The model that an experiment names: built in, or among the files.
    fn model(&self, experiment: &Experiment) -> Result<Given, Refusal> {
        let Some(name) = experiment.model.as_deref().filter(|name| PRESETS.iter().all(|(preset, _)| preset != name))
        else {
            return Ok(Given::default());
        };
        let text = self.texts.get(name).ok_or_else(|| {
            Refusal::bad(format!("experiment.toml, model: `{name}` is neither among the files nor a built-in model"))
        })?;
        let failed = |error: &dyn std::fmt::Display| Refusal::bad(format!("`{name}`: {error}"));
        let table: toml::Table = text.parse().map_err(|error| failed(&error))?;
        // A model's own ground is a file beside it, which could be any of this machine; the runs have theirs.
        if table.get("terrain").and_then(|terrain| terrain.get("file")).is_some() {
            return Err(failed(
                &"`file` under [terrain] is not read from an upload; leave it out: the ground is that of the runs",
            ));
        }
        let model = Model::from_toml(text, None).map_err(|error| Refusal::bad(format!("`{name}`: {error}")))?;
        Ok(Given::again(model, true, BTreeMap::new()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn property_no_name_leads_out_of_the_folder() {
        for name in ["../x.csv", "/etc/passwd", "a/../../x", "C:\\x.csv", "", "..", "a\0b", &"x".repeat(300)] {
            assert!(checked(name).is_err(), "{name:?}");
        }
        assert_eq!(checked("runs\\a.csv").expect("a name"), "runs/a.csv");
        assert_eq!(checked("Lauf 1 (früh).csv").expect("a name"), "Lauf 1 (früh).csv");
    }

    #[test]
    fn property_uploads_have_limits_and_bad_text_an_error_with_its_line() {
        let mut uploads = Uploads::new(10);
        let number = uploads.begin();
        uploads.take(number, "a.csv", b"a,b\n1,2\n".to_vec()).expect("eight bytes");
        assert!(uploads.take(number, "b.csv", b"a,b\n".to_vec()).is_err(), "twelve bytes");
        // The same file again takes the place of the first.
        uploads.take(number, "a.csv", b"a\n1\n".to_vec()).expect("four bytes");
        let refused = uploads.take(number, "c.csv", b"a\n\xb0\n".to_vec()).expect_err("no UTF-8");
        assert!(format!("{refused:?}").contains("line 2"), "{refused:?}");
        for _ in 0..MOST_UPLOADS {
            uploads.begin();
        }
        assert!(uploads.get(number).is_err(), "the oldest is gone");
    }
}
