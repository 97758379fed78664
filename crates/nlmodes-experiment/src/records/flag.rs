use std::ops::Range;

/// Share of its largest value from which on a flag is set: a flag may be the number of a level, up to twenty, or a
/// voltage with noise.
const SET: f64 = 0.05;
/// Share of its largest value by which a flag must change to begin another level without a pause.
const ANOTHER: f64 = 0.025;

/// A channel that is not zero while a level is held.
#[derive(Debug, Clone, PartialEq)]
pub struct Flag {
    /// Its name in the scene.
    pub name: String,
    /// Samples of each level, in their order.
    pub stretches: Vec<Range<usize>>,
}

impl Flag {
    /// The intervals of a recorded flag: where its size is a twentieth of the largest one or more. Where it changes
    /// without becoming zero, as the number of a level does, another interval begins.
    pub fn new(name: impl Into<String>, values: &[f64]) -> Self {
        let largest = values.iter().filter(|x| x.is_finite()).fold(0.0, |m: f64, x| m.max(x.abs()));
        let mut stretches: Vec<Range<usize>> = Vec::new();
        let mut first: Option<usize> = None;
        for (j, x) in values.iter().enumerate() {
            let is_set = largest > 0.0 && x.abs() >= SET * largest;
            let changes = first.is_some_and(|first| (x - values[first]).abs() > ANOTHER * largest);
            if let Some(first) = first.filter(|_| !is_set || changes) {
                stretches.push(first..j);
            }
            first = if is_set && (changes || first.is_none()) { Some(j) } else { first.filter(|_| is_set) };
        }
        stretches.extend(first.map(|first| first..values.len()));
        Self { name: name.into(), stretches }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flag_is_set_where_it_is_not_zero_and_changes_with_the_level() {
        let found = |values: &[f64]| Flag::new("settled", values).stretches;
        assert_eq!(found(&[0.0, 1.0, 1.0, 0.0, 0.0, 1.0]), [1..3, 5..6]);
        assert_eq!(found(&[1.0, 1.0, 2.0, 2.0, 2.0, 0.0, 3.0]), [0..2, 2..5, 6..7], "numbers of levels");
        assert_eq!(found(&[0.01, 5.0, 5.02, 4.99, -0.02]), std::slice::from_ref(&(1..4)), "a voltage with noise");
        assert_eq!(found(&[-1.0, f64::NAN, -1.0]), [0..1, 2..3]);
        assert!(found(&[0.0, 0.0]).is_empty() && found(&[]).is_empty() && found(&[f64::NAN]).is_empty());
    }
}
