use nlmodes_linalg::{SparseMatrix, asymmetry};

use crate::ModelError;

/// What a degree of freedom measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum DofKind {
    /// Displacement along the axis, m.
    Axial,
    /// Displacement across the axis, m.
    Deflection,
    /// Rotation of the cross section, rad; positive with the slope, so that a rigid rotation `θ` about `x = 0` displaces by `θ x`.
    Rotation,
}

impl DofKind {
    /// Lower-case name, as it stands in result files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Axial => "axial",
            Self::Deflection => "deflection",
            Self::Rotation => "rotation",
        }
    }
}

/// A degree of freedom that the supports leave free.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dof {
    /// Node that it belongs to.
    pub node: usize,
    /// Position of the node along the axis, m.
    pub position: f64,
    /// What it measures.
    pub kind: DofKind,
}

/// The side on which a stop stands, seen along the positive direction of the degree of freedom.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Side {
    /// Touched by a positive displacement: `g = g₀ − q`.
    Positive,
    /// Touched by a negative displacement: `g = g₀ + q`.
    Negative,
}

impl Side {
    /// +1 or −1: the direction from the structure to the stop.
    pub fn sign(self) -> f64 {
        match self {
            Self::Positive => 1.0,
            Self::Negative => -1.0,
        }
    }
}

/// How a stop answers when it is pressed: it yields by its compliance times the force.
///
/// ```text
/// 0 ≤ λ ⊥ g + c λ ≥ 0 ,   c = 0 (rigid, eq. (5)) or 1/k_c (elastic, eq. (3))
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum ContactLaw {
    /// A hard stop, eq. (5): nothing penetrates.
    #[default]
    Rigid,
    /// A stop on a massless spring, eq. (3): `λ = k_c max(−g, 0)`.
    Elastic {
        /// Contact stiffness `k_c`, N/m, positive.
        stiffness: f64,
    },
}

impl ContactLaw {
    /// `1/k_c`, m/N; zero for a rigid stop.
    pub fn compliance(self) -> f64 {
        match self {
            Self::Rigid => 0.0,
            Self::Elastic { stiffness } => 1.0 / stiffness,
        }
    }
}

/// A one-sided stop at one degree of freedom, eqs. (3), (5): `g = g₀ + w q` with `w = −side`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Index of the degree of freedom in [`StructuralModel::dofs`].
    pub dof: usize,
    /// Where the stop stands.
    pub side: Side,
    /// Clearance at rest `g₀`, m; zero touches, negative presses.
    pub gap: f64,
    /// Rigid, or with a contact stiffness.
    pub law: ContactLaw,
}

impl Contact {
    /// A rigid stop.
    pub fn rigid(dof: usize, side: Side, gap: f64) -> Self {
        Self { dof, side, gap, law: ContactLaw::Rigid }
    }

    /// A stop with the contact stiffness `stiffness`, N/m.
    pub fn elastic(dof: usize, side: Side, gap: f64, stiffness: f64) -> Self {
        Self { dof, side, gap, law: ContactLaw::Elastic { stiffness } }
    }

    /// Entry of `W` for this contact, eq. (2): +1 or −1.
    pub fn direction(&self) -> f64 {
        -self.side.sign()
    }
}

/// A linear structure with unilateral contacts, eqs. (1), (4), (5).
///
/// `M` (n × n, kg or kg·m²) and `K` (n × n, N/m …) are symmetric, of the free degrees of freedom only.
#[derive(Debug, Clone)]
pub struct StructuralModel {
    mass: SparseMatrix,
    stiffness: SparseMatrix,
    dofs: Vec<Dof>,
    contacts: Vec<Contact>,
}

impl StructuralModel {
    /// Checks and holds the parts.
    ///
    /// # Errors
    /// [`ModelError::Dimension`] if sizes disagree, [`ModelError::NotFinite`] for an entry, position or gap,
    /// [`ModelError::NotSymmetric`], [`ModelError::NoSuchDof`] if a contact names a degree of freedom that does not exist,
    /// [`ModelError::ContactStiffness`] if that of an elastic stop is not positive or its inverse is not finite.
    pub fn new(
        mass: SparseMatrix,
        stiffness: SparseMatrix,
        dofs: Vec<Dof>,
        contacts: Vec<Contact>,
    ) -> Result<Self, ModelError> {
        for (what, matrix) in [("mass matrix", &mass), ("stiffness matrix", &stiffness)] {
            check_matrix(what, matrix, dofs.len())?;
        }
        check_finite("position of degree of freedom", dofs.iter().map(|d| d.position))?;
        check_finite("gap of contact", contacts.iter().map(|c| c.gap))?;
        if let Some((contact, c)) = contacts.iter().enumerate().find(|(_, c)| c.dof >= dofs.len()) {
            return Err(ModelError::NoSuchDof { contact, dof: c.dof, dofs: dofs.len() });
        }
        for (contact, c) in contacts.iter().enumerate() {
            if let ContactLaw::Elastic { stiffness } = c.law
                && !(stiffness.is_finite() && stiffness > 0.0 && c.law.compliance().is_finite())
            {
                return Err(ModelError::ContactStiffness { contact, stiffness });
            }
        }
        Ok(Self { mass, stiffness, dofs, contacts })
    }

    /// Mass matrix `M`.
    pub fn mass(&self) -> &SparseMatrix {
        &self.mass
    }

    /// Stiffness matrix `K`.
    pub fn stiffness(&self) -> &SparseMatrix {
        &self.stiffness
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
        assert_eq!((model.dofs().len(), model.contacts()[0].direction()), (2, -1.0));
    }

    #[test]
    fn sizes_must_agree() {
        let (m, k, mut dofs, contacts) = parts();
        dofs.pop();
        let error = StructuralModel::new(m, k, dofs, contacts).unwrap_err();
        assert_eq!(error, ModelError::Dimension { what: "mass matrix", expected: 1, found: 2 });
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
        assert_eq!(Contact::elastic(1, Side::Positive, 0.1, 4.0).law.compliance(), 0.25);
        assert_eq!(Contact::rigid(1, Side::Positive, 0.1).law.compliance(), 0.0);
    }
}
