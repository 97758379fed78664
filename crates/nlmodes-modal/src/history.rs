/// An instant at which a contact closes or opens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactInstant {
    /// Time within the record, s.
    pub time: f64,
    /// True: contact begins. False: contact ends.
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
    /// Instants at which contact begins and ends, ascending.
    pub instants: Vec<ContactInstant>,
}

/// Minimum number of equidistant instants in addition to those of contact.
const FEWEST: usize = 64;
/// Number of instants within the shortest segment: odd, so that its midpoint is one of them.
const WITHIN: usize = 15;

impl TimeHistory {
    /// A history without instants, with a stop at this signed position (m).
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

    /// Appends an instant (s): displacement (m) with its first two time derivatives, and force (N).
    pub fn push(&mut self, time: f64, [displacement, velocity, acceleration]: [f64; 3], force: f64) {
        self.time.push(time);
        self.displacement.push(displacement);
        self.velocity.push(velocity);
        self.acceleration.push(acceleration);
        self.force.push(force);
    }

    /// Instants that resolve a motion which is smooth within each of `stretches` (the ends of consecutive segments) and
    /// nonsmooth between them, each with the number of the segment whose formulas apply. They include both ends of each
    /// segment, and equidistant instants within it: a minimum number even in the shortest, which may be a brief
    /// contact, and more in others according to their lengths, so that there are `samples + 1` in total, or more if
    /// needed to have 65 in addition to the segment ends.
    pub fn exact_instants(stretches: &[[f64; 2]], samples: usize) -> Vec<(f64, usize)> {
        let n = stretches.len();
        if n == 0 {
            return Vec::new();
        }
        let within = (samples + 1).saturating_sub(2 * n).max(FEWEST - 1);
        let counts = shares(stretches, within, WITHIN.min(within / (2 * n)));
        let mut found = Vec::with_capacity(within + 2 * n);
        for (number, ([from, to], count)) in stretches.iter().zip(counts).enumerate() {
            let at = |j: usize| from + (to - from) * j as f64 / (count + 1) as f64;
            found.push((*from, number));
            found.extend((1..=count).map(|j| (at(j), number)));
            found.push((*to, number));
        }
        found
    }
}

/// `count` distributed over the segments: `least` for each, the rest in proportion to their lengths.
fn shares(stretches: &[[f64; 2]], count: usize, least: usize) -> Vec<usize> {
    let length = |stretch: &[f64; 2]| (stretch[1] - stretch[0]).max(0.0);
    let whole: f64 = stretches.iter().map(length).sum();
    let rest = count - least * stretches.len();
    let (mut so_far, mut given) = (0.0, 0);
    let mut share = |stretch: &[f64; 2]| {
        so_far += length(stretch);
        let up_to = if whole > 0.0 { (rest as f64 * so_far / whole).round() as usize } else { rest };
        let own = up_to.min(rest) - given;
        given += own;
        least + own
    };
    stretches.iter().map(&mut share).collect()
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
        // A contact of a thousandth of the period has its largest force between its ends: its midpoint is among the
        // instants.
        let short: Vec<[f64; 2]> = [0.0, 0.3, 0.301, 1.0].windows(2).map(|pair| [pair[0], pair[1]]).collect();
        let found = TimeHistory::exact_instants(&short, 200);
        let blow: Vec<f64> = found.iter().filter(|(_, k)| *k == 1).map(|(t, _)| *t).collect();
        assert_eq!((found.len(), blow.len()), (201, WITHIN + 2));
        assert!(blow.iter().any(|t| (t - 0.3005).abs() < 1e-12));
        let widest = found.windows(2).map(|pair| pair[1].0 - pair[0].0).fold(0.0, f64::max);
        assert!(widest < 1.2 / 200.0 * 1.1, "{widest}");
        // Many segments do not exclude instants within them.
        let many: Vec<[f64; 2]> = (0..100).map(|k| [f64::from(k), f64::from(k + 1)]).collect();
        assert_eq!(TimeHistory::exact_instants(&many, 100).len(), 65 + 2 * 99);
        assert!(TimeHistory::exact_instants(&[], 10).is_empty());
    }
}
