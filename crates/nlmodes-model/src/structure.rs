use std::sync::Arc;

use nlmodes_linalg::{SparseMatrix, asymmetry};

use crate::definite::check_mass;
use crate::{Contact, ContactLaw, Dof, ModelError, SteadyForce};

/// A linear structure with unilateral contacts, eqs. (1), (4), (5).
///
/// `M` (n × n, kg or kg·m²), `K` (n × n, N/m …) and, if known, the viscous damping `C` (n × n, N·s/m …) are symmetric
/// and for the free degrees of freedom only. Copies share the matrices.
#[derive(Debug, Clone)]
pub struct StructuralModel {
    mass: Arc<SparseMatrix>,
    stiffness: Arc<SparseMatrix>,
    damping: Option<Arc<SparseMatrix>>,
    dofs: Arc<[Dof]>,
    places: Option<Arc<[[f64; 3]]>>,
    contacts: Vec<Contact>,
    steady: Option<Arc<SteadyForce>>,
}

impl StructuralModel {
    /// Checks the parts.
    ///
    /// # Errors
    /// [`ModelError::Dimension`] if sizes disagree, [`ModelError::NotFinite`] for an entry, position or gap,
    /// [`ModelError::NotSymmetric`], [`ModelError::NegativeMass`], [`ModelError::CoupledMass`],
    /// [`ModelError::NoSuchDof`] if a contact names a degree of freedom that does not exist,
    /// [`ModelError::ContactStiffness`] if that of an elastic stop is not positive or its inverse is not finite.
    pub fn new(
        mass: impl Into<Arc<SparseMatrix>>,
        stiffness: impl Into<Arc<SparseMatrix>>,
        dofs: Vec<Dof>,
        contacts: Vec<Contact>,
    ) -> Result<Self, ModelError> {
        let (mass, stiffness) = (mass.into(), stiffness.into());
        for (what, matrix) in [("mass matrix", &mass), ("stiffness matrix", &stiffness)] {
            check_matrix(what, matrix, dofs.len())?;
        }
        check_mass(&mass, &dofs)?;
        check_finite("position of degree of freedom", dofs.iter().map(|d| d.position))?;
        check_contacts(&contacts, dofs.len())?;
        Ok(Self { mass, stiffness, damping: None, dofs: dofs.into(), places: None, contacts, steady: None })
    }

    /// The same structure under a constant force that its contacts alone can balance.
    ///
    /// # Errors
    /// [`ModelError::Dimension`], [`ModelError::NotFinite`].
    pub fn with_steady_force(mut self, steady: SteadyForce) -> Result<Self, ModelError> {
        let expected = self.dofs.len();
        for (what, found) in [("steady force", steady.force.len()), ("free motions", steady.motions.nrows())] {
            if found != expected {
                return Err(ModelError::Dimension { what, expected, found });
            }
        }
        check_finite("steady force on degree of freedom", steady.force.iter().copied())?;
        self.steady = Some(Arc::new(steady));
        Ok(self)
    }

    /// The same structure with the viscous damping `C` (n × n). Conservative analyses ignore it.
    ///
    /// # Errors
    /// [`ModelError::Dimension`], [`ModelError::NotFinite`], [`ModelError::NotSymmetric`].
    pub fn with_damping(mut self, damping: impl Into<Arc<SparseMatrix>>) -> Result<Self, ModelError> {
        let damping = damping.into();
        check_matrix("damping matrix", &damping, self.dofs.len())?;
        self.damping = Some(damping);
        Ok(self)
    }

    /// The same structure with the coordinates (m) of the node of each degree of freedom.
    ///
    /// # Errors
    /// [`ModelError::Dimension`], [`ModelError::NotFinite`].
    pub fn with_places(mut self, places: Vec<[f64; 3]>) -> Result<Self, ModelError> {
        let (expected, found) = (self.dofs.len(), places.len());
        if expected != found {
            return Err(ModelError::Dimension { what: "list of places", expected, found });
        }
        check_finite("coordinate of degree of freedom", places.iter().map(|p| p.iter().sum()))?;
        self.places = Some(places.into());
        Ok(self)
    }

    /// The same structure with another stiffness (n × n).
    pub(crate) fn with_stiffness(&self, stiffness: SparseMatrix) -> Result<Self, ModelError> {
        check_matrix("stiffness matrix", &stiffness, self.dofs.len())?;
        Ok(Self { stiffness: Arc::new(stiffness), ..self.clone() })
    }

