use std::f64::consts::TAU;

use nlmodes_modal::ContactPeriod;
use num_complex::Complex64;

use crate::Symmetry;
use crate::contact_operator::{ContactOperator, PatternInterval, Spectrum};
use crate::trigonometric::Trigonometric;

/// What users ask of a period with contact.
impl ContactOperator {
    /// Each contact over a period of a motion of angular frequency `omega` (rad/s).
    pub fn contact_periods(&self, omega: f64) -> Vec<ContactPeriod> {
        let of = |(i, mean_force): (usize, f64)| ContactPeriod {
            closed_share: self.closed_share(i),
            peak_force: self.peak_force(i),
            mean_force,
            impulse: mean_force * TAU / omega,
            touches: self.touches(i),
            approach_velocity: omega * self.approach(i),
            sliding: None,
        };
        self.mean_forces().into_iter().enumerate().map(of).collect()
    }

    /// Largest rate by phase (m/rad) at which the gap of a contact closes as it is touched; zero without a touch.
    pub(crate) fn approach(&self, contact: usize) -> f64 {
        let slope = |interval: &PatternInterval, tau: f64| {
            self.combination(self.sets.get(interval.set).guard_row(contact)).evaluate(tau)[1]
        };
        let is_even = self.series.symmetry == Symmetry::Even;
        let rate = |before: &PatternInterval, after: &PatternInterval| {
            match [before, after].map(|interval| self.closed(interval)[contact]) {
                [false, true] => -slope(before, before.to),
                // Where it opens, its mirror image closes.
                [true, false] if is_even => slope(after, after.from),
                _ => 0.0,
            }
        };
        let inner = self.intervals.windows(2).map(|pair| rate(&pair[0], &pair[1]));
        let around = self.intervals.last().zip(self.intervals.first()).filter(|_| !is_even);
        inner.chain(around.map(|(last, first)| rate(last, first))).fold(0.0, f64::max)
    }

    /// Mean contact forces over a period, N, c.
    pub fn mean_forces(&self) -> Vec<f64> {
        let mut mean = vec![0.0; self.n_contacts()];
        for Spectrum { set, averages, .. } in &self.spectra {
            let set = self.sets.get(*set);
            // ⟨χ Re Σ y_n e^{inτ}⟩ = Re Σ y_n conj⟨χ e^{−inτ}⟩*
            let weighted = |j: usize| self.y[j].iter().zip(averages).map(|(y, a)| (y * a.conj()).re).sum::<f64>();
            let weighted: Vec<f64> = set.active.iter().map(|j| weighted(*j)).collect();
            for &i in &set.active {
                mean[i] += set.force_row(i).zip(&weighted).map(|((_, s), weighted)| s * weighted).sum::<f64>();
            }
        }
        mean
    }

    /// Share of the period in which a contact is closed.
    pub fn closed_share(&self, contact: usize) -> f64 {
        let closed_length = |i: &PatternInterval| if self.closed(i)[contact] { i.to - i.from } else { 0.0 };
        self.intervals.iter().map(closed_length).sum::<f64>() / self.end()
    }

    /// Closed intervals a period of a contact.
    pub fn touches(&self, contact: usize) -> usize {
        let (Some(first), Some(last)) = (self.intervals.first(), self.intervals.last()) else { return 0 };
        let is_closed = |i: &PatternInterval| self.closed(i)[contact];
        let (mut runs, mut before) = (0, false);
        for interval in &self.intervals {
            let now = is_closed(interval);
            runs += usize::from(now && !before);
            before = now;
        }
        let (at_start, at_end) = (usize::from(is_closed(first)), usize::from(is_closed(last)));
        let always = self.intervals.iter().all(is_closed);
        match self.series.symmetry {
            _ if always => 1,
            // Mirrored at both ends: an interval that touches one is continued beyond it.
            Symmetry::Even => 2 * runs - at_start - at_end,
            Symmetry::None => runs - at_start.min(at_end),
        }
    }

    /// Largest force of a contact, N.
    pub fn peak_force(&self, contact: usize) -> f64 {
        self.hardest(contact).map_or(0.0, |found| found.value)
    }

    /// Where the force of a contact is largest over the period; none where it stays open.
    pub(crate) fn hardest(&self, contact: usize) -> Option<Extreme> {
        let force = |set: usize| {
            let set = self.sets.get(set);
            set.closed[contact].then(|| self.combination(set.force_row(contact)))
        };
        self.extreme(force).filter(|found| found.value > 0.0)
    }

