use nlmodes_linalg::{LinalgError, rounded};
use thiserror::Error;

use crate::{DofKind, RigidMotion};

/// Why a model cannot be constructed.
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
    /// A steady force acts on a contact node, which has no mass.
    #[error(
        "a steady force of {} N acts on degree of freedom {dof}, a contact node without mass; expected it in the gap \
        of its contact", rounded(*force, 6)
    )]
    ForceAtContact {
        /// The degree of freedom.
        dof: usize,
        /// The force, N.
        force: f64,
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
    /// A degree of freedom has a negative mass: moving alone it would have a negative kinetic energy.
    #[error(
        "the mass matrix has {value:e} on its diagonal, at degree of freedom {dof} ({kind} of node {node} at \
         {position} m); no mass is negative",
        kind = .kind.name()
    )]
    NegativeMass {
        /// The degree of freedom.
        dof: usize,
        /// Its node.
        node: usize,
        /// Its position, m.
        position: f64,
        /// Its kind.
        kind: DofKind,
        /// The entry.
        value: f64,
    },
    /// Two degrees of freedom are coupled by more mass than they have: some motion of these two has a negative kinetic
    /// energy.
    #[error(
        "the mass matrix has {value:e} between degrees of freedom {row} and {column}, beside {most:e} at most for a \
         mass that is nowhere \
         negative (the root of the product of their diagonal entries)"
    )]
    CoupledMass {
        /// One of them.
        row: usize,
        /// The other.
        column: usize,
        /// The entry.
        value: f64,
        /// Largest entry in magnitude, `√(m_ii m_jj)`.
        most: f64,
    },
    /// A contact refers to a degree of freedom that does not exist.
    #[error("contact {contact} is at degree of freedom {dof}, but there are {dofs} (counted from 0)")]
    NoSuchDof {
        /// Index of the contact.
        contact: usize,
        /// The requested degree of freedom.
        dof: usize,
        /// Number of degrees of freedom.
        dofs: usize,
    },
    /// The direction of a contact is zero.
    #[error("the direction of a contact has no entry other than zero")]
    EmptyDirection,
    /// The normal of a contact has zero or undefined length.
    #[error("the normal {normal:?} of a contact has no direction")]
    NormalLength {
        /// The normal.
        normal: [f64; 3],
    },
    /// A node cannot move along the normal of its contact.
    #[error("node {node} cannot move along the normal of its contact: it is not there, or the supports hold it")]
    NodeCannotMove {
        /// The node.
        node: usize,
    },
    /// A contact whose direction involves several degrees of freedom, where the partition into contact nodes and the
    /// rest requires a single one.
    #[error(
        "contact {contact} acts on {dofs} degree(s) of freedom in a direction of its own: the held-modes reduction \
         needs contacts at \
         single degrees of freedom; use open modes"
    )]
    NotASingleDof {
        /// Index of the contact.
        contact: usize,
        /// Number of degrees of freedom of its direction.
        dofs: usize,
    },
    /// The positions of a structure in space are unknown, and so are its rigid-body motions.
    #[error(
        "the structure is one in space, but the places of its nodes are not known: the held-modes reduction cannot \
         tell whether it floats"
    )]
    PlacesUnknown,
    /// A rule that moves mass along an axis, for a structure that has none.
    #[error(
        "the mass redistribution '{rule}' is one for straight structures; contact degree of freedom {dof} is one in \
         space"
    )]
    StraightOnly {
        /// Name of the rule.
        rule: &'static str,
        /// Contact degree of freedom.
        dof: usize,
    },
    /// The stiffness of an elastic stop cannot be used.
    #[error("the contact stiffness of contact {contact} is {stiffness:e} N/m; it has to be positive and finite")]
    ContactStiffness {
        /// Index of the contact.
        contact: usize,
        /// Its stiffness.
        stiffness: f64,
    },
    /// A rigid stop in conventional harmonic balance, where the contact node moves in harmonics and only the spring of
    /// the stop follows the contact law.
    #[error("contact {contact} is rigid, but harmonic balance of the contact node needs a contact stiffness")]
    RigidStop {
        /// Index of the contact.
        contact: usize,
    },
    /// A model with massless contact nodes was requested, but there is no contact.
    #[error("the structure has no contact, so that there is no contact mass to redistribute")]
    NoContact,
    /// Every degree of freedom has a contact, so that no mass remains.
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
    /// Not enough neighbours can take the mass of a contact.
    #[error(
        "the mass of the {kind} contact at {position} m cannot be moved: its {found} free, massive neighbours are too \
         few or too light",
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
    /// Moving the mass of the contacts makes the remaining mass matrix indefinite.
    #[error("moving the mass of the contacts leaves a mass matrix that is not positive definite, at the {kind} of \
        {position} m", kind = .kind.name())]
    IndefiniteMass {
        /// Degree of freedom at which the factorisation stopped.
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
    /// An imposed frequency is not positive, or not above the previous one.
    #[error(
        "imposed frequency {number} is {hz} Hz; expected more than {low} Hz, frequencies ascend",
        number = .index + 1, hz = hertz(*.value), low = hertz(*.below)
    )]
    ImposedFrequency {
        /// Its index.
        index: usize,
        /// The frequency, rad/s.
        value: f64,
        /// The previous one, rad/s; zero for the first.
        below: f64,
    },
    /// More frequencies are imposed than there are modes.
    #[error("frequencies of {wanted} modes are wanted, but the structure has {found} {} with motion of the kind \
        '{kind}'", if *.found == 1 { "mode" } else { "modes" }, kind = .kind.name())]
    TooManyImposed {
        /// Frequencies.
        wanted: usize,
        /// Modes.
        found: usize,
        /// The kind of degree of freedom that they move.
        kind: DofKind,
    },
    /// The last imposed frequency exceeds that of the next mode, which is kept: their numbers would be exchanged.
    #[error(
        "the last imposed frequency, {imposed} Hz, is not below the next mode, which keeps its {next} Hz: impose one \
         on that mode too",
        imposed = hertz(*.imposed), next = hertz(*.next)
    )]
    ImposedAboveNext {
        /// The imposed frequency, rad/s.
        imposed: f64,
        /// That of the next mode, rad/s.
        next: f64,
    },
    /// A frequency is imposed on a rigid-body motion.
    #[error("mode {mode} is a rigid-body motion: frequencies are imposed on structures that are held")]
    ImposedOnRigidBody {
        /// Number of the mode, from 1.
        mode: usize,
    },
    /// Too many degrees of freedom for imposed frequencies.
    #[error(
        "imposed frequencies couple all degrees of freedom that their modes move: {dofs} of them, {limit} at most; \
         take fewer elements"
    )]
    ImposedSize {
        /// Degrees of freedom that the modes move.
        dofs: usize,
        /// The maximum.
        limit: usize,
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
    /// Adds the failed computation to an error of linear algebra.
    pub(crate) fn during(what: &'static str) -> impl FnOnce(LinalgError) -> Self {
        move |source| Self::Linalg { what, source }
    }
}

/// Hz to ten digits, of rad/s.
fn hertz(omega: f64) -> f64 {
    rounded(omega / std::f64::consts::TAU, 10)
}