    /// The same structure with other contacts.
    ///
    /// # Errors
    /// As [`StructuralModel::new`].
    pub fn with_contacts(mut self, contacts: Vec<Contact>) -> Result<Self, ModelError> {
        check_contacts(&contacts, self.dofs.len())?;
        self.contacts = contacts;
        Ok(self)
    }

    /// Mass matrix `M`.
    pub fn mass(&self) -> &SparseMatrix {
        &self.mass
    }

    /// Stiffness matrix `K`.
    pub fn stiffness(&self) -> &SparseMatrix {
        &self.stiffness
    }

    /// Viscous damping matrix `C`, if known.
    pub fn damping(&self) -> Option<&SparseMatrix> {
        self.damping.as_deref()
    }

    /// The constant force that its contacts alone can balance, if there is one.
    pub fn steady_force(&self) -> Option<&Arc<SteadyForce>> {
        self.steady.as_ref()
    }

    /// `M`, shared.
    pub fn shared_mass(&self) -> Arc<SparseMatrix> {
        Arc::clone(&self.mass)
    }

    /// `K`, shared.
    pub fn shared_stiffness(&self) -> Arc<SparseMatrix> {
        Arc::clone(&self.stiffness)
    }

    /// Position of the node of degree of freedom `dof`, m: on the axis X for straight structures. None for modal
    /// coordinates, and in space if no positions were given.
    pub fn place(&self, dof: usize) -> Option<[f64; 3]> {
        let of = self.dofs.get(dof)?;
        match (&self.places, of.kind) {
            (_, crate::DofKind::Modal | crate::DofKind::Contact | crate::DofKind::Row) => None,
            (Some(places), _) => places.get(dof).copied(),
            (None, kind) => (!kind.is_spatial()).then_some([of.position, 0.0, 0.0]),
        }
    }

    /// The degrees of freedom, in the order of the matrices.
    pub fn dofs(&self) -> &[Dof] {
        &self.dofs
    }

    /// The contacts, in the order of the columns of `W`.
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }
}

fn check_contacts(contacts: &[Contact], dofs: usize) -> Result<(), ModelError> {
    check_finite("gap of contact", contacts.iter().map(|c| c.gap))?;
    for (contact, c) in contacts.iter().enumerate() {
        if let Some(&(dof, _)) = c.normal.entries().iter().find(|(dof, _)| *dof >= dofs) {
            return Err(ModelError::NoSuchDof { contact, dof, dofs });
        }
        if let ContactLaw::Elastic { stiffness } = c.law
            && !(stiffness.is_finite() && stiffness > 0.0 && c.law.compliance().is_finite())
        {
            return Err(ModelError::ContactStiffness { contact, stiffness });
        }
    }
    Ok(())
}

/// Size, finite values and symmetry of a matrix of the structure.
pub(crate) fn check_matrix(what: &'static str, matrix: &SparseMatrix, expected: usize) -> Result<(), ModelError> {
    if let Some(&found) = [matrix.nrows(), matrix.ncols()].iter().find(|&&size| size != expected) {
        return Err(ModelError::Dimension { what, expected, found });
    }
    check_finite(what, matrix.val().iter().copied())?;
    match asymmetry(matrix) {
        Some((row, column, value, mirrored)) => Err(ModelError::NotSymmetric { what, row, column, value, mirrored }),
        None => Ok(()),
    }
}

