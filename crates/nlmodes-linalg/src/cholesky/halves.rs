//! Solutions with one of the two triangular factors, panel by panel.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::reborrow::ReborrowMut;
use faer::{Accum, MatMut, MatRef, Par};

use super::panels::Panels;
use super::subtrees::{Subtree, Subtrees};
use super::thin;
use crate::Mat;
use crate::threads::spread;

/// Up to this number of right-hand sides the entries of some rows are kept in registers. With eight, a copy of the
/// panel as made by faer costs less.
const FEW: usize = 4;

/// A factor with dense blocks: `L`, panel by panel.
///
/// Right-hand sides are stored row by row, with `stride` numbers each: for few right-hand sides, the number kept in
/// registers.
#[derive(Clone, Copy)]
pub(super) struct Halves<'a> {
    pub panels: &'a Panels,
    pub values: &'a [Mat<f64>],
}

/// The right-hand sides in the rows that a part of the panels works on.
struct Rows<'a, P> {
    x: &'a mut [f64],
    stride: usize,
    /// Index of a row in `x`.
    place: P,
    /// The first row that is elsewhere.
    end: usize,
}

impl<P: Fn(usize) -> usize> Rows<'_, P> {
    fn row(&mut self, row: usize) -> &mut [f64] {
        let at = (self.place)(row) * self.stride;
        &mut self.x[at..at + self.stride]
    }

    fn rows(&mut self, first: usize, count: usize) -> &mut [f64] {
        let at = (self.place)(first) * self.stride;
        &mut self.x[at..at + count * self.stride]
    }
}

impl Halves<'_> {
    /// Overwrites `x` with `L⁻¹ x`.
    pub fn forward(self, x: MatMut<'_, f64>) {
        in_rows(x, |x, stride| self.forward_rows(x, stride));
    }

    /// Overwrites `x` with `L⁻ᵀ x`.
    pub fn backward(self, x: MatMut<'_, f64>) {
        in_rows(x, |x, stride| self.backward_rows(x, stride));
    }

    /// Each subtree sums its changes to the top, and the sums are subtracted in the order of the subtrees, so that they
    /// do not depend on the number of threads.
    pub fn forward_rows(self, x: &mut [f64], stride: usize) {
        let subtrees = &self.panels.subtrees;
        if subtrees.parts.is_empty() {
            return self.forward_top(x, stride);
        }
        let mut top = subtrees.top_of(x, stride);
        let changes = spread(subtrees.split(x, stride), || (), |(), (part, x)| self.forward_below(part, x, stride));
        for (part, change) in subtrees.parts.iter().zip(changes) {
            let rows = self.panels.rows_of_node(part.root).iter().zip(change.chunks_exact(stride));
            rows.for_each(|(&row, change)| {
                let at = subtrees.place_in_top(row as usize) * stride;
                add(&mut top[at..at + stride], change);
            });
        }
        self.forward_top(&mut top, stride);
        subtrees.put_top(&top, x, stride);
    }

    pub fn backward_rows(self, x: &mut [f64], stride: usize) {
        let subtrees = &self.panels.subtrees;
        if subtrees.parts.is_empty() {
            return self.backward_top(x, stride);
        }
        let mut top = subtrees.top_of(x, stride);
        self.backward_top(&mut top, stride);
        subtrees.put_top(&top, x, stride);
        let top = &top;
        let beyond = |row: usize| &top[subtrees.place_in_top(row) * stride..][..stride];
        let below = |part: &Subtree, x| {
            let (start, end) = (part.columns.start, part.columns.end);
            let rows = Rows { x, stride, place: |row| row - start, end };
            self.backward_through(part.panels.clone().rev(), rows, beyond);
        };
        spread(subtrees.split(x, stride), || (), |(), (part, x)| below(part, x));
    }

    /// The rows of a subtree; returns its contribution to the rows of its last node.
    fn forward_below(self, part: &Subtree, x: &mut [f64], stride: usize) -> Vec<f64> {
        let (rows, subtrees) = (self.panels.rows_of_node(part.root), &self.panels.subtrees);
        let mut at = vec![0_u32; subtrees.rows_of_top];
        rows.iter().zip(0..).for_each(|(&row, k)| at[subtrees.place_in_top(row as usize)] = k);
        let mut changes = vec![0.0; rows.len() * stride];
        let (start, end) = (part.columns.start, part.columns.end);
        let beyond = |row: usize, change: &[f64]| {
            let at = at[subtrees.place_in_top(row)] as usize * stride;
            add(&mut changes[at..at + stride], change);
        };
        self.forward_through(part.panels.clone(), Rows { x, stride, place: |row| row - start, end }, beyond);
        changes
    }

    fn forward_top(self, x: &mut [f64], stride: usize) {
        let subtrees = &self.panels.subtrees;
        let rows = Rows { x, stride, place: |row| subtrees.place_in_top(row), end: usize::MAX };
        self.forward_through(subtrees.top.iter().copied(), rows, |_, _| {});
    }

    fn backward_top(self, x: &mut [f64], stride: usize) {
        let subtrees = &self.panels.subtrees;
        let rows = Rows { x, stride, place: |row| subtrees.place_in_top(row), end: usize::MAX };
        self.backward_through(subtrees.top.iter().rev().copied(), rows, |_| &[]);
    }

    /// These panels one after the other; `beyond` receives their contributions to other rows.
    fn forward_through<P: Fn(usize) -> usize>(
        self,
        panels: impl Iterator<Item = usize>,
        mut rows: Rows<'_, P>,
        mut beyond: impl FnMut(usize, &[f64]),
    ) {
        let stride = rows.stride;
        let mut changes = vec![0.0; self.panels.tallest() * stride];
        for p in panels {
            let panel = self.panels.panel(p);
            let changes = &mut changes[..(self.panels.height(p) - panel.width()) * stride];
            changes.fill(0.0);
            forward(&self.values[p], rows.rows(panel.first, panel.width()), changes, stride);
            let (here, elsewhere) = self.panels.rows_before(p, rows.end);
            let mut changes = changes.chunks_exact(stride);
            here.zip(&mut changes).for_each(|(row, change)| add(rows.row(row), change));
            elsewhere.iter().zip(changes).for_each(|(&row, change)| beyond(row as usize, change));
        }
    }

    /// These panels one after the other; `beyond` supplies the numbers of other rows.
    fn backward_through<'b, P: Fn(usize) -> usize>(
        self,
        panels: impl Iterator<Item = usize>,
        mut rows: Rows<'_, P>,
        beyond: impl Fn(usize) -> &'b [f64],
    ) {
        let stride = rows.stride;
        let mut known = vec![0.0; self.panels.tallest() * stride];
        for p in panels {
            let panel = self.panels.panel(p);
            let known = &mut known[..(self.panels.height(p) - panel.width()) * stride];
            let (here, elsewhere) = self.panels.rows_before(p, rows.end);
            let mut to = known.chunks_exact_mut(stride);
            here.zip(&mut to).for_each(|(row, to)| to.copy_from_slice(rows.row(row)));
            elsewhere.iter().zip(to).for_each(|(&row, to)| to.copy_from_slice(beyond(row as usize)));
            backward(&self.values[p], rows.rows(panel.first, panel.width()), known, stride);
        }
    }
}

