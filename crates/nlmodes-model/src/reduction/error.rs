use nlmodes_contact::LcpError;
use nlmodes_linalg::LinalgError;
use thiserror::Error;

use crate::ModelError;

/// Why a structure cannot be reduced.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ReductionError {
    /// Two parts have different sizes.
    #[error("{what}: {found} where {expected} was expected")]
    Dimension {
        /// The part.
        what: &'static str,
        /// The size that it should have.
        expected: usize,
        /// The size that it has.
        found: usize,
    },
    /// A number is NaN or infinite.
    #[error("{what} {index} is {value}, which is not a finite number")]
    NotFinite {
        /// The quantity.
        what: &'static str,
        /// Its index.
        index: usize,
        /// The number.
        value: f64,
    },
    /// The compliance of a stop is negative.
    #[error(
        "the stop of contact {contact} has the compliance {value:e} m/N; it is zero for a rigid stop and positive \
        otherwise"
    )]
    StopCompliance {
        /// Index of the contact.
        contact: usize,
        /// Its compliance, m/N.
        value: f64,
    },
    /// The limit of frequency up to which modes are wanted is not a positive number.
    #[error("modes are wanted up to {omega} rad/s; expected a positive frequency")]
    FrequencyLimit {
        /// The limit, rad/s.
        omega: f64,
    },
    /// The frequencies of modes that were computed elsewhere do not ascend from zero.
    #[error(
        "mode {mode} has ω² = {omega_squared:e} rad²/s² behind {before:e} rad²/s²; expected zero for each rigid-body \
        motion, and then squares that ascend"
    )]
    Descending {
        /// The mode, from 1.
        mode: usize,
        /// Its `ω²`, rad²/s².
        omega_squared: f64,
        /// That of the mode before, zero before the first.
        before: f64,
    },
    /// A flexibility that was computed elsewhere is not symmetric.
    #[error(
        "the flexibility between rows {row} and {column} is {value:e} m/N, and {mirrored:e} m/N between {column} and \
        {row}; expected a symmetric matrix"
    )]
    NotSymmetric {
        /// The row, from 1.
        row: usize,
        /// The column, from 1.
        column: usize,
        /// The flexibility at a place, m/N.
        value: f64,
        /// The flexibility at its mirror, m/N.
        mirrored: f64,
    },
    /// A residual flexibility that was computed elsewhere is negative in some direction.
    #[error(
        "the flexibility beyond the modes is negative, mostly at row {row}: it is {flexibility:e} m/N there; expected \
        a symmetric positive semidefinite matrix"
    )]
    NegativeFlexibility {
        /// The row, from 1.
        row: usize,
        /// The residual flexibility of that row, m/N.
        flexibility: f64,
    },
    /// A static flexibility that was computed elsewhere is less than what the modes have of it.
    #[error(
        "the static flexibility is less than what the modes alone give, mostly at row {row}: {flexibility:e} m/N \
        there, and {modal:e} m/N of the modes; expected the whole static flexibility, that of the modes included"
    )]
    LessThanModes {
        /// The row, from 1.
        row: usize,
        /// Its static flexibility, m/N.
        flexibility: f64,
        /// What the elastic modes have of it, m/N.
        modal: f64,
    },
    /// A static flexibility of a structure that floats.
    #[error(
        "the structure floats (mode 1 has ω² = 0), so that it has no static flexibility; expected the residual one, \
        of loads in balance with the inertia forces of the modes"
    )]
    FloatingFlexibility,
    /// No mode is left to describe the motion.
    #[error("the structure has no mode to retain ({wanted} wanted)")]
    NoMode {
        /// Modes asked for.
        wanted: usize,
    },
    /// A structure that floats, with fewer modes than rigid-body motions: what is left out has no static answer.
    #[error("the {retained} retained modes are all rigid-body motions: retain more")]
    OnlyRigidModes {
        /// Modes retained.
        retained: usize,
    },
    /// Motions with neither stiffness nor mass, which a contact could press away without any force.
    #[error(
        "contact {contact} (counted from 0) feels hourglass motions: {motions} motions of the structure have neither \
        stiffness nor mass, as elements with too few points of \
         integration leave them (C3D20R, one across the thickness); expected two such elements across, or others"
    )]
    Hourglass {
        /// Index of the contact.
        contact: usize,
        /// How many such motions there are.
        motions: usize,
    },
    /// A structure that has buckled.
    #[error(
        "the stiffness is negative in mode {mode} (ω² = {omega_squared:.3e} rad²/s²): the structure has buckled, and \
        does not vibrate about this state"
    )]
    Unstable {
        /// The mode, from 1.
        mode: usize,
        /// `φᵀ K φ`, rad²/s².
        omega_squared: f64,
    },
    /// A contact whose motion others determine.
    #[error(
        "the motion of contact {contact} (counted from 0) follows from those of other contacts or from the \
        {retained} retained modes: \
         {left:.1e} of its flexibility is left; take it away, or retain fewer modes. A node has as many directions \
         of contact as it may move in, of which stops that face each \
         other exactly are one; and a structure with few unknowns has nothing left once all of its modes are \
         retained, before a rigid stop: one with a stiffness needs nothing"
    )]
    DependentContact {
        /// Index of the contact.
        contact: usize,
        /// Its residual flexibility with the contacts before it held, over its static one.
        left: f64,
        /// Modes retained.
        retained: usize,
    },
    /// A structure that was reduced elsewhere has no matrices to differentiate by.
    #[error("of a structure that was reduced elsewhere only modes are known: it has no entries of stiffness and mass")]
    ModesGiven,
    /// Modes of one frequency, of which one is retained and another not.
    #[error(
        "mode {mode} has the frequency of one that is left out beside the {retained} retained ones, so that their \
        derivatives have no bounds: retain one mode more or less"
    )]
    CutBetweenModes {
        /// The mode, from 1.
        mode: usize,
        /// Modes retained.
        retained: usize,
    },
    /// The reduced equations make no structure.
    #[error("the reduced structure")]
    Model(#[from] ModelError),
    /// A structure that floats is pressed at rest.
    #[error(
        "the structure floats: where it rests under loads or between stops that it interferes with is not determined \
        by its stiffness"
    )]
    FloatingRest,
    /// A load on rigid-body motions that no contact forces balance.
    #[error("the structure falls away: no forces of its contacts balance the load on it")]
    FallsAway {
        /// How it goes: displacements of all degrees of freedom, n, the largest one.
        motion: Vec<f64>,
    },
    /// A load on rigid-body motions that no contact feels.
    #[error("the structure falls away: the load on it moves it as a rigid body in a way that no contact feels")]
    FallsUnfelt {
        /// How it goes: displacements of all degrees of freedom, n, the largest one.
        motion: Vec<f64>,
    },
    /// The contact problem of the structure at rest has no solution.
    #[error("contact forces at rest")]
    Rest(#[source] LcpError),
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

impl ReductionError {
    /// Names what was being computed when linear algebra failed.
    pub(crate) fn during(what: &'static str) -> impl FnOnce(LinalgError) -> Self {
        move |source| Self::Linalg { what, source }
    }
}
