use std::sync::Arc;

use nlmodes_linalg::{Mat, SparseCholesky, SparseMatrix, Triplet, select, sparse_from_triplets, triplets};

use crate::linear_modes::KnownModes;
use crate::structure::check_matrix;
use crate::{
    Contact, ContactLaw, Dof, DofContact, DofKind, MassRedistribution, ModelError, RigidMotion, SteadyForce,
    StructuralModel,
};

/// The massless coordinates `q_N` that satisfy the contact law at each instant; all others move in harmonics.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactCoordinates {
    /// The contact nodes of the structure, without mass, one for each contact degree of freedom: mixed
    /// shooting-harmonic balance.
    Nodes,
    /// The tips of the springs of elastic stops, one for each contact. The contact nodes are among the others and keep
    /// their mass: conventional harmonic balance.
    SpringTips,
}

/// A structure with massless contact coordinates, partitioned as in eq. (12).
///
/// ```text
/// | M_LL 0 | | q̈_L |   | K_LL K_LN | | q_L |   |  0  |
/// |  0   0 | | q̈_N | + | K_NL K_NN | | q_N | = | W λ | ,   0 ≤ λ ⊥ Wᵀ q_N + g₀ + C λ ≥ 0
/// ```
///
/// With [`ContactCoordinates::Nodes`], [`Self::new`], N are the contact nodes, and `C = diag(1/k_c)` is the compliance
/// of the stops, zero for rigid ones.
///
/// With [`ContactCoordinates::SpringTips`], [`Self::with_spring_tips`], each elastic stop of eq. (3) is a massless
/// spring `k_c` attached to the contact node, whose tip meets a rigid wall. With `w_i` the direction of contact i, eq.
/// (2),
///
/// ```text
/// L: all degrees of freedom ,   K_LL = K + Σ_i k_c,i w_i w_iᵀ
/// K_LN: −k_c,i at the node of contact i ,   K_NN = diag(k_c,i) ,   C = 0
/// ```
///
/// The contact node is at the position that the tip would have without the wall, `q_N = −K_NN⁻¹ K_NL q_L`, so that `λ =
/// k_c max(−g, 0)`.
#[derive(Debug, Clone)]
pub struct MasslessContactModel {
    pub(crate) dofs: Vec<Dof>,
    /// Positions of the nodes of a structure in space.
    pub(crate) places: Option<Vec<[f64; 3]>>,
    pub(crate) contacts: Vec<DofContact>,
    pub(crate) coordinates: ContactCoordinates,
    pub(crate) linear: Vec<usize>,
    pub(crate) nonlinear: Vec<usize>,
    pub(crate) mass: SparseMatrix,
    pub(crate) stiffness: Arc<SparseMatrix>,
    pub(crate) m_ll: SparseMatrix,
    pub(crate) k_ll: SparseMatrix,
    pub(crate) k_ln: Mat<f64>,
    pub(crate) k_nn: Mat<f64>,
    pub(crate) w: Mat<f64>,
    pub(crate) steady: Option<Arc<SteadyForce>>,
    /// Shared by all clones: a model is immutable.
    pub(crate) known: Arc<KnownModes>,
}

