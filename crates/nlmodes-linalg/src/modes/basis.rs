//! Lanczos vectors: columns that grow in number.

use faer::linalg::matmul::matmul;
use faer::{Accum, ColRef, MatRef, Par};

use crate::Mat;

/// Columns of one piece of memory: pieces are never moved, so that nothing is in memory twice while the basis grows.
const PIECE: usize = 32;

/// Columns of length `n`, M-orthonormal where those who add them see to it.
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

    pub fn column(&self, j: usize) -> ColRef<'_, f64> {
        self.pieces[j / PIECE].col(j % PIECE)
    }

    /// `Qᵀ X`.
    pub fn overlap(&self, x: MatRef<'_, f64>) -> Mat<f64> {
        let mut overlap = Mat::zeros(self.len, x.ncols());
        for (first, piece) in self.filled() {
            let to = overlap.subrows_mut(first, piece.ncols());
            matmul(to, Accum::Replace, piece.transpose(), x, 1.0, Par::Seq);
        }
        overlap
    }

    /// `X − Q C`, in place.
    pub fn take_out(&self, coefficients: &Mat<f64>, x: &mut Mat<f64>) {
        for (first, piece) in self.filled() {
            let share = coefficients.subrows(first, piece.ncols());
            matmul(x.as_mut(), Accum::Add, piece, share, -1.0, Par::Seq);
        }
    }

    /// `Q C`, with as many of the columns of `Q` as `C` has rows.
    pub fn combine(&self, coefficients: MatRef<'_, f64>) -> Mat<f64> {
        let mut sum = Mat::zeros(self.n, coefficients.ncols());
        for (first, piece) in self.filled() {
            let count = piece.ncols().min(coefficients.nrows().saturating_sub(first));
            let share = coefficients.subrows(first.min(coefficients.nrows()), count);
            matmul(sum.as_mut(), Accum::Add, piece.subcols(0, count), share, 1.0, Par::Seq);
        }
        sum
    }

    /// Index of the first column of each piece, and its columns.
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
        for rows in [1, PIECE, PIECE + 4, count] {
            let part = overlap.subrows(0, rows);
            assert_eq!(basis.combine(part), whole.subcols(0, rows) * part);
        }
    }
}
