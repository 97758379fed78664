use std::sync::Arc;

use crate::{
    LcpError,
    factor::{ClosedSet, Factor},
    kernel,
    scaled::Scaled,
};

/// The factored block `A_aa` of a set of closed contacts: contact forces as long as the set does not change.
///
/// Between two changes of the closed set the contact problem is linear, `λ_a = −A_aa⁻¹ b_a`. This is the minimum work
/// of any solver; the instants at which a contact opens or closes are found with it.
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
        factor.settle();
        Self { matrix, factor }
    }

    /// The contacts of the block: the requested ones, or an independent subset of them.
    pub fn contacts(&self) -> &[usize] {
        self.factor.order()
    }

    /// Forces `λ_a = −A_aa⁻¹ b_a` (N), zero elsewhere, that close the gaps of the block. They may be tensile.
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
        // The first entries of `lambda` are the work space, in the order of the factor, that is in ascending order of
        // contacts. They are moved into place from the back, so that no entry is overwritten before it is moved.
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

#[cfg(test)]
mod tests {
    use crate::{LcpMatrix, Mat};

    /// `A = W Wᵀ` of directions in space.
    fn of_directions(w: &[[f64; 3]]) -> LcpMatrix {
        LcpMatrix::new(&Mat::from_fn(w.len(), w.len(), |i, j| (0..3).map(|k| w[i][k] * w[j][k]).sum())).unwrap()
    }

    #[test]
    fn of_redundant_contacts_those_are_chosen_that_are_furthest_from_dependent() {
        // The first three are nearly collinear: less than 1e-3 of the other two is perpendicular to the first, the
        // longest.
        let directions = [[1.4, 0.0, 0.0], [1.0, 0.01, 0.0], [1.0, 0.0, 0.02], [0.0, 1.4, 0.0], [0.1, 0.2, 1.1]];
        let block = of_directions(&directions).closed_block(&[true; 5]).unwrap();
        assert_eq!(block.contacts(), [0, 3, 4]);
        // Without the last one only the third is out of the plane of the others.
        let block = of_directions(&directions).closed_block(&[true, true, true, true, false]).unwrap();
        assert_eq!(block.contacts(), [0, 2, 3]);
    }

    #[test]
    fn forces_of_a_block_of_redundant_contacts_close_all_gaps_of_a_body() {
        let directions = [[1.4, 0.0, 0.0], [1.0, 0.01, 0.0], [1.0, 0.0, 0.02], [0.0, 1.4, 0.0], [0.1, 0.2, 1.1]];
        let a = of_directions(&directions);
        // Gaps due to a displacement of the body, which three contacts reverse.
        let b: Vec<f64> = directions.iter().map(|w| w[0] * 0.3 - w[1] * 0.7 + w[2] * 0.2).collect();
        let (mut forces, mut gaps) = ([0.0; 5], [0.0; 5]);
        a.closed_block(&[true; 5]).unwrap().forces(&b, &mut forces).unwrap();
        a.gaps(&b, &forces, &mut gaps).unwrap();
        assert!(gaps.iter().all(|g| g.abs() < 1e-14), "{gaps:?}");
        assert_eq!(forces[1..3], [0.0; 2]);
    }
}
