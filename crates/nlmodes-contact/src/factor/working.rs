use super::{ClosedSet, Factor, begin::MANY, suppression::Suppression};
use crate::{kernel, scaled::Scaled};

/// The factor of a closed set that changes by a few contacts from one problem to the next.
///
/// A contact that closes appends a row. One that opens remains in the factor and is suppressed. Neither copies the
/// factor, a contact that closes again costs nothing, and the factor stays in the cache. When many are suppressed they
/// are removed.
#[derive(Debug)]
pub(crate) struct WorkingFactor {
    factor: Factor,
    /// The requested set; contacts that depend on others in it are not in the factor.
    asked: ClosedSet,
    members: ClosedSet,
    suppression: Suppression,
    list: Vec<usize>,
    /// `L⁻¹` times the right-hand side, as far as computed.
    right: Vec<f64>,
}

/// Maximum number of suppressed contacts.
const MOST_SUPPRESSED: usize = 32;

/// Ratio of contacts to changes above which a factor is kept and updated.
const NEAR: usize = 4;

/// The same if a new factor is computed by blocks, which costs less than row by row.
const NEAR_OF_MANY: usize = 32;

/// Ratio of rows to removed contacts above which a new blocked factor costs less than rotating the old one.
const ROTATIONS_OF_A_FACTOR: usize = 64;

impl WorkingFactor {
    pub(crate) fn new(c: usize) -> Self {
        let (asked, members) = (ClosedSet::new(c), ClosedSet::new(c));
        let (factor, suppression) = (Factor::default(), Suppression::default());
        Self { factor, asked, members, suppression, list: vec![], right: vec![] }
    }

    /// The contacts in the order of the entries that [`WorkingFactor::solve`] works on, with suppressed ones among
    /// them.
    pub(crate) fn order(&self) -> &[usize] {
        self.factor.order()
    }

    /// The contacts of the set, or an independent subset.
    pub(crate) fn closed(&self) -> impl Iterator<Item = usize> {
        self.order().iter().copied().filter(|&i| self.asked.contains(i))
    }

    /// Updates the factor to the set.
    pub(crate) fn select(&mut self, matrix: &Scaled, set: &ClosedSet) {
        if self.asked == *set {
            return;
        }
        let near = if set.count() < MANY { NEAR } else { NEAR_OF_MANY };
        let is_near = self.asked.distance(set) * near <= set.count();
        self.asked.copy_from(set);
        if is_near {
            let (asked, order) = (&self.asked, self.factor.order());
            self.suppression.release(|position| asked.contains(order[position]));
        } else {
            self.clear();
        }
        self.close(matrix);
        self.open(matrix);
    }

    fn clear(&mut self) {
        self.suppression.clear();
        self.factor.clear();
        self.right.clear();
        self.members.clear();
    }

    /// Adds the contacts of the set that are missing.
    fn close(&mut self, matrix: &Scaled) {
        if self.append_missing(matrix) && !self.suppression.is_empty() {
            // What depends on a suppressed contact need not depend on the set.
            self.consolidate(matrix);
            self.append_missing(matrix);
        }
    }

    /// Returns whether some were not added because they depend on others.
    fn append_missing(&mut self, matrix: &Scaled) -> bool {
        let (members, list) = (&mut self.members, &mut self.list);
        list.clear();
        self.asked.for_each(|contact| {
            if !members.contains(contact) {
                list.push(contact);
            }
        });
        if list.is_empty() {
            return false;
        }
        let before = self.factor.len();
        self.factor.append_all(matrix, list);
        self.factor.order()[before..].iter().for_each(|&contact| members.toggle(contact));
        self.suppression.extend(&self.factor, before);
        self.factor.len() < before + self.list.len()
    }

    /// Suppresses the contacts that are not in the set, or removes them if that is easy or they are many.
    fn open(&mut self, matrix: &Scaled) {
        self.drop_last();
        let (order, asked, suppression) = (self.factor.order(), &self.asked, &mut self.suppression);
        let is_new = |at: usize, suppression: &Suppression| !asked.contains(order[at]) && !suppression.contains(at);
        self.list.clear();
        self.list.extend((0..order.len()).filter(|&at| is_new(at, suppression)));
        let suppressed = suppression.len() + self.list.len();
        let closed = order.len() - suppressed;
        // Contacts left out may depend on one that has just opened.
        let dependent = closed < asked.count();
        if dependent || suppressed > MOST_SUPPRESSED.min(8 + closed / 8) {
            self.consolidate(matrix);
        } else {
            self.list.iter().for_each(|&at| suppression.add(&self.factor, at));
        }
        if dependent {
            self.append_missing(matrix);
        }
    }

    /// Removes the last rows as long as they are not needed: nothing depends on them.
    fn drop_last(&mut self) {
        while self.suppression.is_empty()
            && let Some(&last) = self.factor.order().last()
            && !self.asked.contains(last)
        {
            self.factor.remove(self.factor.len() - 1);
            self.right.truncate(self.factor.len());
            self.members.toggle(last);
        }
    }

