use nlmodes_linalg::{Digits, LinalgError, SparseMatrix, sparse_from_columns};

/// Each unknown in terms `(k, T_ik)` of others, `q_i = Σ T_ik p_k`.
pub(crate) type Motion = Vec<Vec<(usize, f64)>>;

/// The lower triangle of a symmetric matrix, diagonal included, in compressed columns.
///
/// `values[p]`, `column_starts[j] ≤ p < column_starts[j + 1]`, is in row `rows[p] ≥ j` of column `j`; rows ascend
/// within a column, none is stored twice, no stored value is zero.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LowerTriangle {
    pub(crate) column_starts: Vec<usize>,
    pub(crate) rows: Vec<usize>,
    pub(crate) values: Vec<f64>,
}

impl LowerTriangle {
    /// Number of rows, and of columns.
    pub fn order(&self) -> usize {
        self.column_starts.len().saturating_sub(1)
    }

    /// Number of stored entries.
    pub fn n_entries(&self) -> usize {
        self.values.len()
    }

    /// The stored entries `(row, column, value)`, column by column.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        (0..self.order()).flat_map(move |j| self.column(j).map(move |(i, value)| (i, j, value)))
    }

    /// The digits that its entries show.
    pub fn digits(&self) -> Digits {
        Digits::of(self.values.iter().copied())
    }

    /// Rows and values of a column.
    pub(crate) fn column(&self, j: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.column_starts[j]..self.column_starts[j + 1];
        self.rows[range.clone()].iter().copied().zip(self.values[range].iter().copied())
    }

    /// The diagonal, zeros included.
    pub fn diagonal(&self) -> Vec<f64> {
        (0..self.order())
            .map(|j| self.column(j).next().filter(|(i, _)| *i == j).map_or(0.0, |(_, value)| value))
            .collect()
    }

    /// The entry in row `i` and column `j` of the symmetric matrix; zero where none is stored.
    pub fn get(&self, i: usize, j: usize) -> f64 {
        let (i, j) = (i.max(j), i.min(j));
        let range = self.column_starts[j]..self.column_starts[j + 1];
        self.rows[range.clone()].binary_search(&i).map_or(0.0, |at| self.values[range.start + at])
    }

    /// Multiplies entry `(i, j)` by `factor(i, j)`, which must be finite, symmetric and not zero.
    pub fn scale(&mut self, factor: impl Fn(usize, usize) -> f64) {
        for j in 0..self.order() {
            for at in self.column_starts[j]..self.column_starts[j + 1] {
                self.values[at] *= factor(self.rows[at], j);
            }
        }
    }

    /// The part of rows and columns `k` with a place `to[k]`, in a matrix of `order` rows. Places ascend with `k`.
    pub(crate) fn placed(&self, to: &[Option<usize>], order: usize) -> Self {
        let mut counts = vec![0; order + 1];
        let (mut rows, mut values) = (Vec::new(), Vec::new());
        for j in 0..self.order() {
            let Some(new_j) = to[j] else { continue };
            for (i, value) in self.column(j) {
                if let Some(new_i) = to[i] {
                    counts[new_j + 1] += 1;
                    rows.push(new_i);
                    values.push(value);
                }
            }
        }
        for j in 0..order {
            counts[j + 1] += counts[j];
        }
        Self { column_starts: counts, rows, values }
    }

    /// `Tᵀ A T` with `q_i = Σ T_ik p_k`, of which `motion[i]` has the terms `(k, T_ik)`; as many unknowns as before.
    pub(crate) fn congruent(&self, motion: &Motion) -> Self {
        let n = self.order();
        let mut columns: Vec<Vec<(usize, f64)>> = vec![Vec::new(); n];
        for (i, j, value) in self.entries() {
            for &(k, of_i) in &motion[i] {
                for &(l, of_j) in &motion[j] {
                    // An entry beside the diagonal represents its mirror image too, of which one triangle is kept.
                    let twice = if i != j && k == l { 2.0 } else { 1.0 };
                    if i != j || k >= l {
                        columns[k.min(l)].push((k.max(l), twice * of_i * of_j * value));
                    }
                }
            }
        }
        let mut new = Self { column_starts: vec![0], ..Self::default() };
        for mut column in columns {
            column.sort_by_key(|(row, _)| *row);
            for same in column.chunk_by(|a, b| a.0 == b.0) {
                let sum: f64 = same.iter().map(|(_, value)| value).sum();
                // What rounding leaves of terms that cancel would be an entry where there is none.
                let rounding = f64::EPSILON * same.iter().map(|(_, value)| value.abs()).sum::<f64>();
                if sum.abs() > rounding {
                    new.rows.push(same[0].0);
                    new.values.push(sum);
                }
            }
            new.column_starts.push(new.rows.len());
        }
        new
    }

    /// The whole symmetric matrix, both triangles.
    ///
    /// # Errors
    /// [`LinalgError`] if there is no memory for it.
    pub fn symmetric(&self) -> Result<SparseMatrix, LinalgError> {
        let n = self.order();
        let mut starts = vec![0; n + 1];
        for (i, j, _) in self.entries() {
            starts[j + 1] += 1;
            if i != j {
                starts[i + 1] += 1;
            }
        }
        for j in 0..n {
            starts[j + 1] += starts[j];
        }
        let mut next = starts.clone();
        let (mut rows, mut values) = (vec![0; starts[n]], vec![0.0; starts[n]]);
        let mut put = |i: usize, j: usize, value: f64| {
            (rows[next[j]], values[next[j]]) = (i, value);
            next[j] += 1;
        };
        // Row j of the upper triangle is column j of the lower: columns before j have put theirs above the diagonal
        // when j's turn comes.
        for (i, j, value) in self.entries() {
            put(i, j, value);
            if i != j {
                put(j, i, value);
            }
        }
        sparse_from_columns(n, n, starts, rows, values)
    }

    /// `y = A x` of the symmetric matrix.
    ///
    /// # Panics
    /// If the lengths are not the order.
    pub fn multiply(&self, x: &[f64], y: &mut [f64]) {
        assert_eq!((x.len(), y.len()), (self.order(), self.order()), "lengths of y = A x");
        y.fill(0.0);
        for (i, j, value) in self.entries() {
            y[i] += value * x[j];
            if i != j {
                y[j] += value * x[i];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> LowerTriangle {
        // 2 -1  0
        //-1  2  3
        // 0  3  0
        LowerTriangle { column_starts: vec![0, 2, 4, 4], rows: vec![0, 1, 1, 2], values: vec![2.0, -1.0, 2.0, 3.0] }
    }

    #[test]
    fn both_triangles_agree_with_hand_calculation() {
        let full = sample().symmetric().unwrap();
        let dense = [[2.0, -1.0, 0.0], [-1.0, 2.0, 3.0], [0.0, 3.0, 0.0]];
        for (i, row) in dense.iter().enumerate() {
            for (j, value) in row.iter().enumerate() {
                assert_eq!(full.get(i, j).copied().unwrap_or(0.0), *value);
                assert_eq!(sample().get(i, j), *value);
            }
        }
        let mut y = [0.0; 3];
        sample().multiply(&[1.0, 2.0, 3.0], &mut y);
        assert_eq!(y, [0.0, 12.0, 6.0]);
        assert_eq!(sample().diagonal(), [2.0, 2.0, 0.0]);
    }

    #[test]
    fn a_part_keeps_its_entries() {
        let part = sample().placed(&[None, Some(1), Some(2)], 4);
        assert_eq!(part.entries().collect::<Vec<_>>(), [(1, 1, 2.0), (2, 1, 3.0)]);
        assert_eq!(part.order(), 4);
    }
}
