//! Static answers of what the retained modes leave out.

use std::sync::Arc;

use nlmodes_linalg::{Mat, SparseCholesky, SparseMatrix, multiply_many};

/// Right-hand sides that are solved for at once: single ones cost three to nine times as much each.
pub(crate) const BLOCK: usize = 32;

/// A floating structure: the iteration ends when it changes the answer by less than this share.
const SETTLED: f64 = 1e-15;
/// The change shrinks by a half at least each time, so that this many leave rounding only.
const MOST_ITERATIONS: usize = 60;

/// What answers statically: `G = K⁻¹ − Φ Ω⁻² Φᵀ`.
#[derive(Debug, Clone)]
pub(crate) enum Residual {
    /// Never written out: loads are solved for.
    Solved(Solved),
    /// Of a structure that was reduced elsewhere, between the n displacements by which it is known.
    Given {
        /// `G` of loads along the first l of them, n × l.
        flexibility: Mat<f64>,
        /// `ω²` of the first elastic mode of a structure that floats, zero of others.
        shift: f64,
    },
}

/// The matrices of a structure.
#[derive(Debug, Clone)]
pub(crate) struct Solved {
    pub mass: Arc<SparseMatrix>,
    /// Factor of `K + sM`.
    pub factor: Arc<SparseCholesky>,
    pub shift: f64,
}

impl Residual {
    /// Zero of a structure that does not float; of others an `ω²` far above those of its rigid-body motions.
    pub fn shift(&self) -> f64 {
        match self {
            Self::Solved(solved) => solved.shift,
            Self::Given { shift, .. } => *shift,
        }
    }

    /// The mass; none of a structure that was reduced elsewhere.
    pub fn mass(&self) -> Option<&SparseMatrix> {
        match self {
            Self::Solved(solved) => Some(&solved.mass),
            Self::Given { .. } => None,
        }
    }

    /// The static response beyond the modes `shapes`. Their product with `M` is computed here, once for any number of
    /// loads.
    pub fn beside<'a>(&'a self, shapes: &'a Mat<f64>) -> Beside<'a> {
        match self {
            Self::Solved(solved) => {
                Beside::Solved(SolvedBeside { solved, shapes, modal_mass: multiply_many(&solved.mass, shapes) })
            }
            Self::Given { flexibility, .. } => Beside::Given(flexibility),
        }
    }

    /// `Wᵀ G W` for sparse `W` (n × c), whose columns move the modes by `rows = Wᵀ Φ`: with `B = W − M Φ Φᵀ W` it is
    /// `Bᵀ K⁻¹ B`. None of a floating structure, and where `G` is known.
    pub fn form(&self, shapes: &Mat<f64>, rows: &Mat<f64>, directions: &SparseMatrix) -> Option<Mat<f64>> {
        let Self::Solved(solved) = self else { return None };
        let modal_mass = (solved.shift == 0.0).then(|| multiply_many(&solved.mass, shapes))?;
        Some(solved.factor.inverse_form(directions, &modal_mass, &rows.transpose().to_owned()))
    }

    /// The same beside fewer modes: this one of the `shapes` answers statically from now on.
    pub fn take_over(&mut self, shapes: &Mat<f64>, mode: usize, omega_squared: f64) {
        if let Self::Given { flexibility, .. } = self {
            add_share(flexibility, (shapes, mode), 1.0 / omega_squared);
        }
    }
}

/// Adds `weight · φ φᵀ` of one of the `shapes` to a matrix between the same displacements.
pub(crate) fn add_share(to: &mut Mat<f64>, (shapes, mode): (&Mat<f64>, usize), weight: f64) {
    for j in 0..to.ncols() {
        (0..to.nrows()).for_each(|i| to[(i, j)] += weight * (shapes[(i, mode)] * shapes[(j, mode)]));
    }
}

/// `G = K⁻¹ − Φ Ω⁻² Φᵀ` of certain modes.
pub(crate) enum Beside<'a> {
    Solved(SolvedBeside<'a>),
    Given(&'a Mat<f64>),
}

impl Beside<'_> {
    /// `G P` for the columns of `loads` (n × any).
    pub fn answer(&self, loads: Mat<f64>) -> Mat<f64> {
        match self {
            Self::Solved(solved) => solved.answer(loads),
            Self::Given(flexibility) => *flexibility * loads.subrows(0, flexibility.ncols()),
        }
    }
}

/// The same where loads are solved for.
pub(crate) struct SolvedBeside<'a> {
    solved: &'a Solved,
    shapes: &'a Mat<f64>,
    /// `M Φ`.
    modal_mass: Mat<f64>,
}

