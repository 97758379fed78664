//! The tables of a scene file as they are written, one struct a table.
//!
//! Every field is optional here, whatever the scene demands: what is missing or wrong is reported by the check against
//! the [schema](crate::schema), all of it at once, and then taken out. The attributes carry that schema: `required`,
//! limits, `default` and `unit` are read by the check and printed by `nlmodes-cli schema`, and the field's comment
//! becomes its description in both.

mod continuation;
mod matrices;
mod method;
mod output;
mod overlay;
mod parts;
mod records;
mod reduction;
mod response;
mod structure;
mod updating;
mod virtual_test;

pub use continuation::{DEFAULT_MAX_BRANCHES, DEFAULT_MAX_POINTS, RawContinuation};
pub use matrices::{NameOrNumbers, NumberOrName, RawMatrices, RawMatrixScene, RawNodeContact, RawNormal};
pub use method::{DEFAULT_MAX_HARMONICS, RawMethod};
pub use output::RawOutput;
pub use overlay::RawOverlay;
pub use parts::{RawMassPoint, RawSegment, RawSpring};
pub use records::{RawChannel, RawExtraction, RawLinearModes, RawPbmifHarmonics, RawRecordScene, RawStop};
pub use reduction::RawReduction;
pub use response::{
    RawBaseMotion, RawDamping, RawDashpot, RawDirection, RawForce, RawOwnDamping, RawRayleigh, RawResponse,
};
pub use structure::{RawMaterial, RawModes, RawSection, RawStructure};
pub use updating::RawUpdating;
pub use virtual_test::{
    RawBackbone, RawExciter, RawLoop, RawNoise, RawSchedule, RawTestScene, RawTestStop, RawVirtualTest,
};

use schemars::JsonSchema;
use serde::Deserialize;

use crate::scene::{Direction, Side};

/// Most structures of a scene.
const MAX_BODIES: u32 = 1000;

/// What scenes of all structures that are computed share.
#[derive(Debug, Default, Deserialize, JsonSchema)]
pub struct RawAnalysis {
    /// Title of tables and figures; default: the name of the file
    pub title: Option<String>,
    /// How the structure is reduced
    pub reduction: Option<RawReduction>,
    /// Parameters of a rod or beam that are fitted to given linear frequencies first
    pub updating: Option<RawUpdating>,
    /// Damping of the structure with its contacts open; responses need it
    pub damping: Option<RawDamping>,
    /// Periodic forces, each under its own heading `[[force]]`
    pub force: Option<Vec<RawForce>>,
    /// A base that shakes, in place of forces
    pub base_motion: Option<RawBaseMotion>,
    /// Damped and forced motions, in place of the conservative nonlinear mode; several stand under headings
    /// `[[response]]`
    pub response: Option<Vec<RawResponse>>,
    /// How the periodic motion is computed; several methods stand under headings `[[method]]`
    #[schemars(required)]
    pub method: Option<RawMethod>,
    /// How far the branch is followed
    #[schemars(required)]
    pub continuation: Option<RawContinuation>,
    /// Results of other runs or of tests that figures and page show beside those of the scene, each under a heading
    /// `[[overlay]]`
    pub overlay: Option<Vec<RawOverlay>>,
    /// Where results go
    pub output: Option<RawOutput>,
}

/// A scene of nlmodes: a structure with one-sided stops, and how its nonlinear mode is to be computed. SI units
/// throughout.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(title = "nlmodes scene")]
pub struct RawScene {
    /// The structure: geometry, mesh and supports
    #[schemars(required)]
    pub structure: Option<RawStructure>,
    /// One-sided stops, any number, each under its own heading `[[contact]]`
    pub contact: Option<Vec<RawContact>>,
    /// Everything else
    #[serde(flatten)]
    pub analysis: RawAnalysis,
}

/// A scene of nlmodes: several rods and beams, each under its own heading `[[structure]]`, with contacts between them
/// and one-sided stops.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[schemars(title = "nlmodes scene of several structures")]
pub struct RawBodiesScene {
    /// The structures, numbered from 1
    #[schemars(required, length(min = 1, max = MAX_BODIES))]
    pub structure: Option<Vec<RawStructure>>,
    /// One-sided contacts, any number, each under its own heading `[[contact]]`
    pub contact: Option<Vec<RawContact>>,
    /// Everything else
    #[serde(flatten)]
    pub analysis: RawAnalysis,
}

/// A stop on one side of a node.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawContact {
    /// Position along the axis, measured from the start; must be a node of the mesh
    #[schemars(required, extend("unit" = "m", "minimum" = 0.0))]
    pub at_m: Option<f64>,
    /// Direction of the motion that the stop limits
    #[schemars(required)]
    pub direction: Option<Direction>,
    /// Side on which the stop stands
    #[schemars(required)]
    pub side: Option<Side>,
    /// Clearance at rest; 0 touches, a negative one presses
    #[schemars(required, extend("unit" = "m"))]
    pub gap_m: Option<f64>,
    /// Contact stiffness of the stop; left out, it is rigid, and with method "hbm" it has
    /// `method.contact_stiffness_n_m`
    #[schemars(extend("unit" = "N/m", "exclusiveMinimum" = 0.0))]
    pub stiffness_n_m: Option<f64>,
    /// Damper beside that stiffness, for responses and damped modes; it only ever pushes, and the stop is left where
    /// the force of both vanishes
    #[schemars(extend("unit" = "N s/m", "exclusiveMinimum" = 0.0))]
    pub damping_n_s_m: Option<f64>,
    /// Number of the structure of several to which `at_m` belongs, from 1 in the order of the file
    #[schemars(range(min = 1, max = MAX_BODIES))]
    pub structure: Option<u32>,
    /// What is touched in place of a rigid stop: a node of another structure
    pub against: Option<RawAgainst>,
}

/// A node of another structure.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawAgainst {
    /// Number of the structure, from 1 in the order of the file
    #[schemars(required, range(min = 1, max = MAX_BODIES))]
    pub structure: Option<u32>,
    /// Position along its axis, measured from its start; must be a node of its mesh
    #[schemars(required, extend("unit" = "m", "minimum" = 0.0))]
    pub at_m: Option<f64>,
}

/// Where results go.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RawDirectory {
    /// Directory of the result files, from where the program is started; default: results/<name of the file>
    #[schemars(length(min = 1))]
    pub directory: Option<String>,
}
