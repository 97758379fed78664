//! `nlmodes-cli modes`: the linear modes, with and without the mass redistribution.

use std::error::Error;
use std::f64::consts::TAU;

use nlmodes::model::{MasslessContactModel, ModelError, StructuralModel, held_modes, linear_modes};
use serde::Serialize;

use crate::Status;
use crate::assemble::{redistribution, structural_model};
use crate::command::print;
use crate::config::SceneFile;
use crate::config::scene::Scene;
use crate::run::chain;

/// Modes of the table.
const COUNT: usize = 10;

/// Lowest linear frequencies, Hz.
#[derive(Debug, Clone, Default, Serialize)]
pub struct LinearFrequencies {
    /// Contacts open, contact mass kept.
    pub mass_kept: Vec<f64>,
    /// Contacts open, contact mass redistributed.
    pub mass_redistributed: Option<Vec<f64>>,
    /// Contacts held, contact mass redistributed.
    pub contacts_held: Option<Vec<f64>>,
}

/// Computes the lowest frequencies of the scene's structure.
///
/// # Errors
/// [`ModelError`] if an eigenproblem cannot be solved.
pub fn linear_frequencies(scene: &Scene, model: &StructuralModel) -> Result<LinearFrequencies, ModelError> {
    let hertz = |omega: Vec<f64>| omega.into_iter().map(|ω| ω / TAU).collect::<Vec<f64>>();
    let mass_kept = hertz(linear_modes(model.mass(), model.stiffness(), COUNT)?.omega);
    let Some(rule) = redistribution(scene).filter(|_| !model.contacts().is_empty()) else {
        return Ok(LinearFrequencies { mass_kept, ..LinearFrequencies::default() });
    };
    let massless = MasslessContactModel::new(model, rule)?;
    Ok(LinearFrequencies {
        mass_kept,
        mass_redistributed: Some(hertz(linear_modes(massless.mass(), massless.stiffness(), COUNT)?.omega)),
        contacts_held: Some(hertz(held_modes(&massless, COUNT)?.omega)),
    })
}

/// Prints the table of linear modes.
pub fn modes(file: &SceneFile) -> Status {
    let found = structural_model(&file.scene)
        .map_err(Box::<dyn Error>::from)
        .and_then(|model| Ok(linear_frequencies(&file.scene, &model)?));
    match found {
        Ok(found) => print(table(&file.scene, &found).trim_end()),
        Err(error) => {
            say!("{}", file.error_at("structure", &chain(error.as_ref()), "", &[]));
            Status::Wrong
        }
    }
}

fn table(scene: &Scene, found: &LinearFrequencies) -> String {
    let rule = scene.method.mass_redistribution.name();
    let redistributed = format!("contact mass: {rule}");
    let columns = [
        Some(("contact mass kept", &found.mass_kept)),
        found.mass_redistributed.as_ref().map(|f| (redistributed.as_str(), f)),
        found.contacts_held.as_ref().map(|f| ("contacts held", f)),
    ];
    let columns: Vec<(&str, &Vec<f64>)> = columns.into_iter().flatten().collect();
    let mut text = format!("{}\n\nfrequency, Hz\n  mode", scene.title);
    columns.iter().for_each(|(name, _)| text += &format!("{name:>22}"));
    text += "\n";
    for k in 0..columns.iter().map(|(_, f)| f.len()).max().unwrap_or(0) {
        text += &format!("  {:>4}", k + 1);
        for (_, frequencies) in &columns {
            text += &frequencies.get(k).map_or_else(|| format!("{:>22}", "-"), |f| format!("{f:>22.8}"));
        }
        text += "\n";
    }
    text
}
