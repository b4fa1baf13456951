//! Names: C identifiers, and the standard's structured names (`wheel[2].slip`).

/// Whether `name` is a C identifier.
pub(super) fn is_identifier(name: &str) -> bool {
    let mut bytes = name.bytes();
    bytes.next().is_some_and(|b| b.is_ascii_alphabetic() || b == b'_')
        && bytes.all(|b| b.is_ascii_alphanumeric() || b == b'_')
}

/// Whether `name` fits the grammar of structured names (FMI 3.0, 2.4.7.5.1): identifiers joined by
/// dots, each with array indices or without, or the derivative `der(..)` of such a name. Quoted names are not used here.
pub(super) fn is_structured(name: &str) -> bool {
    let plain = name.strip_prefix("der(").and_then(|rest| rest.strip_suffix(')')).unwrap_or(name);
    plain.split('.').all(|part| match part.split_once('[') {
        None => is_identifier(part),
        Some((word, indices)) => is_identifier(word) && indices.strip_suffix(']').is_some_and(are_indices),
    })
}

fn are_indices(text: &str) -> bool {
    text.split(',').all(|index| !index.is_empty() && index.bytes().all(|b| b.is_ascii_digit()))
}

#[cfg(test)]
mod tests {
    use super::is_structured;

    #[test]
    fn published_structured_names() {
        // The grammar that the FMI 3.0 standard gives for `variableNamingConvention="structured"`.
        for good in ["x", "_a", "wheel[2].slip", "soil.k_phi", "m[1,20].n[3]", "der(state.wheel[2].spin)"] {
            assert!(is_structured(good), "{good}");
        }
        for bad in ["", "2x", "a.", ".a", "a[", "a[]", "a[x]", "a[1]b", "a b", "a[1,]", "ä", "der(x", "der()"] {
            assert!(!is_structured(bad), "{bad}");
        }
    }
}