    /// Where the gap of a contact that stays open is smallest over the period; its value is the opposite of the gap.
    pub(crate) fn closest(&self, contact: usize) -> Option<Extreme> {
        self.extreme(|set| Some(self.combination(self.sets.get(set).guard_row(contact).map(|(j, g)| (j, -g)))))
    }

    /// Where a function of the phase is largest that has another form while other contacts are closed.
    fn extreme(&self, of: impl Fn(usize) -> Option<Trigonometric>) -> Option<Extreme> {
        let all = self.intervals.iter().enumerate();
        let each = all.filter_map(|(k, interval)| Some((k, largest(&of(interval.set)?, interval.from, interval.to))));
        let (k, (phase, value)) = each.max_by(|a, b| a.1.1.total_cmp(&b.1.1))?;
        let (interval, n) = (&self.intervals[k], self.intervals.len());
        let is_even = self.series.symmetry == Symmetry::Even;
        // Where other contacts close or open there, the form behind that instant falls.
        let behind = if phase >= interval.to { (k + 1 < n || !is_even).then_some((k + 1) % n) } else { None };
        let before = if phase <= interval.from { (k > 0 || !is_even).then_some((k + n - 1) % n) } else { None };
        let other = behind.or(before).filter(|other| *other != k).map(|other| &self.intervals[other]);
        let slope = |set: usize, tau: f64| Some(of(set)?.evaluate(tau)[1]);
        let beside = other.and_then(|other| {
            let at = if behind.is_some() { other.from } else { other.to };
            let slopes = [slope(interval.set, phase)?, slope(other.set, at)?];
            (slopes[0] * slopes[1] < 0.0).then_some((other.set, slopes))
        });
        Some(Extreme { phase, set: interval.set, value, beside })
    }

    /// Smallest gap of a contact over the period, m; zero or less where it closes.
    pub(crate) fn smallest_gap(&self, contact: usize) -> f64 {
        let gaps = self.intervals.iter().map(|interval| {
            let set = self.sets.get(interval.set);
            if set.closed[contact] {
                return 0.0;
            }
            let opposite = set.guard_row(contact).map(|(j, g)| (j, -g));
            -largest(&self.combination(opposite), interval.from, interval.to).1
        });
        gaps.fold(f64::INFINITY, f64::min)
    }

    /// `Σ_j weight_j y_j(τ)`, of the contacts with a weight.
    pub(crate) fn combination(&self, weights: impl Iterator<Item = (usize, f64)>) -> Trigonometric {
        let mut sum = Trigonometric { z: vec![Complex64::default(); self.series.n_harmonics + 1] };
        for (j, weight) in weights {
            sum.z.iter_mut().zip(&self.y[j]).for_each(|(s, y)| *s += y * weight);
        }
        sum
    }
}

/// An instant of a period at which something is largest or smallest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Extreme {
    /// Phase, rad.
    pub phase: f64,
    /// The closed contacts there, as an index into the sets of the operator.
    pub set: usize,
    /// What is largest.
    pub value: f64,
    /// At a corner, the closed contacts on its other side, and the slopes on this and on that.
    pub beside: Option<(usize, [f64; 2])>,
}

impl Extreme {
    /// The derivative of the largest value by a parameter, from that of the function at the instant with each of the
    /// sets: at a corner the instant moves, so that both forms stay equal there.
    pub fn change(&self, of: impl Fn(usize) -> f64) -> f64 {
        self.shares().map(|(set, share)| share * of(set)).sum()
    }

    /// The sets with the share that each has in such a derivative.
    pub fn shares(&self) -> impl Iterator<Item = (usize, f64)> + use<> {
        let (own, beside) = match self.beside {
            Some((set, [slope, other])) => (-other / (slope - other), Some((set, slope / (slope - other)))),
            None => (1.0, None),
        };
        std::iter::once((self.set, own)).chain(beside)
    }
}

