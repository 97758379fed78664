use super::super::workspace::Outcome;
use crate::{
    factor::{ClosedSet, WorkingFactor},
    kernel,
    sample::{Sample, Verdict},
};

/// Values below this, relative to the size of the forces, are rounding errors of a product with `A`.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Semismooth Newton on `min(λ, g) = 0`, that is block principal pivoting, with a factor that is updated.
#[derive(Debug)]
pub(crate) struct Newton {
    factor: WorkingFactor,
    set: ClosedSet,
    forces: Vec<f64>,
    iterations: usize,
}

/// Sizes below which a sign counts as zero.
pub(crate) fn sign_tolerance(lambda: &[f64]) -> f64 {
    (ROUNDING * (1.0 + kernel::max_abs(lambda))).min(1e-11)
}

impl Newton {
    pub(crate) fn new(c: usize) -> Self {
        Self { factor: WorkingFactor::new(c), set: ClosedSet::new(c), forces: Vec::with_capacity(c), iterations: 0 }
    }

    /// Steps of the last run.
    pub(crate) fn iterations(&self) -> usize {
        self.iterations
    }

    pub(crate) fn guess(&mut self, closed: &[bool]) {
        self.set.load(closed);
    }

    /// Closed where there is a force and no gap: `λ > g`.
    pub(crate) fn guess_from_forces(&mut self, sample: &Sample) {
        self.set.load_with(sample.b.len(), |i| sample.lambda[i] > 0.0 && sample.lambda[i] > sample.gap[i]);
    }

    /// The closed contacts of the last step that carry forces.
    pub(crate) fn unload_closed(&self, closed: &mut [bool]) {
        closed.fill(false);
        self.factor.closed().for_each(|i| closed[i] = true);
    }

    /// Steps until all signs are correct. None if the number of wrong signs has not decreased in `patience` steps.
    pub(crate) fn run(&mut self, sample: &mut Sample, patience: usize) -> Option<Outcome> {
        let (mut fewest, mut stalled) = (usize::MAX, 0);
        self.iterations = 0;
        self.factor.reset();
        loop {
            self.iterations += 1;
            let verdict = self.step(sample);
            let wrong = if verdict.violation() <= ROUNDING { 0 } else { self.exchange(sample) };
            if wrong == 0 {
                let verdict = self.refine(sample, verdict);
                return Some(Outcome {
                    iterations: self.iterations,
                    verdict: sample.clamp(verdict),
                    infeasible: false,
                });
            }
            stalled = if wrong < fewest { 0 } else { stalled + 1 };
            fewest = fewest.min(wrong);
            if stalled >= patience {
                return None;
            }
        }
    }

    /// Forces that close the gaps of the set, without tensile ones, and the judge's verdict.
    ///
    /// A set that is too large often has several excess layers at the edge of a contact patch, of which only the
    /// outermost is in tension at a time; removing them before the gaps are computed saves the product with `A`.
    fn step(&mut self, sample: &mut Sample) -> Verdict {
        loop {
            self.factor.select(sample.matrix(), &self.set);
            self.factor.forces(&sample.b, &mut self.forces);
            if !self.open_pulling() {
                break;
            }
            self.iterations += 1;
        }
        sample.lambda.fill(0.0);
        for (&i, force) in self.factor.order().iter().zip(&self.forces) {
            sample.lambda[i] = *force;
        }
        sample.judge()
    }

    /// Removes the contacts in tension from the set. Returns whether there were any.
    fn open_pulling(&mut self) -> bool {
        let tolerance = sign_tolerance(&self.forces);
        let mut any = false;
        for (&i, _) in self.factor.order().iter().zip(&self.forces).filter(|(_, f)| **f < -tolerance) {
            self.set.toggle(i);
            any = true;
        }
        any
    }

    /// Exchanges the contacts that are in tension or penetrate. Returns their number.
    fn exchange(&mut self, sample: &Sample) -> usize {
        let tolerance = sign_tolerance(&sample.lambda);
        let mut wrong = 0;
        for (i, (&force, &gap)) in sample.lambda.iter().zip(&sample.gap).enumerate() {
            // NaN is accepted here: the judge rejects it.
            if (if force == 0.0 { gap } else { force }) < -tolerance {
                self.set.toggle(i);
                wrong += 1;
            }
        }
        wrong
    }

    /// Iterative refinement of the forces while the closed gaps exceed rounding and decrease.
    fn refine(&mut self, sample: &mut Sample, mut verdict: Verdict) -> Verdict {
        for _ in 0..3 {
            if verdict.violation() <= 1e-13 {
                break;
            }
            self.forces.clear();
            self.forces.extend(self.factor.order().iter().map(|&i| sample.gap[i]));
            self.factor.solve(&mut self.forces);
            let subtract = |sample: &mut Sample, forces: &[f64], sign: f64| {
                self.factor.order().iter().zip(forces).for_each(|(&i, f)| sample.lambda[i] -= sign * f);
            };
            subtract(sample, &self.forces, 1.0);
            let refined = sample.judge();
            if refined.violation() >= verdict.violation() {
                subtract(sample, &self.forces, -1.0);
                return sample.judge();
            }
            verdict = refined;
        }
        verdict
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LcpMatrix, Mat, factor::tests::smooth};

    #[test]
    fn contacts_are_guessed_closed_where_there_is_a_force_and_less_gap_than_that() {
        let matrix = LcpMatrix::new(&Mat::from_fn(6, 6, |i, j| if i == j { 1.0 } else { 0.0 })).unwrap();
        let mut sample = Sample::new(&matrix);
        sample.lambda.copy_from_slice(&[1.0, 0.0, 0.5, 2.0, -1.0, 0.0]);
        sample.gap.copy_from_slice(&[0.0, 1.0, 0.7, -1.0, -2.0, -0.3]);
        let mut newton = Newton::new(6);
        newton.guess_from_forces(&sample);
        let closed: Vec<bool> = (0..6).map(|i| newton.set.contains(i)).collect();
        assert_eq!(closed, [true, false, false, true, false, false]);
    }

    #[test]
    fn forces_are_refined_where_that_closes_the_gaps_further() {
        let mut sample = Sample::new(&smooth(9));
        sample.load(&[-1.0; 9]).unwrap();
        let mut newton = Newton::new(9);
        newton.guess(&[true; 9]);
        let outcome = newton.run(&mut sample, 8).unwrap();
        assert!(outcome.verdict.violation() < 1e-15);
        let exact = sample.lambda.clone();
        sample.lambda.iter_mut().enumerate().for_each(|(i, l)| *l *= 1.0 + 1e-6 * (i as f64).cos());
        let verdict = sample.judge();
        assert!(verdict.violation() > 1e-8);
        assert!(newton.refine(&mut sample, verdict).violation() < 1e-15);
        approx::assert_relative_eq!(sample.lambda[..], exact[..], max_relative = 1e-14);
    }

    #[test]
    fn wrong_signs_are_exchanged_until_all_are_right() {
        let gaps: Vec<f64> = (0..40).map(|i| 1e-4 * (0.3 + (0.4 * f64::from(i)).cos())).collect();
        for all_closed in [false, true] {
            let mut sample = Sample::new(&smooth(40));
            sample.load(&gaps).unwrap();
            let mut newton = Newton::new(40);
            newton.guess(&[all_closed; 40]);
            let outcome = newton.run(&mut sample, 8).unwrap();
            assert!(outcome.verdict.violation() < 1e-13 && outcome.iterations <= 10, "{outcome:?}");
        }
    }
}
