//! Primal active-set method of Keller for `min ½ λᵀ A λ + bᵀ λ` over `λ ≥ 0`, whose solution is that of the contact
//! problem.

use super::{super::workspace::Outcome, newton::sign_tolerance};
use crate::{
    factor::Factor,
    sample::{Sample, Verdict},
};

/// A penetration below this at a contact that no force can open is ignored: it is rounding, as for opposing stops
/// without clearance.
const TOLERATED: f64 = 1e-11;

/// Contacts enter one at a time, the forces are never tensile, and the energy decreases at every entry, so there is no
/// cycling. The block in use is always independent.
#[derive(Debug, Default)]
pub(crate) struct Primal {
    factor: Factor,
    direction: Vec<f64>,
    tolerated: Vec<bool>,
    steps: usize,
}

/// Outcome of closing a contact.
enum Entry {
    Closed,
    Tolerated,
    Infeasible,
}

impl Primal {
    /// The contacts of the final block.
    pub(crate) fn unload_closed(&self, closed: &mut [bool]) {
        closed.fill(false);
        self.factor.order().iter().for_each(|&i| closed[i] = true);
    }

    /// From the non-negative forces in `sample` to the solution, in at most about `budget` exchanges in addition to
    /// those that make the block independent.
    pub(crate) fn run(&mut self, sample: &mut Sample, budget: usize) -> Outcome {
        self.steps = 0;
        self.tolerated.clear();
        self.tolerated.resize(sample.b.len(), false);
        self.make_independent(sample);
        let limit = self.steps + budget;
        loop {
            self.minimise(sample);
            let mut verdict = sample.judge();
            let Some(contact) = self.deepest(sample).filter(|_| self.steps < limit) else {
                verdict = self.refine(sample, verdict);
                return Outcome { iterations: self.steps, verdict: sample.clamp(verdict), infeasible: false };
            };
            if matches!(self.close(sample, contact), Entry::Infeasible) {
                return Outcome { iterations: self.steps, verdict, infeasible: true };
            }
        }
    }

    /// Moves forces along null directions of the block until the remaining contacts are independent. Gaps do not
    /// change.
    fn make_independent(&mut self, sample: &mut Sample) {
        let matrix = sample.matrix().clone();
        self.factor.clear();
        let mut loaded: Vec<usize> = (0..sample.b.len()).filter(|&i| sample.lambda[i] > 0.0).collect();
        loaded.sort_by(|&i, &j| sample.lambda[j].total_cmp(&sample.lambda[i]));
        for contact in loaded {
            while !self.factor.append(&matrix, contact) {
                self.steps += 1;
                self.aim(sample, contact);
                let block = self.blocking(sample, -1.0);
                let Some((position, step)) = block.filter(|(_, step)| *step < sample.lambda[contact]) else {
                    self.advance(sample, contact, -sample.lambda[contact]);
                    sample.lambda[contact] = 0.0;
                    break;
                };
                self.advance(sample, contact, -step);
                self.open(sample, position);
            }
        }
        for i in 0..sample.b.len() {
            sample.lambda[i] = sample.lambda[i].max(0.0);
        }
    }

    /// The exact minimum over the forces of the block; contacts in tension are opened.
    fn minimise(&mut self, sample: &mut Sample) {
        loop {
            self.direction.clear();
            self.direction.extend(self.factor.order().iter().map(|&i| -sample.b[i]));
            self.factor.solve(&mut self.direction);
            for (d, &i) in self.direction.iter_mut().zip(self.factor.order()) {
                *d -= sample.lambda[i];
            }
            match self.blocking(sample, 1.0).filter(|(_, step)| *step < 1.0) {
                None => {
                    let order = self.factor.order();
                    order.iter().zip(&self.direction).for_each(|(&i, d)| sample.lambda[i] += d);
                    return;
                }
                Some((position, step)) => {
                    let order = self.factor.order();
                    order.iter().zip(&self.direction).for_each(|(&i, d)| sample.lambda[i] += step * d);
                    self.steps += 1;
                    self.open(sample, position);
                }
            }
        }
    }

