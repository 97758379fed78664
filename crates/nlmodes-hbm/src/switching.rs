use num_complex::Complex64;

use crate::HbmError;
use crate::closed_set::{ClosedSet, SetTable};
use crate::contact_operator::PatternInterval;
use crate::trigonometric::{Instant, Trigonometric, bound, bound_of_curvature};

/// Samples of `y` and of `dy/dτ`, and the sample that is meant.
type Sample<'a> = (&'a Vec<Vec<f64>>, &'a Vec<Vec<f64>>, usize);

/// Solves the contact problem for given `y`, from and into the closed contacts.
pub(crate) type Solve<'a> = dyn FnMut(f64, &[f64], &mut [bool]) -> Result<(), HbmError> + 'a;

/// Narrowest cell that is divided further, rad.
const FINEST: f64 = 1e-14;

/// Shortest interval that is searched for more than one extremum, rad: on it a dip is lost in rounding.
const SHORTEST: f64 = 1e-6;

/// Over what the curvature of a guard allows, so that rounding of bounds decides nothing.
const FAR: f64 = 1.0 + 1e-9;

/// Finds the instants at which contacts close and open, cell by cell along the period.
///
/// While a set of contacts is closed, gaps and forces are trigonometric polynomials (the guards of [`ClosedSet`]); the
/// first one that turns negative ends the interval, and its contact changes sides.
pub(crate) struct Tracer<'a> {
    y: &'a [Vec<Complex64>],
    pub intervals: Vec<PatternInterval>,
    guard: Trigonometric,
    curvature: Vec<f64>,
    /// `Σ_n |y_n|` of each contact.
    sizes: Vec<f64>,
}

/// Rounding of a sum, over the sum of the magnitudes.
const NOISE: f64 = 64.0 * f64::EPSILON;

impl<'a> Tracer<'a> {
    pub fn new(y: &'a [Vec<Complex64>]) -> Self {
        let curvature = y.iter().map(|z| bound_of_curvature(z)).collect();
        let sizes = y.iter().map(|z| bound(z)).collect();
        Self { y, intervals: Vec::new(), guard: Trigonometric::default(), curvature, sizes }
    }

    /// Appends an interval with the contacts of `set` closed.
    pub fn extend(&mut self, set: usize, from: f64, to: f64) {
        match self.intervals.last_mut() {
            Some(last) if last.set == set => last.to = to,
            _ => self.intervals.push(PatternInterval { from, to, set }),
        }
    }

    /// True if nothing can happen between two samples with the same closed contacts: every guard is so far from zero,
    /// for its curvature, that it cannot dip below, or its slopes are too large, for its curvature, to change their
    /// sign.
    pub fn is_quiet(&self, sets: &SetTable, from: usize, to: usize, left: Sample, right: Sample, width: f64) -> bool {
        if from != to {
            return false;
        }
        let set = sets.get(from);
        if let ([curvature], [y], [slope]) = (self.curvature.as_slice(), left.0.as_slice(), left.1.as_slice())
            && let Some((_, guard)) = set.guard_row(0).next()
        {
            let low = (guard * y[left.2]).min(guard * y[right.2]);
            let bound = width * guard.abs() * curvature;
            let slopes = guard * (slope[left.2] + slope[right.2]);
            return low > 0.0 && (low > 0.125 * width * bound || slopes.abs() > bound);
        }
        (0..self.y.len()).all(|i| {
            let sum = |(t, at): (&[Vec<f64>], usize)| set.guard_row(i).map(|(j, g)| g * t[j][at]).sum::<f64>();
            let low = sum((left.0, left.2)).min(sum((right.0, right.2)));
            if low <= 0.0 {
                return false;
            }
            let bound = width * self.curvature_of(set, i);
            low > 0.125 * width * bound || (sum((left.1, left.2)) + sum((right.1, right.2))).abs() > bound
        })
    }

