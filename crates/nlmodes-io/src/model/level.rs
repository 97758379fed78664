//! Rows that are held by equal values on both diagonals: what some programs leave in the place of a row and a column
//! that they have taken out.

use super::FeModel;
use super::assemble::rows_of;

impl FeModel {
    /// Takes out the rows with one value on both diagonals, in the units of the files, beside which nothing counts:
    ///
    /// ```text
    /// K_ii = M_ii ,   |K_ij| ≤ ε K_ii ,   |M_ij| ≤ ε M_ii ,   j ≠ i
    /// ```
    ///
    /// The value may be one, a mean of the diagonal, or far above all others (1e30, beside which entries may be left).
    /// A true mass on a spring would have to vibrate with one radian per unit of time to the last digit. None are taken
    /// out where no row has anything beside its diagonal, for those may be such masses.
    pub(super) fn leave_out_level(&mut self) {
        let (stiffness, mass) = (self.stiffness.diagonal(), self.mass.diagonal());
        let alone = self.rows_alone();
        let is_level = |row: usize| alone[row] && stiffness[row] == mass[row] && stiffness[row] > 0.0;
        let order = self.labels.len();
        if alone.iter().all(|alone| *alone) || !(0..order).any(is_level) {
            return;
        }
        let mut free = 0;
        let to: Vec<Option<usize>> = (0..order)
            .map(|row| {
                (!is_level(row)).then(|| {
                    free += 1;
                    free - 1
                })
            })
            .collect();
        self.keep_rows(&to, free);
        self.fixed_mass.iter_mut().for_each(|(row, ..)| *row = to[*row].unwrap_or(*row));
        let rows = std::mem::take(&mut self.labels).into_iter().enumerate();
        let (held, labels): (Vec<_>, Vec<_>) = rows.partition(|(row, _)| to[*row].is_none());
        self.labels = labels.into_iter().map(|(_, label)| label).collect();
        self.held_on_diagonals = held.into_iter().map(|(_, label)| label).collect();
        self.fixed.extend(self.held_on_diagonals.iter().copied());
        self.rows = rows_of(&self.labels);
    }

    /// Of each row whether nothing beside the diagonals of stiffness and mass counts there: what the rounding of the
    /// diagonal swallows does not.
    pub fn rows_alone(&self) -> Vec<bool> {
        let mut alone = vec![true; self.labels.len()];
        for matrix in [&self.stiffness, &self.mass] {
            let diagonal = matrix.diagonal();
            for (i, j, value) in matrix.entries().filter(|(i, j, _)| i != j) {
                for row in [i, j] {
                    alone[row] &= value.abs() <= f64::EPSILON * diagonal[row].abs();
                }
            }
        }
        alone
    }
}
