use nlmodes_linalg::LinalgError;
use thiserror::Error;

use crate::{DofKind, RigidMotion};

/// Why a model cannot be made.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ModelError {
    /// Two parts of the model have different sizes.
    #[error("{what} has {found} rows where the model has {expected} degrees of freedom")]
    Dimension {
        /// The part.
        what: &'static str,
        /// Degrees of freedom.
        expected: usize,
        /// Size found.
        found: usize,
    },
    /// A number is NaN or infinite.
    #[error("{what} {index} is {value}, which is not a finite number")]
    NotFinite {
        /// The quantity.
        what: &'static str,
        /// Its index: degree of freedom, contact or stored matrix entry.
        index: usize,
        /// The number.
        value: f64,
    },
    /// A matrix differs from its transpose.
    #[error("the {what} is not symmetric: {value:e} at ({row}, {column}), {mirrored:e} at ({column}, {row})")]
    NotSymmetric {
        /// The matrix.
        what: &'static str,
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// The entry.
        value: f64,
        /// The entry with row and column exchanged.
        mirrored: f64,
    },
    /// A contact names a degree of freedom that the model has not.
    #[error("contact {contact} is at degree of freedom {dof}, but there are {dofs} (counted from 0)")]
    NoSuchDof {
        /// Index of the contact.
        contact: usize,
        /// The degree of freedom asked for.
        dof: usize,
        /// How many there are.
        dofs: usize,
    },
    /// The stiffness of an elastic stop cannot be used.
    #[error("the contact stiffness of contact {contact} is {stiffness:e} N/m; it has to be positive and finite")]
    ContactStiffness {
        /// Index of the contact.
        contact: usize,
        /// Its stiffness.
        stiffness: f64,
    },
    /// A rigid stop where the contact node moves in harmonics and only the spring of the stop follows the contact law.
    #[error("contact {contact} is rigid, but harmonic balance of the contact node needs a contact stiffness")]
    RigidStop {
        /// Index of the contact.
        contact: usize,
    },
    /// A model with massless contact nodes was asked for, but there is no contact.
    #[error("the structure has no contact, so that there is no contact mass to redistribute")]
    NoContact,
    /// Every degree of freedom has a contact, so that nothing with mass is left.
    #[error("all {dofs} degrees of freedom have a contact: no mass is left")]
    NoLinearDof {
        /// Degrees of freedom.
        dofs: usize,
    },
    /// A redistribution left mass at a contact degree of freedom.
    #[error(
        "the mass redistribution '{rule}' leaves {value:e} at entry ({row}, {column}), of a contact degree of freedom"
    )]
    MassAtContact {
        /// Name of the rule.
        rule: &'static str,
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// There are not enough places that can take the mass of a contact.
    #[error(
        "the mass of the {kind} contact at {position} m cannot be moved: its {found} free, massive neighbours are too few or too light",
        kind = .kind.name()
    )]
    TooFewNeighbours {
        /// Contact degree of freedom.
        dof: usize,
        /// Its position, m.
        position: f64,
        /// Its kind.
        kind: DofKind,
        /// Neighbours found.
        found: usize,
    },
    /// Moving the mass of the contacts makes the mass of the rest indefinite.
    #[error("moving the mass of the contacts leaves a mass matrix that is not positive definite, at the {kind} of {position} m", kind = .kind.name())]
    IndefiniteMass {
        /// Degree of freedom where the factorisation stopped.
        dof: usize,
        /// Its position, m.
        position: f64,
        /// Its kind.
        kind: DofKind,
    },
    /// With the contacts closed the structure can still move as a rigid body, so that `K_LL` is singular.
    #[error("with its contacts held the structure is still free to move as a rigid body: {motion}")]
    HeldRigidBody {
        /// The motion that remains.
        motion: RigidMotion,
    },
    /// A factorisation or eigenproblem failed.
    #[error("{what}")]
    Linalg {
        /// What was being computed.
        what: &'static str,
        /// The failure.
        #[source]
        source: LinalgError,
    },
}

impl ModelError {
    /// Names what was being computed when linear algebra failed.
    pub(crate) fn during(what: &'static str) -> impl FnOnce(LinalgError) -> Self {
        move |source| Self::Linalg { what, source }
    }
}
