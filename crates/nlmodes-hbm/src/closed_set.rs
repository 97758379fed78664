use std::collections::HashMap;

use nlmodes_contact::LcpMatrix;

use crate::HbmError;

/// The contact problem while one set of contacts is closed: everything is linear in the gaps `y` without contact
/// forces.
///
/// Only the gaps of the k closed contacts make forces: what belongs to them is kept, c × k numbers.
#[derive(Debug, Clone)]
pub(crate) struct ClosedSet {
    pub closed: Vec<bool>,
    /// The closed contacts, ascending.
    pub active: Vec<usize>,
    /// `S = dλ/dy` of the closed contacts, k × k, row-major: `λ = S y`.
    s: Vec<f64>,
    /// Row i is what must not turn negative, as a combination of the closed contacts' `y`, c × k: the gap of an open
    /// contact without its own `y`, the force of a closed one times its own compliance (so that both are lengths).
    guard: Vec<f64>,
}

impl ClosedSet {
    pub fn new(matrix: &LcpMatrix, closed: &[bool]) -> Result<Self, HbmError> {
        let derivative = matrix.sensitivity(closed).map_err(HbmError::Compliance)?;
        let active: Vec<usize> = (0..closed.len()).filter(|i| closed[*i]).collect();
        let (a, k) = (matrix.a(), active.len());
        let s: Vec<f64> = active.iter().flat_map(|i| active.iter().map(|j| derivative[(*i, *j)])).collect();
        let mut guard = vec![0.0; closed.len() * k];
        for (i, row) in guard.chunks_exact_mut(k.max(1)).enumerate() {
            for (forces, l) in s.chunks_exact(k).zip(&active) {
                // What a closed contact yields to the others' forces is not its guard: its own force is.
                let weight = if closed[i] && i != *l { 0.0 } else { a[(i, *l)] };
                if weight != 0.0 {
                    row.iter_mut().zip(forces).for_each(|(g, s)| *g += weight * s);
                }
            }
        }
        Ok(Self { closed: closed.to_vec(), active, s, guard })
    }

    /// Row i of `S`, with the contacts that its entries are about; nothing for an open contact.
    pub fn force_row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + Clone {
        let (k, at) = (self.active.len(), self.active.binary_search(&i));
        let row = at.map_or(&[][..], |at| &self.s[at * k..(at + 1) * k]);
        self.active.iter().copied().zip(row.iter().copied())
    }

    /// Row i of the guards, with the contacts that its entries are about.
    pub fn guard_row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + Clone {
        let k = self.active.len();
        let own = (!self.closed[i]).then_some((i, 1.0));
        own.into_iter().chain(self.active.iter().copied().zip(self.guard[i * k..(i + 1) * k].iter().copied()))
    }

    /// Row i of the guards for all contacts, c.
    pub fn whole_guard(&self, i: usize) -> Vec<f64> {
        let mut row = vec![0.0; self.closed.len()];
        self.guard_row(i).for_each(|(j, g)| row[j] += g);
        row
    }

    /// Guard `i` at the given `y`.
    pub fn guard_value(&self, i: usize, y: &[f64]) -> f64 {
        self.guard_row(i).map(|(j, g)| g * y[j]).sum()
    }

    /// True if all guards are positive: gaps where open, forces where closed.
    pub fn is_solution(&self, y: &[f64]) -> bool {
        (0..y.len()).all(|i| self.guard_value(i, y) > 0.0)
    }

    /// Force of contact `i` at the given `y`.
    pub fn force(&self, i: usize, y: &[f64]) -> f64 {
        self.force_row(i).map(|(j, s)| s * y[j]).sum()
    }

    pub fn is_open(&self) -> bool {
        self.active.is_empty()
    }

    /// Memory of its numbers, bytes.
    fn bytes(&self) -> usize {
        (self.s.len() + self.guard.len()) * size_of::<f64>()
    }
}

/// The closed sets met so far; a period has few, and neighbouring iterates share them.
#[derive(Debug, Clone)]
pub(crate) struct SetTable {
    matrix: LcpMatrix,
    sets: Vec<ClosedSet>,
    index: HashMap<Vec<bool>, usize>,
    bytes: usize,
}

impl SetTable {
    /// Index of the set in which all contacts are open.
    pub const OPEN: usize = 0;

    pub fn new(matrix: &LcpMatrix) -> Result<Self, HbmError> {
        let mut table = Self { matrix: matrix.clone(), sets: Vec::new(), index: HashMap::new(), bytes: 0 };
        table.find(&vec![false; matrix.n_contacts()])?;
        Ok(table)
    }

    pub fn find(&mut self, closed: &[bool]) -> Result<usize, HbmError> {
        if let Some(&i) = self.index.get(closed) {
            return Ok(i);
        }
        let set = ClosedSet::new(&self.matrix, closed)?;
        self.bytes += set.bytes();
        self.sets.push(set);
        self.index.insert(closed.to_vec(), self.sets.len() - 1);
        Ok(self.sets.len() - 1)
    }

    pub fn get(&self, i: usize) -> &ClosedSet {
        &self.sets[i]
    }

    pub fn len(&self) -> usize {
        self.sets.len()
    }

    /// Memory of all sets, bytes.
    pub fn bytes(&self) -> usize {
        self.bytes
    }

    /// Forgets all sets but the one in which all contacts are open.
    pub fn clear(&mut self) {
        self.sets.truncate(1);
        self.bytes = self.sets.iter().map(ClosedSet::bytes).sum();
        self.index.retain(|_, number| *number == Self::OPEN);
    }
}
