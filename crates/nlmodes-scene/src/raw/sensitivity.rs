use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Deserialize;

/// A parameter by which the points of every curve are differentiated: a number of the scene, or many that change
/// entries of the matrices. One of the keys.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
pub struct RawSensitivity {
    /// A key of the scene with a number, as `--set` takes it: "contact.0.gap_m", "structure.material.youngs_modulus_pa"
    #[schemars(length(min = 1))]
    pub key: Option<String>,
    /// Of a structure from files: a table `parameter,matrix,node,component,other_node,other_component,value` of entries
    /// of `dK/dp` and `dM/dp` in the units of the files, for any number of parameters; matrix is `stiffness` or `mass`.
    /// An entry beside the diagonal stands for its mirror image too
    pub entries: Option<PathBuf>,
}