/// Largest value of `f` in `[from, to]`, behind the phase at which it has it: samples, then the zero of the slope
/// beside the best one.
pub(crate) fn largest(f: &Trigonometric, from: f64, to: f64) -> (f64, f64) {
    // As many as the shortest wave asks for on this interval.
    let cells = 8 + (8.0 * f.z.len() as f64 * (to - from) / TAU).ceil() as usize;
    let width = (to - from) / cells as f64;
    let at = |j: usize| from + width * j as f64;
    let best = (0..=cells).map(|j| (j, f.evaluate(at(j))[0])).max_by(|a, b| a.1.total_cmp(&b.1));
    let Some((j, value)) = best else { return (from, f64::NEG_INFINITY) };
    let [low, high] = [j.saturating_sub(1), (j + 1).min(cells)].map(|j| f.at(at(j)));
    if low.f[1] > 0.0 && high.f[1] < 0.0 {
        let turn = f.turn(f64::EPSILON * f.bounds()[0], low, high, |_| false);
        if turn.f[0] > value {
            return (turn.tau, turn.f[0]);
        }
    }
    (at(j), value)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use nlmodes_contact::{LcpMatrix, solver_by_name};
    use nlmodes_linalg::Mat;

    use super::*;
    use crate::{RealSeries, Switching};

    /// The gap `y_0 + y_1 cos τ + y_2 cos 2τ` before a body of unit compliance: `λ = max(−y, 0)`.
    fn solved(y: [f64; 3], symmetry: Symmetry) -> ContactOperator {
        let series = RealSeries { symmetry, n_harmonics: 2 };
        let matrix = LcpMatrix::new(&Mat::from_fn(1, 1, |_, _| 1.0)).unwrap();
        let solver = solver_by_name("active-set").unwrap();
        let mut operator = ContactOperator::new(&matrix, series, Switching::Exact, solver.as_ref()).unwrap();
        let mut coefficients = y.to_vec();
        coefficients.resize(series.width(), 0.0);
        operator.solve(&coefficients).unwrap();
        operator
    }

    #[test]
    fn share_touches_peak_and_mean_are_those_of_the_closed_form() {
        let third = (3.0_f64.sqrt() - PI / 3.0) / TAU;
        for symmetry in [Symmetry::Even, Symmetry::None] {
            // y, share, touches, largest force, mean force.
            let cases = [
                ([0.5, 1.0, 0.0], 1.0 / 3.0, 1, 0.5, third),
                ([0.5, -1.0, 0.0], 1.0 / 3.0, 1, 0.5, third),
                ([0.5, 0.0, 1.0], 1.0 / 3.0, 2, 0.5, third),
                ([0.5, 0.0, -1.0], 1.0 / 3.0, 2, 0.5, third),
                ([-2.0, 1.0, 0.0], 1.0, 1, 3.0, 2.0),
                ([2.0, 1.0, 0.0], 0.0, 0, 0.0, 0.0),
            ];
            for (y, share, touches, peak, mean) in cases {
                let operator = solved(y, symmetry);
                assert!((operator.closed_share(0) - share).abs() < 1e-12, "{y:?}: {}", operator.closed_share(0));
                assert_eq!(operator.touches(0), touches, "{y:?} {symmetry:?}");
                assert!((operator.peak_force(0) - peak).abs() < 1e-12, "{y:?}: {}", operator.peak_force(0));
                assert!((operator.mean_forces()[0] - mean).abs() < 1e-12, "{y:?}: {:?}", operator.mean_forces());
                let lowest = (y[0] - y[1].abs() - if y[1] == 0.0 { y[2].abs() } else { 0.0 }).max(0.0);
                assert!((operator.smallest_gap(0) - lowest).abs() < 1e-12, "{y:?}: {}", operator.smallest_gap(0));
            }
        }
    }

    #[test]
    fn a_sample_stands_for_the_stretch_around_it() {
        for (samples, symmetry) in [(16, Symmetry::Even), (16, Symmetry::None), (50, Symmetry::None)] {
            let series = RealSeries { symmetry, n_harmonics: 2 };
            let matrix = LcpMatrix::new(&Mat::from_fn(1, 1, |_, _| 1.0)).unwrap();
            let solver = solver_by_name("active-set").unwrap();
            let switching = Switching::Sampled { samples };
            let mut operator = ContactOperator::new(&matrix, series, switching, solver.as_ref()).unwrap();
            let gap = |tau: f64| 0.3 + tau.cos();
            let mut coefficients = vec![0.0; series.width()];
            coefficients[..2].copy_from_slice(&[0.3, 1.0]);
            operator.solve(&coefficients).unwrap();
            let step = TAU / samples as f64;
            let closed = (0..samples).filter(|j| gap(step * *j as f64) < 0.0);
            let share = closed.clone().count() as f64 / samples as f64;
            assert!((operator.closed_share(0) - share).abs() < 1e-12, "{samples}: {}", operator.closed_share(0));
            let (first, last) = (closed.clone().min().unwrap(), closed.max().unwrap());
            let intervals = operator.intervals();
            let middle = intervals.iter().find(|interval| operator.closed(interval)[0]).unwrap();
            let end = ((last as f64 + 0.5) * step).min(operator.end());
            assert!((middle.from - (first as f64 - 0.5) * step).abs() < 1e-12 && (middle.to - end).abs() < 1e-12);
            assert!(intervals[0].from == 0.0 && (intervals[intervals.len() - 1].to - operator.end()).abs() < 1e-12);
        }
    }
}