    /// One cell from `ends[0]` to `ends[1]`, with the closed contacts known at both ends.
    pub fn cell(
        &mut self,
        sets: &mut SetTable,
        solve: &mut Solve,
        ends: [f64; 2],
        at_ends: [usize; 2],
    ) -> Result<usize, HbmError> {
        let (mut tau, mut set) = (ends[0], at_ends[0]);
        let mut found: Vec<PatternInterval> = Vec::new();
        for _ in 0..2 * self.y.len() + 4 {
            let Some((instant, contact)) = self.first_event(sets.get(set), tau, ends[1]) else { break };
            found.push(PatternInterval { from: tau, to: instant, set });
            let mut closed = sets.get(set).closed.clone();
            closed[contact] = !closed[contact];
            set = sets.find(&closed)?;
            tau = instant;
        }
        // Where contacts are redundant several sets give the same motion, and the solver may have found another one.
        if set == at_ends[1] || self.fits(sets.get(set), ends[1]) {
            found.push(PatternInterval { from: tau, to: ends[1], set });
            found.iter().filter(|i| i.to > i.from).for_each(|i| self.extend(i.set, i.from, i.to));
            return Ok(set);
        }
        self.bisect(sets, solve, ends, at_ends)
    }

    /// Where single changes do not explain what the solver finds (several contacts at once, degenerate instants): halve
    /// the cell.
    fn bisect(
        &mut self,
        sets: &mut SetTable,
        solve: &mut Solve,
        ends: [f64; 2],
        at_ends: [usize; 2],
    ) -> Result<usize, HbmError> {
        let middle = 0.5 * (ends[0] + ends[1]);
        if ends[1] - ends[0] < FINEST || at_ends[0] == at_ends[1] {
            self.extend(at_ends[0], ends[0], middle);
            self.extend(at_ends[1], middle, ends[1]);
            return Ok(at_ends[1]);
        }
        let y = self.y_at(middle);
        let mut closed = sets.get(at_ends[0]).closed.clone();
        solve(middle, &y, &mut closed)?;
        let set = sets.find(&closed)?;
        let set = self.cell(sets, solve, [ends[0], middle], [at_ends[0], set])?;
        self.cell(sets, solve, [middle, ends[1]], [set, at_ends[1]])
    }

    /// Largest second derivative of a guard.
    fn curvature_of(&self, set: &ClosedSet, contact: usize) -> f64 {
        set.guard_row(contact).map(|(j, g)| g.abs() * self.curvature[j]).sum()
    }

    fn y_at(&self, tau: f64) -> Vec<f64> {
        let (step, mut turn) = (Complex64::cis(tau), Complex64::ONE);
        let harmonics = self.y.first().map_or(0, Vec::len);
        let next = |_| {
            let this = turn;
            turn *= step;
            this
        };
        let turns: Vec<Complex64> = (0..harmonics).map(next).collect();
        self.y.iter().map(|z| z.iter().zip(&turns).map(|(z, turn)| (z * turn).re).sum()).collect()
    }

    /// Whether no guard of `set` is negative at `tau`, but for rounding.
    fn fits(&self, set: &ClosedSet, tau: f64) -> bool {
        let y = self.y_at(tau);
        (0..y.len()).all(|i| set.guard_value(i, &y) >= -self.noise_of(set, i))
    }

    /// Largest rounding of a guard: relative to what it is made of, for what is left may be nothing but rounding
    /// (redundant contacts).
    fn noise_of(&self, set: &ClosedSet, contact: usize) -> f64 {
        NOISE * set.guard_row(contact).map(|(j, g)| g.abs() * self.sizes[j]).sum::<f64>()
    }

