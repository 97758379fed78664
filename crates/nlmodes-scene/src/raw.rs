//! The tables of a scene file as they are written, one struct a table.
//!
//! They are read from what conforms to their [schema](crate::schema): the attributes carry its limits, defaults and
//! units, and the field's comment becomes its description. Tables that mean the same beside any structure are those of
//! [the scene](crate::scene) itself.

mod matrices;
mod method;
mod parts;
mod records;
mod reduced;
mod response;
mod sensitivity;
mod springs;
mod static_loads;
mod structure;
mod transient;
mod virtual_test;

pub use matrices::{NameOrNumbers, NumberOrName, RawMatrices, RawMatrixScene, RawNodeContact, RawNormal};
pub use method::{DEFAULT_MAX_HARMONICS, RawMethod};
pub use parts::{RawSegment, RawSpring};
pub use records::{
    RawChannel, RawExtraction, RawLinearModes, RawPbmifHarmonics, RawRecordScene, RawRecordSegment, RawStop,
};
pub use reduced::{RawReduced, RawReducedScene, RawRowContact};
pub use response::{
    RawBaseMotion, RawDamping, RawDashpot, RawDirection, RawForce, RawModeDamping, RawPlace, RawResponse,
};
pub use sensitivity::RawSensitivity;
pub use springs::{RawLaw, RawLawSpring};
pub use static_loads::{RawGravity, RawStaticDisplacement, RawStaticForce, RawThermal};
pub use structure::{RawMaterial, RawSection, RawStructure};
pub use transient::{RawStart, RawTransient, RawTransientLoad, StartWord};
pub use virtual_test::{RawExciter, RawNoise, RawSchedule, RawTestScene, RawVirtualTest};

use schemars::JsonSchema;
use serde::Deserialize;

use crate::scene::{Continuation, Direction, Output, Overlay, Reduction, Side, Updating};

/// Most structures of a scene.
const MAX_BODIES: u32 = 1000;

/// What scenes of all structures that are computed share.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawAnalysis {
    /// Title of tables and figures; default: the name of the file
    pub title: Option<String>,
    /// How the structure is reduced
    pub reduction: Option<Reduction>,
    /// Parameters of a rod or beam that are first fitted to given linear frequencies
    pub updating: Option<Updating>,
    /// Damping of the structure with open contacts; required for responses
    pub damping: Option<RawDamping>,
    /// Periodic forces, each under its own heading `[[force]]`
    pub force: Option<Vec<RawForce>>,
    /// Motion of the base, instead of forces
    pub base_motion: Option<RawBaseMotion>,
    /// Gravity
    pub gravity: Option<RawGravity>,
    /// Constant forces, each under its own heading `[[static_force]]`
    pub static_force: Option<Vec<RawStaticForce>>,
    /// A uniform rise in temperature, or thermal forces
    pub thermal: Option<RawThermal>,
    /// Displacements under static loads, as computed by another program
    pub static_displacement: Option<RawStaticDisplacement>,
    /// Springs and dampers with a law of force beside the stops, each under its own heading `[[spring]]`
    pub spring: Option<Vec<RawLawSpring>>,
    /// Damped and forced motions, instead of the conservative nonlinear mode; several are given under headings
    /// `[[response]]`
    pub response: Option<Vec<RawResponse>>,
    /// A motion in time under any loads, instead of a branch or responses
    pub transient: Option<RawTransient>,
    /// Parameters for which every point gets its derivatives, each under its own heading `[[sensitivity]]`
    #[schemars(length(max = 1000))]
    pub sensitivity: Option<Vec<RawSensitivity>>,
    /// How the periodic motion is computed; several methods are given under headings `[[method]]`
    #[serde(default)]
    pub method: RawMethod,
    /// Where the branch starts, where it ends, and what it does on the way
    #[serde(default)]
    pub continuation: Continuation,
    /// Results of other runs or tests to be shown in figures and on the page beside those of the scene, each under a
    /// heading `[[overlay]]`
    pub overlay: Option<Vec<Overlay>>,
    /// Where results are written, and which
    pub output: Option<Output>,
    /// Whether a stop has a law of force, which the tables of contacts say.
    #[serde(skip)]
    #[schemars(skip)]
    pub has_law_stops: bool,
}

impl RawAnalysis {
    /// Whether curves of responses are computed: they are asked for, or springs or stops with a law of force are there,
    /// whose nonlinear mode is one.
    pub fn has_responses(&self) -> bool {
        self.response.as_ref().is_some_and(|responses| !responses.is_empty()) || self.has_laws()
    }

