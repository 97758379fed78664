//! Small square tiles of a matrix, transposed in the cache, so that entries far apart in memory are accessed together.

use std::ops::Range;

use nlmodes_linalg::Mat;

/// Maximum number of rows and columns of a tile.
const SIZE: usize = 32;

/// A square part of a matrix, by columns.
pub(crate) struct Tile {
    columns: [[f64; SIZE]; SIZE],
}

impl Tile {
    /// The transpose of the part of the matrix with these rows and columns.
    pub(crate) fn transposed(matrix: &Mat<f64>, rows: Range<usize>, columns: Range<usize>) -> Self {
        let mut turned = [[0.0; SIZE]; SIZE];
        for (k, column) in columns.enumerate() {
            let part = &matrix.col_as_slice(column)[rows.clone()];
            turned.iter_mut().zip(part).for_each(|(turned, v)| turned[k] = *v);
        }
        Self { columns: turned }
    }

    /// The columns of the tile; the matrix has no entries beyond its last row.
    pub(crate) fn columns(&mut self) -> impl Iterator<Item = &mut [f64; SIZE]> {
        self.columns.iter_mut()
    }

    /// Writes the tile to the part with these rows and columns.
    pub(crate) fn write(&self, matrix: &mut Mat<f64>, rows: Range<usize>, columns: Range<usize>) {
        for (column, entries) in columns.zip(&self.columns) {
            matrix.col_as_slice_mut(column)[rows.clone()].copy_from_slice(&entries[..rows.len()]);
        }
    }

    /// Writes the transpose of the tile to the part with these rows and columns.
    pub(crate) fn write_transposed(&self, matrix: &mut Mat<f64>, rows: Range<usize>, columns: Range<usize>) {
        for (k, column) in columns.enumerate() {
            let part = &mut matrix.col_as_slice_mut(column)[rows.clone()];
            part.iter_mut().zip(&self.columns).for_each(|(v, entries)| *v = entries[k]);
        }
    }
}

/// Rows and columns of all tiles at and below the diagonal of a matrix with `n` rows.
pub(crate) fn pairs(n: usize) -> impl Iterator<Item = (Range<usize>, Range<usize>)> {
    let tile = move |first: usize| first..n.min(first + SIZE);
    (0..n).step_by(SIZE).flat_map(move |i| (0..=i).step_by(SIZE).map(move |j| (tile(i), tile(j))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_turn_a_matrix_of_any_size_round() {
        for n in [1, 31, 32, 33, 70] {
            let matrix = Mat::from_fn(n, n, |i, j| (100 * i + j) as f64);
            let (mut turned, mut same) = (Mat::zeros(n, n), matrix.clone());
            for (rows, columns) in pairs(n) {
                let tile = Tile::transposed(&matrix, columns.clone(), rows.clone());
                tile.write(&mut turned, rows.clone(), columns.clone());
                tile.write_transposed(&mut same, columns.clone(), rows.clone());
                let tile = Tile::transposed(&matrix, rows.clone(), columns.clone());
                tile.write(&mut turned, columns, rows);
            }
            assert_eq!(turned, matrix.transpose());
            assert_eq!(same, matrix);
        }
    }
}
