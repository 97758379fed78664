use nlmodes_contact::LcpError;
use nlmodes_linalg::{LinalgError, rounded};
use nlmodes_modal::ModalError;
use nlmodes_model::ModelError;
use nlmodes_model::reduction::ReductionError;
use thiserror::Error;

/// Why a periodic problem cannot be set up or evaluated.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum HbmError {
    /// No harmonic, or more than can be handled.
    #[error("{found} harmonics were asked for; 1 to {most} are possible")]
    Harmonics {
        /// Harmonics asked for.
        found: usize,
        /// Most harmonics.
        most: usize,
    },
    /// The samples of a period cannot carry the harmonics.
    #[error("{harmonics} harmonics need at least {needed} samples a period, not {samples}")]
    Samples {
        /// Harmonics asked for.
        harmonics: usize,
        /// Samples asked for.
        samples: usize,
        /// Fewest samples.
        needed: usize,
    },
    /// Laws of force together with damping that couples modes.
    #[error("laws of force beside damping that couples modes: give the dampers as laws too")]
    LawsBesideCoupledModes,
    /// Laws of force have no place at rest under static loads.
    #[error(
        "no place at rest is found under the static loads: the laws of force may give way under them, or hold a \
        structure that floats without them"
    )]
    LawsAtRest,
    /// The mode number is zero or beyond the number of modes.
    #[error("mode {mode} does not exist: the structure has {available} \
        {}", if *.available == 1 { "mode" } else { "modes" })]
    NoSuchMode {
        /// The mode asked for, from 1.
        mode: usize,
        /// Modes that there are.
        available: usize,
    },
    /// The linear mode does not move any contact.
    #[error(
        "mode {mode} ({frequency_hz:.4} Hz) never {}: its largest motion at a contact is {ratio:.1e} of its largest \
         motion{}",
        if *.is_pressed { "lifts off" } else { "touches" },
        .first.map_or_else(String::new, |(first, hz)| format!("; the next one that does is mode {first} ({hz:.4} Hz)"))
    )]
    NeverTouches {
        /// The mode, from 1.
        mode: usize,
        /// Its frequency, Hz.
        frequency_hz: f64,
        /// Contact motion over largest motion.
        ratio: f64,
        /// Contacts press at rest.
        is_pressed: bool,
        /// The next mode that moves a contact, and its frequency, Hz, if one was found.
        first: Option<(usize, f64)>,
    },
    /// The contact nodes were all that had mass of what moves with them.
    #[error(
        "mode {mode} ({frequency_hz:.4} Hz) moves no contact: all that moves with the contacts has lost its mass with \
            them. A finer mesh \
         has other nodes with mass, a mass redistribution by \"move\" or \"conserve\" needs some too"
    )]
    NoMassBehindContacts {
        /// The mode, from 1.
        mode: usize,
        /// Its frequency, Hz.
        frequency_hz: f64,
    },
    /// A contact touches without force at rest, so that no linear motion precedes contact.
    #[error("contact {contact} touches at rest without force (gap {gap} m): there is no linear mode to start from",
        gap = rounded(*.gap, 6))]
    TouchesAtRest {
        /// Index of the contact.
        contact: usize,
        /// Its gap.
        gap: f64,
    },
    /// A contact presses at rest: the open modes are not those of the motion about rest.
    #[error(
        "contact {contact} presses at rest (gap {gap} m): the structure does not vibrate in the modes that it has with \
        open contacts",
        gap = rounded(*.gap, 6)
    )]
    PressedAtRest {
        /// Index of the contact.
        contact: usize,
        /// Its gap.
        gap: f64,
    },
    /// The law whose amplitude is given does not move in the mode.
    #[error("the first spring is at a node of mode {mode}: its amplitude does not say where the mode begins")]
    LawAtNode {
        /// Number of the mode, from 1.
        mode: usize,
    },
    /// The mode has no frequency (a rigid-body mode).
    #[error(
        "mode {mode} is a rigid-body mode, which strains nothing: it has no frequency to start from{}",
        .first_elastic.map_or_else(String::new, |first| format!("; the first mode that vibrates is mode {first}"))
    )]
    RigidBodyMode {
        /// The mode, from 1.
        mode: usize,
        /// The lowest mode that has a frequency, if there is one.
        first_elastic: Option<usize>,
    },
    /// Frequency or coefficients are not usable numbers.
    #[error("the motion has frequency {omega} rad/s and energy {energy} J; both must be positive and finite")]
    Motion {
        /// Angular frequency.
        omega: f64,
        /// Averaged kinetic energy.
        energy: f64,
    },
    /// Frequency, negative damping or level are not usable numbers.
    #[error(
        "the motion has frequency {omega} rad/s, negative damping {xi} 1/s and load level {level}; the frequency must \
            be positive, all finite"
    )]
    OperatingPoint {
        /// Angular frequency.
        omega: f64,
        /// Negative damping.
        xi: f64,
        /// Level of the load.
        level: f64,
    },
    /// The drive point does not move, so that it has no phase.
    #[error("the drive point does not move in harmonic {harmonic}: it has no phase")]
    DriveAtRest {
        /// The harmonic.
        harmonic: usize,
    },
    /// The load has harmonics that the motion has not.
    #[error("the load has harmonic {load}, the motion only {harmonics}")]
    LoadBeyond {
        /// Highest harmonic of the load.
        load: usize,
        /// Harmonics of the motion.
        harmonics: usize,
    },
    /// Parts of a problem have different sizes.
    #[error("{what}: {found} where {expected} are expected")]
    Size {
        /// The part.
        what: &'static str,
        /// Its size should be this.
        expected: usize,
        /// Its size is this.
        found: usize,
    },
    /// A part of a problem is not finite.
    #[error("{what}: not all numbers are finite")]
    NotFinite {
        /// The part.
        what: &'static str,
    },
    /// The contact problem at one instant has no solution.
    #[error("the contact problem at phase {tau:.6} rad")]
    Contact {
        /// Phase `ωt`.
        tau: f64,
        /// The failure.
        #[source]
        source: LcpError,
    },
    /// Conventional harmonic balance with a contact spring so stiff that rounding takes the place of the structure's
    /// own stiffness.
    #[error(
        "the spring of contact {contact} is {ratio:.0e} times as stiff as the structure behind it: harmonic balance \
            with a contact \
         stiffness is possible up to {most:.0e}; a rigid stop (ms-hbm) has no such limit"
    )]
    ContactTooStiff {
        /// Index of the contact.
        contact: usize,
        /// Contact stiffness over the static stiffness of the structure at the contact.
        ratio: f64,
        /// Largest ratio.
        most: f64,
    },
    /// The contact compliance cannot be used.
    #[error("the contact compliance")]
    Compliance(#[source] LcpError),
    /// A factorisation or an eigenproblem failed.
    #[error("{what}")]
    Linalg {
        /// What was being computed.
        what: &'static str,
        /// The failure.
        #[source]
        source: LinalgError,
    },
    /// The linear model.
    #[error("the linear model")]
    Model(#[from] ModelError),
    /// The reduction to modes.
    #[error("the reduction to modes")]
    Reduction(#[source] ReductionError),
    /// The Fourier basis.
    #[error("the Fourier basis")]
    Basis(#[from] ModalError),
}

/// That there are as many of something as expected.
pub(crate) fn agrees(what: &'static str, expected: usize, found: usize) -> Result<(), HbmError> {
    if found == expected { Ok(()) } else { Err(HbmError::Size { what, expected, found }) }
}

impl From<ReductionError> for HbmError {
    fn from(error: ReductionError) -> Self {
        match error {
            ReductionError::Model(error) => Self::Model(error),
            ReductionError::Linalg { what, source } => Self::Linalg { what, source },
            other => Self::Reduction(other),
        }
    }
}
