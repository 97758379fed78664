use faer::Par;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{cholesky_in_place, cholesky_in_place_scratch};
use nlmodes_linalg::Mat;

use super::{Factor, offset};
use crate::scaled::Scaled;

/// From so many contacts on a factor that begins with all of them is found by blocks: faer's, on the instructions that the processor has.
pub(crate) const MANY: usize = 96;

/// Columns that stay in the cache while rows are put together from them.
const COLUMNS: usize = 16;

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
        if !factor_in_place(&mut block) {
            return false;
        }
        for (i, &contact) in contacts.iter().enumerate() {
            let pivot = block[(i, i)] * block[(i, i)];
            // NaN counts as dependent.
            if pivot.is_nan() || pivot <= self.dependence(matrix, contact) {
                self.clear();
                return false;
            }
            self.accept(contact, pivot);
        }
        self.pack(&block);
        true
    }

    /// Takes the rows below the diagonal over from a matrix that is stored by columns, some columns at a time.
    fn pack(&mut self, lower: &Mat<f64>) {
        let m = lower.nrows();
        self.rows.resize(offset(m), 0.0);
        for first in (0..m).step_by(COLUMNS) {
            for i in first + 1..m {
                let row = &mut self.rows[offset(i)..offset(i + 1)];
                for j in first..i.min(first + COLUMNS) {
                    row[j] = lower[(i, j)];
                }
            }
        }
    }
}

/// Replaces the lower triangle of a matrix by its Cholesky factor. False if it has none, or memory is short.
pub(crate) fn factor_in_place(matrix: &mut Mat<f64>) -> bool {
    let scratch = cholesky_in_place_scratch::<f64>(matrix.nrows(), Par::Seq, Default::default());
    let Ok(mut memory) = MemBuffer::try_new(scratch) else { return false };
    let stack = MemStack::new(&mut memory);
    cholesky_in_place(matrix.as_mut(), Default::default(), Par::Seq, stack, Default::default()).is_ok()
}