    /// The contact that penetrates most.
    fn deepest(&self, sample: &Sample) -> Option<usize> {
        let tolerance = sign_tolerance(&sample.lambda);
        let penetrates = |&i: &usize| sample.lambda[i] == 0.0 && sample.gap[i] < -tolerance && !self.tolerated[i];
        (0..sample.b.len()).filter(penetrates).min_by(|&i, &j| sample.gap[i].total_cmp(&sample.gap[j]))
    }

    /// Raises the force of an open contact, with the gaps of the block kept closed, until its own gap is closed.
    fn close(&mut self, sample: &mut Sample, contact: usize) -> Entry {
        let matrix = sample.matrix().clone();
        let mut gap = sample.gap[contact];
        if let Some(position) = self.factor.order().iter().position(|&i| i == contact) {
            self.factor.remove(position);
        }
        loop {
            self.steps += 1;
            let stiffening = self.aim(sample, contact);
            let independent = stiffening > self.factor.dependence(&matrix, contact);
            let shut = if independent { -gap / stiffening } else { f64::INFINITY };
            if shut > 1e8 {
                self.drop_rounding();
            }
            match self.blocking(sample, 1.0).filter(|(_, step)| *step < shut) {
                Some((position, step)) => {
                    self.advance(sample, contact, step);
                    gap += step * stiffening;
                    self.open(sample, position);
                }
                None if gap >= -TOLERATED && !independent => return self.tolerate(sample, contact),
                None if shut > 1e8 && self.proves_infeasible(sample, contact) => return Entry::Infeasible,
                None if !independent || shut > 1e8 => return self.tolerate(sample, contact),
                None => {
                    self.advance(sample, contact, shut);
                    self.factor.append(&matrix, contact);
                    return Entry::Closed;
                }
            }
        }
    }

    fn tolerate(&mut self, sample: &mut Sample, contact: usize) -> Entry {
        self.tolerated[contact] = true;
        sample.lambda[contact] = 0.0;
        Entry::Tolerated
    }

    /// Change of the forces of the block due to a unit force at `contact`, `−A_aa⁻¹ A_as`. Returns the gap per unit
    /// force there.
    fn aim(&mut self, sample: &Sample, contact: usize) -> f64 {
        let column = sample.matrix().column(contact);
        self.direction.clear();
        self.direction.extend(self.factor.order().iter().map(|&i| column[i]));
        self.factor.forward(&mut self.direction);
        let gap = column[contact] - crate::kernel::dot(&self.direction, &self.direction);
        self.factor.backward(&mut self.direction);
        self.direction.iter_mut().for_each(|d| *d = -*d);
        gap
    }

    /// Sets entries of a direction to zero that are rounding compared with a unit force. Along a null direction nothing
    /// else limits the step, and a force that appears to decrease by 1e-17 would end it at 1e17.
    fn drop_rounding(&mut self) {
        let least = 1e-10 * crate::kernel::max_abs(&self.direction).max(1.0);
        self.direction.iter_mut().filter(|d| d.abs() < least).for_each(|d| *d = 0.0);
    }

    /// The first force of the block to vanish along `sign` times the direction: its row, and the step there.
    fn blocking(&self, sample: &Sample, sign: f64) -> Option<(usize, f64)> {
        let steps = self.factor.order().iter().zip(&self.direction).enumerate();
        steps
            .filter(|(_, (_, d))| sign * **d < 0.0)
            .map(|(position, (&i, d))| (position, sample.lambda[i] / d.abs()))
            .min_by(|a, b| a.1.total_cmp(&b.1))
    }

    fn advance(&self, sample: &mut Sample, contact: usize, step: f64) {
        sample.lambda[contact] += step;
        for (&i, d) in self.factor.order().iter().zip(&self.direction) {
            sample.lambda[i] += step * d;
        }
    }

    fn open(&mut self, sample: &mut Sample, position: usize) {
        sample.lambda[self.factor.order()[position]] = 0.0;
        self.factor.remove(position);
    }

