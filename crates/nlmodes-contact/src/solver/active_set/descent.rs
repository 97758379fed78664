use std::ops::Range;

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};

use crate::{sample::Sample, scaled::Scaled};

/// At most this number of contacts that open or close in one step is left to Newton's method, by updates of the factor.
const FEW: usize = 2;

/// Minimum number of candidates for each of these.
const CANDIDATES_OF_ONE: usize = 32;

/// Ratio of candidates to new ones above which the steps are not repeated with the new ones.
const COMPLETE: usize = 16;

/// Accelerated projected gradient steps (Nesterov, restarted when the momentum points uphill) among the contacts that
/// may close, in single precision: an initial guess for many contacts.
///
/// Only the signs of these forces are used, so single precision suffices and halves the memory traffic. The step is one
/// over the largest curvature found so far; the first is that of steepest descent.
#[derive(Debug, Default)]
pub(super) struct Descent {
    is_candidate: Vec<bool>,
    candidates: Vec<usize>,
    /// The candidates that follow each other.
    runs: Vec<Range<usize>>,
    /// `A` and `b` of the candidates.
    compliance: Vec<f32>,
    b: Vec<f32>,
    before: State,
    now: State,
    /// Linear extrapolation of `before` and `now`.
    ahead: State,
    next: State,
    curvature: f32,
}

/// Forces of the candidates, and their gaps.
#[derive(Debug, Default)]
struct State {
    lambda: Vec<f32>,
    gap: Vec<f32>,
}

impl Descent {
    /// Leaves forces in the sample, and gaps where there are forces. There are `steps` steps at most.
    pub(super) fn run(&mut self, sample: &mut Sample, steps: usize) {
        let matrix = sample.matrix().clone();
        self.is_candidate.clear();
        self.is_candidate.resize(sample.b.len(), false);
        self.candidates.clear();
        sample.gap.copy_from_slice(&sample.b);
        while self.widen(sample) {
            self.load(&matrix, &sample.b);
            self.descend(steps);
            self.unload(sample);
            if matrix.only_opens() {
                // A contact that is open without forces remains open.
                return;
            }
            sample.refresh_gaps();
        }
    }

    /// Contacts that penetrate become candidates. Returns whether this makes a difference.
    fn widen(&mut self, sample: &Sample) -> bool {
        let before = self.candidates.len();
        for (i, (is_candidate, gap)) in self.is_candidate.iter_mut().zip(&sample.gap).enumerate() {
            *is_candidate |= *gap < 0.0 && sample.matrix().diagonal(i) > 0.0;
        }
        self.candidates.clear();
        self.candidates.extend((0..sample.b.len()).filter(|&i| self.is_candidate[i]));
        (self.candidates.len() - before) * COMPLETE > before
    }

    fn load(&mut self, matrix: &Scaled, b: &[f64]) {
        let (candidates, n) = (&self.candidates, self.candidates.len());
        let runs = candidates.chunk_by(|a, b| a + 1 == *b).map(|run| run[0]..run[0] + run.len());
        self.runs.clear();
        self.runs.extend(runs);
        self.compliance.clear();
        for column in candidates.iter().map(|&j| matrix.column(j)) {
            for run in &self.runs {
                self.compliance.extend(column[run.clone()].iter().map(|v| *v as f32));
            }
        }
        self.b.clear();
        self.b.extend(candidates.iter().map(|&i| b[i] as f32));
        [&mut self.before, &mut self.now, &mut self.ahead, &mut self.next]
            .into_iter()
            .for_each(|state| state.resize(n));
    }

    fn unload(&self, sample: &mut Sample) {
        for (k, &i) in self.candidates.iter().enumerate() {
            (sample.lambda[i], sample.gap[i]) = (f64::from(self.now.lambda[k]), f64::from(self.now.gap[k]));
        }
    }

    fn descend(&mut self, steps: usize) {
        self.begin();
        let mut momentum = 1.0_f32;
        for _ in 1..steps {
            let following = 0.5 * (1.0 + (1.0 + 4.0 * momentum * momentum).sqrt());
            self.ahead.extrapolate(&self.before, &self.now, (momentum - 1.0) / following);
            momentum = following;
            self.step();
            let climbs = self.is_too_long() && self.next.energy(&self.b) > self.now.energy(&self.b);
            if climbs || self.points_uphill() {
                momentum = 1.0;
            }
            if !climbs {
                std::mem::swap(&mut self.before, &mut self.now);
                std::mem::swap(&mut self.now, &mut self.next);
                if self.now.exchanges(&self.before) <= FEW.min(self.candidates.len() / CANDIDATES_OF_ONE) {
                    return;
                }
            }
        }
    }

    /// From zero forces to the least energy along the gradient.
    fn begin(&mut self) {
        for (force, b) in self.next.lambda.iter_mut().zip(&self.b) {
            *force = (-b).max(0.0);
        }
        self.next.multiply(&self.compliance);
        let (stiff, size) = (dot(&self.next.lambda, &self.next.gap), dot(&self.next.lambda, &self.next.lambda));
        // The largest eigenvalue is not less than any diagonal entry, all of which are at least one.
        self.curvature = if stiff > size { stiff / size } else { 1.0 };
        self.before.lambda.fill(0.0);
        self.before.gap.copy_from_slice(&self.b);
        for (k, b) in self.b.iter().enumerate() {
            self.now.lambda[k] = self.next.lambda[k] / self.curvature;
            self.now.gap[k] = self.next.gap[k] / self.curvature + b;
        }
    }

    /// One projected step from the point ahead.
    fn step(&mut self) {
        let ahead = self.ahead.lambda.iter().zip(&self.ahead.gap);
        for (next, (force, gap)) in self.next.lambda.iter_mut().zip(ahead) {
            *next = (force - gap / self.curvature).max(0.0);
        }
        self.next.multiply(&self.compliance);
        self.next.gap.iter_mut().zip(&self.b).for_each(|(gap, b)| *gap += b);
    }

