use serde::{Deserialize, Serialize};

use super::Scene;

/// A parameter by which the points of every curve are differentiated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Sensitivity {
    /// Its key, as `--set` takes it.
    pub key: String,
    /// Its value, in the unit of the key.
    pub value: f64,
    /// The scene at other values of it, of which structure and load are differentiated; of a scene that results were
    /// left of none.
    #[serde(skip)]
    pub states: Vec<SceneState>,
}

/// A scene at another value of a parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneState {
    /// The scene.
    pub scene: Scene,
    /// Its weight in the difference quotient, per unit of the key.
    pub weight: f64,
}
