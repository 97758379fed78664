//! Values of scenes that are one of a few words.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Declares enums whose values are written in scenes in lower case with hyphens.
macro_rules! choices {
    ($($(#[$doc:meta])* $name:ident { $($(#[$vdoc:meta])* $variant:ident = $text:literal),+ $(,)? })+) => {$(
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
        pub enum $name {
            $($(#[$vdoc])* #[serde(rename = $text)] $variant),+
        }

        impl $name {
            /// All of them.
            #[allow(dead_code, reason = "few enums are gone through")]
            pub const ALL: &[Self] = &[$(Self::$variant),+];

            /// As it is written in a scene.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $text),+
                }
            }
        }
    )+};
}

choices! {
    /// What a channel measures.
    MeasuredQuantity {
        /// Force
        Force = "force",
        /// Displacement
        Displacement = "displacement",
        /// Velocity
        Velocity = "velocity",
        /// Acceleration
        Acceleration = "acceleration",
        /// Phase of the excitation
        Phase = "phase",
    }
    /// What a channel is there for.
    ChannelRole {
        /// The force that excites the structure
        Excitation = "excitation",
        /// The response where the force acts
        DrivePoint = "drive-point",
        /// The response elsewhere
        Response = "response",
        /// The force at the stop
        Contact = "contact",
        /// The phase of the oscillator that drives the excitation
        ExcitationPhase = "excitation-phase",
    }
    /// Which damped or forced motions are followed.
    ResponseKind {
        /// The response at each level over the frequency
        Frequency = "frequency",
        /// The response at one frequency over the level
        Force = "force",
        /// Motions whose drive point lags the load by a given angle
        PhaseResonance = "phase-resonance",
        /// The damped nonlinear mode: the motion that goes on by itself while negative damping makes up for what is
        /// lost
        DampedMode = "damped-mode",
        /// The conservative nonlinear mode, for comparison with the others
        Mode = "mode",
        /// The force in several harmonics that brings the damped structure into its conservative nonlinear mode
        Appropriation = "appropriation",
    }
    /// What stops do while the base shakes.
    #[derive(Default)]
    StopOfBase {
        /// They move with the base
        #[default]
        Moves = "moves",
        /// They are fixed in space
        Fixed = "fixed",
    }
    /// What the structure is.
    StructureKind {
        /// Axial motion only
        Rod = "rod",
        /// Axial motion, deflection and rotation (Timoshenko)
        Beam = "beam",
    }
    /// A structure from files.
    MatricesKind {
        /// Matrices of a finite-element program
        Matrices = "matrices",
    }
    /// A structure that was reduced elsewhere.
    ReducedKind {
        /// Modes and flexibility that another program computed
        Reduced = "reduced",
    }
    /// How a structure is reduced.
    #[derive(Default)]
    ReductionKind {
        /// Modes with open contacts, and the static flexibility of all others
        #[default]
        #[serde(alias = "free-interface")]
        #[schemars(extend("alias" = "free-interface"))]
        OpenModes = "open-modes",
        /// Modes with held contacts, the mass of their nodes left out or moved
        #[serde(alias = "fixed-interface")]
        #[schemars(extend("alias" = "fixed-interface"))]
        HeldModes = "held-modes",
    }
    /// Mass matrix of the elements.
    #[derive(Default)]
    MassMatrix {
        /// From the shape functions of the stiffness
        #[default]
        Consistent = "consistent",
        /// Half of an element's mass at each of its nodes
        Lumped = "lumped",
    }
    /// Support of an end.
    Support {
        /// Nothing moves
        Clamped = "clamped",
        /// Displacements held, rotation free
        Pinned = "pinned",
        /// Rotation held, deflection free
        Sliding = "sliding",
        /// Everything free
        Free = "free",
    }
    /// Direction of the motion that a stop limits.
    Direction {
        /// Along the axis
        Axial = "axial",
        /// Across the axis, beam only
        Transverse = "transverse",
    }
    /// What a spring holds back.
    SpringDirection {
        /// Motion along the axis
        Axial = "axial",
        /// Motion across the axis, beam only
        Transverse = "transverse",
        /// Rotation of the cross section, beam only
        Rotation = "rotation",
    }
    /// Side on which a stop limits the motion.
    #[derive(Default)]
    Side {
        /// On the positive side
        #[default]
        Positive = "positive",
        /// On the negative side
        Negative = "negative",
    }
    /// Method for the periodic motion.
    #[derive(Default)]
    MethodKind {
        /// Mixed shooting-harmonic balance with massless contact nodes and rigid stops
        #[default]
        MsHbm = "ms-hbm",
        /// Harmonic balance with elastic stops of `contact_stiffness_n_m`
        Hbm = "hbm",
        /// Exact shooting, with massless contact nodes, or with contact nodes that keep their mass on elastic stops
        Shooting = "shooting",
    }
    /// Method for the backbone beside a virtual test.
    BackboneMethod {
        /// Mixed shooting-harmonic balance before a rigid stop
        MsHbm = "ms-hbm",
        /// Harmonic balance of the rig's modes and stop
        Hbm = "hbm",
        /// The damped nonlinear mode of the rig's modes and stop
        DampedMode = "damped-mode",
        /// What the loop holds: motions of the rig's modes and stop whose drive point lags the force as it should
        PhaseResonance = "phase-resonance",
    }
    /// For which points Floquet multipliers are computed.
    #[derive(Default)]
    StabilityChoice {
        /// For all points of shooting, and for those in harmonics of structures of up to 40 modes and 16 contacts
        #[default]
        #[serde(alias = "figures")]
        #[schemars(extend("alias" = "figures"))]
        Auto = "auto",
        /// For all points
        #[serde(alias = "all")]
        #[schemars(extend("alias" = "all"))]
        Always = "always",
        /// For none
        Never = "never",
    }
    /// How the instants of closing and opening are found.
    #[derive(Default)]
    Switching {
        /// As roots, with Fourier integrals in closed form
        #[default]
        Exact = "exact",
        /// On an equidistant grid of `samples` per period
        Sampled = "sampled",
    }
    /// What happens to the mass of the contact degrees of freedom.
    #[derive(Default)]
    MassRule {
        /// It is left out
        #[default]
        Drop = "drop",
        /// It is moved to the neighbours; total mass and centre of mass are kept
        Move = "move",
        /// It is moved to the neighbours; total mass, centre of mass and moment of inertia are kept
        Conserve = "conserve",
        /// It stays where it is, for hbm
        None = "none",
    }
    /// Parameter of a structure that is fitted to linear frequencies.
    UpdatedParameter {
        /// Young's modulus
        YoungsModulus = "youngs_modulus_pa",
        /// Mass per volume
        Density = "density_kg_m3",
        /// Length; stops keep their nodes
        Length = "length_m",
    }
    /// Solver of the contact problem at an instant.
    #[derive(Default)]
    ContactSolver {
        /// Active set
        #[default]
        ActiveSet = "active-set",
        /// Proximal point iteration
        Proximal = "proximal",
        /// Interior point
        Clarabel = "clarabel",
        /// Pivoting
        Lemke = "lemke",
    }
    /// Time symmetry that a motion is assumed to have.
    #[derive(Default)]
    Symmetry {
        /// Even in time: cosine series only
        #[default]
        Even = "even",
        /// None: full Fourier series with a phase anchor
        None = "none",
    }
    /// Which half-branch is followed at a branch point.
    #[derive(Default)]
    AtBranchPoint {
        /// The branch's own continuation
        #[default]
        Stay = "stay",
        /// The one along which energy grows most
        Switch = "switch",
        /// All, each as a branch of its own
        All = "all",
    }
    /// What is done where an internal resonance leads the branch away.
    #[derive(Default)]
    InternalResonance {
        /// `"skip"` with harmonics, where branch points are passed on the same branch, otherwise `"follow"`
        #[default]
        Auto = "auto",
        /// Follow it
        Follow = "follow",
        /// Leave it out and continue with the backbone beyond it; follow it where no backbone is found there
        Skip = "skip",
    }
    /// Which way a branch leaves its start.
    #[derive(Default)]
    FrequencyDirection {
        /// Toward higher frequencies, or energies
        #[default]
        Up = "up",
        /// Toward lower frequencies, or energies
        Down = "down",
        /// Both, one after the other
        Both = "both",
    }    /// What turns the drive of a virtual test into a force.
    #[derive(Default)]
    ExciterKind {
        /// An electrodynamic shaker, driven by voltage
        #[default]
        Shaker = "shaker",
        /// An ideal force
        Force = "force",
    }
    /// How the loop measures the lag.
    #[derive(Default)]
    LoopDetector {
        /// Least mean squares on the leading harmonics
        #[default]
        Adaptive = "adaptive",
        /// Synchronous demodulation with a low-pass
        Demodulation = "demodulation",
    }
    /// Order of the levels of a test.
    #[derive(Default)]
    LevelOrder {
        /// In their order
        #[default]
        Once = "once",
        /// In their order, and back from the last but one
        ThereAndBack = "there-and-back",
    }
    /// Format of a record's file.
    #[derive(Default)]
    RecordFormat {
        /// Text with named columns
        #[default]
        Csv = "csv",
        /// Universal File Format, dataset 58
        Uff = "uff",
        /// Sound file
        Wav = "wav",
        /// NumPy array
        Npy = "npy",
    }
}