    /// The same beside these stops.
    pub fn beside<'a>(mut self, mut stops: impl Iterator<Item = &'a RawStopLaw>) -> Self {
        self.has_law_stops = stops.any(|stop| stop.stiffness_hertz_n_m15.is_some());
        self
    }

    /// Whether there are springs with a law of force.
    pub fn has_springs(&self) -> bool {
        self.spring.as_ref().is_some_and(|springs| !springs.is_empty())
    }

    /// Whether there are springs or stops with a law of force.
    pub fn has_laws(&self) -> bool {
        self.has_law_stops || self.has_springs()
    }
}

/// A scene of nlmodes: a structure with one-sided stops, and how its nonlinear mode is to be computed. SI units
/// throughout.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(title = "nlmodes scene")]
pub struct RawScene {
    /// The structure: geometry, mesh and supports
    pub structure: RawStructure,
    /// One-sided stops, any number, each under its own heading `[[contact]]`
    pub contact: Option<Vec<RawContact>>,
    /// Everything else
    #[serde(flatten)]
    pub analysis: RawAnalysis,
}

/// A scene of nlmodes: several rods and beams, each under its own heading `[[structure]]`, with contacts between them
/// and one-sided stops.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(title = "nlmodes scene of several structures")]
pub struct RawBodiesScene {
    /// The structures, numbered from 1
    #[schemars(length(min = 1, max = MAX_BODIES))]
    pub structure: Vec<RawStructure>,
    /// One-sided contacts, any number, each under its own heading `[[contact]]`
    pub contact: Option<Vec<RawContact>>,
    /// Everything else
    #[serde(flatten)]
    pub analysis: RawAnalysis,
}

/// A stop on one side of a node.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawContact {
    /// Position along the axis, measured from the start; the mesh gets a node there
    #[schemars(extend("unit" = "m", "minimum" = 0.0))]
    pub at_m: f64,
    /// Direction of the motion that the stop limits
    pub direction: Direction,
    /// Side on which the stop is
    pub side: Side,
    /// Clearance at rest; at 0 the stop just touches, and a negative gap preloads it
    #[schemars(extend("unit" = "m"))]
    pub gap_m: f64,
    /// How it yields and dissipates
    #[serde(flatten)]
    pub stop: RawStopLaw,
    /// Coefficient of friction for the estimate of friction power in `contacts.csv`; the motion itself is computed
    /// without friction
    #[schemars(range(min = 0.0))]
    pub friction_estimate: Option<f64>,
    /// Number of the structure to which `at_m` belongs, if there are several; from 1 in the order of the file
    #[schemars(range(min = 1, max = MAX_BODIES))]
    pub structure: Option<u32>,
    /// What is touched instead of a rigid stop: a node of another structure
    pub against: Option<RawAgainst>,
}

/// How a stop yields and dissipates, whatever touches it.
#[derive(Debug, Default, Deserialize, JsonSchema)]
pub struct RawStopLaw {
    /// Contact stiffness; without it the stop is rigid, or with method "hbm" has `method.contact_stiffness_n_m`
    #[schemars(extend("unit" = "N/m", "exclusiveMinimum" = 0.0))]
    pub stiffness_n_m: Option<f64>,
    /// Damper in parallel with that stiffness, for responses and damped modes; the stop only pushes, and contact ends
    /// when the sum of both forces vanishes
    #[schemars(extend("unit" = "N s/m", "exclusiveMinimum" = 0.0))]
    pub damping_n_s_m: Option<f64>,
    /// Stiffness of a stop whose force is this times a power of the approach, as that of a ball on a plate after Hertz,
    /// in N over that power of a metre; such stops follow those that have none
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub stiffness_hertz_n_m15: Option<f64>,
    /// Exponent of the approach; default 1.5
    #[schemars(range(min = 1.0, max = 20.0))]
    pub exponent: Option<f64>,
    /// Dissipation after Hunt and Crossley, for responses and damped modes: the force is multiplied by one plus this
    /// times the approach velocity, and never pulls
    #[schemars(extend("unit" = "s/m", "minimum" = 0.0))]
    pub dissipation_s_m: Option<f64>,
}

/// A node of another structure.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawAgainst {
    /// Number of the structure, from 1 in the order of the file
    #[schemars(range(min = 1, max = MAX_BODIES))]
    pub structure: u32,
    /// Position along its axis, measured from its start; must be a node of its mesh
    #[schemars(extend("unit" = "m", "minimum" = 0.0))]
    pub at_m: f64,
}
