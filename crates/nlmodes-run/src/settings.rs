//! From a checked scene to what the computation of a branch takes.

use nlmodes::branches::{
    Accuracy, BranchMethod, BranchPointRule, BranchSettings, BranchStart, ResonanceRule, StabilityRule,
};
use nlmodes::model::{MasslessContactModel, StructuralModel};
use nlmodes_scene::SceneFile;
use nlmodes_scene::assemble::{Assembly, OpenStructure, StaticState, Structures, contact_model};
use nlmodes_scene::scene::{
    AtBranchPoint, FrequencyDirection, InternalResonance, MethodKind, Scene, StabilityChoice, Start, Switching,
    Symmetry,
};

use crate::{RunError, refusal};

/// What a scene computes with.
pub struct Models {
    /// The structure.
    pub model: StructuralModel,
    /// The model of it that the method works on.
    pub massless: MasslessContactModel,
    /// The open modes from which it is made, if it is.
    pub open: Option<OpenStructure>,
    /// What static loads and stops that press do to it.
    pub state: Option<StaticState>,
}

/// Modes up to which the stability of a branch is found unasked, within its budget: those of any structure that is
/// reduced by default.
const STABILITY_MODES: usize = 40;

/// A structure in free-interface modes, if it is reduced by them, and its static state, if it has one.
pub type Checked = (Option<OpenStructure>, Option<StaticState>);

/// The structure of the scene, and the model of it that the method works on.
pub fn models(file: &SceneFile) -> Result<Models, RunError> {
    models_sharing(file, &Structures::default())
}

/// The same, reusing files that were already read and reduced.
pub fn models_sharing(file: &SceneFile, structures: &Structures) -> Result<Models, RunError> {
    let Assembly { model, open, state } =
        Assembly::sharing(&file.scene, structures).map_err(|error| refusal::at(file, &error.path(), &error))?;
    let massless =
        contact_model(&file.scene, &model).map_err(|error| refusal::at(file, "method.mass_redistribution", &error))?;
    Ok(Models { model, massless, open, state })
}

/// Where the branch of a scene starts, and the start of its other half where it goes both ways.
pub fn starts(start: Start) -> (BranchStart, Option<BranchStart>) {
    let both = |direction, begin: &dyn Fn(bool) -> BranchStart| match direction {
        FrequencyDirection::Up => (begin(true), None),
        FrequencyDirection::Down => (begin(false), None),
        FrequencyDirection::Both => (begin(false), Some(begin(true))),
    };
    match start {
        Start::Grazing => (BranchStart::Grazing, None),
        Start::Frequency { hz, direction } => both(direction, &|upward| BranchStart::Frequency { hz, upward }),
        Start::Energy { ratio, direction } => both(direction, &|upward| BranchStart::Energy { ratio, upward }),
    }
}

/// Settings of the branch of a scene, except its start.
pub fn branch_settings(scene: &Scene) -> BranchSettings {
    let method = &scene.method;
    BranchSettings {
        method: match method.kind {
            MethodKind::MsHbm | MethodKind::Hbm => BranchMethod::HarmonicBalance,
            MethodKind::Shooting => BranchMethod::Shooting,
        },
        stability: match scene.stability {
            StabilityChoice::Auto => StabilityRule::Auto,
            StabilityChoice::Always => StabilityRule::Always,
            StabilityChoice::Never => StabilityRule::Never,
        },
        stability_modes: STABILITY_MODES,
        stability_budget_s: scene.stability_budget_s,
        mode: method.mode,
        harmonics: method.harmonics,
        accuracy: method.accuracy.map(|a| Accuracy { error: a.error, max_harmonics: a.max_harmonics }),
        symmetry: match method.symmetry {
            Symmetry::Even => nlmodes::hbm::Symmetry::Even,
            Symmetry::None => nlmodes::hbm::Symmetry::None,
        },
        switching: match method.switching {
            Switching::Exact => nlmodes::hbm::Switching::Exact,
            Switching::Sampled => nlmodes::hbm::Switching::Sampled { samples: method.samples },
        },
        contact_solver: method.contact_solver.name().to_owned(),
        held_modes: method.held_modes,
        max_energy_ratio: Some(scene.max_energy_ratio(scene.continuation.frequency_hz.is_some())),
        frequency_hz: scene.continuation.frequency_hz,
        max_points: scene.continuation.max_points,
        at_branch_point: match scene.continuation.at_branch_point {
            AtBranchPoint::Stay => BranchPointRule::Stay,
            AtBranchPoint::Switch => BranchPointRule::Switch,
            AtBranchPoint::All => BranchPointRule::All,
        },
        max_branches: scene.continuation.max_branches,
        internal_resonance: match scene.continuation.internal_resonance {
            InternalResonance::Auto => ResonanceRule::Auto,
            InternalResonance::Follow => ResonanceRule::Follow,
            InternalResonance::Skip => ResonanceRule::Skip,
        },
        ..BranchSettings::default()
    }
}
