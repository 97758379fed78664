//! Rows that are held by ones: what some programs leave in the place of a row and a column that they have taken out.

use super::FeModel;
use super::assemble::rows_of;

impl FeModel {
    /// Takes out the rows with nothing but a one on both diagonals, in the units of the files; none where no row has
    /// anything beside its diagonal, for those may be masses on springs of one.
    pub(super) fn leave_out_ones(&mut self) {
        let order = self.labels.len();
        let mut alone = vec![true; order];
        for matrix in [&self.stiffness, &self.mass] {
            for (i, j, _) in matrix.entries().filter(|(i, j, _)| i != j) {
                (alone[i], alone[j]) = (false, false);
            }
        }
        let (stiffness, mass) = (self.stiffness.diagonal(), self.mass.diagonal());
        let is_one = |row: usize| alone[row] && stiffness[row] == 1.0 && mass[row] == 1.0;
        if alone.iter().all(|alone| *alone) || !(0..order).any(is_one) {
            return;
        }
        let mut free = 0;
        let to: Vec<Option<usize>> = (0..order)
            .map(|row| {
                (!is_one(row)).then(|| {
                    free += 1;
                    free - 1
                })
            })
            .collect();
        self.stiffness = self.stiffness.placed(&to, free);
        self.mass = self.mass.placed(&to, free);
        self.fixed_mass.iter_mut().for_each(|(row, ..)| *row = to[*row].unwrap_or(*row));
        let rows = std::mem::take(&mut self.labels).into_iter().enumerate();
        let (held, labels): (Vec<_>, Vec<_>) = rows.partition(|(row, _)| to[*row].is_none());
        self.labels = labels.into_iter().map(|(_, label)| label).collect();
        self.held_by_ones = held.into_iter().map(|(_, label)| label).collect();
        self.fixed.extend(self.held_by_ones.iter().copied());
        self.rows = rows_of(&self.labels);
    }
}
