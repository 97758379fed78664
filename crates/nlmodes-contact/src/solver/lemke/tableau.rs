use crate::{kernel, scaled::Scaled};

/// `I g − A λ − 1 z = b` in the basis reached. Columns: g, λ, the covering variable z, right-hand side.
///
/// The columns of g hold the inverse of the basis, which the lexicographic rule needs.
pub(super) struct Tableau {
    c: usize,
    entries: Vec<f64>,
    /// Column of the basic variable of each row.
    basis: Vec<usize>,
    pivot_row: Vec<f64>,
    candidates: Vec<usize>,
}

/// How the pivoting ended.
pub(super) enum End {
    Solved,
    /// No basic variable decreases when that of column `entering` increases.
    Ray {
        entering: usize,
    },
    Limit,
}

/// Entries below this are rounding.
const PIVOT: f64 = 1e-11;

impl Tableau {
    pub(super) fn new(c: usize) -> Self {
        let (entries, pivot_row) = (vec![0.0; c * (2 * c + 2)], vec![0.0; 2 * c + 2]);
        Self { c, entries, basis: vec![0; c], pivot_row, candidates: Vec::with_capacity(c) }
    }

    pub(super) fn load(&mut self, matrix: &Scaled, b: &[f64]) {
        let (c, width) = (self.c, 2 * self.c + 2);
        self.entries.fill(0.0);
        for (i, row) in self.entries.chunks_exact_mut(width).enumerate() {
            row[i] = 1.0;
            row[c..2 * c].iter_mut().zip(matrix.column(i)).for_each(|(entry, a)| *entry = -a);
            row[2 * c] = -1.0;
            row[2 * c + 1] = b[i];
            self.basis[i] = i;
        }
    }

    /// Pivots until the covering variable leaves. Returns the number of pivots too.
    pub(super) fn pivot(&mut self, limit: usize) -> (End, usize) {
        let (c, covering) = (self.c, 2 * self.c);
        let mut row = self.first_row();
        let mut entering = covering;
        for pivots in 1..=limit {
            let leaving = self.exchange(row, entering);
            if leaving == covering {
                return (End::Solved, pivots);
            }
            entering = if leaving < c { leaving + c } else { leaving - c };
            match self.leaving_row(entering) {
                Some(next) => row = next,
                None => return (End::Ray { entering }, pivots),
            }
        }
        (End::Limit, limit)
    }

    pub(super) fn unload(&self, lambda: &mut [f64]) {
        lambda.fill(0.0);
        for (i, &basic) in self.basis.iter().enumerate() {
            if (self.c..2 * self.c).contains(&basic) {
                let force = self.row(i)[2 * self.c + 1];
                lambda[basic - self.c] = if force > 0.0 { force } else { 0.0 };
            }
        }
    }

    /// Change of the forces along the ray.
    pub(super) fn unload_ray(&self, entering: usize, ray: &mut [f64]) {
        ray.fill(0.0);
        let forces = self.c..2 * self.c;
        if forces.contains(&entering) {
            ray[entering - self.c] = 1.0;
        }
        for (i, basic) in self.basis.iter().enumerate().filter(|(_, basic)| forces.contains(basic)) {
            ray[basic - self.c] = -self.row(i)[entering];
        }
    }

    fn row(&self, i: usize) -> &[f64] {
        let width = 2 * self.c + 2;
        &self.entries[i * width..(i + 1) * width]
    }

    /// The row of the smallest b; the last one where several are equal, which is the lexicographic choice in the unit
    /// basis.
    fn first_row(&self) -> usize {
        let right = |i: usize| self.row(i)[2 * self.c + 1];
        (0..self.c).rev().min_by(|&i, &j| right(i).total_cmp(&right(j))).unwrap_or(0)
    }

    /// The row with the lexicographically smallest ratio of (right-hand side, inverse basis) to the entering column.
    fn leaving_row(&mut self, entering: usize) -> Option<usize> {
        let c = self.c;
        let mut candidates = std::mem::take(&mut self.candidates);
        candidates.clear();
        candidates.extend((0..c).filter(|&i| self.row(i)[entering] > PIVOT));
        for column in std::iter::once(2 * c + 1).chain(0..c) {
            if candidates.len() <= 1 {
                break;
            }
            let ratio = |i: usize| self.row(i)[column] / self.row(i)[entering];
            let least = candidates.iter().map(|&i| ratio(i)).fold(f64::INFINITY, f64::min);
            let tie = least + 1e-13 * (1.0 + least.abs());
            candidates.retain(|&i| ratio(i) <= tie);
            if let Some(&covering) = candidates.iter().find(|&&i| self.basis[i] == 2 * c) {
                candidates.clear();
                candidates.push(covering);
            }
        }
        let row = candidates.first().copied();
        self.candidates = candidates;
        row
    }

    /// Makes the variable of column `entering` basic in `row`. Returns the column of the one that leaves.
    fn exchange(&mut self, row: usize, entering: usize) -> usize {
        let width = 2 * self.c + 2;
        let pivot = self.row(row)[entering];
        let mut pivot_row = std::mem::take(&mut self.pivot_row);
        pivot_row.copy_from_slice(self.row(row));
        pivot_row.iter_mut().for_each(|v| *v /= pivot);
        for (i, line) in self.entries.chunks_exact_mut(width).enumerate() {
            if i == row {
                line.copy_from_slice(&pivot_row);
            } else if line[entering] != 0.0 {
                kernel::axpy(-line[entering], &pivot_row, line);
                line[entering] = 0.0;
            }
        }
        self.pivot_row = pivot_row;
        std::mem::replace(&mut self.basis[row], entering)
    }
}
