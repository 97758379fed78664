use nlmodes_linalg::{Mat, max_norm};

use super::structure::ModalStructure;

/// The distinct directions in which contacts move: stops that face each other share one.
pub(crate) struct Directions {
    /// The first contact of each direction.
    pub first: Vec<usize>,
    /// Direction of each contact, and its motion over that of the first one.
    pub of_contact: Vec<(usize, f64)>,
}

/// Relative difference up to which two directions are one.
const SAME: f64 = 1e-11;

/// Pivot over the diagonal below which a compliance is singular.
const SINGULAR: f64 = 1e-9;

impl Directions {
    pub fn of(structure: &ModalStructure) -> Self {
        let (mut first, mut of_contact) = (Vec::<usize>::new(), Vec::new());
        for i in 0..structure.n_contacts() {
            let known = first.iter().enumerate().find_map(|(d, &r)| Some((d, ratio(structure, i, r)?)));
            of_contact.push(known.unwrap_or((first.len(), 1.0)));
            if known.is_none() {
                first.push(i);
            }
        }
        Self { first, of_contact }
    }

    /// Whether any motion of the directions leaves the contact problem solvable: their compliance is regular.
    pub fn are_independent(&self, structure: &ModalStructure) -> bool {
        let (a, n) = (structure.compliance().a(), self.first.len());
        let mut m = Mat::from_fn(n, n, |i, j| a[(self.first[i], self.first[j])]);
        for k in 0..n {
            if m[(k, k)] <= SINGULAR * a[(self.first[k], self.first[k])] {
                return false;
            }
            for i in k + 1..n {
                let factor = m[(i, k)] / m[(k, k)];
                (k..n).for_each(|j| m[(i, j)] -= factor * m[(k, j)]);
            }
        }
        true
    }
}

/// Motion of contact `i` over that of `r`, where the one follows from the other.
fn ratio(structure: &ModalStructure, i: usize, r: usize) -> Option<f64> {
    let (rows, a) = (structure.rows(), structure.compliance().a());
    let body = |i: usize, j: usize| a[(i, j)] - if i == j { structure.stop_compliance()[i] } else { 0.0 };
    let m = structure.n_modes();
    let square: f64 = (0..m).map(|k| rows[(r, k)].powi(2)).sum();
    let factor = (0..m).map(|k| rows[(i, k)] * rows[(r, k)]).sum::<f64>() / square;
    let size = |j: usize| max_norm((0..m).map(|k| rows[(j, k)]));
    let same_modes = (0..m).all(|k| (rows[(i, k)] - factor * rows[(r, k)]).abs() <= SAME * size(i));
    let still = a[(r, r)].abs() * SAME;
    let same_statics = (body(i, r) - factor * body(r, r)).abs() <= still * factor.abs()
        && (body(i, i) - factor * factor * body(r, r)).abs() <= still * factor * factor;
    (factor.is_finite() && factor != 0.0 && same_modes && same_statics).then_some(factor)
}
