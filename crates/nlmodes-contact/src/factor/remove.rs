use super::{Factor, offset};

/// Rows treated at once: the rotations of one row form a chain, those of several rows run side by side.
const ABREAST: usize = 4;

impl Factor {
    /// Removes all contacts except those to be kept.
    pub(crate) fn retain(&mut self, keep: impl Fn(usize) -> bool) {
        for position in (0..self.len()).rev() {
            if !keep(self.order[position]) {
                self.remove(position);
            }
        }
    }

    /// Removes the contact in row `position` from the block.
    ///
    /// Deleting a row leaves one entry above the diagonal in each row below it. Plane rotations of neighbouring columns
    /// `j, j + 1` eliminate these; row by row, all earlier rotations are applied and the next one is found.
    pub(crate) fn remove(&mut self, position: usize) {
        let n = self.len();
        self.order.remove(position);
        let mut rotations = std::mem::take(&mut self.rotations);
        rotations.clear();
        let mut i = position + 1;
        while i + ABREAST <= n {
            self.shift_rows::<ABREAST>(i, position, &mut rotations);
            i += ABREAST;
        }
        (i..n).for_each(|i| self.shift_rows::<1>(i, position, &mut rotations));
        self.rotations = rotations;
        self.rows.truncate(offset(n - 1));
        self.diagonal.truncate(n - 1);
        self.inverse_diagonal.truncate(n - 1);
    }

    /// Moves rows `i .. i + R` up by one, one column shorter, and adds the rotations that they need.
    fn shift_rows<const R: usize>(&mut self, i: usize, position: usize, rotations: &mut Vec<(f64, f64)>) {
        let start: [usize; R] = std::array::from_fn(|r| offset(i + r) + position);
        let mut carried = start.map(|at| self.rows[at]);
        for (r, at) in start.iter().enumerate() {
            self.rows.copy_within(offset(i + r)..*at, offset(i + r - 1));
        }
        // A row is always read before the row below overwrites it.
        let write: [usize; R] = std::array::from_fn(|r| offset(i + r - 1) + position);
        for (t, &(cosine, sine)) in rotations.iter().enumerate() {
            for r in 0..R {
                let next = self.rows[start[r] + 1 + t];
                self.rows[write[r] + t] = cosine * carried[r] + sine * next;
                carried[r] = cosine * next - sine * carried[r];
            }
        }
        let before = rotations.len();
        for r in 0..R {
            for (t, &(cosine, sine)) in rotations.iter().enumerate().skip(before) {
                let next = self.rows[start[r] + 1 + t];
                self.rows[write[r] + t] = cosine * carried[r] + sine * next;
                carried[r] = cosine * next - sine * carried[r];
            }
            let length = (carried[r] * carried[r] + self.diagonal[i + r] * self.diagonal[i + r]).sqrt();
            rotations.push((carried[r] / length, self.diagonal[i + r] / length));
            self.diagonal[i + r - 1] = length;
            self.inverse_diagonal[i + r - 1] = 1.0 / length;
        }
    }
}
