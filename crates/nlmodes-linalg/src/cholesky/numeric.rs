//! The numbers of a factor with dense blocks, panel by panel.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltError, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::reborrow::ReborrowMut;
use faer::sparse::SparseColMatRef;
use faer::{Accum, MatMut, Par, Spec};

use super::panels::{Panel, Panels, WIDEST};
use crate::Mat;
use crate::threads::spread;

/// Rows of a change computed at a time, so that they are still in the cache when they are subtracted.
const ROWS: usize = 1024;

/// `L` of the lower triangle of a matrix with rows in the order of elimination, or the first column whose pivot is not
/// positive.
///
/// Each panel is computed by one thread, from the previous panels in ascending order, whatever the number of threads:
/// first the subtrees, each by one thread, then the panels of the top, which wait for one another as late as possible.
pub(super) fn factorise(panels: &Panels, lower: SparseColMatRef<'_, usize, f64>) -> Result<Vec<Mat<f64>>, usize> {
    let numeric = Numeric {
        panels,
        lower,
        done: (0..panels.len()).map(|_| OnceLock::new()).collect(),
        failed: AtomicUsize::new(usize::MAX),
    };
    spread(
        tasks(panels),
        || Workspace::new(panels.nrows()),
        |own, task: Vec<usize>| task.into_iter().for_each(|p| numeric.compute(p, own)),
    );
    let panels = numeric.done.into_iter().map(|panel| panel.into_inner().flatten());
    panels.collect::<Option<_>>().ok_or(numeric.failed.into_inner())
}

/// The panels of each task: the subtrees, the largest first, and the panels of the top.
fn tasks(panels: &Panels) -> Vec<Vec<usize>> {
    let subtrees = &panels.subtrees;
    if subtrees.parts.is_empty() {
        return vec![subtrees.top.clone()];
    }
    let mut parts: Vec<_> = subtrees.parts.iter().collect();
    parts.sort_by_key(|part| std::cmp::Reverse(part.numbers));
    parts.iter().map(|part| part.panels.clone().collect()).chain(subtrees.top.iter().map(|&p| vec![p])).collect()
}

/// Work space of each thread.
struct Workspace {
    /// The row of the current panel that corresponds to each row.
    at: Vec<u32>,
    change: Mat<f64>,
    memory: MemBuffer,
}

impl Workspace {
    fn new(n: usize) -> Self {
        let memory = MemBuffer::new(cholesky_in_place_scratch::<f64>(WIDEST, Par::Seq, Spec::default()));
        Self { at: vec![0; n], change: Mat::zeros(ROWS, WIDEST), memory }
    }
}

/// A factorisation in progress.
struct Numeric<'a> {
    panels: &'a Panels,
    lower: SparseColMatRef<'a, usize, f64>,
    /// Panels of the factor; `None` for those that depend on a panel without a positive pivot or are no longer needed
    /// because of it.
    done: Vec<OnceLock<Option<Mat<f64>>>>,
    /// The first column so far whose pivot is not positive.
    failed: AtomicUsize,
}

impl Numeric<'_> {
    /// Computes panel `p`, or skips it.
    fn compute(&self, p: usize, own: &mut Workspace) {
        let panel = self.panels.panel(p);
        let values = if self.failed.load(Ordering::Relaxed) < panel.first { None } else { self.values(p, own) };
        // No other thread computes this panel.
        let _ = self.done[p].set(values);
    }

    fn values(&self, p: usize, own: &mut Workspace) -> Option<Mat<f64>> {
        let panel = self.panels.panel(p);
        (panel.first..panel.node_end).zip(0..).for_each(|(row, at)| own.at[row] = at);
        let inner = panel.node_end - panel.first;
        (inner as u32..).zip(self.panels.rows_of_node(panel.node)).for_each(|(at, &row)| own.at[row as usize] = at);
        let mut values = self.entries(p, &own.at);
        for &node in self.panels.changed_by(p) {
            self.take_change_of(node as usize, panel, values.as_mut(), own)?;
        }
        for before in self.panels.of_node(panel.node).take_while(|&before| before < p) {
            let block = self.block(before)?;
            let below = block.get(panel.first - self.panels.panel(before).first.., ..);
            matmul(&mut values, Accum::Add, below, below.subrows(0, panel.width()).transpose(), -1.0, Par::Seq);
        }
        self.eliminate(panel, &mut values, &mut own.memory).then_some(values)
    }

    /// The entries of the matrix in the columns of panel `p`.
    fn entries(&self, p: usize, at: &[u32]) -> Mat<f64> {
        let panel = self.panels.panel(p);
        let mut values = Mat::zeros(self.panels.height(p), panel.width());
        for (column, j) in (panel.first..panel.end).enumerate() {
            let to = values.col_as_slice_mut(column);
            for (&i, value) in self.lower.row_idx_of_col_raw(j).iter().zip(self.lower.val_of_col(j)) {
                to[at[i] as usize] += value;
            }
        }
        values
    }

    /// A panel that was computed before, or is being computed; `None` if it was skipped.
    fn block(&self, p: usize) -> Option<&Mat<f64>> {
        self.done[p].wait().as_ref()
    }

    /// Subtracts the contribution of the columns of an earlier node from a panel.
    fn take_change_of(
        &self,
        node: usize,
        panel: Panel,
        mut values: MatMut<'_, f64>,
        own: &mut Workspace,
    ) -> Option<()> {
        let rows = self.panels.rows_of_node(node);
        let (first, end) = (below(rows, panel.first), below(rows, panel.end));
        let (columns, mut top) = (end - first, first);
        while top < rows.len() {
            let count = ROWS.min(rows.len() - top);
            let mut change = own.change.get_mut(..count, ..columns);
            let mut accumulate = Accum::Replace;
            for p in self.panels.of_node(node) {
                let block = self.block(p)?;
                let beyond = block.nrows() - rows.len();
                let (left, right) = (block.subrows(beyond + top, count), block.subrows(beyond + first, columns));
                matmul(&mut change, accumulate, left, right.transpose(), 1.0, Par::Seq);
                accumulate = Accum::Add;
            }
            for j in 0..columns {
                let mut to = values.rb_mut().col_mut(rows[first + j] as usize - panel.first);
                // The part above the diagonal is not read.
                for (k, &row) in rows[top..top + count].iter().enumerate() {
                    to[own.at[row as usize] as usize] -= change[(k, j)];
                }
            }
            top += count;
        }
        Some(())
    }

    /// The diagonal block and the part below it. Returns false if a pivot is not positive.
    fn eliminate(&self, panel: Panel, values: &mut Mat<f64>, memory: &mut MemBuffer) -> bool {
        let (mut top, bottom) = values.as_mut().split_at_row_mut(panel.width());
        let stack = MemStack::new(memory);
        match cholesky_in_place(top.rb_mut(), Default::default(), Par::Seq, stack, Spec::default()) {
            Ok(_) => {
                solve_lower_triangular_in_place(top.as_ref(), bottom.transpose_mut(), Par::Seq);
                true
            }
            Err(LltError::NonPositivePivot { index }) => {
                self.failed.fetch_min(panel.first + index, Ordering::Relaxed);
                false
            }
        }
    }
}

/// Number of the ascending `rows` that are below `limit`.
fn below(rows: &[u32], limit: usize) -> usize {
    rows.partition_point(|&row| (row as usize) < limit)
}
