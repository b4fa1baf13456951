//! What a diagnosis did not try, because its time budget was used up or it was interrupted.

/// A piece of work that was not done.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Untried {
    /// A first look at a set of effects, before it is known which are worth a fit.
    Look(Vec<String>),
    /// The first fit of a set of effects.
    Fit(Vec<String>),
    /// A further search for a set that is fitted already.
    Again(Vec<String>),
    /// The search for one more effect beside a set.
    Further(Vec<String>),
    /// The prediction of left-out conditions with a set.
    LeftOut(Vec<String>),
    /// The fit in which an experiment of a set has a soil of its own.
    OwnSoil(String),
    /// The profile of a parameter.
    Profile(String),
    /// The simulation of a possible next experiment.
    Variation(String),
}

/// Sets or names that one line lists; more are counted.
const LISTED: usize = 4;

impl Untried {
    /// What the piece belongs to, in words.
    fn of(&self) -> &'static str {
        match self {
            Self::Look(_) => "first looks at",
            Self::Fit(_) => "fits of",
            Self::Again(_) => "further searches for better fits of",
            Self::Further(_) => "the search for one more effect beside",
            Self::LeftOut(_) => "predictions of left-out conditions with",
            Self::OwnSoil(_) => "fits with a soil of its own in",
            Self::Profile(_) => "profiles of",
            Self::Variation(_) => "simulations of further experiments:",
        }
    }

    fn name(&self) -> String {
        match self {
            Self::Look(set) | Self::Fit(set) | Self::Again(set) | Self::Further(set) | Self::LeftOut(set) => named(set),
            Self::OwnSoil(name) | Self::Profile(name) | Self::Variation(name) => name.clone(),
        }
    }

    /// Number of effects.
    fn effects(&self) -> usize {
        match self {
            Self::Look(set) | Self::Fit(set) | Self::Again(set) | Self::Further(set) | Self::LeftOut(set) => set.len(),
            Self::OwnSoil(_) | Self::Profile(_) | Self::Variation(_) => 0,
        }
    }

    /// The set of effects of a fit or a first look that was not made: an effect about which nothing is known then.
    pub fn unknown(&self) -> Option<&[String]> {
        match self {
            Self::Look(set) | Self::Fit(set) => Some(set),
            _ => None,
        }
    }
}

/// A set of effects in words.
pub(crate) fn named(set: &[String]) -> String {
    if set.is_empty() { "the baseline".to_owned() } else { set.join(" + ") }
}

/// One line a kind of work: `fits of drag, tether, payload, rate and 3 more`.
pub(crate) fn lines(untried: &[Untried]) -> Vec<String> {
    let mut sorted = untried.to_vec();
    sorted.sort();
    sorted.dedup();
    sorted.chunk_by(|a, b| a.of() == b.of()).map(line).collect()
}

/// Sets of few effects come first: a single that was not tried says more than a pair.
fn line(kind: &[Untried]) -> String {
    let mut kind = kind.to_vec();
    kind.sort_by_key(Untried::effects);
    let names: Vec<String> = kind.iter().take(LISTED).map(Untried::name).collect();
    let more = match kind.len().saturating_sub(LISTED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    format!("{} {}{more}", kind[0].of(), names.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn property_each_kind_of_work_has_one_line() {
        let set = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        let mut all: Vec<Untried> = ["a", "b", "c", "d", "e", "f"].map(|id| Untried::Fit(set(&[id]))).to_vec();
        all.push(Untried::LeftOut(Vec::new()));
        all.push(Untried::Fit(set(&["a"])));
        all.push(Untried::Fit(set(&["a", "b"])));
        let expected = ["fits of a, b, c, d and 3 more", "predictions of left-out conditions with the baseline"];
        assert_eq!(lines(&all), expected);
    }
}