/// `own ← L⁻¹ own` with the diagonal block of a panel, and `below ← −B own` with the part below it.
fn forward(panel: &Mat<f64>, own: &mut [f64], below: &mut [f64], stride: usize) {
    match stride {
        1 => thin::forward::<1>(panel, own.as_chunks_mut().0, below.as_chunks_mut().0),
        2 => thin::forward::<2>(panel, own.as_chunks_mut().0, below.as_chunks_mut().0),
        FEW => thin::forward::<FEW>(panel, own.as_chunks_mut().0, below.as_chunks_mut().0),
        _ => {
            let (top, bottom) = panel.split_at_row(panel.ncols());
            let mut own = MatMut::from_row_major_slice_mut(own, panel.ncols(), stride);
            let below = MatMut::from_row_major_slice_mut(below, bottom.nrows(), stride);
            solve_lower_triangular_in_place(top, own.rb_mut(), Par::Seq);
            matmul(below, Accum::Replace, bottom, own, -1.0, Par::Seq);
        }
    }
}

/// `own ← L⁻ᵀ (own − Bᵀ below)`.
fn backward(panel: &Mat<f64>, own: &mut [f64], below: &[f64], stride: usize) {
    match stride {
        1 => thin::backward::<1>(panel, own.as_chunks_mut().0, below.as_chunks().0),
        2 => thin::backward::<2>(panel, own.as_chunks_mut().0, below.as_chunks().0),
        FEW => thin::backward::<FEW>(panel, own.as_chunks_mut().0, below.as_chunks().0),
        _ => {
            let (top, bottom) = panel.split_at_row(panel.ncols());
            let mut own = MatMut::from_row_major_slice_mut(own, panel.ncols(), stride);
            let below = MatRef::from_row_major_slice(below, bottom.nrows(), stride);
            matmul(&mut own, Accum::Add, bottom.transpose(), below, -1.0, Par::Seq);
            solve_upper_triangular_in_place(top.transpose(), own, Par::Seq);
        }
    }
}

/// Lets `work` change the columns of `x`, row by row.
fn in_rows(mut x: MatMut<'_, f64>, work: impl FnOnce(&mut [f64], usize)) {
    let (n, k) = (x.nrows(), x.ncols());
    let stride = if k <= FEW { k.next_power_of_two() } else { k };
    let mut rows = vec![0.0; n * stride];
    for (j, column) in x.rb_mut().col_iter_mut().enumerate() {
        rows.iter_mut().skip(j).step_by(stride).zip(column.iter()).for_each(|(to, from)| *to = *from);
    }
    work(&mut rows, stride);
    for (j, column) in x.col_iter_mut().enumerate() {
        column.iter_mut().zip(rows.iter().skip(j).step_by(stride)).for_each(|(to, from)| *to = *from);
    }
}

fn add(to: &mut [f64], from: &[f64]) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to += from);
}

impl Subtrees {
    /// The rows of each subtree.
    fn split<'a>(&self, mut x: &'a mut [f64], stride: usize) -> Vec<(&Subtree, &'a mut [f64])> {
        let (mut parts, mut passed) = (Vec::with_capacity(self.parts.len()), 0);
        for part in &self.parts {
            let (_, beyond) = x.split_at_mut((part.columns.start - passed) * stride);
            let (own, rest) = beyond.split_at_mut(part.columns.len() * stride);
            parts.push((part, own));
            (x, passed) = (rest, part.columns.end);
        }
        parts
    }

    /// The rows of the top.
    fn top_of(&self, x: &[f64], stride: usize) -> Vec<f64> {
        let runs = self.columns_of_top.iter().map(|rows| &x[rows.start * stride..rows.end * stride]);
        runs.flatten().copied().collect()
    }

    fn put_top(&self, mut top: &[f64], x: &mut [f64], stride: usize) {
        for rows in &self.columns_of_top {
            let (own, rest) = top.split_at(rows.len() * stride);
            x[rows.start * stride..rows.end * stride].copy_from_slice(own);
            top = rest;
        }
    }
}
