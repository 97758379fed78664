/// An instant at which a contact closes or opens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactInstant {
    /// Time within the record, s.
    pub time: f64,
    /// True: touching begins. False: the body leaves.
    pub touching: bool,
}

/// Motion and force of one contact coordinate over time.
///
/// All series have the length of `time`.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeHistory {
    /// Name in legends.
    pub label: String,
    /// Time, s, ascending.
    pub time: Vec<f64>,
    /// Displacement, m.
    pub displacement: Vec<f64>,
    /// Velocity, m/s.
    pub velocity: Vec<f64>,
    /// Acceleration, m/s².
    pub acceleration: Vec<f64>,
    /// Contact force, N, zero or positive.
    pub force: Vec<f64>,
    /// Signed position of the stop along the coordinate, m.
    pub stop: f64,
    /// Instants of touching and leaving, ascending.
    pub instants: Vec<ContactInstant>,
}

/// Fewest equidistant instants beside those of contact.
const FEWEST: usize = 64;

impl TimeHistory {
    /// A history without instants, before a stop at this signed position (m).
    pub fn empty(label: &str, stop: f64) -> Self {
        let none = Vec::new;
        Self {
            label: label.to_owned(),
            time: none(),
            displacement: none(),
            velocity: none(),
            acceleration: none(),
            force: none(),
            stop,
            instants: Vec::new(),
        }
    }

    /// Appends an instant (s): displacement (m) with its two derivatives by time, and force (N).
    pub fn push(&mut self, time: f64, [displacement, velocity, acceleration]: [f64; 3], force: f64) {
        self.time.push(time);
        self.displacement.push(displacement);
        self.velocity.push(velocity);
        self.acceleration.push(acceleration);
        self.force.push(force);
    }

    /// Instants that do justice to motions which are smooth within each of `stretches` (their ends, one after the other) and change between
    /// them: each with the number of its stretch, in whose formulas it is meant. Both ends of each stretch are among them, and equidistant
    /// ones, so that there are `samples + 1` in all, or as many more as it takes for 64 of these.
    pub fn exact_instants(stretches: &[[f64; 2]], samples: usize) -> Vec<(f64, usize)> {
        let (Some(first), Some(last)) = (stretches.first(), stretches.last()) else { return Vec::new() };
        let (from, to) = (first[0], last[1]);
        let cells = samples.saturating_sub(2 * (stretches.len() - 1)).max(FEWEST);
        let at = |j: usize| if j == cells { to } else { from + (to - from) * j as f64 / cells as f64 };
        let (mut found, mut next) = (Vec::with_capacity(cells + 2 * stretches.len()), 0);
        for (number, [begin, end]) in stretches.iter().enumerate() {
            let is_last = number + 1 == stretches.len();
            if number > 0 {
                found.push((*begin, number));
            }
            while next <= cells && (at(next) <= *end || is_last) {
                found.push((at(next), number));
                next += 1;
            }
            if !is_last {
                found.push((*end, number));
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn an_instant_that_is_appended_has_its_numbers_in_all_series() {
        let mut history = TimeHistory::empty("tip", -0.1);
        assert_eq!((history.label.as_str(), history.stop, history.time.len()), ("tip", -0.1, 0));
        history.push(0.5, [1.0, 2.0, 3.0], 4.0);
        let found = [&history.time, &history.displacement, &history.velocity, &history.acceleration, &history.force];
        assert_eq!(found, [&[0.5], &[1.0], &[2.0], &[3.0], &[4.0]]);
    }

    #[test]
    fn exact_instants_ascend_have_the_number_asked_for_and_both_sides_of_each_change() {
        for scale in [1.0, 1e-3, TAU] {
            let ends = [0.0, 0.25, 0.5, 0.61, 1.0].map(|x| x * scale);
            let stretches: Vec<[f64; 2]> = ends.windows(2).map(|pair| [pair[0], pair[1]]).collect();
            let found = TimeHistory::exact_instants(&stretches, 200);
            assert_eq!(found.len(), 201);
            assert!(found.is_sorted_by(|a, b| a.0 <= b.0 && a.1 <= b.1));
            for (k, end) in ends[1..4].iter().enumerate() {
                assert!(found.contains(&(*end, k)) && found.contains(&(*end, k + 1)), "{k}");
            }
            assert_eq!((found[0], found[200]), ((0.0, 0), (scale, 3)));
            assert!(found.iter().all(|(t, k)| (stretches[*k][0]..=stretches[*k][1]).contains(t)));
        }
        // Many changes do not leave the motion without instants between them.
        let many: Vec<[f64; 2]> = (0..100).map(|k| [f64::from(k), f64::from(k + 1)]).collect();
        assert_eq!(TimeHistory::exact_instants(&many, 100).len(), 65 + 2 * 99);
        assert!(TimeHistory::exact_instants(&[], 10).is_empty());
    }
}
