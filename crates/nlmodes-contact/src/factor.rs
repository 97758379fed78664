//! Cholesky factor of the closed block of `A`, updated contact by contact.

mod append;
mod begin;
mod remove;
mod set;
mod suppression;
mod triangle;
mod working;

pub(crate) use begin::{MANY, Memory, factor_in_place};
pub(crate) use set::ClosedSet;
pub(crate) use working::WorkingFactor;

use crate::scaled::Scaled;
use triangle::{backward, forward};

/// `A_aa = L Lᵀ` of the contacts `a`, in the order in which they were added.
///
/// The rows of `L` are packed one after the other without the diagonal: adding a contact appends a row, and the
/// triangular solves run over contiguous memory.
#[derive(Debug, Default)]
pub(crate) struct Factor {
    order: Vec<usize>,
    rows: Vec<f64>,
    diagonal: Vec<f64>,
    inverse_diagonal: Vec<f64>,
    /// Work space of a removal.
    rotations: Vec<(f64, f64)>,
    /// Work space for starting with many contacts.
    memory: Memory,
}

/// Where row `i` begins.
fn offset(i: usize) -> usize {
    i * i.saturating_sub(1) / 2
}

impl Factor {
    /// The contacts of the block, in the order of the rows.
    pub(crate) fn order(&self) -> &[usize] {
        &self.order
    }

    pub(crate) fn len(&self) -> usize {
        self.order.len()
    }

    pub(crate) fn clear(&mut self) {
        self.order.clear();
        self.rows.clear();
        self.diagonal.clear();
        self.inverse_diagonal.clear();
    }

    /// Frees the memory that only updates need.
    pub(crate) fn settle(&mut self) {
        self.memory = Memory::default();
        self.rotations = Vec::new();
    }

    /// Smaller pivots are rounding errors: the contact depends on those in the block.
    pub(crate) fn dependence(&self, matrix: &Scaled, contact: usize) -> f64 {
        4.0 * f64::EPSILON * (self.len() + 8) as f64 * matrix.diagonal(contact)
    }

    /// Row `i` of `L` without the diagonal, and the inverse of the diagonal.
    fn row(&self, i: usize) -> (&[f64], f64) {
        (&self.rows[offset(i)..offset(i) + i], self.inverse_diagonal[i])
    }

    /// `x ← L⁻¹ x`.
    pub(crate) fn forward(&self, x: &mut [f64]) {
        forward(&self.rows, &self.inverse_diagonal, x);
    }

    /// `x ← L⁻ᵀ x`.
    pub(crate) fn backward(&self, x: &mut [f64]) {
        backward(&self.rows, &self.inverse_diagonal, x);
    }

    /// `x ← A_aa⁻¹ x`, entries in the order of the rows.
    pub(crate) fn solve(&self, x: &mut [f64]) {
        self.forward(x);
        self.backward(x);
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::LcpMatrix;
    use nlmodes_linalg::Mat;

    /// `exp(−|i − j| / 3)` plus a tenth on the diagonal.
    pub(crate) fn smooth(c: usize) -> LcpMatrix {
        let entry = |i: usize, j: usize| (-(i.abs_diff(j) as f64) / 3.0).exp() + if i == j { 0.1 } else { 0.0 };
        LcpMatrix::new(&Mat::from_fn(c, c, entry)).expect("the exponential kernel is positive definite")
    }

    /// `max |A_aa x − r|`.
    fn residual(matrix: &Scaled, factor: &Factor) -> f64 {
        let right: Vec<f64> = (0..factor.len()).map(|i| (i as f64).cos()).collect();
        let mut x = right.clone();
        factor.solve(&mut x);
        let line = |&i: &usize| factor.order().iter().zip(&x).map(|(&j, v)| matrix.column(j)[i] * v).sum::<f64>();
        factor.order().iter().zip(&right).map(|(i, r)| (line(i) - r).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn the_factor_solves_the_block_after_any_additions_and_removals() {
        let matrix = smooth(40);
        let mut factor = Factor::default();
        for contact in (0..40).rev() {
            assert!(factor.append(matrix.scaled(), contact));
            assert!(residual(matrix.scaled(), &factor) < 1e-13);
        }
        for step in 0..30 {
            let position = step * 7 % factor.len();
            let contact = factor.order()[position];
            factor.remove(position);
            assert!(!factor.order().contains(&contact));
            assert!(residual(matrix.scaled(), &factor) < 1e-13, "after removing {step}");
        }
        factor.clear();
        factor.append_all(matrix.scaled(), &(0..40).rev().collect::<Vec<_>>());
        assert_eq!(factor.len(), 40);
        assert!(residual(matrix.scaled(), &factor) < 1e-13);
    }

    #[test]
    fn a_factor_that_begins_with_many_contacts_is_that_of_one_after_the_other() {
        let c = 2 * begin::MANY;
        let matrix = smooth(c);
        let contacts: Vec<usize> = (0..c).filter(|i| i % 5 != 2).rev().collect();
        let (mut at_once, mut one_by_one) = (Factor::default(), Factor::default());
        assert!(at_once.begin(matrix.scaled(), &contacts));
        contacts.iter().for_each(|&contact| assert!(one_by_one.append(matrix.scaled(), contact)));
        assert_eq!(at_once.order(), one_by_one.order());
        assert!(at_once.rows.iter().zip(&one_by_one.rows).all(|(a, b)| (a - b).abs() < 1e-13));
        assert!(residual(matrix.scaled(), &at_once) < 1e-12);
    }

    #[test]
    fn of_many_contacts_that_depend_on_each_other_an_independent_part_is_taken() {
        let c = 2 * begin::MANY;
        // Every contact occurs twice.
        let pairs = smooth(c / 2);
        let matrix = LcpMatrix::new(&Mat::from_fn(c, c, |i, j| pairs.a()[(i / 2, j / 2)])).expect("semidefinite");
        let mut factor = Factor::default();
        factor.append_all(matrix.scaled(), &(0..c).collect::<Vec<_>>());
        assert_eq!(factor.order(), (0..c).step_by(2).collect::<Vec<_>>());
    }

    #[test]
    fn a_contact_that_repeats_another_is_not_added() {
        let matrix = LcpMatrix::new(&Mat::from_fn(2, 2, |_, _| 3.0)).expect("rank one");
        let mut factor = Factor::default();
        assert!(factor.append(matrix.scaled(), 1));
        assert!(!factor.append(matrix.scaled(), 0));
        assert_eq!(factor.order(), [1]);
        factor.clear();
        factor.append_all(matrix.scaled(), &[0, 1]);
        assert_eq!(factor.order(), [0]);
    }
}
