use std::collections::HashMap;

use nlmodes_linalg::Mat;

use crate::{CondensedStructure, HbmError};

/// The contact problem while one set of contacts is closed: everything is linear in `y = Wᵀ b + g₀`.
#[derive(Debug, Clone)]
pub(crate) struct ClosedSet {
    pub closed: Vec<bool>,
    /// `S = dλ/dy`, c × c, row-major: `λ = S y`.
    pub s: Vec<f64>,
    /// Row i is what must not turn negative, as a combination of `y`: the gap of an open contact, the force of a closed one
    /// times its own compliance (so that both are lengths).
    pub guard: Vec<f64>,
    /// `D = −K_NN⁻¹ W S Wᵀ`, n_N × n_N, row-major: `q_N = b − D b + r`.
    pub d: Vec<f64>,
    /// `r = K_NN⁻¹ W S g₀`, n_N.
    pub r: Vec<f64>,
}

impl ClosedSet {
    pub fn new(structure: &CondensedStructure, closed: &[bool]) -> Result<Self, HbmError> {
        let c = closed.len();
        let response = structure.body.response(closed).map_err(HbmError::Compliance)?;
        let a = structure.body.matrix().a();
        let guard =
            |i: usize, j: usize| if closed[i] { a[(i, i)] * response.lambda[(i, j)] } else { response.gaps[(i, j)] };
        let (s, d) = (rows(&response.lambda), rows(&response.blocked));
        Ok(Self { closed: closed.to_vec(), s, guard: rows(&Mat::from_fn(c, c, guard)), d, r: response.offset })
    }

    /// Guard `i` at the given `y`.
    pub fn guard_value(&self, i: usize, y: &[f64]) -> f64 {
        let c = y.len();
        self.guard[i * c..(i + 1) * c].iter().zip(y).map(|(g, y)| g * y).sum()
    }

    /// True if all guards are positive: gaps where open, forces where closed.
    pub fn is_solution(&self, y: &[f64]) -> bool {
        self.guard.chunks_exact(y.len()).all(|row| row.iter().zip(y).map(|(g, y)| g * y).sum::<f64>() > 0.0)
    }

    /// Force of contact `i` at the given `y`.
    pub fn force(&self, i: usize, y: &[f64]) -> f64 {
        let c = y.len();
        self.s[i * c..(i + 1) * c].iter().zip(y).map(|(s, y)| s * y).sum()
    }

    pub fn is_open(&self) -> bool {
        !self.closed.contains(&true)
    }
}

fn rows(m: &Mat<f64>) -> Vec<f64> {
    (0..m.nrows()).flat_map(|i| (0..m.ncols()).map(move |j| m[(i, j)])).collect()
}

/// The closed sets met so far; a period has few, and neighbouring iterates share them.
#[derive(Debug, Clone)]
pub(crate) struct SetTable {
    sets: Vec<ClosedSet>,
    index: HashMap<Vec<bool>, usize>,
}

impl SetTable {
    /// Index of the set in which all contacts are open.
    pub const OPEN: usize = 0;

    pub fn new(structure: &CondensedStructure) -> Result<Self, HbmError> {
        let mut table = Self { sets: Vec::new(), index: HashMap::new() };
        table.find(structure, &vec![false; structure.n_contacts()])?;
        Ok(table)
    }

    pub fn find(&mut self, structure: &CondensedStructure, closed: &[bool]) -> Result<usize, HbmError> {
        if let Some(&i) = self.index.get(closed) {
            return Ok(i);
        }
        self.sets.push(ClosedSet::new(structure, closed)?);
        self.index.insert(closed.to_vec(), self.sets.len() - 1);
        Ok(self.sets.len() - 1)
    }

    pub fn get(&self, i: usize) -> &ClosedSet {
        &self.sets[i]
    }

    pub fn len(&self) -> usize {
        self.sets.len()
    }
}