    /// The first guard of `set` that turns negative after `from`, and its contact.
    fn first_event(&mut self, set: &ClosedSet, from: f64, to: f64) -> Option<(f64, usize)> {
        let mut first: Option<(f64, usize)> = None;
        // Of many most are so far from zero that their curvature cannot bring them there: they need not be formed.
        let at_ends = (self.y.len() > 1).then(|| [self.y_at(from), self.y_at(to)]);
        for contact in 0..self.y.len() {
            if let Some([at_from, at_to]) = &at_ends {
                let low = set.guard_value(contact, at_from).min(set.guard_value(contact, at_to));
                let bound = (to - from).powi(2) / 8.0 * self.curvature_of(set, contact);
                if low > FAR * bound + self.noise_of(set, contact) {
                    continue;
                }
            }
            self.form_guard(set, contact);
            let end = first.map_or(to, |(tau, _)| tau);
            if let Some(tau) = falls_below_zero(&self.guard, self.noise_of(set, contact), from, end) {
                first = Some((tau, contact));
            }
        }
        first
    }

    fn form_guard(&mut self, set: &ClosedSet, contact: usize) {
        self.guard.z.clear();
        self.guard.z.resize(self.y[0].len(), Complex64::default());
        for (j, weight) in set.guard_row(contact).filter(|(_, weight)| *weight != 0.0) {
            self.guard.z.iter_mut().zip(&self.y[j]).for_each(|(g, y)| *g += y * weight);
        }
    }
}

/// First instant in `(from, to]` at which `f` turns negative, having been positive; rounding at `from` does not count.
fn falls_below_zero(f: &Trigonometric, noise: f64, from: f64, to: f64) -> Option<f64> {
    let bounds = f.bounds();
    // A gap that stays zero while another contact is closed is rounding and nothing else. Without finite numbers
    // nothing would end the search before its shortest interval, everywhere.
    if bounds[0] <= noise || !bounds.iter().all(|bound| bound.is_finite()) {
        return None;
    }
    Guard { f, noise, bounds }.search(f.at(from), f.at(to))
}

/// A gap or a force that must not become negative.
struct Guard<'a> {
    f: &'a Trigonometric,
    noise: f64,
    /// Of the function and of its first three derivatives.
    bounds: [f64; 4],
}

