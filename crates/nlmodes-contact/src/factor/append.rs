use super::{
    Factor,
    begin::MANY,
    offset,
    triangle::{forward, forward_all},
};
use crate::{kernel, scaled::Scaled};

/// Rows found at once.
const BLOCK: usize = 8;

impl Factor {
    /// Adds a contact unless it depends on the block. Returns whether it was added.
    pub(crate) fn append(&mut self, matrix: &Scaled, contact: usize) -> bool {
        let noise = self.dependence(matrix, contact);
        self.push(matrix, contact, 0.0, noise) > noise
    }

    /// Adds a contact with `slack` added to its diagonal if the pivot is positive. Returns the pivot.
    pub(crate) fn try_append(&mut self, matrix: &Scaled, contact: usize, slack: f64) -> f64 {
        self.push(matrix, contact, slack, 0.0)
    }

    fn push(&mut self, matrix: &Scaled, contact: usize, slack: f64, noise: f64) -> f64 {
        let (n, column) = (self.len(), matrix.column(contact));
        let start = offset(n);
        self.rows.truncate(start);
        self.rows.extend(self.order.iter().map(|&i| column[i]));
        let (above, row) = self.rows.split_at_mut(start);
        forward(above, &self.inverse_diagonal, row);
        let pivot = column[contact] + slack - kernel::dot(row, row);
        if pivot > noise {
            self.accept(contact, pivot);
        } else {
            self.rows.truncate(start);
        }
        pivot
    }

    /// Adds the row `entries` of a matrix, up to its diagonal; a pivot that is not positive is replaced by a positive
    /// one.
    pub(super) fn append_row(&mut self, entries: &[f64]) {
        let (n, start) = (self.len(), offset(self.len()));
        self.rows.truncate(start);
        self.rows.extend_from_slice(&entries[..n]);
        let (above, row) = self.rows.split_at_mut(start);
        forward(above, &self.inverse_diagonal, row);
        let pivot = entries[n] - kernel::dot(row, row);
        self.accept(n, pivot.max(f64::EPSILON * entries[n]));
    }

    /// Adds all contacts that do not depend on the block or on previous ones.
    pub(crate) fn append_all(&mut self, matrix: &Scaled, contacts: &[usize]) {
        if self.len() == 0 && contacts.len() >= MANY && self.begin(matrix, contacts) {
            return;
        }
        let mut rest = contacts;
        while rest.len() > 1 {
            let block = &rest[..rest.len().min(BLOCK)];
            let added = self.append_block(matrix, block);
            rest = &rest[added..];
            if added < block.len() {
                // The next one is dependent, perhaps only by the rounding of the block.
                self.append(matrix, rest[0]);
                rest = &rest[1..];
            }
        }
        rest.iter().for_each(|&contact| {
            self.append(matrix, contact);
        });
    }

    /// Adds contacts until one depends on the previous ones. Returns the number added.
    fn append_block(&mut self, matrix: &Scaled, contacts: &[usize]) -> usize {
        let n = self.len();
        self.rows.resize(offset(n + contacts.len()), 0.0);
        let (above, mut below) = self.rows.split_at_mut(offset(n));
        let mut new: [&mut [f64]; BLOCK] = Default::default();
        for (k, &contact) in contacts.iter().enumerate() {
            let (row, rest) = below.split_at_mut(n + k);
            let column = matrix.column(contact);
            row[..n].iter_mut().zip(&self.order).for_each(|(entry, &i)| *entry = column[i]);
            (new[k], below) = (row, rest);
        }
        forward_all(above, &self.inverse_diagonal, &mut new[..contacts.len()]);
        let added = contacts.iter().enumerate().take_while(|(k, _)| self.finish_row(matrix, contacts, n, *k)).count();
        self.rows.truncate(offset(n + added));
        added
    }

    /// The entries of row `n + k` that couple it to the rows of its own block, and its pivot. False if it is dependent.
    fn finish_row(&mut self, matrix: &Scaled, contacts: &[usize], n: usize, k: usize) -> bool {
        let column = matrix.column(contacts[k]);
        let (above, row) = self.rows.split_at_mut(offset(n + k));
        for (l, contact) in contacts[..k].iter().enumerate() {
            let other = &above[offset(n + l)..offset(n + l) + n + l];
            row[n + l] = (column[*contact] - kernel::dot(other, &row[..n + l])) * self.inverse_diagonal[n + l];
        }
        let pivot = column[contacts[k]] - kernel::dot(&row[..n + k], &row[..n + k]);
        let independent = pivot > self.dependence(matrix, contacts[k]);
        if independent {
            self.accept(contacts[k], pivot);
        }
        independent
    }

    pub(super) fn accept(&mut self, contact: usize, pivot: f64) {
        self.order.push(contact);
        self.diagonal.push(pivot.sqrt());
        self.inverse_diagonal.push(1.0 / pivot.sqrt());
    }
}
