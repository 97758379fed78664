//! Boundaries between contact patterns: where a contact interval appears or vanishes, or two instants exchange their
//! order.

use std::f64::consts::TAU;

use crate::closed_set::SetTable;
use crate::contact_operator::{ContactOperator, PatternInterval};
use crate::series::Symmetry;
use crate::trigonometric::Trigonometric;

/// Newton steps towards an extremum or a zero of a guard, and the change that ends them, rad.
const NEWTON_STEPS: usize = 60;
const SETTLED: f64 = 1e-14;

/// Longest of these steps, over the shortest wavelength.
const LONGEST: f64 = 0.08;

/// A difference between two contact patterns, as a function of the gaps: positive for the first, negative for the
/// second.
///
/// While a set of contacts is closed, the gap of an open one and the force of a closed one are trigonometric
/// polynomials, its guards. An interval with one more or one less contact closed exists where the least value of a
/// guard around it is negative; and of two contacts that change sides one after the other, the guard of the second is
/// positive when that of the first vanishes.
#[derive(Debug, Clone)]
pub(crate) struct PatternBoundary {
    /// The guard, as weights of the gaps of all contacts.
    pub guard: Vec<f64>,
    /// That whose zero tells the instant at which the guard counts; none where it is the extremum of the guard itself.
    pub clock: Option<Vec<f64>>,
    /// About when, rad.
    near: f64,
    /// +1 if the first pattern is that with the positive guard, else −1.
    sense: f64,
}

impl PatternBoundary {
    /// The one difference between two sequences of closed sets; `None` where they are the same or differ in more.
    pub fn between(
        sets: &SetTable,
        symmetry: Symmetry,
        from: &[PatternInterval],
        to: &[PatternInterval],
    ) -> Option<Self> {
        match symmetry {
            Symmetry::Even => Self::between_halves(sets, from, to),
            Symmetry::None => Self::between_periods(sets, &around_the_period(from), &around_the_period(to)),
        }
    }

    /// The same for halves of periods, at whose ends even motions have their extrema.
    fn between_halves(sets: &SetTable, from: &[PatternInterval], to: &[PatternInterval]) -> Option<Self> {
        let (few, many, sense) = if from.len() < to.len() { (from, to, 1.0) } else { (to, from, -1.0) };
        let last = many.len().checked_sub(1)?;
        match many.len() - few.len() {
            0 => {
                let mut different = (0..=last).filter(|&i| from[i].set != to[i].set);
                let at = different.next().filter(|_| different.next().is_none())?;
                Self::exchanged(sets, from.get(at.checked_sub(1)?)?.set, &from[at], &to[at])
            }
            1 if same_sets(few, &many[1..]) => Self::appearing(sets, &many[0], &many[1], many[0].from, sense),
            1 if same_sets(few, &many[..last]) => {
                Self::appearing(sets, &many[last], many.get(last.checked_sub(1)?)?, many[last].to, sense)
            }
            2 => {
                let at = one_more(few, many)?;
                Self::appearing(sets, &many[at], &many[at - 1], middle(&many[at]), sense)
            }
            _ => None,
        }
    }

    /// The same for whole periods, which begin anywhere.
    fn between_periods(sets: &SetTable, from: &[PatternInterval], to: &[PatternInterval]) -> Option<Self> {
        let (few, many, sense) = if from.len() < to.len() { (from, to, 1.0) } else { (to, from, -1.0) };
        let (n, count) = (many.len(), few.len());
        if n == count {
            let turned = |k: usize| (0..n).map(move |i| &to[(i + k) % n]);
            let differing = |k: usize| (0..n).zip(turned(k)).filter(|(i, b)| from[*i].set != b.set).collect::<Vec<_>>();
            return (0..n).map(differing).find(|different| different.len() == 1).and_then(|different| {
                let (i, b) = different[0];
                Self::exchanged(sets, from[(i + n - 1) % n].set, &from[i], b)
            });
        }
        let set = |k: usize| many[k % n].set;
        // Without interval k its neighbours are one.
        let left = |k: usize| (k + 1..k + n.max(3) - 1).map(set).collect::<Vec<usize>>();
        let is_few = |sets: &[usize]| (0..count).any(|r| (0..count).all(|i| few[(i + r) % count].set == sets[i]));
        let fits = |k: &usize| set(k + 1) == set(k + n - 1) && left(*k).len() == count && is_few(&left(*k));
        let length = |k: &usize| many[*k].to - many[*k].from;
        let k = (0..n).filter(fits).min_by(|a, b| length(a).total_cmp(&length(b)))?;
        Self::appearing(sets, &many[k], &many[(k + 1) % n], middle(&many[k]), sense)
    }