fn check_finite(what: &'static str, values: impl Iterator<Item = f64>) -> Result<(), ModelError> {
    match values.enumerate().find(|(_, v)| !v.is_finite()) {
        Some((index, value)) => Err(ModelError::NotFinite { what, index, value }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DofKind, Side};
    use nlmodes_linalg::sparse_from_triplets;

    fn parts() -> (SparseMatrix, SparseMatrix, Vec<Dof>, Vec<Contact>) {
        let m = sparse_from_triplets(2, 2, &[(0, 0, 1.0), (1, 1, 1.0)]).unwrap();
        let k = sparse_from_triplets(2, 2, &[(0, 0, 2.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 1.0)]).unwrap();
        let dofs = (0..2).map(|i| Dof { node: i, position: i as f64, kind: DofKind::Axial }).collect();
        (m, k, dofs, vec![Contact::rigid(1, Side::Positive, 0.1)])
    }

    #[test]
    fn proper_parts_are_accepted() {
        let (m, k, dofs, contacts) = parts();
        let model = StructuralModel::new(m, k, dofs, contacts).unwrap();
        assert_eq!((model.dofs().len(), model.contacts()[0].normal.entries()), (2, &[(1, -1.0)][..]));
    }

    #[test]
    fn sizes_must_agree() {
        let (m, k, mut dofs, contacts) = parts();
        dofs.pop();
        let error = StructuralModel::new(m, k, dofs, contacts).unwrap_err();
        assert_eq!(error, ModelError::Dimension { what: "mass matrix", expected: 1, found: 2 });
    }

    #[test]
    fn damping_is_kept_and_none_is_made_up() {
        let (m, k, dofs, contacts) = parts();
        let model = StructuralModel::new(m, k.clone(), dofs, contacts).unwrap();
        assert!(model.damping().is_none());
        assert_eq!(model.with_damping(k.clone()).unwrap().damping().unwrap().to_dense(), k.to_dense());
    }

    #[test]
    fn damping_and_places_are_checked() {
        let model = || {
            let (m, k, dofs, contacts) = parts();
            StructuralModel::new(m, k, dofs, contacts).unwrap()
        };
        let c = sparse_from_triplets(2, 2, &[(0, 1, 1.0), (1, 0, -1.0)]).unwrap();
        assert!(matches!(
            model().with_damping(c).unwrap_err(),
            ModelError::NotSymmetric { what: "damping matrix", .. }
        ));
        let small = sparse_from_triplets(1, 1, &[(0, 0, 1.0)]).unwrap();
        assert!(matches!(
            model().with_damping(small).unwrap_err(),
            ModelError::Dimension { expected: 2, found: 1, .. }
        ));
        assert_eq!((model().place(1), model().place(2)), (Some([1.0, 0.0, 0.0]), None));
        let placed = model().with_places(vec![[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]).unwrap();
        assert_eq!(placed.place(1), Some([3.0, 4.0, 5.0]));
        assert!(matches!(model().with_places(vec![[0.0; 3]]).unwrap_err(), ModelError::Dimension { found: 1, .. }));
        let nowhere = model().with_places(vec![[0.0; 3], [f64::NAN, 0.0, 0.0]]).unwrap_err();
        assert!(matches!(nowhere, ModelError::NotFinite { index: 1, .. }));
    }

    #[test]
    fn matrices_must_be_symmetric() {
        let (m, _, dofs, contacts) = parts();
        let k = sparse_from_triplets(2, 2, &[(0, 0, 2.0), (0, 1, -1.0), (1, 0, -1.1), (1, 1, 1.0)]).unwrap();
        let error = StructuralModel::new(m, k, dofs, contacts).unwrap_err();
        assert!(matches!(
            error,
            ModelError::NotSymmetric { what: "stiffness matrix", value: -1.1, mirrored: -1.0, .. }
        ));
    }

    #[test]
    fn contacts_must_exist_and_have_a_finite_gap() {
        for (dof, gap) in [(2, 0.1), (1, f64::NAN), (1, f64::INFINITY)] {
            let (m, k, dofs, _) = parts();
            let contacts = vec![Contact::rigid(dof, Side::Negative, gap)];
            let error = StructuralModel::new(m, k, dofs, contacts).unwrap_err();
            match error {
                ModelError::NoSuchDof { contact: 0, dof: 2, dofs: 2 } => assert_eq!(dof, 2),
                ModelError::NotFinite { what: "gap of contact", index: 0, .. } => assert!(!gap.is_finite()),
                other => panic!("{other}"),
            }
        }
    }

    #[test]
    fn a_contact_stiffness_is_positive_and_has_an_inverse() {
        for stiffness in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-309] {
            let (m, k, dofs, _) = parts();
            let contacts = vec![Contact::elastic(1, Side::Positive, 0.1, stiffness)];
            let error = StructuralModel::new(m, k, dofs, contacts).unwrap_err();
            assert!(matches!(error, ModelError::ContactStiffness { contact: 0, .. }), "{stiffness}: {error}");
        }
        for stiffness in [1e-3, 1e12] {
            let (m, k, dofs, _) = parts();
            StructuralModel::new(m, k, dofs, vec![Contact::elastic(1, Side::Positive, 0.1, stiffness)]).unwrap();
        }
        assert_eq!(Contact::elastic(1, Side::Positive, 0.1, 4.0).law.compliance(), 0.25);
        assert_eq!(Contact::rigid(1, Side::Positive, 0.1).law.compliance(), 0.0);
    }
}
