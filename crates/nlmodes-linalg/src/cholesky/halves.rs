//! Solutions with one of the two triangular factors, panel by panel.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par};

use super::panels::Panels;
use super::subtrees::{Subtree, Subtrees};
use crate::Mat;
use crate::threads::spread;

/// A factor with dense blocks: `L`, panel by panel.
#[derive(Clone, Copy)]
pub(super) struct Halves<'a> {
    pub panels: &'a Panels,
    pub values: &'a [Mat<f64>],
}

/// Rows that a part of the panels works on.
struct Rows<'a, P> {
    x: MatMut<'a, f64>,
    /// Where a row stands in `x`.
    place: P,
    /// The first row that is elsewhere.
    end: usize,
}

impl Halves<'_> {
    /// Overwrites `x` with `L⁻¹ x`.
    ///
    /// Each subtree adds up what it changes in the top, and the sums are taken out of it in the order of the subtrees: they do not depend on the number of
    /// threads.
    pub fn forward(self, mut x: MatMut<'_, f64>) {
        let subtrees = &self.panels.subtrees;
        if subtrees.parts.is_empty() {
            return self.forward_top(x);
        }
        let mut top = subtrees.top_of(x.as_ref());
        let changes = spread(subtrees.split(x.rb_mut()), || (), |(), (part, own)| self.forward_below(part, own));
        for (part, change) in subtrees.parts.iter().zip(changes) {
            for j in 0..top.ncols() {
                let (to, from) = (top.col_as_slice_mut(j), change.col_as_slice(j));
                let rows = self.panels.rows_of_node(part.root).iter().zip(from);
                rows.for_each(|(&row, from)| to[subtrees.place_in_top(row as usize)] -= from);
            }
        }
        self.forward_top(top.as_mut());
        subtrees.put_top(&top, x);
    }

    /// Overwrites `x` with `L⁻ᵀ x`.
    pub fn backward(self, mut x: MatMut<'_, f64>) {
        let subtrees = &self.panels.subtrees;
        if subtrees.parts.is_empty() {
            return self.backward_top(x);
        }
        let mut top = subtrees.top_of(x.as_ref());
        self.backward_top(top.as_mut());
        subtrees.put_top(&top, x.rb_mut());
        let beyond = |row: usize, j: usize| top[(subtrees.place_in_top(row), j)];
        let below = |part: &Subtree, x| {
            let (start, end) = (part.columns.start, part.columns.end);
            self.backward_through(part.panels.clone().rev(), Rows { x, place: |row| row - start, end }, beyond);
        };
        spread(subtrees.split(x), || (), |(), (part, own)| below(part, own));
    }

    /// The rows of a subtree; what it changes in the rows of its last node is returned.
    fn forward_below(self, part: &Subtree, x: MatMut<'_, f64>) -> Mat<f64> {
        let (rows, subtrees) = (self.panels.rows_of_node(part.root), &self.panels.subtrees);
        let mut at = vec![0_u32; subtrees.rows_of_top];
        rows.iter().zip(0..).for_each(|(&row, k)| at[subtrees.place_in_top(row as usize)] = k);
        let mut change = Mat::zeros(rows.len(), x.ncols());
        let (start, end) = (part.columns.start, part.columns.end);
        let beyond = |row: usize, j: usize, value: f64| change[(at[subtrees.place_in_top(row)] as usize, j)] += value;
        self.forward_through(part.panels.clone(), Rows { x, place: |row| row - start, end }, beyond);
        change
    }

    fn forward_top(self, x: MatMut<'_, f64>) {
        let subtrees = &self.panels.subtrees;
        let rows = Rows { x, place: |row| subtrees.place_in_top(row), end: usize::MAX };
        self.forward_through(subtrees.top.iter().copied(), rows, |_, _, _| {});
    }

    fn backward_top(self, x: MatMut<'_, f64>) {
        let subtrees = &self.panels.subtrees;
        let rows = Rows { x, place: |row| subtrees.place_in_top(row), end: usize::MAX };
        self.backward_through(subtrees.top.iter().rev().copied(), rows, |_, _| 0.0);
    }

    /// These panels one after the other; `beyond` takes row, column and value of what they change elsewhere.
    fn forward_through<P: Fn(usize) -> usize>(
        self,
        panels: impl Iterator<Item = usize>,
        mut rows: Rows<'_, P>,
        mut beyond: impl FnMut(usize, usize, f64),
    ) {
        let mut change = Mat::zeros(self.panels.tallest(), rows.x.ncols());
        for p in panels {
            let panel = self.panels.panel(p);
            let (top, bottom) = self.values[p].split_at_row(panel.width());
            let mut own = rows.x.rb_mut().subrows_mut((rows.place)(panel.first), panel.width());
            solve_lower_triangular_in_place(top, own.rb_mut(), Par::Seq);
            let mut change = change.subrows_mut(0, bottom.nrows());
            matmul(&mut change, Accum::Replace, bottom, own, 1.0, Par::Seq);
            let (here, elsewhere) = self.panels.rows_before(p, rows.end);
            for j in 0..change.ncols() {
                let (mut to, from) = (rows.x.rb_mut().col_mut(j), change.rb().col(j));
                here.clone().zip(from.iter()).for_each(|(row, from)| to[(rows.place)(row)] -= from);
                let from = from.iter().skip(bottom.nrows() - elsewhere.len());
                elsewhere.iter().zip(from).for_each(|(&row, from)| beyond(row as usize, j, *from));
            }
        }
    }

    /// These panels one after the other; `beyond` gives the value in a row and column elsewhere.
    fn backward_through<P: Fn(usize) -> usize>(
        self,
        panels: impl Iterator<Item = usize>,
        mut rows: Rows<'_, P>,
        beyond: impl Fn(usize, usize) -> f64,
    ) {
        let mut known = Mat::zeros(self.panels.tallest(), rows.x.ncols());
        for p in panels {
            let panel = self.panels.panel(p);
            let (top, bottom) = self.values[p].split_at_row(panel.width());
            let (here, elsewhere) = self.panels.rows_before(p, rows.end);
            for j in 0..known.ncols() {
                let (from, to) = (rows.x.rb().col(j), known.col_as_slice_mut(j));
                let elsewhere = elsewhere.iter().map(|&row| beyond(row as usize, j));
                let values = here.clone().map(|row| from[(rows.place)(row)]).chain(elsewhere);
                to.iter_mut().zip(values).for_each(|(to, value)| *to = value);
            }
            let mut own = rows.x.rb_mut().subrows_mut((rows.place)(panel.first), panel.width());
            let known = known.subrows(0, bottom.nrows());
            matmul(&mut own, Accum::Add, bottom.transpose(), known, -1.0, Par::Seq);
            solve_upper_triangular_in_place(top.transpose(), own, Par::Seq);
        }
    }
}