impl MasslessContactModel {
    /// Redistributes the mass of `model` by `rule` and partitions it.
    ///
    /// # Errors
    /// [`ModelError::NoContact`]; [`ModelError::NoLinearDof`]; [`ModelError::MassAtContact`] if `rule` violates its
    /// trait, and other errors of `rule`; [`ModelError::ForceAtContact`] for a steady force on a contact node;
    /// [`ModelError::Linalg`] if `K_NN` is not positive definite.
    pub fn new(model: &StructuralModel, rule: &dyn MassRedistribution) -> Result<Self, ModelError> {
        let n = model.dofs().len();
        let (contacts, places) = (single_dofs(model)?, places_in_space(model)?);
        let nonlinear = contact_dofs(model);
        let linear: Vec<usize> = (0..n).filter(|i| nonlinear.binary_search(i).is_err()).collect();
        if nonlinear.is_empty() {
            return Err(ModelError::NoContact);
        }
        if linear.is_empty() {
            return Err(ModelError::NoLinearDof { dofs: n });
        }
        let mass = redistributed(model, rule)?;
        check_unloaded(model, &nonlinear)?;
        let part = |a: &SparseMatrix, rows: &[usize], columns: &[usize]| {
            select(a, rows, columns).map_err(ModelError::during("partition into linear and contact coordinates"))
        };
        let k_nn = part(model.stiffness(), &nonlinear, &nonlinear)?;
        SparseCholesky::factor(&k_nn, "stiffness of the contact nodes K_NN")
            .map_err(ModelError::during("static problem of the contact nodes"))?;
        Ok(Self {
            dofs: model.dofs().to_vec(),
            w: directions(&contacts, &nonlinear),
            contacts,
            places,
            coordinates: ContactCoordinates::Nodes,
            m_ll: part(&mass, &linear, &linear)?,
            k_ll: part(model.stiffness(), &linear, &linear)?,
            k_ln: part(model.stiffness(), &linear, &nonlinear)?.to_dense(),
            k_nn: k_nn.to_dense(),
            stiffness: model.shared_stiffness(),
            mass,
            linear,
            nonlinear,
            steady: model.steady_force().cloned(),
            known: Arc::default(),
        })
    }

    /// The model whose contact coordinates are the tips of the springs of its elastic stops; the contact nodes keep
    /// their mass unless `rule` removes it.
    ///
    /// # Errors
    /// [`ModelError::NoContact`]; [`ModelError::RigidStop`]; errors of `rule`.
    pub fn with_spring_tips(
        model: &StructuralModel,
        rule: Option<&dyn MassRedistribution>,
    ) -> Result<Self, ModelError> {
        let n = model.dofs().len();
        let (contacts, places) = (single_dofs(model)?, places_in_space(model)?);
        if contacts.is_empty() {
            return Err(ModelError::NoContact);
        }
        let springs = spring_stiffnesses(&contacts)?;
        let mass = match rule {
            Some(rule) => redistributed(model, rule)?,
            None => model.mass().clone(),
        };
        let nonlinear: Vec<usize> = contacts.iter().map(|c| c.dof).collect();
        let grounded = nonlinear.iter().zip(&springs).map(|(&dof, &k)| (dof, dof, k));
        let entries: Vec<Triplet> = triplets(model.stiffness()).chain(grounded).collect();
        let k_ll =
            sparse_from_triplets(n, n, &entries).map_err(ModelError::during("stiffness with contact springs"))?;
        let c = contacts.len();
        Ok(Self {
            dofs: model.dofs().to_vec(),
            places,
            coordinates: ContactCoordinates::SpringTips,
            linear: (0..n).collect(),
            k_ln: Mat::from_fn(n, c, |i, j| if nonlinear[j] == i { -springs[j] } else { 0.0 }),
            k_nn: Mat::from_fn(c, c, |i, j| if i == j { springs[i] } else { 0.0 }),
            w: Mat::from_fn(c, c, |i, j| if i == j { contacts[i].direction() } else { 0.0 }),
            contacts,
            stiffness: model.shared_stiffness(),
            m_ll: mass.clone(),
            k_ll,
            mass,
            nonlinear,
            steady: model.steady_force().cloned(),
            known: Arc::default(),
        })
    }

    /// The coordinates that satisfy the contact law.
    pub fn contact_coordinates(&self) -> ContactCoordinates {
        self.coordinates
    }

    /// Compliance `C` of the stops in series with `K_NN⁻¹`, m/N, one per contact: zero if the stop is rigid, or if its
    /// spring is already in `K_NN`.
    pub fn stop_compliance(&self) -> Vec<f64> {
        let of = |c: &DofContact| match self.coordinates {
            ContactCoordinates::Nodes => c.law.compliance(),
            ContactCoordinates::SpringTips => 0.0,
        };
        self.contacts.iter().map(of).collect()
    }

    /// A rigid-body motion that remains with the contact degrees of freedom fixed, so that `K_LL` is singular.
    pub fn held_rigid_motion(&self) -> Option<RigidMotion> {
        RigidMotion::of_held(&self.stiffness, &self.dofs, self.places.as_deref(), &self.nonlinear)
    }

