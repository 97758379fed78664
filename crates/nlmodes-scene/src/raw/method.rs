use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;

use super::RawAnalysis;
use crate::scene::{ContactSolver, MAX_HARMONICS, MassRule, MethodKind, Switching, Symmetry};

/// Most harmonics that an accuracy chooses where the scene does not say.
pub const DEFAULT_MAX_HARMONICS: u32 = 60;
/// Harmonics where the scene says neither how many nor how accurate, of modes and of responses, and those from which
/// the number of modes of a transient follows.
const DEFAULT_HARMONICS: [u32; 3] = [7, 15, 10];
/// Most samples a period that a scene may ask for.
pub const MAX_SAMPLES: u32 = 1 << 20;

/// How the periodic motion is computed.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[schemars(extend("required" = []))]
pub struct RawMethod {
    /// Method
    #[schemars(extend("default" = "ms-hbm"))]
    pub kind: Option<MethodKind>,
    /// Number of the linear mode from which the branch starts, 1 for the lowest
    #[schemars(range(min = 1), extend("default" = 1))]
    pub mode: Option<u32>,
    /// Number of harmonics of the motion, not counting its mean; default: 7 for modes, 15 for responses, 10 for a
    /// transient, chosen with `accuracy`. The estimated errors tell whether more are needed. A list computes one branch
    /// for each. With shooting, the number of harmonics that are written
    #[schemars(schema_with = "one_or_several_harmonics")]
    pub harmonics: Option<Vec<u32>>,
    /// Largest relative error of the frequency, at the same energy, that may come from harmonics and fixed-interface
    /// modes left out. Their numbers are then chosen, that of the harmonics along the branch and at least `harmonics`
    /// or 2
    #[schemars(range(min = 1e-10, max = 0.01))]
    pub accuracy: Option<f64>,
    /// Maximum number of harmonics that `accuracy` may choose
    #[schemars(range(min = 1, max = MAX_HARMONICS), extend("default" = DEFAULT_MAX_HARMONICS))]
    pub max_harmonics: Option<u32>,
    /// How the instants of closing and opening are found
    #[schemars(extend("default" = "exact"))]
    pub switching: Option<Switching>,
    /// Samples of the contact per period, at least 4 times `harmonics`; default: a power of two, 256 or more and at
    /// least 32 times `harmonics`. Results of exact switching do not depend on it
    #[schemars(range(min = 4, max = MAX_SAMPLES))]
    pub samples: Option<u32>,
    /// What happens to the mass of the contact degrees of freedom of a rod or beam: "drop", "move" and "conserve" are
    /// rules of massless contact nodes; default: none is taken away
    pub mass_redistribution: Option<MassRule>,
    /// Solver of the contact problem
    #[schemars(extend("default" = "active-set"))]
    pub contact_solver: Option<ContactSolver>,
    /// Contact stiffness of the stops that have no `stiffness_n_m` of their own, for hbm and shooting
    #[schemars(extend("unit" = "N/m", "exclusiveMinimum" = 0.0))]
    pub contact_stiffness_n_m: Option<f64>,
    /// Symmetry in time that the motion is assumed to have
    #[schemars(extend("default" = "even"))]
    pub symmetry: Option<Symmetry>,
    /// Number of fixed-interface modes that carry the dynamics; default: chosen by the program, for shooting all
    #[schemars(range(min = 1))]
    pub held_modes: Option<u32>,
}

impl RawMethod {
    /// The same with harmonics where neither their number nor an accuracy is given.
    pub fn with_harmonics(&self, scene: &RawAnalysis) -> Self {
        let [of_modes, of_responses, of_transients] = DEFAULT_HARMONICS;
        let default = match scene.transient {
            Some(_) => of_transients,
            None if scene.has_responses() => of_responses,
            None => of_modes,
        };
        let harmonics = self.harmonics.clone().or_else(|| self.accuracy.is_none().then(|| vec![default]));
        Self { harmonics, ..self.clone() }
    }
}

/// A whole number, or a list of them; a single one is read as a list.
fn one_or_several_harmonics(_: &mut SchemaGenerator) -> Schema {
    json_schema!({
        "type": ["integer", "array"],
        "minimum": 1,
        "maximum": MAX_HARMONICS,
        "items": { "type": "integer", "minimum": 1, "maximum": MAX_HARMONICS },
        "minItems": 1,
        "maxItems": 100,
    })
}
