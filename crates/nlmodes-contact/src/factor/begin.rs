use std::mem::MaybeUninit;

use faer::dyn_stack::MemStack;
use faer::linalg::cholesky::llt::factor::{cholesky_in_place, cholesky_in_place_scratch};
use faer::{MatMut, Par};

use super::{Factor, offset};
use crate::scaled::Scaled;

/// From this number of contacts on, a factor that starts with all of them is computed by faer's blocked algorithm, with
/// the vector instructions of the processor.
pub(crate) const MANY: usize = 96;

/// Columns that remain in the cache while rows are assembled from them.
const COLUMNS: usize = 16;

/// Work space of a blocked factorisation, kept for the next one.
#[derive(Debug, Default)]
pub(crate) struct Memory {
    block: Vec<f64>,
    scratch: Vec<MaybeUninit<u8>>,
}

impl Factor {
    /// Starts with all of the contacts at once. Returns false, with an empty factor, if one depends on others: then
    /// they have to be added one by one.
    pub(super) fn begin(&mut self, matrix: &Scaled, contacts: &[usize]) -> bool {
        let mut memory = std::mem::take(&mut self.memory);
        let mut block = std::mem::take(&mut memory.block);
        lower_triangle(matrix, contacts, &mut block);
        let m = contacts.len();
        let begun = factor_in_place(MatMut::from_column_major_slice_mut(&mut block, m, m), &mut memory)
            && self.accept_all(matrix, contacts, |i| block[i * m + i] * block[i * m + i]);
        if begun {
            self.pack(&block);
        }
        self.memory = Memory { block, ..memory };
        begun
    }

    /// Accepts contacts with these pivots. Returns false, with an empty factor, if one of them depends on others.
    fn accept_all(&mut self, matrix: &Scaled, contacts: &[usize], pivot: impl Fn(usize) -> f64) -> bool {
        for (i, &contact) in contacts.iter().enumerate() {
            let pivot = pivot(i);
            // NaN counts as dependent.
            if pivot.is_nan() || pivot <= self.dependence(matrix, contact) {
                self.clear();
                return false;
            }
            self.accept(contact, pivot);
        }
        true
    }

    /// Copies the rows below the diagonal from a matrix stored by columns, some columns at a time.
    fn pack(&mut self, lower: &[f64]) {
        let m = self.len();
        self.rows.resize(offset(m), 0.0);
        for first in (0..m).step_by(COLUMNS) {
            for i in first + 1..m {
                let last = i.min(first + COLUMNS);
                let row = &mut self.rows[offset(i) + first..offset(i) + last];
                row.iter_mut().zip(first..last).for_each(|(entry, j)| *entry = lower[j * m + i]);
            }
        }
    }
}

/// The lower triangle of the block of these contacts, stored by columns; the upper one is unchanged.
fn lower_triangle(matrix: &Scaled, contacts: &[usize], block: &mut Vec<f64>) {
    let m = contacts.len();
    block.resize(m * m, 0.0);
    for (j, (&contact, entries)) in contacts.iter().zip(block.chunks_exact_mut(m)).enumerate() {
        let column = matrix.column(contact);
        entries[j..].iter_mut().zip(&contacts[j..]).for_each(|(entry, &i)| *entry = column[i]);
    }
}

/// Replaces the lower triangle of a matrix by its Cholesky factor. Returns false if it has none, or if memory is short.
pub(crate) fn factor_in_place(matrix: MatMut<'_, f64>, memory: &mut Memory) -> bool {
    let needed = cholesky_in_place_scratch::<f64>(matrix.nrows(), Par::Seq, Default::default());
    let (bytes, scratch) = (needed.unaligned_bytes_required(), &mut memory.scratch);
    if scratch.try_reserve(bytes.saturating_sub(scratch.len())).is_err() {
        return false;
    }
    scratch.resize(bytes.max(scratch.len()), MaybeUninit::uninit());
    cholesky_in_place(matrix, Default::default(), Par::Seq, MemStack::new(scratch), Default::default()).is_ok()
}