    /// A rigid-body motion of the structure with its contacts free.
    pub fn rigid_motion(&self) -> Option<RigidMotion> {
        RigidMotion::of_held(&self.stiffness, &self.dofs, self.places.as_deref(), &[])
    }

    /// Cholesky factor of `K_LL`.
    ///
    /// # Errors
    /// [`ModelError::HeldRigidBody`] if the structure can move as a rigid body with its contacts fixed: constant
    /// contact forces could not be balanced then. [`ModelError::Linalg`] if `K_LL` is not positive definite otherwise.
    pub fn factor_k_ll(&self) -> Result<SparseCholesky, ModelError> {
        match self.held_rigid_motion() {
            Some(motion) => Err(ModelError::HeldRigidBody { motion }),
            None => SparseCholesky::factor(&self.k_ll, "stiffness with contacts held K_LL")
                .map_err(ModelError::during("statics of the structure with its contacts held")),
        }
    }

    /// All degrees of freedom, in the order of the structural model.
    pub fn dofs(&self) -> &[Dof] {
        &self.dofs
    }

    /// The contacts, in the order of the columns of `W`.
    pub fn contacts(&self) -> &[DofContact] {
        &self.contacts
    }

    /// Indices in [`Self::dofs`] of the degrees of freedom L, ascending: those without contact, or all of them.
    pub fn linear_dofs(&self) -> &[usize] {
        &self.linear
    }

    /// Indices in [`Self::dofs`] of the contact coordinates' degrees of freedom. For [`ContactCoordinates::Nodes`] in
    /// ascending order, shared by two stops at one degree of freedom; for [`ContactCoordinates::SpringTips`] that of
    /// each stop.
    pub fn contact_dofs(&self) -> &[usize] {
        &self.nonlinear
    }

    /// Redistributed mass `M_R` of all degrees of freedom, n × n.
    pub fn mass(&self) -> &SparseMatrix {
        &self.mass
    }

    /// `K`, shared.
    pub fn shared_stiffness(&self) -> Arc<SparseMatrix> {
        Arc::clone(&self.stiffness)
    }

    /// Stiffness `K` of all degrees of freedom, n × n.
    pub fn stiffness(&self) -> &SparseMatrix {
        &self.stiffness
    }

    /// The constant force on the degrees of freedom L that its contacts alone can balance, if there is one; `R` is of
    /// all.
    pub fn steady_force(&self) -> Option<&SteadyForce> {
        self.steady.as_deref()
    }

    /// `M̄_LL`, n_L × n_L.
    pub fn m_ll(&self) -> &SparseMatrix {
        &self.m_ll
    }

    /// `K_LL`, n_L × n_L.
    pub fn k_ll(&self) -> &SparseMatrix {
        &self.k_ll
    }

    /// `K_LN`, n_L × n_N.
    pub fn k_ln(&self) -> &Mat<f64> {
        &self.k_ln
    }

    /// `K_NN`, n_N × n_N, symmetric positive definite.
    pub fn k_nn(&self) -> &Mat<f64> {
        &self.k_nn
    }

    /// `W̄`, n_N × c, eq. (6): the force directions of the contacts.
    pub fn w(&self) -> &Mat<f64> {
        &self.w
    }
}

/// `rule` applied and checked.
fn redistributed(model: &StructuralModel, rule: &dyn MassRedistribution) -> Result<SparseMatrix, ModelError> {
    let mass = rule.redistribute(model)?;
    check_matrix("redistributed mass matrix", &mass, model.dofs().len())?;
    check_massless(rule.name(), &mass, &contact_dofs(model))?;
    Ok(mass)
}

/// A steady force acts where there is mass: elsewhere it is part of the gaps.
fn check_unloaded(model: &StructuralModel, nonlinear: &[usize]) -> Result<(), ModelError> {
    let Some(steady) = model.steady_force() else { return Ok(()) };
    match nonlinear.iter().find(|dof| steady.force[**dof] != 0.0) {
        Some(&dof) => Err(ModelError::ForceAtContact { dof, force: steady.force[dof] }),
        None => Ok(()),
    }
}

