//! `Bᵀ A⁻¹ B` from the forward solution `L⁻¹ P B`, most of whose rows are zero for a sparse `B`.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Accum, Par};

use super::blocks::Blocks;
use super::halves::Halves;
use super::{Factor, SparseCholesky};
use crate::{Mat, SparseMatrix};

/// Number of right-hand sides solved together if the factor has no dense blocks.
const AT_ONCE: usize = 32;

impl SparseCholesky {
    /// `(S − D C)ᵀ A⁻¹ (S − D C)`, c × c and symmetric, for sparse `S` (n × c), dense `D` (n × m) and `C` (m × c).
    ///
    /// With `Z = L⁻¹ P B` it is `Zᵀ Z`. For a sparse column, `Z` is nonzero only on the path from its entries to the
    /// root of the elimination tree: with few entries per column this costs a small fraction of the full solutions if
    /// the factor has dense blocks. Otherwise the solutions are computed, several at a time.
    ///
    /// # Panics
    /// If the sizes are inconsistent.
    pub fn inverse_form(&self, sparse: &SparseMatrix, dense: &Mat<f64>, coefficients: &Mat<f64>) -> Mat<f64> {
        let (c, m) = (sparse.ncols(), dense.ncols());
        assert!(
            sparse.nrows() == self.dim() && dense.nrows() == self.dim(),
            "rows of a {n} x {n} system",
            n = self.dim()
        );
        assert!(coefficients.nrows() == m && coefficients.ncols() == c, "coefficients of {m} columns in {c}");
        let form = match &self.factor {
            Factor::Blocks(blocks, values) => {
                let mut z = Mat::from_fn(dense.nrows(), m, |i, j| dense[(blocks.order[i], j)]);
                self.forward(z.as_mut());
                let (form, cross) = Tree::new(blocks, blocks.halves(values), sparse).products(&z);
                let mixed = cross * coefficients;
                form - &mixed - mixed.transpose() + coefficients.transpose() * (z.transpose() * &z) * coefficients
            }
            Factor::Columns(..) => self.form_by_solutions(sparse, dense, coefficients),
        };
        Mat::from_fn(c, c, |i, j| 0.5 * (form[(i, j)] + form[(j, i)]))
    }

    fn form_by_solutions(&self, sparse: &SparseMatrix, dense: &Mat<f64>, coefficients: &Mat<f64>) -> Mat<f64> {
        let c = sparse.ncols();
        let mut form = Mat::zeros(c, c);
        for first in (0..c).step_by(AT_ONCE) {
            let count = AT_ONCE.min(c - first);
            let mut x = -(dense * coefficients.subcols(first, count));
            for j in 0..count {
                let entries = sparse.symbolic().row_idx_of_col_raw(first + j).iter().zip(sparse.val_of_col(first + j));
                entries.for_each(|(&i, v)| x[(i, j)] += v);
            }
            self.solve_many(&mut x);
            let direct = crate::multiply_transposed(sparse, &x) - coefficients.transpose() * (dense.transpose() * &x);
            form.subcols_mut(first, count).copy_from(&direct);
        }
        form
    }
}

/// The part of the elimination tree that the columns of a sparse matrix reach.
struct Tree<'a> {
    factor: Halves<'a>,
    /// The columns that reach each panel, ascending.
    reached_by: Vec<Vec<usize>>,
    /// The entries in the rows of each panel (its rows × the columns that reach it), if any.
    blocks: Vec<Option<Mat<f64>>>,
    columns: usize,
}

impl<'a> Tree<'a> {
    fn new(blocks: &Blocks, factor: Halves<'a>, sparse: &SparseMatrix) -> Self {
        let panels = factor.panels;
        let entries: Vec<(usize, usize, f64)> = (0..sparse.ncols())
            .flat_map(|j| {
                sparse.symbolic().row_idx_of_col_raw(j).iter().zip(sparse.val_of_col(j)).map(move |(i, v)| (*i, j, *v))
            })
            .map(|(i, j, v)| (blocks.place[i], j, v))
            .collect();
        let mut reached_by = vec![Vec::new(); panels.len()];
        entries.iter().for_each(|&(k, j, _)| reached_by[panels.of_column(k)].push(j));
        for p in 0..panels.len() {
            let mut own = std::mem::take(&mut reached_by[p]);
            own.sort_unstable();
            own.dedup();
            // A panel changes only rows on its path to the root, which begins with the first of them.
            if let Some(next) = panels.rows(p).next().filter(|_| !own.is_empty()) {
                reached_by[panels.of_column(next)].extend_from_slice(&own);
            }
            reached_by[p] = own;
        }
        let blocks = (0..panels.len()).map(|_| None).collect();
        let mut tree = Self { factor, reached_by, blocks, columns: sparse.ncols() };
        for (k, j, value) in entries {
            let p = panels.of_column(k);
            let (row, at) = (k - panels.panel(p).first, tree.reached_by[p].partition_point(|&other| other < j));
            tree.block(p)[(row, at)] += value;
        }
        tree
    }

    fn block(&mut self, p: usize) -> &mut Mat<f64> {
        let size = (self.factor.values[p].ncols(), self.reached_by[p].len());
        self.blocks[p].get_or_insert_with(|| Mat::zeros(size.0, size.1))
    }