impl Subtrees {
    /// The rows of each subtree.
    fn split<'a>(&self, mut x: MatMut<'a, f64>) -> Vec<(&Subtree, MatMut<'a, f64>)> {
        let (mut parts, mut passed) = (Vec::with_capacity(self.parts.len()), 0);
        for part in &self.parts {
            let (_, beyond) = x.split_at_row_mut(part.columns.start - passed);
            let (own, rest) = beyond.split_at_row_mut(part.columns.len());
            parts.push((part, own));
            (x, passed) = (rest, part.columns.end);
        }
        parts
    }

    /// The rows of the top.
    fn top_of(&self, x: MatRef<'_, f64>) -> Mat<f64> {
        let (mut top, mut at) = (Mat::zeros(self.rows_of_top, x.ncols()), 0);
        for rows in &self.columns_of_top {
            top.subrows_mut(at, rows.len()).copy_from(x.subrows(rows.start, rows.len()));
            at += rows.len();
        }
        top
    }

    fn put_top(&self, top: &Mat<f64>, mut x: MatMut<'_, f64>) {
        let mut at = 0;
        for rows in &self.columns_of_top {
            x.rb_mut().subrows_mut(rows.start, rows.len()).copy_from(top.subrows(at, rows.len()));
            at += rows.len();
        }
    }
}
