use nlmodes::model::reduction::MatrixDirection;
use nlmodes_io::{FeModel, ParameterEntry, UnitSystem};
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
    /// What it does to the matrices of a structure from files, in their units, where it is no number of the scene.
    #[serde(skip)]
    pub entries: Vec<ParameterEntry>,
}

/// A scene at another value of a parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneState {
    /// The scene.
    pub scene: Scene,
    /// Its weight in the difference quotient, per unit of the key.
    pub weight: f64,
}

impl Sensitivity {
    /// What the entries do to the matrices of a structure from files in these units: rows and columns, in SI units.
    ///
    /// # Errors
    /// Words about a degree of freedom that has no row.
    pub fn direction(&self, model: &FeModel, units: &UnitSystem) -> Result<MatrixDirection, String> {
        let mut direction = MatrixDirection::default();
        for entry in &self.entries {
            let row = |at: usize| {
                let label = entry.at[at];
                let missing = || format!("parameter `{}` is about {label}, which is no row of the matrices", self.key);
                model.row_of(label.node, label.component).ok_or_else(missing)
            };
            let (i, j, [a, b]) = (row(0)?, row(1)?, entry.at.map(|label| label.component));
            match entry.is_mass {
                true => direction.mass.push((i, j, entry.value * units.mass(a, b))),
                false => direction.stiffness.push((i, j, entry.value * units.stiffness(a, b))),
            }
        }
        Ok(direction)
    }
}
