use faer::Par;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{cholesky_in_place, cholesky_in_place_scratch};
use nlmodes_linalg::Mat;

use super::Factor;
use crate::scaled::Scaled;

/// From so many contacts on a factor that begins with all of them is found by blocks: faer's, on the instructions that the processor has.
pub(super) const MANY: usize = 96;

impl Factor {
    /// Begins with all of the contacts at once. False, and nothing is there, if one depends on others: then they are to come one after the other.
    pub(super) fn begin(&mut self, matrix: &Scaled, contacts: &[usize]) -> bool {
        let m = contacts.len();
        let mut block = Mat::zeros(m, m);
        for (j, &contact) in contacts.iter().enumerate() {
            let column = matrix.column(contact);
            let entries = block.col_mut(j).iter_mut().zip(contacts).skip(j);
            entries.for_each(|(entry, &i)| *entry = column[i]);
        }
        let Ok(mut memory) = MemBuffer::try_new(cholesky_in_place_scratch::<f64>(m, Par::Seq, Default::default()))
        else {
            return false;
        };
        let stack = MemStack::new(&mut memory);
        let found = cholesky_in_place(block.as_mut(), Default::default(), Par::Seq, stack, Default::default());
        if found.is_err() {
            return false;
        }
        for (i, &contact) in contacts.iter().enumerate() {
            let pivot = block[(i, i)] * block[(i, i)];
            // NaN counts as dependent.
            if pivot.is_nan() || pivot <= self.dependence(matrix, contact) {
                self.clear();
                return false;
            }
            self.rows.extend(block.row(i).iter().take(i));
            self.accept(contact, pivot);
        }
        true
    }
}