    /// Whether the curvature of the energy along the last step exceeds the known maximum, which is then updated.
    fn is_too_long(&mut self) -> bool {
        let (mut stiff, mut size) = (0.0, 0.0);
        for k in 0..self.b.len() {
            let moved = self.next.lambda[k] - self.ahead.lambda[k];
            stiff += moved * (self.next.gap[k] - self.ahead.gap[k]);
            size += moved * moved;
        }
        let too_long = stiff > 1.01 * self.curvature * size;
        if too_long {
            self.curvature = 1.02 * stiff / size;
        }
        too_long
    }

    /// Whether the last move and the projected gradient point against each other.
    fn points_uphill(&self) -> bool {
        let product =
            |k: usize| (self.ahead.lambda[k] - self.next.lambda[k]) * (self.next.lambda[k] - self.now.lambda[k]);
        (0..self.b.len()).map(product).sum::<f32>() > 0.0
    }
}

impl State {
    fn resize(&mut self, n: usize) {
        self.lambda.resize(n, 0.0);
        self.gap.resize(n, 0.0);
    }

    /// The gaps are affine in the forces.
    fn extrapolate(&mut self, before: &Self, now: &Self, factor: f32) {
        for k in 0..self.lambda.len() {
            self.lambda[k] = now.lambda[k] + factor * (now.lambda[k] - before.lambda[k]);
            self.gap[k] = now.gap[k] + factor * (now.gap[k] - before.gap[k]);
        }
    }

    /// `A λ`, in the place of the gaps.
    fn multiply(&mut self, compliance: &[f32]) {
        let n = self.lambda.len();
        let matrix = MatRef::from_column_major_slice(compliance, n, n);
        let lambda = MatRef::from_column_major_slice(&self.lambda, n, 1);
        let product = MatMut::from_column_major_slice_mut(&mut self.gap, n, 1);
        matmul(product, Accum::Replace, matrix, lambda, 1.0, Par::Seq);
    }

    /// Twice the energy.
    fn energy(&self, b: &[f32]) -> f32 {
        self.lambda.iter().zip(self.gap.iter().zip(b)).map(|(force, (gap, b))| force * (gap + b)).sum()
    }

    fn is_closed(&self, k: usize) -> bool {
        self.lambda[k] > 0.0 && self.lambda[k] > self.gap[k]
    }

    /// Contacts that opened or closed.
    fn exchanges(&self, before: &Self) -> usize {
        (0..self.lambda.len()).filter(|&k| self.is_closed(k) != before.is_closed(k)).count()
    }
}

fn dot(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LcpMatrix, Mat, factor::tests::smooth, solver::active_set::Newton};

    fn guess(sample: &Sample) -> Vec<bool> {
        sample.lambda.iter().zip(&sample.gap).map(|(force, gap)| *force > 0.0 && force > gap).collect()
    }

    /// The closed contacts of a problem after these steps.
    fn closed(sample: &mut Sample) -> Vec<bool> {
        let mut newton = Newton::new(sample.b.len());
        newton.guess_from_forces(sample);
        assert!(newton.run(sample, 8).unwrap().verdict.is_accepted());
        let mut closed = vec![false; sample.b.len()];
        newton.unload_closed(&mut closed);
        closed
    }

    #[test]
    fn all_but_a_few_closed_contacts_are_guessed() {
        let gaps: Vec<f64> = (0..200).map(|i| 1e-4 * (0.3 + (0.07 * f64::from(i)).cos())).collect();
        let mut sample = Sample::new(&smooth(200));
        sample.load(&gaps).unwrap();
        Descent::default().run(&mut sample, 16);
        let found = guess(&sample);
        let exact = closed(&mut sample);
        assert!(exact.iter().filter(|closed| **closed).count() > 50);
        assert!((0..200).filter(|&i| found[i] != exact[i]).count() <= 4, "{found:?} {exact:?}");
    }

    #[test]
    fn contacts_that_only_forces_of_others_close_are_guessed_too() {
        // Stops on both sides: opening one side closes the other.
        let side = |i: usize| if i.is_multiple_of(2) { 1.0 } else { -1.0 };
        let entry = |i: usize, j: usize| {
            side(i) * side(j) * (-(i.abs_diff(j) as f64) / 9.0).exp() + if i == j { 0.1 } else { 0.0 }
        };
        let matrix = LcpMatrix::new(&Mat::from_fn(120, 120, entry)).unwrap();
        let mut sample = Sample::new(&matrix);
        let gaps: Vec<f64> = (0..120).map(|i| if side(i) > 0.0 { -1.0 } else { 0.1 }).collect();
        sample.load(&gaps).unwrap();
        Descent::default().run(&mut sample, 16);
        let found = guess(&sample);
        let exact = closed(&mut sample);
        assert!((0..120).any(|i| exact[i] && gaps[i] > 0.0), "{exact:?}");
        assert!((0..120).filter(|&i| found[i] != exact[i]).count() <= 12, "{found:?} {exact:?}");
    }

    #[test]
    fn a_contact_that_no_force_moves_gets_none() {
        let matrix = LcpMatrix::new(&Mat::from_fn(20, 20, |i, j| if i == j && i != 7 { 1.0 } else { 0.0 })).unwrap();
        let mut sample = Sample::new(&matrix);
        sample.load(&[-1.0; 20]).unwrap();
        Descent::default().run(&mut sample, 16);
        assert!((0..20).all(|i| (sample.lambda[i] > 0.0) == (i != 7)), "{:?}", sample.lambda);
    }
}
