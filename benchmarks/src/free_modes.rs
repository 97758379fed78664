//! A structure in its lowest modes with open contacts, and in the static flexibility of all others.

use nlmodes::linalg::{DenseLu, Mat, SparseCholesky, Triplet, multiply, sparse_from_triplets};
use nlmodes::model::{Contact, Dof, DofContact, DofKind, MasslessContactModel, StructuralModel, linear_modes};

use crate::Failure;

/// Share of the contacts in a mode, relative, below which the mode leaves them at rest.
const REST: f64 = 1e-9;

/// The reduction of a structure with massless contact nodes to `m` modes:
///
/// ```text
/// q = Φ η + X λ ,   η̈ + Λ η = Φ_Nᵀ λ ,   q_N = Φ_N η + R λ
/// X = (K⁻¹ − Φ Λ⁻¹ Φᵀ) I_N ,   R = X_N
/// ```
///
/// with modes `Φ` of the structure with open contacts. It has their frequencies, the statics of the whole structure,
/// and no mass at its contact coordinates: `λ = R⁻¹ (q_N − Φ_N η)` is their equation. Modes that leave the contacts at
/// rest are left out.
pub struct FreeModes {
    /// Degrees of freedom `η`, then the contact degrees of freedom.
    pub model: StructuralModel,
    shapes: Mat<f64>,
    flexible: Mat<f64>,
    stiffness: DenseLu,
    contact_dofs: Vec<usize>,
    available: usize,
}

impl FreeModes {
    /// The lowest `count` modes that move a contact.
    ///
    /// # Errors
    /// If the structure can move as a rigid body, or has no such modes.
    pub fn new(full: &MasslessContactModel, count: usize) -> Result<Self, Failure> {
        let modes = linear_modes(full.mass(), full.stiffness(), full.dofs().len())?;
        let at = full.contact_dofs();
        let moved = |k: usize| at.iter().fold(0.0_f64, |most, &dof| most.max(modes.shapes[(dof, k)].abs()));
        let largest = (0..modes.omega.len()).map(moved).fold(0.0, f64::max);
        let mut kept: Vec<usize> = (0..modes.omega.len()).filter(|&k| moved(k) > REST * largest).collect();
        let available = kept.len();
        if available < count {
            return Err(format!("{available} modes move a contact, {count} are wanted").into());
        }
        kept.truncate(count);
        let lambda: Vec<f64> = kept.iter().map(|&k| modes.omega[k].powi(2)).collect();
        let (n, m, n_n) = (full.dofs().len(), count, at.len());
        let shapes = Mat::from_fn(n, m, |i, k| modes.shapes[(i, kept[k])]);
        let mut flexible = Mat::from_fn(n, n_n, |i, d| if i == at[d] { 1.0 } else { 0.0 });
        SparseCholesky::factor(full.stiffness(), "stiffness with open contacts")?.solve_many(&mut flexible);
        for d in 0..n_n {
            for i in 0..n {
                flexible[(i, d)] -= (0..m).map(|k| shapes[(i, k)] * shapes[(at[d], k)] / lambda[k]).sum::<f64>();
            }
        }
        let symmetric = |i: usize, j: usize| 0.5 * (flexible[(at[i], j)] + flexible[(at[j], i)]);
        let stiffness = DenseLu::factor(&Mat::from_fn(n_n, n_n, symmetric))?;
        let model = matrices(full, &lambda, &shapes, &stiffness)?;
        Ok(Self { model, shapes, flexible, stiffness, contact_dofs: at.to_vec(), available })
    }

    /// Modes kept.
    pub fn n_modes(&self) -> usize {
        self.shapes.ncols()
    }

    /// Modes that move a contact.
    pub fn n_modes_of_the_whole(&self) -> usize {
        self.available
    }

    /// Displacements of the reduced structure from those of the whole one, `η = Φᵀ M q`; those of its contacts follow
    /// statically and are left at zero.
    pub fn project(&self, full: &MasslessContactModel, displacement: &[f64]) -> Vec<f64> {
        let inertia = multiply(full.mass(), displacement);
        let modal = |k: usize| inertia.iter().enumerate().map(|(i, f)| self.shapes[(i, k)] * f).sum::<f64>();
        (0..self.n_modes()).map(modal).chain(self.contact_dofs.iter().map(|_| 0.0)).collect()
    }

    /// Displacements of the whole structure.
    pub fn expand(&self, reduced: &[f64]) -> Vec<f64> {
        let m = self.shapes.ncols();
        let modal = |i: usize| (0..m).map(|k| self.shapes[(i, k)] * reduced[k]).sum::<f64>();
        let mut force: Vec<f64> = self.contact_dofs.iter().zip(&reduced[m..]).map(|(&dof, q)| q - modal(dof)).collect();
        self.stiffness.solve_in_place(&mut force);
        let bent = |i: usize| force.iter().enumerate().map(|(d, f)| self.flexible[(i, d)] * f).sum::<f64>();
        (0..self.shapes.nrows()).map(|i| modal(i) + bent(i)).collect()
    }
}