    /// The direction and a unit force at `contact` as a ray, verified.
    fn proves_infeasible(&self, sample: &mut Sample, contact: usize) -> bool {
        sample.ray.fill(0.0);
        sample.ray[contact] = 1.0;
        for (&i, d) in self.factor.order().iter().zip(&self.direction) {
            sample.ray[i] = *d;
        }
        sample.is_proven_infeasible()
    }

    /// One step of iterative refinement if that helps.
    fn refine(&mut self, sample: &mut Sample, verdict: Verdict) -> Verdict {
        if verdict.violation() <= 1e-13 {
            return verdict;
        }
        self.direction.clear();
        self.direction.extend(self.factor.order().iter().map(|&i| -sample.gap[i]));
        self.factor.solve(&mut self.direction);
        let shift = |sample: &mut Sample, step: f64| {
            self.factor.order().iter().zip(&self.direction).for_each(|(&i, d)| sample.lambda[i] += step * d);
            sample.judge()
        };
        let refined = shift(sample, 1.0);
        if refined.violation() < verdict.violation() { refined } else { shift(sample, -1.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::factor::tests::smooth;

    /// All contacts of a smooth body are closed, with forces in error by this amount.
    fn pressed(error: f64) -> (Primal, Sample) {
        let (mut primal, mut sample) = (Primal::default(), Sample::new(&smooth(9)));
        sample.load(&[-1.0; 9]).unwrap();
        let matrix = sample.matrix().clone();
        (0..9).for_each(|contact| assert!(primal.factor.append(&matrix, contact)));
        let mut exact: Vec<f64> = sample.b.iter().map(|b| -b).collect();
        primal.factor.solve(&mut exact);
        let forces = exact.iter().enumerate().map(|(i, force)| force * (1.0 + error * (i as f64).cos()));
        sample.lambda.iter_mut().zip(forces).for_each(|(l, force)| *l = force);
        (primal, sample)
    }

    #[test]
    fn one_step_of_refinement_closes_the_gaps_of_linear_equations() {
        let (mut primal, mut sample) = pressed(1e-6);
        let before = sample.judge();
        assert!(before.violation() > 1e-8);
        let refined = primal.refine(&mut sample, before);
        assert!(refined.violation() < 1e-15, "{:e}", refined.violation());
    }

    #[test]
    fn what_refinement_cannot_improve_stays_as_it_is() {
        let (mut primal, mut sample) = pressed(0.0);
        let (before, forces) = (sample.judge(), sample.lambda.clone());
        assert!(before.violation() < 1e-13);
        primal.refine(&mut sample, before);
        assert_eq!(sample.lambda, forces);
        // The forces of the block cannot correct a penetrating contact outside it.
        primal.factor.remove(4);
        sample.lambda[4] = 0.0;
        let mut forces = sample.b.iter().enumerate().filter(|(i, _)| *i != 4).map(|(_, b)| -b).collect::<Vec<f64>>();
        primal.factor.solve(&mut forces);
        primal.factor.order().iter().zip(&forces).for_each(|(&i, force)| sample.lambda[i] = *force);
        let (before, forces) = (sample.judge(), sample.lambda.clone());
        let after = primal.refine(&mut sample, before);
        assert!(after.violation() <= before.violation());
        approx::assert_abs_diff_eq!(sample.lambda[..], forces[..], epsilon = 1e-14);
    }

    #[test]
    fn a_direction_answers_a_unit_force_and_keeps_the_gaps_of_the_block() {
        let mut primal = Primal::default();
        let mut sample = Sample::new(&smooth(9));
        sample.load(&[-1.0; 9]).unwrap();
        let matrix = sample.matrix().clone();
        [1, 4, 6].into_iter().for_each(|contact| assert!(primal.factor.append(&matrix, contact)));
        let stiffening = primal.aim(&sample, 5);
        primal.advance(&mut sample, 5, 2.0);
        sample.b.fill(0.0);
        sample.refresh_gaps();
        assert_eq!(sample.lambda[5], 2.0);
        assert!([1, 4, 6].into_iter().all(|i| sample.gap[i].abs() < 1e-15), "{:?}", sample.gap);
        approx::assert_relative_eq!(sample.gap[5], 2.0 * stiffening, max_relative = 1e-14);
    }
}