    /// Removes the suppressed contacts from the factor: one by one, or by a new factor if that is less work.
    fn consolidate(&mut self, matrix: &Scaled) {
        self.suppression.clear();
        let before = self.factor.len();
        self.list.clear();
        self.list.extend(self.factor.order().iter().filter(|&&contact| self.asked.contains(contact)));
        let (kept, gone) = (self.list.len(), before - self.list.len());
        if kept >= MANY && gone * ROTATIONS_OF_A_FACTOR > kept {
            self.factor.clear();
            self.factor.append_all(matrix, &self.list);
        } else {
            let asked = &self.asked;
            self.factor.retain(|contact| asked.contains(contact));
        }
        if self.factor.len() < before {
            self.right.clear();
        }
        self.members.clear();
        self.factor.order().iter().for_each(|&contact| self.members.toggle(contact));
    }

    /// Another problem begins.
    pub(crate) fn reset(&mut self) {
        self.right.clear();
    }

    /// `−A_aa⁻¹ b_a` in the order of the contacts, zero where they are suppressed. As long as the problem is the same,
    /// only the rows added since the last call are substituted forward.
    pub(crate) fn forces(&mut self, b: &[f64], x: &mut Vec<f64>) {
        let known = self.right.len();
        self.right.extend(self.factor.order()[known..].iter().map(|&i| -b[i]));
        if known == 0 {
            self.factor.forward(&mut self.right);
        } else {
            for i in known..self.right.len() {
                let (row, inverse) = self.factor.row(i);
                self.right[i] = (self.right[i] - kernel::dot(row, &self.right[..i])) * inverse;
            }
        }
        x.clone_from(&self.right);
        self.suppression.substitute_backward(&self.factor, x);
    }

    /// `x ← A_aa⁻¹ x` in the order of the contacts, zero where they are suppressed.
    pub(crate) fn solve(&mut self, x: &mut [f64]) {
        self.factor.forward(x);
        self.suppression.substitute_backward(&self.factor, x);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::factor::tests::smooth;

    #[test]
    fn every_sequence_of_sets_is_solved_as_by_a_new_factor() {
        [60, 4 * MANY].into_iter().for_each(follow_sets);
    }

    /// The order of the rows shows what was kept, suppressed and removed.
    #[test]
    fn a_factor_keeps_what_is_near_drops_what_came_last_and_begins_anew_for_another_set() {
        let matrix = smooth(40);
        let (mut working, mut set) = (WorkingFactor::new(40), ClosedSet::new(40));
        let mut order_with = |change: &[usize]| {
            change.iter().for_each(|&contact| set.toggle(contact));
            working.select(matrix.scaled(), &set);
            working.order().to_vec()
        };
        let begin: Vec<usize> = (10..20).collect();
        assert_eq!(order_with(&begin), begin);
        let larger: Vec<usize> = begin.iter().copied().chain([5, 30]).collect();
        assert_eq!(order_with(&[5, 30]), larger, "what closes is appended");
        assert_eq!(order_with(&[5, 30]), begin, "what closed last is taken out");
        assert_eq!(order_with(&[13]), begin, "what opens stays, suppressed");
        assert_eq!(order_with(&[19]), begin, "also at the end, beside others");
        assert_eq!(order_with(&[13, 19]), begin, "and closes again at no expense");
        // A quarter of the eight contacts then closed.
        assert_eq!(order_with(&[12, 13]), begin, "a set is near");
        // Three of seven.
        assert_eq!(order_with(&[17, 12, 18]), [10, 11, 12, 14, 15, 16, 19], "a set is not near");
    }

    fn follow_sets(c: usize) {
        let matrix = smooth(c);
        let matrix = matrix.scaled();
        let mut working = WorkingFactor::new(c);
        let mut set = ClosedSet::new(c);
        let right: Vec<f64> = (0..c).map(|i| (1.7 * i as f64).sin()).collect();
        for step in 0..400 {
            // Some contacts close and open often, a few at a time.
            for k in 0..1 + step % 3 {
                set.toggle((step * step / 7 + 11 * k * step) % c);
            }
            if step % 97 == 96 {
                (0..c).step_by(2).for_each(|i| set.toggle(i));
            }
            working.select(matrix, &set);
            // More suppressed contacts than that would cost more than they save.
            let (suppressed, closed) = (working.order().len() - set.count(), set.count());
            assert!(suppressed <= MOST_SUPPRESSED.min(8 + closed / 8), "step {step}: {suppressed} beside {closed}");
            let mut x: Vec<f64> = working.order().iter().map(|&i| right[i]).collect();
            working.solve(&mut x);
            if step % 50 == 0 {
                working.reset();
            }
            let mut again = vec![];
            working.forces(&right, &mut again);
            assert!(x.iter().zip(&again).all(|(x, y)| (x + y).abs() < 1e-12), "step {step}");
            let mut forces = vec![0.0; c];
            working.order().iter().zip(&x).for_each(|(&i, v)| forces[i] = *v);
            let mut product = vec![0.0; c];
            matrix.gap(&vec![0.0; c], &forces, &mut product);
            for i in 0..c {
                let error = if set.contains(i) { product[i] - right[i] } else { forces[i] };
                assert!(error.abs() < 1e-12, "step {step}, contact {i}: {error:e}");
            }
            assert_eq!(working.closed().count(), set.count());
        }
    }
}