    /// `Xᵀ X` (c × c) and `Xᵀ Z` (c × m) for `X = L⁻¹ P S`.
    fn products(mut self, z: &Mat<f64>) -> (Mat<f64>, Mat<f64>) {
        let (mut form, mut cross) = (Mat::zeros(self.columns, self.columns), Mat::zeros(self.columns, z.ncols()));
        for p in 0..self.blocks.len() {
            let Some(mut x) = self.blocks[p].take() else { continue };
            let top = self.factor.values[p].get(..x.nrows(), ..);
            solve_lower_triangular_in_place(top, x.as_mut(), Par::Seq);
            self.pass_on(p, &x);
            let columns = &self.reached_by[p];
            let own = x.transpose() * &x;
            let with_z = x.transpose() * z.subrows(self.factor.panels.panel(p).first, x.nrows());
            for (b, &j) in columns.iter().enumerate() {
                columns.iter().enumerate().for_each(|(a, &i)| form[(i, j)] += own[(a, b)]);
                (0..z.ncols()).for_each(|r| cross[(j, r)] += with_z[(b, r)]);
            }
        }
        (form, cross)
    }

    /// Subtracts the contribution of the rows of panel `p` from those below.
    fn pass_on(&mut self, p: usize, x: &Mat<f64>) {
        let Halves { panels, values } = self.factor;
        let bottom = values[p].get(x.nrows().., ..);
        let mut change = Mat::zeros(bottom.nrows(), x.ncols());
        matmul(change.as_mut(), Accum::Replace, bottom, x.as_ref(), 1.0, Par::Seq);
        let (mut target, mut positions) = (None, Vec::new());
        for (k, row) in panels.rows(p).enumerate() {
            let t = panels.of_column(row);
            if target != Some(t) {
                let of = |j: &usize| self.reached_by[t].partition_point(|other| other < j);
                positions = self.reached_by[p].iter().map(of).collect();
                target = Some(t);
            }
            let block = self.block(t);
            let at_row = row - panels.panel(t).first;
            positions.iter().enumerate().for_each(|(j, &at)| block[(at_row, at)] -= change[(k, j)]);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{Mat, SparseCholesky, SparseMatrix, multiply_transposed, sparse_from_triplets};

    /// A grid of `n`³ nodes with one unknown each, coupled to all neighbours, with weak springs to ground.
    fn grid(n: usize) -> SparseMatrix {
        let near = |x: usize| x.saturating_sub(1)..(x + 2).min(n);
        let mut entries = Vec::new();
        for (x, y, z) in (0..n.pow(3)).map(|i| (i / n / n, i / n % n, i % n)) {
            let own = (x * n + y) * n + z;
            for (u, v, w) in near(x).flat_map(|u| near(y).flat_map(move |v| near(z).map(move |w| (u, v, w)))) {
                let other = (u * n + v) * n + w;
                if other != own {
                    entries.extend([(own, other, -1.0), (own, own, 1.0)]);
                }
            }
            entries.push((own, own, 1e-3));
        }
        sparse_from_triplets(n.pow(3), n.pow(3), &entries).unwrap()
    }

    #[test]
    fn it_is_what_full_solutions_give_with_and_without_dense_blocks() {
        // A chain is factored by columns, a cube by dense blocks.
        let chain: Vec<_> =
            (0..300).flat_map(|i| [(i, i, 2.01), (i, (i + 1) % 300, -1.0), ((i + 1) % 300, i, -1.0)]).collect();
        for (a, blocks) in [(sparse_from_triplets(300, 300, &chain).unwrap(), false), (grid(12), true)] {
            let n = a.nrows();
            let factor = SparseCholesky::factor(&a, "test matrix").unwrap();
            assert_eq!(factor.has_dense_blocks(), blocks);
            for (columns, shapes) in [(1, 0), (7, 3), (70, 5)] {
                // Columns with one to three entries, some of them the same.
                let entry = |j: usize, k: usize| ((131 * (j % 60) + 977 * k) % n, j, 1.0 - 0.4 * k as f64);
                let entries: Vec<_> = (0..columns).flat_map(|j| (0..=j % 3).map(move |k| entry(j, k))).collect();
                let s = sparse_from_triplets(n, columns, &entries).unwrap();
                let d = Mat::from_fn(n, shapes, |i, r| ((i * (r + 2)) % 17) as f64 / 17.0 - 0.4);
                let c = Mat::from_fn(shapes, columns, |r, j| ((3 * r + 5 * j) % 7) as f64 / 7.0 - 0.3);
                let mut b = -(&d * &c);
                entries.iter().for_each(|&(i, j, v)| b[(i, j)] += v);
                let mut x = b.clone();
                factor.solve_many(&mut x);
                let expected = b.transpose() * &x;
                let found = factor.inverse_form(&s, &d, &c);
                let size = (0..columns).map(|j| expected[(j, j)]).fold(0.0, f64::max);
                for (i, j) in (0..columns).flat_map(|i| (0..columns).map(move |j| (i, j))) {
                    assert!((found[(i, j)] - expected[(i, j)]).abs() < 1e-12 * size, "{i} {j}");
                    assert_eq!(found[(i, j)], found[(j, i)]);
                }
                let again = multiply_transposed(&s, &x);
                assert!(shapes > 0 || (0..columns).all(|j| (again[(j, j)] - found[(j, j)]).abs() < 1e-12 * size));
            }
        }
    }
}
