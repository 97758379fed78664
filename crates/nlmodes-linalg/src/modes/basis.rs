//! Lanczos vectors: a growing number of columns.

use faer::linalg::matmul::matmul;
use faer::{Accum, ColRef, MatMut, MatRef, Par};

use crate::Mat;
use crate::threads::{in_pieces, pays, spread};

/// Columns per block of memory: blocks are never moved, so that nothing is stored twice while the basis grows.
const PIECE: usize = 16;

/// Rows rotated at a time.
const ROWS: usize = 2048;

/// Columns of length `n`, M-orthonormal if the caller ensures it.
#[derive(Debug)]
pub(super) struct Basis {
    n: usize,
    pieces: Vec<Mat<f64>>,
    len: usize,
}

impl Basis {
    pub fn new(n: usize) -> Self {
        Self { n, pieces: Vec::new(), len: 0 }
    }

    /// Number of columns.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Appends the columns of `block`.
    pub fn extend(&mut self, block: MatRef<'_, f64>) {
        for j in 0..block.ncols() {
            let at = self.len % PIECE;
            if at == 0 {
                self.pieces.push(Mat::zeros(self.n, PIECE));
            }
            if let Some(piece) = self.pieces.last_mut() {
                piece.col_mut(at).copy_from(block.col(j));
            }
            self.len += 1;
        }
    }

    /// Keeps the first `len` columns.
    pub fn truncate(&mut self, len: usize) {
        self.len = len.min(self.len);
        self.pieces.truncate(self.len.div_ceil(PIECE));
    }

    pub fn column(&self, j: usize) -> ColRef<'_, f64> {
        self.pieces[j / PIECE].col(j % PIECE)
    }

    /// `Qᵀ X`.
    pub fn overlap(&self, x: MatRef<'_, f64>) -> Mat<f64> {
        let mut overlap = Mat::zeros(self.len, x.ncols());
        let mut rest = overlap.as_mut();
        let mut shares = Vec::new();
        for (_, piece) in self.filled() {
            let (share, others) = rest.split_at_row_mut(piece.ncols());
            shares.push((share, piece));
            rest = others;
        }
        let product = |(to, piece): (MatMut<'_, f64>, MatRef<'_, f64>)| {
            matmul(to, Accum::Replace, piece.transpose(), x, 1.0, Par::Seq);
        };
        if pays(self.n * self.len * x.ncols()) {
            spread(shares, || (), |(), share| product(share));
        } else {
            shares.into_iter().for_each(product);
        }
        overlap
    }

    /// `X − Q C`, in place.
    pub fn take_out(&self, coefficients: &Mat<f64>, x: &mut Mat<f64>) {
        let take = |(row, mut x): (usize, MatMut<'_, f64>)| {
            for (first, piece) in self.filled() {
                let share = coefficients.subrows(first, piece.ncols());
                let rows = piece.subrows(row, x.nrows());
                matmul(&mut x, Accum::Add, rows, share, -1.0, Par::Seq);
            }
        };
        if pays(self.n * self.len * x.ncols()) {
            spread(in_pieces(x.as_mut()), || (), |(), piece| take(piece));
        } else {
            take((0, x.as_mut()));
        }
    }

    /// `Q C`, with as many of the columns of `Q` as `C` has rows, in place of `Q`, without a second table.
    pub fn turned(mut self, c: MatRef<'_, f64>) -> Self {
        let kept = c.ncols();
        self.len = c.nrows();
        self.pieces.truncate(self.len.div_ceil(PIECE));
        for first in (0..self.n).step_by(ROWS) {
            let count = ROWS.min(self.n - first);
            let mut sum = Mat::<f64>::zeros(count, kept);
            for (column, piece) in self.filled() {
                let share = c.subrows(column, piece.ncols());
                matmul(sum.as_mut(), Accum::Add, piece.subrows(first, count), share, 1.0, Par::Seq);
            }
            for j in 0..kept {
                self.pieces[j / PIECE].col_mut(j % PIECE).subrows_mut(first, count).copy_from(sum.col(j));
            }
        }
        self.truncate(kept);
        self
    }

    /// Appends the columns of `other`.
    pub fn join(&mut self, other: Self) {
        if self.len.is_multiple_of(PIECE) {
            self.len += other.len;
            self.pieces.extend(other.pieces);
            return;
        }
        let mut left = other.len;
        for piece in other.pieces {
            let count = PIECE.min(left);
            self.extend(piece.subcols(0, count));
            left -= count;
        }
    }

    /// Index of the first column of each block, and its columns.
    fn filled(&self) -> impl Iterator<Item = (usize, MatRef<'_, f64>)> {
        self.pieces.iter().enumerate().map(|(i, piece)| {
            let first = i * PIECE;
            (first, piece.subcols(0, PIECE.min(self.len - first)))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_those_of_one_matrix_across_the_pieces() {
        let (n, count) = (50, 2 * PIECE + 5);
        let whole = Mat::from_fn(n, count, |i, j| ((3 * i + 5 * j) % 7) as f64 - 3.0);
        let mut basis = Basis::new(n);
        for first in (0..count).step_by(3) {
            basis.extend(whole.subcols(first, 3.min(count - first)));
        }
        assert_eq!(basis.len(), count);
        assert!((0..n).all(|i| basis.column(PIECE)[i] == whole[(i, PIECE)]));
        let x = Mat::from_fn(n, 2, |i, j| ((i + 4 * j) % 5) as f64 - 2.0);
        let overlap = basis.overlap(x.as_ref());
        assert_eq!(overlap, whole.transpose() * &x);
        let mut rest = x.clone();
        basis.take_out(&overlap, &mut rest);
        assert_eq!(rest, &x - &whole * &overlap);
    }

    /// The first `count` columns of the blocks.
    fn filled(n: usize, count: usize, value: impl Fn(usize, usize) -> f64) -> Basis {
        let mut basis = Basis::new(n);
        basis.extend(Mat::from_fn(n, count, value).as_ref());
        basis
    }

    #[test]
    fn combinations_take_the_place_of_the_columns_in_any_number_of_rows_and_pieces() {
        for (n, rows, kept) in [(7, 1, 1), (ROWS + 9, PIECE + 4, PIECE + 2), (2 * ROWS, 2 * PIECE + 3, 2), (40, 9, 0)] {
            let value = |i: usize, j: usize| ((3 * i + 5 * j) % 7) as f64 - 3.0;
            let c = Mat::from_fn(rows, kept, |i, j| ((i + 2 * j) % 3) as f64 - 1.0);
            // The column beyond the number of coefficients is not used.
            let turned = filled(n, rows + 1, value).turned(c.as_ref());
            let expected = Mat::from_fn(n, rows, value) * &c;
            assert_eq!(turned.len(), kept);
            assert!((0..kept).all(|j| (0..n).all(|i| turned.column(j)[i] == expected[(i, j)])));
        }
    }

    #[test]
    fn joined_bases_have_the_columns_of_both_in_order() {
        for (first, second) in [(0, 5), (PIECE, PIECE + 3), (3, 2 * PIECE + 1), (4, 0)] {
            let value = |i: usize, j: usize| (i + 10 * j) as f64;
            let mut both = filled(6, first, value);
            both.join(filled(6, second, |i, j| value(i, first + j)));
            assert_eq!(both.len(), first + second);
            assert!((0..first + second).all(|j| (0..6).all(|i| both.column(j)[i] == value(i, j))));
            both.extend(Mat::from_fn(6, 1, |_, _| -1.0).as_ref());
            assert_eq!(both.column(first + second)[3], -1.0);
        }
    }
}