impl Guard<'_> {
    /// Divides the interval until the function cannot reach zero, or is convex or concave: then its ends and their
    /// slopes tell all. An interval in which it rises, falls and rises again would otherwise hide a short contact.
    fn search(&self, from: Instant, to: Instant) -> Option<f64> {
        let width = to.tau - from.tau;
        if from.f[0].min(to.f[0]) > width * width / 8.0 * self.bounds[2] {
            return None;
        }
        if width < SHORTEST {
            return self.falls_once(from, to);
        }
        let middle = self.f.at(0.5 * (from.tau + to.tau));
        if middle.f[2].abs() > 0.5 * width * self.bounds[3] {
            return self.falls_once(from, to);
        }
        self.search(from, middle).or_else(|| self.search(middle, to))
    }

    /// [`falls_below_zero`] where the function is convex or concave.
    fn falls_once(&self, from: Instant, to: Instant) -> Option<f64> {
        let (left, right) = (from.f, to.f);
        if left[0] < -self.noise {
            // The caller's set does not fit at its own beginning: leave it to bisection.
            return None;
        }
        if right[0] < -self.noise {
            let rises_first = left[0] <= self.noise && left[1] >= 0.0;
            if left[0] <= self.noise && !rises_first {
                return Some(from.tau);
            }
            let low = if rises_first { self.peak(from, to)? } else { from };
            return Some(self.root(low, to));
        }
        let below = self.dip(from, to)?;
        Some(if left[0] > self.noise { self.root(from, below) } else { from.tau })
    }

    /// A point at which the function, zero and rising at `from`, is positive before it falls to `to`.
    fn peak(&self, from: Instant, to: Instant) -> Option<Instant> {
        if to.f[1] < 0.0 && from.f[1] > 0.0 {
            let top = self.f.turn(self.rounding(), from, to, |value| value > 0.0);
            return (top.f[0] > 0.0).then_some(top);
        }
        None
    }

    /// A point at which the function, convex and not negative at both ends, is negative between them.
    fn dip(&self, from: Instant, to: Instant) -> Option<Instant> {
        if !(from.f[1] < 0.0 && to.f[1] > 0.0) {
            return None;
        }
        // Convex, it lies above its tangents at both ends, which meet in between.
        let width = to.tau - from.tau;
        let share = (from.f[0] - to.f[0] + width * to.f[1]) / (width * (to.f[1] - from.f[1]));
        if from.f[0] + share * width * from.f[1] > 0.0 {
            return None;
        }
        let below = self.f.turn(self.rounding(), from, to, |value| value < -self.noise);
        (below.f[0] < -self.noise).then_some(below)
    }

    fn root(&self, low: Instant, high: Instant) -> f64 {
        self.f.root(self.rounding(), low, high)
    }

    /// A value that is zero but for rounding.
    fn rounding(&self) -> f64 {
        f64::EPSILON * self.bounds[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `u (u − 0.03) (u − 0.05)` with `u = sin τ`.
    fn rises_falls_and_rises() -> Trigonometric {
        let z = [(-0.04, 0.0), (0.0, -0.7515), (0.04, 0.0), (0.0, 0.25)];
        Trigonometric { z: z.map(|(re, im)| Complex64::new(re, im)).to_vec() }
    }

    #[test]
    fn a_dip_behind_a_rise_is_found_wherever_the_stretch_begins() {
        let f = rises_falls_and_rises();
        for from in [0.0, 0.001, 0.005, 0.02, 0.029] {
            let found = falls_below_zero(&f, NOISE, from, 0.098).unwrap();
            assert!((found - 0.03_f64.asin()).abs() < 1e-14, "{from}: {found}");
        }
        assert_eq!(falls_below_zero(&f, NOISE, 0.051, 0.098), None);
    }

    /// `cos τ` about its minimum, raised by less and more than one, in any unit; from a place where it falls and from
    /// one where it is flat.
    #[test]
    fn a_dip_is_found_in_gaps_of_any_size() {
        for unit in [1.0, 1e-6, 1e6] {
            for (height, found) in [(1.0 - 1e-4, true), (1.0 + 1e-4, false)] {
                let f = Trigonometric { z: [height, 1.0].map(|z| Complex64::from(z * unit)).to_vec() };
                for width in [0.05, 0.1, 0.3] {
                    let (from, to) = (std::f64::consts::PI - width, std::f64::consts::PI + 0.7 * width);
                    let dip = falls_below_zero(&f, NOISE * unit, from, to);
                    let expected = found.then(|| (-height.min(1.0)).acos());
                    assert_eq!(dip.is_some(), found, "{unit} {height} {width}");
                    assert!(dip.zip(expected).is_none_or(|(a, b)| (a - b).abs() < 1e-9), "{dip:?} {expected:?}");
                }
            }
        }
    }

    /// Whether the interval of this width about `middle` is quiet, with the gap `height + cos τ` and other contacts
    /// that stay open.
    fn quiet(height: f64, middle: f64, width: f64, others: usize) -> bool {
        let c = 1 + others;
        let identity = nlmodes_linalg::Mat::from_fn(c, c, |i, j| if i == j { 1.0 } else { 0.0 });
        let sets = SetTable::new(&nlmodes_contact::LcpMatrix::new(&identity).unwrap()).unwrap();
        let series = |i: usize| vec![Complex64::from(if i == 0 { height } else { 5.0 }), Complex64::ONE];
        let y: Vec<Vec<Complex64>> = (0..c).map(series).collect();
        let at = |f: &dyn Fn(f64, f64) -> f64| -> Vec<Vec<f64>> {
            let ends = [middle - 0.5 * width, middle + 0.5 * width];
            y.iter().map(|y| ends.map(|t| f(y[0].re, t)).to_vec()).collect()
        };
        let (values, slopes) = (at(&|h, t| h + t.cos()), at(&|_, t| -t.sin()));
        let open = SetTable::OPEN;
        Tracer::new(&y).is_quiet(&sets, open, open, (&values, &slopes, 0), (&values, &slopes, 1), width)
    }

    #[test]
    fn a_stretch_is_quiet_only_where_no_guard_can_dip_below_zero_between_its_ends() {
        for others in [0, 1] {
            // About the minimum both ends are positive: only the curvature tells, ⅛ · 0.2² = 0.005 above −1.
            assert!(!quiet(0.999, std::f64::consts::PI, 0.2, others), "dips by 1e-3");
            assert!(quiet(1.02, std::f64::consts::PI, 0.2, others), "stays 0.02 above");
            // On the slope the value may be small, the slope cannot change its sign.
            assert!(quiet(1e-4 - 1.2_f64.cos(), 1.1, 0.2, others), "falls to 1e-4");
            assert!(!quiet(-1e-4 - 1.2_f64.cos(), 1.1, 0.2, others), "falls below zero");
            assert!(!quiet(-1.0, 1.1, 0.2, others), "is below zero all the way");
        }
    }

    #[test]
    fn whatever_is_called_quiet_stays_above_zero() {
        let mut called = 0;
        for (i, j) in (0..40).flat_map(|i| (0..40).map(move |j| (i, j))) {
            let (height, middle) = (-1.1 + 0.06 * f64::from(i), 0.16 * f64::from(j));
            for width in [0.05, 0.3, 1.0] {
                let at = |k: i32| height + (middle + width * (f64::from(k) / 200.0 - 0.5)).cos();
                let lowest = (0..=200).map(at).fold(f64::INFINITY, f64::min);
                let is = quiet(height, middle, width, 0);
                assert!(!is || lowest > 0.0, "{height} {middle} {width}: {lowest}");
                assert_eq!(is, quiet(height, middle, width, 1), "{height} {middle} {width}");
                called += usize::from(is);
            }
        }
        assert!(called > 1000, "{called}");
    }

    /// Halved where nothing is known but both ends, the cell has its contact instant where the gap `cos τ` vanishes;
    /// where both ends are alike it ends there.
    #[test]
    fn a_cell_that_is_halved_has_its_instants_where_the_gap_vanishes() {
        let identity = nlmodes_linalg::Mat::from_fn(1, 1, |_, _| 1.0);
        let mut sets = SetTable::new(&nlmodes_contact::LcpMatrix::new(&identity).unwrap()).unwrap();
        let (open, closed) = (SetTable::OPEN, sets.find(&[true]).unwrap());
        let y = [vec![Complex64::default(), Complex64::ONE]];
        let mut solve = |_: f64, y: &[f64], closed: &mut [bool]| {
            closed[0] = y[0] < 0.0;
            Ok(())
        };
        let half = std::f64::consts::FRAC_PI_2;
        for ends in [[1.4, 1.8], [1.5, 3.0], [half - 1e-9, half + 3e-9]] {
            let mut tracer = Tracer::new(&y);
            assert_eq!(tracer.bisect(&mut sets, &mut solve, ends, [open, closed]).unwrap(), closed);
            let found: Vec<(f64, f64, usize)> = tracer.intervals.iter().map(|i| (i.from, i.to, i.set)).collect();
            assert_eq!(found.len(), 2, "{found:?}");
            assert!(found[0].0 == ends[0] && found[0].2 == open && (found[0].1 - half).abs() < 1e-14, "{found:?}");
            assert!(found[1].0 == found[0].1 && found[1].2 == closed && found[1].1 == ends[1], "{found:?}");
        }
        let mut tracer = Tracer::new(&y);
        assert_eq!(tracer.bisect(&mut sets, &mut solve, [1.0, 1.2], [open, open]).unwrap(), open);
        assert_eq!(tracer.intervals.len(), 1);
    }
}
