use std::sync::Arc;

use crate::{
    LcpError,
    factor::{ClosedSet, Factor},
    kernel,
    scaled::Scaled,
};

/// The factored block `A_aa` of a set of closed contacts: forces while the set stays the same.
///
/// Between two changes of the closed set the contact problem is linear, `λ_a = −A_aa⁻¹ b_a`. This is all the work that
/// a solver cannot avoid; instants at which a contact opens or closes are found with it.
///
/// ```
/// use nlmodes_contact::{LcpMatrix, Mat};
/// let a = LcpMatrix::new(&Mat::from_fn(2, 2, |i, j| if i == j { 2e-6 } else { 1e-6 }))?;
/// let block = a.closed_block(&[true, false])?;
/// let mut forces = [0.0; 2];
/// block.forces(&[-1e-3, 5e-3], &mut forces)?;
/// assert!((forces[0] - 500.0).abs() < 1e-9 && forces[1] == 0.0);
/// # Ok::<(), nlmodes_contact::LcpError>(())
/// ```
#[derive(Debug)]
pub struct ClosedBlock {
    matrix: Arc<Scaled>,
    factor: Factor,
}

impl ClosedBlock {
    pub(crate) fn new(matrix: Arc<Scaled>, closed: &[bool]) -> Self {
        let mut set = ClosedSet::new(closed.len());
        set.load(closed);
        let mut factor = Factor::default();
        let mut contacts = Vec::with_capacity(set.count());
        set.for_each(|contact| contacts.push(contact));
        factor.append_all(&matrix, &contacts);
        if factor.len() < contacts.len() {
            contacts = independent(&matrix, &set);
            contacts.sort_unstable();
            factor.clear();
            factor.append_all(&matrix, &contacts);
        }
        Self { matrix, factor }
    }

    /// The contacts of the block: those asked for, or an independent subset of them.
    pub fn contacts(&self) -> &[usize] {
        self.factor.order()
    }

    /// Forces `λ_a = −A_aa⁻¹ b_a` (N), zero elsewhere, that close the gaps of the block. They may pull.
    ///
    /// # Errors
    /// [`LcpError::Dimension`] if a slice has not c entries.
    pub fn forces(&self, b: &[f64], lambda: &mut [f64]) -> Result<(), LcpError> {
        let c = self.matrix.n_contacts();
        for (what, found) in [("b", b.len()), ("lambda", lambda.len())] {
            if found != c {
                return Err(LcpError::Dimension { what, expected: c, found });
            }
        }
        let (order, n) = (self.factor.order(), self.factor.len());
        // The head of `lambda` is the work space, in the order of the factor, that is in ascending order of contacts;
        // moved into place from the back, no entry is overwritten before it is moved.
        for (l, &i) in lambda.iter_mut().zip(order) {
            *l = -b[i] * self.matrix.gap_unit()[i];
        }
        self.factor.solve(&mut lambda[..n]);
        lambda[n..].fill(0.0);
        for (k, &i) in order.iter().enumerate().rev() {
            let force = std::mem::replace(&mut lambda[k], 0.0);
            lambda[i] = force * self.matrix.force_unit()[i];
        }
        Ok(())
    }
}

/// A subset with an independent block, by Cholesky with the largest remaining pivot first.
fn independent(matrix: &Scaled, set: &ClosedSet) -> Vec<usize> {
    let mut rest = Vec::new();
    set.for_each(|contact| rest.push((contact, matrix.diagonal(contact), Vec::new())));
    let mut chosen = Vec::new();
    while let Some(best) = (0..rest.len()).max_by(|&i, &j| f64::total_cmp(&rest[i].1, &rest[j].1)) {
        let (contact, pivot, row): (usize, f64, Vec<f64>) = rest.swap_remove(best);
        if pivot <= 1e-13 * (chosen.len() + 8) as f64 * matrix.diagonal(contact) {
            break;
        }
        for (other, remaining, column) in &mut rest {
            let entry = (matrix.column(contact)[*other] - kernel::dot(&row, column)) / pivot.sqrt();
            column.push(entry);
            *remaining -= entry * entry;
        }
        chosen.push(contact);
    }
    chosen
}
