//! Which values of an input are set-points and which differ by accident.

/// More classes than this are no set-points but values all along.
const MOST: usize = 10;

/// Set-points lie this many times farther apart than the widest of them is wide.
const APART: f64 = 2.0;

/// Lowest and highest value of each class, in rising order, where the values stand in classes that lie clearly apart: by
/// more than `least` and by more than twice the width of the widest class. One class of all values otherwise: then they
/// differ by accident, or continuously. NaN is left out.
pub(crate) fn set_points(values: impl IntoIterator<Item = f64>, least: f64) -> Vec<(f64, f64)> {
    let mut values: Vec<f64> = values.into_iter().filter(|value| !value.is_nan()).collect();
    values.sort_by(f64::total_cmp);
    let (Some(first), Some(last)) = (values.first(), values.last()) else { return Vec::new() };
    let mut gaps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).filter(|gap| *gap > least).collect();
    gaps.sort_by(|a, b| b.total_cmp(a));
    gaps.truncate(MOST - 1);
    // The finest division that holds; classes are divided by their largest gaps.
    for smallest in gaps.iter().rev() {
        let parts: Vec<(f64, f64)> =
            values.chunk_by(|a, b| b - a < *smallest).map(|part| (part[0], part[part.len() - 1])).collect();
        let widest = parts.iter().map(|(low, high)| high - low).fold(0.0, f64::max);
        if parts.len() <= MOST && *smallest > APART * widest {
            return parts;
        }
    }
    vec![(*first, *last)]
}

/// The class in which a value lies.
pub(super) fn class_of(classes: &[(f64, f64)], value: f64) -> Option<usize> {
    classes.iter().position(|(low, high)| (*low..=*high).contains(&value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn property_set_points_are_told_from_accidental_differences() {
        // Loads of a rig that holds 20, 40 and 60 N within a few tenths.
        let held = [20.1, 39.8, 60.0, 19.9, 40.3, 60.2, 40.0, 20.0];
        assert_eq!(set_points(held, 3.0), [(19.9, 20.1), (39.8, 40.3), (60.0, 60.2)]);
        // Loads that were meant to be one, between 20 and 26 N, one of them farther off than the rest.
        let scattered = [21.6, 24.0, 24.3, 24.5, 24.6, 24.8, 25.1, 25.3, 25.6, 26.0, 26.1];
        assert_eq!(set_points(scattered, 1.3), [(21.6, 26.1)]);
        // More values than anyone sets one by one.
        assert_eq!(set_points((0..30).map(f64::from), 0.5).len(), 1);
        assert!(set_points([f64::NAN], 0.1).is_empty());
    }
}