/// The contacts, each at one degree of freedom.
fn single_dofs(model: &StructuralModel) -> Result<Vec<DofContact>, ModelError> {
    let single = |(contact, c): (usize, &Contact)| {
        c.single_dof().ok_or(ModelError::NotASingleDof { contact, dofs: c.normal.entries().len() })
    };
    model.contacts().iter().enumerate().map(single).collect()
}

/// Positions of all degrees of freedom of a structure in space; none for a straight one.
fn places_in_space(model: &StructuralModel) -> Result<Option<Vec<[f64; 3]>>, ModelError> {
    if !model.dofs().iter().any(|dof| dof.kind.is_spatial()) {
        return Ok(None);
    }
    // Modal coordinates have no position; rigid motions leave them at rest.
    let place = |(i, dof): (usize, &Dof)| match dof.kind {
        DofKind::Modal => Some([0.0; 3]),
        _ => model.place(i),
    };
    let places: Option<Vec<[f64; 3]>> = model.dofs().iter().enumerate().map(place).collect();
    places.map(Some).ok_or(ModelError::PlacesUnknown)
}

/// `k_c` of each contact.
fn spring_stiffnesses(contacts: &[DofContact]) -> Result<Vec<f64>, ModelError> {
    let of = |(contact, c): (usize, &DofContact)| match c.law {
        ContactLaw::Elastic { stiffness } => Ok(stiffness),
        ContactLaw::Rigid => Err(ModelError::RigidStop { contact }),
    };
    contacts.iter().enumerate().map(of).collect()
}

/// Degrees of freedom with a contact, ascending, each once.
pub(crate) fn contact_dofs(model: &StructuralModel) -> Vec<usize> {
    let touched = model.contacts().iter().flat_map(|c| c.normal.entries());
    let mut dofs: Vec<usize> = touched.map(|(dof, _)| *dof).collect();
    dofs.sort_unstable();
    dofs.dedup();
    dofs
}

fn check_massless(rule: &'static str, mass: &SparseMatrix, nonlinear: &[usize]) -> Result<(), ModelError> {
    let touches = |i: usize| nonlinear.binary_search(&i).is_ok();
    match triplets(mass).find(|&(i, j, value)| value != 0.0 && (touches(i) || touches(j))) {
        Some((row, column, value)) => Err(ModelError::MassAtContact { rule, row, column, value }),
        None => Ok(()),
    }
}

