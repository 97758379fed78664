use std::collections::HashMap;

use nlmodes_contact::{ContactBody, LcpMatrix};
use nlmodes_linalg::Mat;

use crate::HbmError;

/// The contact problem while one set of contacts is closed: everything is linear in the gaps `y` without contact forces.
#[derive(Debug, Clone)]
pub(crate) struct ClosedSet {
    pub closed: Vec<bool>,
    /// `S = dλ/dy`, c × c, row-major: `λ = S y`.
    pub s: Vec<f64>,
    /// Row i is what must not turn negative, as a combination of `y`: the gap of an open contact, the force of a closed one
    /// times its own compliance (so that both are lengths).
    pub guard: Vec<f64>,
}

impl ClosedSet {
    pub fn new(matrix: &LcpMatrix, closed: &[bool]) -> Result<Self, HbmError> {
        let c = closed.len();
        let s = matrix.sensitivity(closed).map_err(HbmError::Compliance)?;
        let a = matrix.a();
        let gaps = a * &s;
        let identity = |i: usize, j: usize| f64::from(u8::from(i == j));
        let guard = |i: usize, j: usize| if closed[i] { a[(i, i)] * s[(i, j)] } else { gaps[(i, j)] + identity(i, j) };
        Ok(Self { closed: closed.to_vec(), guard: rows(&Mat::from_fn(c, c, guard)), s: rows(&s) })
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

/// The displacements of the contact nodes while one set of contacts is closed, `q_N = b − D b + r`.
#[derive(Debug, Clone)]
pub(crate) struct NodeResponse {
    /// `D = −K_NN⁻¹ W S Wᵀ`, n_N × n_N, row-major.
    pub d: Vec<f64>,
    /// `r = K_NN⁻¹ W S g₀`, n_N.
    pub r: Vec<f64>,
}

impl NodeResponse {
    pub fn new(body: &ContactBody, closed: &[bool]) -> Result<Self, HbmError> {
        let response = body.response(closed).map_err(HbmError::Compliance)?;
        Ok(Self { d: rows(&response.blocked), r: response.offset })
    }
}

fn rows(m: &Mat<f64>) -> Vec<f64> {
    (0..m.nrows()).flat_map(|i| (0..m.ncols()).map(move |j| m[(i, j)])).collect()
}

/// The closed sets met so far; a period has few, and neighbouring iterates share them.
#[derive(Debug, Clone)]
pub(crate) struct SetTable {
    matrix: LcpMatrix,
    sets: Vec<ClosedSet>,
    index: HashMap<Vec<bool>, usize>,
}

impl SetTable {
    /// Index of the set in which all contacts are open.
    pub const OPEN: usize = 0;

    pub fn new(matrix: &LcpMatrix) -> Result<Self, HbmError> {
        let mut table = Self { matrix: matrix.clone(), sets: Vec::new(), index: HashMap::new() };
        table.find(&vec![false; matrix.n_contacts()])?;
        Ok(table)
    }

    pub fn find(&mut self, closed: &[bool]) -> Result<usize, HbmError> {
        if let Some(&i) = self.index.get(closed) {
            return Ok(i);
        }
        self.sets.push(ClosedSet::new(&self.matrix, closed)?);
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
