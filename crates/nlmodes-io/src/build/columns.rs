use super::{Fault, mirrors};
use crate::lower::LowerTriangle;

/// Which part of a symmetric matrix the columns of a file hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stored {
    /// Rows from the diagonal on.
    Lower,
    /// All rows.
    Full,
}

/// Takes column after column, the upper triangle only to compare it: nothing but the final matrix is held.
///
/// When column j comes, its entries above the diagonal are mirror images of entries (j, i) of earlier columns i.
/// Columns come in order, so a cursor in each earlier column is at the first row that has not been compared yet.
pub(crate) struct ColumnBuilder {
    stored: Stored,
    lower: LowerTriangle,
    diagonal: Vec<f64>,
    cursors: Vec<usize>,
}

impl ColumnBuilder {
    pub(crate) fn new(stored: Stored) -> Self {
        let lower = LowerTriangle { column_starts: vec![0], ..LowerTriangle::default() };
        Self { stored, lower, diagonal: Vec::new(), cursors: Vec::new() }
    }

    /// Takes the entries `(row, value)` of the next column, in any order, and leaves them sorted.
    pub(crate) fn push(&mut self, column: &mut [(usize, f64)]) -> Result<(), Fault> {
        let j = self.lower.order();
        if !column.is_sorted_by_key(|entry| entry.0) {
            column.sort_by_key(|entry| entry.0);
        }
        if let Some(two) = column.windows(2).find(|two| two[0].0 == two[1].0) {
            return Err(Fault::Duplicate { row: two[0].0, column: j });
        }
        let above = column.partition_point(|entry| entry.0 < j);
        let (above, below) = column.split_at(above);
        self.diagonal.push(below.first().filter(|entry| entry.0 == j).map_or(0.0, |entry| entry.1));
        if self.stored == Stored::Full {
            above.iter().try_for_each(|&(i, value)| self.compare(i, j, value))?;
        } else if let Some(&(row, value)) = above.iter().find(|entry| entry.1 != 0.0) {
            return Err(Fault::Asymmetric { row, column: j, value, mirrored: 0.0 });
        }
        self.cursors.push(self.lower.rows.len() + usize::from(below.first().is_some_and(|e| e.0 == j && e.1 != 0.0)));
        for &(row, value) in below.iter().filter(|entry| entry.1 != 0.0) {
            self.lower.rows.push(row);
            self.lower.values.push(value);
        }
        self.lower.column_starts.push(self.lower.rows.len());
        Ok(())
    }

    /// Entry (i, j), i < j, against (j, i) of column i.
    fn compare(&mut self, i: usize, j: usize, value: f64) -> Result<(), Fault> {
        if value == 0.0 {
            return Ok(());
        }
        self.pass(i, j)?;
        let at = self.cursors[i];
        let there = at < self.lower.column_starts[i + 1] && self.lower.rows[at] == j;
        let mirrored = if there { self.lower.values[at] } else { 0.0 };
        if !mirrors(value, mirrored, (self.diagonal[i], self.diagonal[j])) {
            return Err(Fault::Asymmetric { row: i, column: j, value, mirrored });
        }
        self.cursors[i] += usize::from(there);
        Ok(())
    }

    /// Moves the cursor of column i to row j; entries passed have no mirror image.
    fn pass(&mut self, i: usize, j: usize) -> Result<(), Fault> {
        while self.cursors[i] < self.lower.column_starts[i + 1] && self.lower.rows[self.cursors[i]] < j {
            let (row, value) = (self.lower.rows[self.cursors[i]], self.lower.values[self.cursors[i]]);
            if !mirrors(value, 0.0, (self.diagonal[i], self.diagonal[row])) {
                return Err(Fault::Asymmetric { row, column: i, value, mirrored: 0.0 });
            }
            self.cursors[i] += 1;
        }
        Ok(())
    }

    pub(crate) fn finish(mut self) -> Result<LowerTriangle, Fault> {
        let order = self.lower.order();
        if self.stored == Stored::Full {
            (0..order).try_for_each(|i| self.pass(i, order))?;
        }
        Ok(self.lower)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn built(stored: Stored, columns: &[&[(usize, f64)]]) -> Result<Vec<(usize, usize, f64)>, Fault> {
        let mut builder = ColumnBuilder::new(stored);
        columns.iter().try_for_each(|column| builder.push(&mut column.to_vec()))?;
        Ok(builder.finish()?.entries().collect())
    }

    #[test]
    fn full_and_lower_columns_give_the_same_matrix() {
        let expected = Ok(vec![(0, 0, 1.0), (2, 0, 4.0), (1, 1, 2.0), (2, 2, 3.0)]);
        let lower: [&[_]; 3] = [&[(2, 4.0), (0, 1.0), (1, 0.0)], &[(1, 2.0)], &[(2, 3.0)]];
        assert_eq!(built(Stored::Lower, &lower), expected);
        let full: [&[_]; 3] = [&[(2, 4.0), (0, 1.0)], &[(1, 2.0)], &[(2, 3.0), (0, 4.0)]];
        assert_eq!(built(Stored::Full, &full), expected);
    }

    #[test]
    fn what_has_no_mirror_image_is_found_on_either_side() {
        let missing_above: [&[_]; 3] = [&[(0, 1.0), (1, 4.0), (2, 5.0)], &[(1, 2.0)], &[(0, 5.0), (2, 3.0)]];
        let fault = Fault::Asymmetric { row: 1, column: 0, value: 4.0, mirrored: 0.0 };
        assert_eq!(built(Stored::Full, &missing_above), Err(fault));
        let missing_below: [&[_]; 2] = [&[(0, 1.0)], &[(0, 4.0), (1, 2.0)]];
        let fault = Fault::Asymmetric { row: 0, column: 1, value: 4.0, mirrored: 0.0 };
        assert_eq!(built(Stored::Full, &missing_below), Err(fault));
        let at_the_end: [&[_]; 2] = [&[(0, 1.0), (1, 4.0)], &[(1, 2.0)]];
        assert!(matches!(built(Stored::Full, &at_the_end), Err(Fault::Asymmetric { row: 1, column: 0, .. })));
        let different: [&[_]; 2] = [&[(0, 1.0), (1, 4.0)], &[(0, 4.1), (1, 2.0)]];
        let fault = Fault::Asymmetric { row: 0, column: 1, value: 4.1, mirrored: 4.0 };
        assert_eq!(built(Stored::Full, &different), Err(fault));
    }

    #[test]
    fn rounding_between_the_triangles_is_no_asymmetry() {
        let rounded: [&[_]; 2] = [&[(0, 1.0), (1, 1e-13)], &[(1, 2.0)]];
        assert!(built(Stored::Full, &rounded).is_ok());
    }
}
