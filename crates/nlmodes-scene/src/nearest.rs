//! The known word that a mistyped one was probably meant to be.

/// The word of `known` nearest to `typed`, if it is near enough to be a slip: few edits, or a unit left out or
/// replaced.
pub fn nearest<'a>(typed: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let typed = typed.to_lowercase().replace('-', "_");
    let ranked = known.into_iter().map(|word| (rank(&typed, &word.replace('-', "_")), word));
    ranked.filter_map(|(rank, word)| rank.map(|rank| (rank, word))).min_by_key(|(rank, _)| *rank).map(|(_, word)| word)
}

/// Number of edits if they are few for the length of the word, 1 if only the unit differs.
fn rank(typed: &str, word: &str) -> Option<usize> {
    let edits = edits(typed, word);
    let allowed = (word.chars().count().max(typed.chars().count()) / 3).max(1);
    if edits <= allowed { Some(edits) } else { same_stem(typed, word).then_some(1) }
}

/// Whether one word is the beginning of the other, or they differ in their units only.
fn same_stem(typed: &str, word: &str) -> bool {
    typed.len() >= 3 && (word.starts_with(typed) || stem(typed) == stem(word))
}

/// A key without the part after its first underscore, where that part is short enough to be a unit.
fn stem(key: &str) -> &str {
    key.split_once('_').filter(|(_, unit)| unit.len() <= 3).map_or(key, |(stem, _)| stem)
}

/// Optimal string alignment distance: insertions, deletions, replacements, and swaps of neighbours.
fn edits(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().take(64).collect(), b.chars().take(64).collect());
    let mut rows: Vec<Vec<usize>> = vec![(0..=b.len()).collect()];
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let replace = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut best = replace.min(rows[i - 1][j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(rows[i - 2][j - 2] + 1);
            }
            row.push(best);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEYS: [&str; 6] = ["length_m", "elements", "youngs_modulus_pa", "gap_m", "harmonics", "mass_matrix"];

    #[test]
    fn slips_of_the_finger_are_recognised() {
        for (typed, meant) in [
            ("lenght_m", "length_m"),
            ("Elements", "elements"),
            ("element", "elements"),
            ("youngs_modulus", "youngs_modulus_pa"),
            ("gap", "gap_m"),
            ("len", "length_m"),
            ("gap_mm", "gap_m"),
            ("harmonic", "harmonics"),
            ("mass-matrix", "mass_matrix"),
        ] {
            assert_eq!(nearest(typed, KEYS), Some(meant), "{typed}");
        }
    }

    #[test]
    fn other_words_are_not() {
        for typed in ["", "x", "viscosity", "colour", "temperature_k"] {
            assert_eq!(nearest(typed, KEYS), None, "{typed}");
        }
    }

    #[test]
    fn swapping_neighbours_is_one_edit() {
        assert_eq!(edits("lenght", "length"), 1);
        assert_eq!(edits("", "abc"), 3);
        assert_eq!(edits("kitten", "sitting"), 3);
    }
}