    /// An interval within another one, about the instant `near`.
    fn appearing(
        sets: &SetTable,
        interval: &PatternInterval,
        around: &PatternInterval,
        near: f64,
        sense: f64,
    ) -> Option<Self> {
        let contact = only_difference(sets, around.set, interval.set)?;
        Some(Self { guard: guard(sets, around.set, contact), clock: None, near, sense })
    }

    /// Between the same neighbours, of which `before` is the first, one contact changes sides first in `a` and another
    /// in `b`.
    fn exchanged(sets: &SetTable, before: usize, a: &PatternInterval, b: &PatternInterval) -> Option<Self> {
        let (first, second) = (only_difference(sets, before, a.set)?, only_difference(sets, before, b.set)?);
        let (guard, clock) = (guard(sets, before, second), Some(guard(sets, before, first)));
        Some(Self { guard, clock, near: a.from, sense: 1.0 })
    }

    /// Its value for the guards as functions of time, of which `form` makes one from weights of the gaps.
    pub fn value(&self, form: impl Fn(&[f64]) -> Trigonometric) -> f64 {
        let guard = form(&self.guard);
        let tau = match &self.clock {
            None => newton(&guard, 1, self.near),
            Some(clock) => newton(&form(clock), 0, self.near),
        };
        self.sense * guard.evaluate(tau)[0]
    }
}

fn same_sets(a: &[PatternInterval], b: &[PatternInterval]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.set == b.set)
}

/// Which interval, not the first or the last one, is there in addition. Where contacts close and open in turn that may
/// be any of them: without it the instants are those that the others are nearest to.
fn one_more(few: &[PatternInterval], many: &[PatternInterval]) -> Option<usize> {
    let without = |k: usize| (0..many.len()).filter(move |i| *i != k && *i + 1 != k).map(|i| &many[i]);
    let fits =
        |k: &usize| many[k - 1].set == many[k + 1].set && without(*k).zip(few).all(|(rest, few)| rest.set == few.set);
    let apart = |k: usize| without(k).zip(few).map(|(rest, few)| (rest.to - few.to).abs()).sum::<f64>();
    (1..many.len() - 1).filter(fits).min_by(|a, b| apart(*a).total_cmp(&apart(*b)))
}

fn middle(interval: &PatternInterval) -> f64 {
    0.5 * (interval.from + interval.to)
}

/// The intervals of a whole period, with the first and the last as one where they have the same set.
pub(crate) fn around_the_period(intervals: &[PatternInterval]) -> Vec<PatternInterval> {
    match intervals {
        [first, rest @ .., last] if first.set == last.set => {
            let joined = PatternInterval { from: last.from - TAU, ..*first };
            std::iter::once(joined).chain(rest.iter().copied()).collect()
        }
        _ => intervals.to_vec(),
    }
}

/// The contact in whose state alone two sets differ.
fn only_difference(sets: &SetTable, a: usize, b: usize) -> Option<usize> {
    let mut different = (sets.get(a).closed.iter().zip(&sets.get(b).closed)).enumerate().filter(|(_, (a, b))| a != b);
    let (contact, _) = different.next()?;
    different.next().is_none().then_some(contact)
}

fn guard(sets: &SetTable, set: usize, contact: usize) -> Vec<f64> {
    sets.get(set).whole_guard(contact)
}

/// The zero of a function (`order` 0) near an instant, or its minimum (`order` 1): Newton's method, downhill where the
/// function is not convex.
fn newton(f: &Trigonometric, order: usize, near: f64) -> f64 {
    let longest = LONGEST * TAU / f.z.len() as f64;
    let mut tau = near;
    for _ in 0..NEWTON_STEPS {
        let at = f.evaluate(tau);
        let step = match order {
            1 if at[2] <= 0.0 => -longest * at[1].signum() * f64::from(u8::from(at[1] != 0.0)),
            _ => -at[order] / at[order + 1],
        };
        if !step.is_finite() {
            break;
        }
        tau += step.clamp(-longest, longest);
        if step.abs() <= SETTLED {
            break;
        }
    }
    tau
}

impl ContactOperator {
    /// The boundary between the pattern with these intervals and that of the last solution.
    pub(crate) fn boundary_from(&self, from: &[PatternInterval]) -> Option<PatternBoundary> {
        if self.is_sampled() {
            // Contacts change sides at samples, not where guards have their extrema.
            return None;
        }
        PatternBoundary::between(&self.sets, self.series.symmetry, from, &self.intervals)
    }
}

#[cfg(test)]
mod tests {
    use nlmodes_contact::{LcpMatrix, solver_by_name};
    use nlmodes_linalg::Mat;
    use num_complex::Complex64;

    use super::*;
    use crate::series::RealSeries;
    use crate::{ContactOperator, Switching};

    /// Two contacts whose gaps, m, change evenly from one random motion to another.
    struct Path {
        operator: ContactOperator,
        ends: [Vec<f64>; 2],
    }