/// `M = diag(I, 0)` and `K = [Λ + Φ_Nᵀ R⁻¹ Φ_N, −Φ_Nᵀ R⁻¹; −R⁻¹ Φ_N, R⁻¹]`, with `R` factored.
fn matrices(
    full: &MasslessContactModel,
    lambda: &[f64],
    shapes: &Mat<f64>,
    flexibility: &DenseLu,
) -> Result<StructuralModel, Failure> {
    let (m, at) = (lambda.len(), full.contact_dofs());
    let n = m + at.len();
    // R⁻¹ [−Φ_N, I]
    let row = |d: usize, j: usize| if j < m { -shapes[(at[d], j)] } else { f64::from(u8::from(j - m == d)) };
    let mut forces = Mat::from_fn(at.len(), n, row);
    for j in 0..n {
        let mut column: Vec<f64> = (0..at.len()).map(|d| forces[(d, j)]).collect();
        flexibility.solve_in_place(&mut column);
        column.iter().enumerate().for_each(|(d, f)| forces[(d, j)] = *f);
    }
    let of_contacts = |i: usize, j: usize| (0..at.len()).map(|d| row(d, i) * forces[(d, j)]).sum::<f64>();
    let mut stiffness: Vec<Triplet> = lambda.iter().enumerate().map(|(k, λ)| (k, k, *λ)).collect();
    for i in 0..n {
        stiffness.extend((0..n).map(|j| (i, j, 0.5 * (of_contacts(i, j) + of_contacts(j, i)))));
    }
    let mass: Vec<Triplet> = (0..m).map(|k| (k, k, 1.0)).collect();
    // A mode is not at any node.
    let mode = |k: usize| Dof { node: k, position: 0.0, kind: DofKind::Deflection };
    let dofs = (0..m).map(mode).chain(at.iter().map(|&dof| full.dofs()[dof])).collect();
    let place = |dof: usize| at.iter().position(|d| *d == dof).unwrap_or(0);
    let reduced = |c: &DofContact| Contact::from(DofContact { dof: m + place(c.dof), ..*c });
    let contacts = full.contacts().iter().map(reduced).collect();
    let [mass, stiffness] = [mass, stiffness].map(|entries| sparse_from_triplets(n, n, &entries));
    Ok(StructuralModel::new(mass?, stiffness?, dofs, contacts)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{beam_structure, beam_with_ten_stops};
    use nlmodes::linalg::SparseMatrix;
    use nlmodes::model::{Drop, held_modes};

    /// `I_Nᵀ K⁻¹ I_N`.
    fn flexibility(stiffness: &SparseMatrix, at: &[usize]) -> Mat<f64> {
        let n = stiffness.nrows();
        let mut x = Mat::from_fn(n, at.len(), |i, d| if i == at[d] { 1.0 } else { 0.0 });
        SparseCholesky::factor(stiffness, "stiffness").unwrap().solve_many(&mut x);
        Mat::from_fn(at.len(), at.len(), |i, j| x[(at[i], j)])
    }

    #[test]
    fn keeps_frequencies_and_statics() {
        let full = MasslessContactModel::new(&beam_with_ten_stops().unwrap(), &Drop).unwrap();
        let reduced = FreeModes::new(&full, 3).unwrap().model;
        let modes = |mass: &SparseMatrix, stiffness: &SparseMatrix| linear_modes(mass, stiffness, 3).unwrap().omega;
        let [own, whole] = [modes(reduced.mass(), reduced.stiffness()), modes(full.mass(), full.stiffness())];
        // The stop next to the clamp is some 1e6 times as stiff as the first mode: so many digits of that are lost in
        // the sum.
        own.iter().zip(&whole).for_each(|(a, b)| assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}"));
        let at: Vec<usize> = (3..13).collect();
        let [own, whole] = [flexibility(reduced.stiffness(), &at), flexibility(full.stiffness(), full.contact_dofs())];
        for i in 0..10 {
            for j in 0..10 {
                let size = (whole[(i, i)] * whole[(j, j)]).sqrt();
                assert!((own[(i, j)] - whole[(i, j)]).abs() < 1e-8 * size);
            }
        }
    }

    #[test]
    fn all_modes_are_the_structure_itself() {
        let full = MasslessContactModel::new(&beam_structure().unwrap(), &Drop).unwrap();
        let count = FreeModes::new(&full, 1).unwrap().n_modes_of_the_whole();
        let whole = FreeModes::new(&full, count).unwrap();
        let reduced = MasslessContactModel::new(&whole.model, &Drop).unwrap();
        let held = |model: &MasslessContactModel| held_modes(model, 200).unwrap().omega;
        let (own, of_full) = (held(&reduced), held(&full));
        // Those of the full one are among them, beside its axial family.
        for omega in &own {
            assert!(of_full.iter().any(|other| (omega / other - 1.0).abs() < 1e-7), "{omega}");
        }
        let bent: Vec<f64> =
            (0..full.dofs().len()).map(|i| if i == full.contact_dofs()[0] { 1.0 } else { 0.0 }).collect();
        let mut statics = bent.clone();
        SparseCholesky::factor(full.stiffness(), "stiffness").unwrap().solve_in_place(&mut statics);
        let mut reduced = whole.project(&full, &statics);
        *reduced.last_mut().unwrap() = statics[full.contact_dofs()[0]];
        let largest = statics.iter().fold(0.0_f64, |m, q| m.max(q.abs()));
        for (a, b) in whole.expand(&reduced).iter().zip(&statics) {
            assert!((a - b).abs() < 1e-6 * largest, "{a} {b}");
        }
    }
}
