//! Which of several experiments share the soil, the vehicle or the drive.

use crate::diagnosis::compare::CompareError;
use crate::diagnosis::given::Given;
use crate::measurement::{Part, Share};
use std::ops::Range;

/// For each of [`Share::ALL`] the number of the first part that has the same of it, by part.
#[derive(Clone, Debug)]
pub(super) struct Sharing {
    firsts: [Vec<usize>; 3],
    names: Vec<String>,
}

impl Sharing {
    /// As the options say; else as the folders name what they share; else all have one soil, and each a vehicle of its own.
    ///
    /// # Errors
    /// [`CompareError::Vehicle`] where some folders name a thing and others do not.
    pub fn of(given: &Given, parts: &[Part]) -> Result<Self, CompareError> {
        let mut firsts = [Vec::new(), Vec::new(), Vec::new()];
        for share in Share::ALL {
            firsts[share as usize] = match &given.share {
                Some(asked) if asked.contains(&share) => vec![0; parts.len()],
                Some(_) => (0..parts.len()).collect(),
                None => by_name(share, parts)?,
            };
        }
        // Experiments with one vehicle have one drive, too.
        for k in 0..parts.len() {
            let (vehicle, drive) = (firsts[Share::Vehicle as usize][k], firsts[Share::Drive as usize][k]);
            let same = firsts[Share::Drive as usize][vehicle];
            for own in &mut firsts[Share::Drive as usize] {
                if *own == drive || *own == same {
                    *own = same.min(drive);
                }
            }
        }
        Ok(Self { firsts, names: parts.iter().map(|part| part.name.clone()).collect() })
    }

    fn parts(&self) -> Range<usize> {
        0..self.names.len()
    }

    /// Whether two parts have the same of a thing.
    fn same(&self, share: Share, one: usize, other: usize) -> bool {
        let firsts = &self.firsts[share as usize];
        firsts[one] == firsts[other]
    }

    /// The parts that have one value of a parameter with part `k`, itself among them.
    pub fn with(&self, parameter: &str, k: usize) -> Vec<usize> {
        match Share::of(parameter) {
            Some(share) => self.parts().filter(|other| self.same(share, k, *other)).collect(),
            None => vec![k],
        }
    }

    /// The different soils: the parts on each.
    pub fn soils(&self) -> Vec<Vec<usize>> {
        let firsts = self.parts().filter(|k| self.firsts[Share::Soil as usize][*k] == *k);
        firsts.map(|first| self.with("soil.", first)).collect()
    }

    /// The names of some parts, behind a parameter that they share; nothing where these are all.
    pub fn names_of(&self, parts: &[usize]) -> Option<String> {
        (parts.len() < self.names.len()).then(|| self.listed(parts))
    }

    fn listed(&self, parts: &[usize]) -> String {
        parts.iter().map(|k| self.names[*k].as_str()).collect::<Vec<_>>().join(" & ")
    }

    /// What is shared in words, where it is not one soil and nothing else.
    pub fn lines(&self) -> Vec<String> {
        let mut all = Vec::new();
        for share in Share::ALL {
            let firsts = &self.firsts[share as usize];
            let groups = self.parts().filter(|k| firsts[*k] == *k);
            let groups: Vec<Vec<usize>> =
                groups.map(|first| self.parts().filter(|k| firsts[*k] == first).collect()).collect();
            let line = match groups.len() {
                1 if share != Share::Soil => Some(format!("one {} in all experiments", share.name())),
                count if share == Share::Soil && count == self.names.len() => {
                    Some("a soil of its own in each experiment".to_owned())
                }
                count if count > 1 && count < self.names.len() => {
                    let groups: Vec<String> = groups.iter().map(|parts| self.listed(parts)).collect();
                    Some(format!("a {} each in {}", share.name(), groups.join("; ")))
                }
                _ => None,
            };
            // The drive of one vehicle is known to be one.
            let of_vehicle = share == Share::Drive && *firsts == self.firsts[Share::Vehicle as usize];
            all.extend(line.filter(|_| !of_vehicle));
        }
        all
    }
}

/// The same experiments with what the options say of sharing written down in each of them, and options that leave it to them: a further
/// experiment can then share a thing with some of them.
///
/// # Errors
/// As of [`Sharing::of`].
pub(crate) fn written_down(given: &Given, parts: &[Part]) -> Result<(Given, Vec<Part>), CompareError> {
    let mut named = parts.to_vec();
    if given.share.is_some() {
        let sharing = Sharing::of(given, parts)?;
        for (k, part) in named.iter_mut().enumerate() {
            for share in Share::ALL {
                let alike: Vec<usize> = sharing.parts().filter(|other| sharing.same(share, k, *other)).collect();
                part.experiment.shared.insert(share, sharing.listed(&alike));
            }
        }
    }
    Ok((Given { share: None, ..given.clone() }, named))
}

/// By the names that folders give a thing.
fn by_name(share: Share, parts: &[Part]) -> Result<Vec<usize>, CompareError> {
    let name = |k: usize| parts[k].experiment.shared.get(&share);
    let (named, unnamed): (Vec<usize>, Vec<usize>) = (0..parts.len()).partition(|k| name(*k).is_some());
    if named.is_empty() {
        return Ok(if share == Share::Soil { vec![0; parts.len()] } else { (0..parts.len()).collect() });
    }
    let listed = |of: &[usize]| of.iter().map(|k| parts[*k].name.as_str()).collect::<Vec<_>>().join(", ");
    if share == Share::Soil && !unnamed.is_empty() {
        return Err(CompareError::Vehicle(format!(
            "[shared] names the soil of {} and not that of {}: name it in each of them, or say what they share (--share, share=)",
            listed(&named),
            listed(&unnamed)
        )));
    }
    let first = |k: usize| (0..k).find(|other| name(*other).is_some() && name(*other) == name(k)).unwrap_or(k);
    Ok((0..parts.len()).map(first).collect())
}