    impl Path {
        fn new(symmetry: Symmetry, seed: u64, length: f64) -> Self {
            let compliance = LcpMatrix::new(&Mat::from_fn(2, 2, |i, j| if i == j { 2e-6 } else { 1.2e-6 })).unwrap();
            let series = RealSeries { symmetry, n_harmonics: 4 };
            let solver = solver_by_name("active-set").unwrap();
            let operator = ContactOperator::new(&compliance, series, Switching::Exact, solver.as_ref()).unwrap();
            let mut state = seed;
            let mut random = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                length * ((state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0)
            };
            let ends = [(); 2].map(|()| (0..2 * series.width()).map(|_| random()).collect());
            Self { operator, ends }
        }

        fn gaps(&self, s: f64) -> Vec<f64> {
            self.ends[0].iter().zip(&self.ends[1]).map(|(a, b)| (1.0 - s) * a + s * b).collect()
        }

        fn at(&mut self, s: f64) -> (u64, Vec<PatternInterval>) {
            let gaps = self.gaps(s);
            self.operator.solve(&gaps).unwrap();
            (self.operator.pattern(), self.operator.intervals().to_vec())
        }

        fn value(&self, boundary: &PatternBoundary, s: f64) -> f64 {
            let (gaps, series) = (self.gaps(s), self.operator.series());
            boundary.value(|weights| {
                let mut real = vec![0.0; series.width()];
                for (gap, weight) in gaps.chunks(series.width()).zip(weights) {
                    real.iter_mut().zip(gap).for_each(|(sum, y)| *sum += weight * y);
                }
                let mut z = vec![Complex64::default(); series.n_harmonics + 1];
                series.to_complex(&real, &mut z);
                Trigonometric { z }
            })
        }

        /// Where the pattern changes between two shares of the path, by halving.
        fn change(&mut self, mut low: f64, mut high: f64) -> f64 {
            let from = self.at(low).0;
            while high - low > 1e-13 {
                let middle = 0.5 * (low + high);
                if self.at(middle).0 == from { low = middle } else { high = middle }
            }
            high
        }
    }

    /// Each change of the pattern that is seen in small steps has a boundary whose function vanishes there, in metres
    /// and in millimetres.
    #[test]
    fn the_function_of_a_boundary_vanishes_where_the_pattern_changes() {
        for (symmetry, length) in [(Symmetry::Even, 1.0), (Symmetry::Even, 1e-3), (Symmetry::None, 1.0)] {
            let (mut known, mut all) = (0, 0);
            for seed in 0..30 {
                let mut path = Path::new(symmetry, seed, length);
                let mut before = path.at(0.0);
                for k in 1..=200 {
                    let [low, high] = [k - 1, k].map(|k| f64::from(k) / 200.0);
                    let now = path.at(high);
                    if now.0 == before.0 {
                        continue;
                    }
                    all += 1;
                    let boundary = path.operator.boundary_from(&before.1);
                    before = now;
                    let Some(boundary) = boundary else { continue };
                    let ends = [low, high].map(|s| path.value(&boundary, s));
                    if ends[0] <= 0.0 || ends[1] >= 0.0 {
                        continue;
                    }
                    let at = path.change(low, high);
                    if path.at(at + 1e-9).0 != before.0 {
                        // Two changes within one step, that together look like one.
                        continue;
                    }
                    known += 1;
                    let value = path.value(&boundary, at);
                    assert!(value.abs() < 1e-11 * length, "{symmetry:?}, seed {seed}, at {at}: {value:e} of {ends:?}");
                }
            }
            // The others are two changes within one step.
            assert!(all > 60 && f64::from(known) > 0.75 * f64::from(all), "{symmetry:?}: {known} of {all}");
        }
    }

    /// Two sets in turn: any of three intervals could be the one that is there in addition.
    #[test]
    fn of_intervals_in_turn_the_one_in_addition_leaves_the_others_where_they_are() {
        let in_turn = |ends: &[f64]| -> Vec<PatternInterval> {
            let from = std::iter::once(0.0).chain(ends.iter().copied());
            from.zip(ends).enumerate().map(|(k, (from, to))| PatternInterval { from, to: *to, set: k % 2 }).collect()
        };
        for (number, added) in [[0.3, 0.31], [1.5, 1.51], [4.0, 4.02]].into_iter().enumerate() {
            // The instants have moved a little.
            let mut many = vec![1.003, 1.996, TAU];
            many.extend(added);
            many.sort_by(f64::total_cmp);
            assert_eq!(one_more(&in_turn(&[1.0, 2.0, TAU]), &in_turn(&many)), Some(number + 1));
        }
        assert_eq!(one_more(&in_turn(&[TAU]), &in_turn(&[3.0, 3.1, TAU])), Some(1));
        let mut other = in_turn(&[3.0, 3.1, TAU]);
        other[2].set = 5;
        assert_eq!(one_more(&in_turn(&[TAU]), &other), None);
    }
}