/// `W̄`: one column per contact, one row per contact degree of freedom.
fn directions(contacts: &[DofContact], nonlinear: &[usize]) -> Mat<f64> {
    Mat::from_fn(nonlinear.len(), contacts.len(), |i, j| {
        if contacts[j].dof == nonlinear[i] { contacts[j].direction() } else { 0.0 }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_chain::{chain, springs};
    use crate::{Drop, Side};

    fn stop(dof: usize, side: Side) -> Contact {
        Contact::rigid(dof, side, 0.5)
    }

    #[test]
    fn partition_puts_every_entry_in_its_block() {
        let contacts = vec![stop(4, Side::Positive), stop(1, Side::Negative), stop(4, Side::Negative)];
        let model = MasslessContactModel::new(&chain(5, contacts), &Drop).unwrap();
        assert_eq!((model.linear_dofs(), model.contact_dofs()), (&[0, 2, 3][..], &[1, 4][..]));
        let w = model.w();
        assert_eq!((w.nrows(), w.ncols()), (2, 3));
        assert_eq!([w[(0, 0)], w[(0, 1)], w[(0, 2)]], [0.0, 1.0, 0.0]);
        assert_eq!([w[(1, 0)], w[(1, 1)], w[(1, 2)]], [-1.0, 0.0, 1.0]);
        let k = model.stiffness().to_dense();
        for (i, &row) in model.linear_dofs().iter().enumerate() {
            for (j, &column) in model.contact_dofs().iter().enumerate() {
                assert_eq!(model.k_ln()[(i, j)], k[(row, column)]);
            }
            for (j, &column) in model.linear_dofs().iter().enumerate() {
                assert_eq!(model.k_ll().get(i, j).copied().unwrap_or(0.0), k[(row, column)]);
            }
        }
        assert_eq!((model.k_nn()[(0, 0)], model.k_nn()[(1, 1)], model.k_nn()[(0, 1)]), (2.0, 1.0, 0.0));
        assert_eq!(model.m_ll().to_dense(), Mat::<f64>::identity(3, 3));
    }

    #[test]
    fn structures_without_contact_or_without_anything_else_are_refused() {
        let refused = |model| MasslessContactModel::new(&model, &Drop).unwrap_err();
        assert_eq!(refused(chain(3, vec![])), ModelError::NoContact);
        let everywhere = (0..3).map(|i| stop(i, Side::Positive)).collect();
        assert_eq!(refused(chain(3, everywhere)), ModelError::NoLinearDof { dofs: 3 });
    }

    #[test]
    fn loose_contact_nodes_are_refused() {
        let model = springs(1, 0.0, vec![stop(0, Side::Positive)], &[(0, 0, 1.0)]);
        let loose = StructuralModel::new(
            nlmodes_linalg::sparse_from_triplets(2, 2, &[(0, 0, 1.0), (1, 1, 1.0)]).unwrap(),
            nlmodes_linalg::sparse_from_triplets(2, 2, &[(0, 0, 1.0)]).unwrap(),
            [model.dofs(), model.dofs()].concat(),
            vec![stop(1, Side::Positive)],
        );
        let error = MasslessContactModel::new(&loose.unwrap(), &Drop).unwrap_err();
        assert!(matches!(error, ModelError::Linalg { what: "static problem of the contact nodes", .. }), "{error}");
    }

    #[test]
    fn rules_that_leave_mass_at_a_contact_are_refused() {
        struct Nothing;
        impl MassRedistribution for Nothing {
            fn name(&self) -> &'static str {
                "nothing"
            }
            fn redistribute(&self, model: &StructuralModel) -> Result<SparseMatrix, ModelError> {
                Ok(model.mass().clone())
            }
        }
        let without = springs(3, 1.0, vec![stop(2, Side::Positive)], &[(0, 0, 1.0), (1, 1, 1.0), (2, 2, 0.0)]);
        assert!(triplets(without.mass()).any(|(i, _, value)| i == 2 && value == 0.0), "a stored zero is no mass");
        MasslessContactModel::new(&without, &Nothing).unwrap();
        let error = MasslessContactModel::new(&chain(3, vec![stop(2, Side::Positive)]), &Nothing).unwrap_err();
        assert_eq!(error, ModelError::MassAtContact { rule: "nothing", row: 2, column: 2, value: 1.0 });
    }

    #[test]
    fn holding_the_contact_may_leave_a_rigid_body() {
        // A free chain fixed by its contact; two chains, only one of which has a contact: the other floats.
        let mass: Vec<_> = (0..4).map(|i| (i, i, 1.0)).collect();
        let free = springs(4, 0.0, vec![stop(3, Side::Positive)], &mass);
        let model = MasslessContactModel::new(&free, &Drop).unwrap();
        assert_eq!(model.held_rigid_motion(), None);
        let mut x = [0.0, 0.0, 1.0];
        model.factor_k_ll().unwrap().solve_in_place(&mut x);
        assert!((x[0] - 1.0).abs() < 1e-14);
        let across = free.dofs().iter().map(|d| Dof { kind: DofKind::Deflection, ..*d });
        let dofs: Vec<Dof> = free.dofs().iter().copied().chain(across).collect();
        let twice = |a: &SparseMatrix| {
            let entries: Vec<_> = triplets(a).flat_map(|(i, j, v)| [(i, j, v), (i + 4, j + 4, v)]).collect();
            nlmodes_linalg::sparse_from_triplets(8, 8, &entries).unwrap()
        };
        let contacts = vec![stop(7, Side::Positive)];
        let both = StructuralModel::new(twice(free.mass()), twice(free.stiffness()), dofs, contacts).unwrap();
        let error = MasslessContactModel::new(&both, &Drop).unwrap().factor_k_ll().unwrap_err();
        assert_eq!(error, ModelError::HeldRigidBody { motion: RigidMotion::Axial });
    }
}