impl SolvedBeside<'_> {
    /// `G P` for the columns of `loads` (n × any).
    ///
    /// `K x = P − M Φ Φᵀ P` with `Φᵀ M x = 0`: the modes' share is removed from the load, not from the response, where
    /// it would leave rounding errors of the larger part. A floating structure has no `K⁻¹`, but such loads are
    /// self-equilibrated, and `x ← (K + sM)⁻¹ (P + s M x)` converges by a factor `s/(ω² + s)` per iteration, where ω is
    /// that of the first truncated mode.
    fn answer(&self, mut loads: Mat<f64>) -> Mat<f64> {
        let modal = self.shapes.transpose() * &loads;
        loads -= &self.modal_mass * modal;
        if self.solved.shift == 0.0 {
            self.solved.factor.solve_many(&mut loads);
            self.take_out(&mut loads);
            return loads;
        }
        let balanced = loads;
        let mut x = balanced.clone();
        self.solved.factor.solve_many(&mut x);
        self.take_out(&mut x);
        for _ in 0..MOST_ITERATIONS {
            let mut next = &balanced + scaled(multiply_many(&self.solved.mass, &x), self.solved.shift);
            self.solved.factor.solve_many(&mut next);
            self.take_out(&mut next);
            let settled = (0..x.ncols()).all(|j| largest(&next, j, Some(&x)) <= SETTLED * largest(&next, j, None));
            x = next;
            if settled {
                break;
            }
        }
        x
    }

    /// Makes the columns of `x` M-orthogonal to the modes.
    fn take_out(&self, x: &mut Mat<f64>) {
        let overlap = self.modal_mass.transpose() * &*x;
        *x -= self.shapes * overlap;
    }
}

fn scaled(mut a: Mat<f64>, factor: f64) -> Mat<f64> {
    (0..a.ncols()).for_each(|j| a.col_mut(j).iter_mut().for_each(|v| *v *= factor));
    a
}

/// Largest component of column `j` of `x`, or of its difference from that of `from`.
fn largest(x: &Mat<f64>, j: usize, from: Option<&Mat<f64>>) -> f64 {
    let of = |i: usize| x[(i, j)] - from.map_or(0.0, |from| from[(i, j)]);
    (0..x.nrows()).map(|i| of(i).abs()).fold(0.0, f64::max)
}

/// Columns `from..to` of a sparse matrix, dense.
pub(crate) fn dense_columns(a: &SparseMatrix, columns: std::ops::Range<usize>) -> Mat<f64> {
    let mut dense = Mat::zeros(a.nrows(), columns.len());
    for (to, j) in columns.enumerate() {
        for (&i, v) in a.symbolic().row_idx_of_col_raw(j).iter().zip(a.val_of_col(j)) {
            dense[(i, to)] += v;
        }
    }
    dense
}

/// The columns `0..count` in blocks.
pub(crate) fn blocks(count: usize) -> impl Iterator<Item = std::ops::Range<usize>> {
    (0..count).step_by(BLOCK).map(move |first| first..(first + BLOCK).min(count))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nlmodes_linalg::{Pencil, multiply_transposed, sparse_from_triplets};

    #[test]
    fn the_form_of_the_contacts_is_what_full_answers_give_and_there_is_none_of_what_floats() {
        // A chain of masses, the first fixed or not, in newtons and metres.
        for held in [true, false] {
            let (n, stiffness) = (80, 2e7);
            let mut entries = vec![(0, 0, if held { stiffness } else { 0.0 })];
            for i in 1..n {
                let pair = [(i - 1, i - 1, 1.0), (i, i, 1.0), (i - 1, i, -1.0), (i, i - 1, -1.0)];
                entries.extend(pair.map(|(i, j, k)| (i, j, stiffness * k)));
            }
            let k = sparse_from_triplets(n, n, &entries).unwrap();
            let m = sparse_from_triplets(n, n, &(0..n).map(|i| (i, i, 0.1)).collect::<Vec<_>>()).unwrap();
            let w = sparse_from_triplets(n, 3, &[(79, 0, -1.0), (40, 1, 1.0), (20, 1, -1.0), (79, 2, 0.5)]).unwrap();
            let pencil = Pencil::new(&k, &m).unwrap();
            let (shapes, shift) = (pencil.lowest(6).unwrap().vectors, pencil.shift());
            let rows = multiply_transposed(&w, &shapes);
            let factor = Arc::new(pencil.into_factor());
            let residual = Residual::Solved(Solved { factor, mass: Arc::new(m), shift });
            let Some(form) = residual.form(&shapes, &rows, &w) else {
                assert!(!held && shift > 0.0);
                continue;
            };
            assert!(held);
            let expected = multiply_transposed(&w, &residual.beside(&shapes).answer(dense_columns(&w, 0..3)));
            assert!((0..9).all(|i| (form[(i / 3, i % 3)] - expected[(i / 3, i % 3)]).abs() < 1e-11 * expected[(0, 0)]));
        }
    }
}
