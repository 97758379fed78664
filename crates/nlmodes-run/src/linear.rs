//! The linear modes of a scene, with and without the mass redistribution.

mod table;

use nlmodes::linalg::LinalgError;
use nlmodes::model::{Drop, MasslessContactModel, ModelError, StructuralModel, held_modes, linear_modes};
use serde::Serialize;

use crate::character::{characters, same_modes};
use crate::mass;
use crate::open_modes::{LISTED, OpenLinearModes};
use nlmodes::model::reduction::OpenModes;
use nlmodes_scene::assemble::{
    Assembly, OpenStructure, Strainless, StructureError, Structures, contact_model, element_model, free_modes,
    redistribution,
};
use nlmodes_scene::number;
use nlmodes_scene::scene::{MethodKind, Scene, Structure, StructureKind};

/// Share of a frequency that the digits of files may leave open without a column of its own: the table has eight
/// decimals.
const SETTLED: f64 = 1e-6;

/// Lowest linear frequencies, Hz.
#[derive(Debug, Clone, Default, Serialize)]
pub struct LinearFrequencies {
    /// Contacts open, contact mass kept.
    pub mass_kept: Vec<f64>,
    /// Contacts open, contact mass as the method has it, without the imposed frequencies of `[structure.modes]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub of_the_elements: Option<Vec<f64>>,
    /// Contacts open, contact mass redistributed.
    pub mass_redistributed: Option<Vec<f64>>,
    /// Contacts held, contact mass redistributed.
    pub contacts_held: Option<Vec<f64>>,
    /// The contacts closed that press at rest under static loads, on the springs of their stops; none where none does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub about_rest: Option<Vec<f64>>,
    /// What each mode with the contact mass kept is, in a few words.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub characters: Vec<String>,
    /// For each mode with the contact mass kept, the standard deviation that the digits of the files leave of its
    /// frequency, over that frequency; empty where they leave less than 1e-6 of every one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub left_open: Vec<Option<f64>>,
    /// For each mode with the contact mass kept, the same one among those with the mass redistributed.
    #[serde(skip)]
    pub redistributed_as: Vec<Option<usize>>,
    /// What a user should know about the mode that is computed, if it is moved by the mass that the contacts lose.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mass_warning: Option<String>,
}

/// Computes the lowest frequencies of the scene's structure.
///
/// # Errors
/// [`StructureError`] if an eigenproblem cannot be solved.
pub fn linear_frequencies(scene: &Scene, assembly: &Assembly) -> Result<LinearFrequencies, StructureError> {
    let model = &assembly.model;
    if model.contacts().is_empty() {
        let modes = linear_modes(model.mass(), model.stiffness(), LISTED)?;
        return Ok(LinearFrequencies {
            mass_kept: hertz(&modes.omega),
            characters: characters(model, &modes),
            of_the_elements: of_the_elements(scene, false)?,
            ..LinearFrequencies::default()
        });
    }
    let massless = contact_model(scene, model)?;
    let open = OpenLinearModes::new(scene, model, &massless).map_err(|error| floating(scene, error))?;
    let mut found = frequencies(scene, model, &massless, &open)?;
    assembly.open.iter().for_each(|open| found.complete(scene, open));
    Ok(found)
}

/// The lowest frequencies of a structure from files without its contacts, which may be such that they cannot be
/// reduced; none of other structures.
///
/// # Errors
/// [`StructureError`] if an eigenproblem cannot be solved.
pub fn without_contacts(scene: &Scene) -> Result<Option<LinearFrequencies>, StructureError> {
    let Some((modes, strainless)) = free_modes(scene, &Structures::default())? else { return Ok(None) };
    let omega = modes.omega_squared().iter().map(|square| square.max(0.0).sqrt());
    let omega: Vec<f64> = omega.take(LISTED + strainless.count()).collect();
    let mass_kept: Vec<f64> = omega.iter().map(|omega| nlmodes::report::hertz(*omega)).collect();
    let characters = vec![String::new(); mass_kept.len()];
    let mut found = LinearFrequencies { mass_kept, characters, ..LinearFrequencies::default() };
    found.mark(&modes, &strainless);
    Ok(Some(found))
}

impl LinearFrequencies {
    /// The columns of a table with their names, `redistributed` that of the rule for the mass of the contacts.
    pub(crate) fn columns<'a>(&'a self, redistributed: &'a str) -> Vec<(&'a str, &'a [f64])> {
        let all = [
            ("contact mass kept", Some(&self.mass_kept)),
            (redistributed, self.mass_redistributed.as_ref()),
            ("contacts held", self.contacts_held.as_ref()),
            ("about the rest", self.about_rest.as_ref()),
            ("of the elements", self.of_the_elements.as_ref()),
        ];
        all.into_iter().filter_map(|(name, f)| Some((name, f?.as_slice()))).collect()
    }

    /// Adds what the reduced structure tells: motions that strain nothing, and the frequencies about its rest.
    pub(crate) fn complete(&mut self, scene: &Scene, open: &OpenStructure) {
        self.mark(&open.modes, &open.strainless);
        self.about_rest = open.about_rest(scene).ok().flatten().map(|omega| hertz(&omega));
    }

    /// Gives the motions that strain nothing the frequency zero, also with the contacts held where no contact feels
    /// them, and says what they are and what the digits of the files leave open of the others.
    fn mark(&mut self, modes: &OpenModes, strainless: &Strainless) {
        let of_each = (1..=self.mass_kept.len()).map(|mode| modes.left_open(mode));
        self.left_open = of_each.collect();
        if self.left_open.iter().flatten().all(|share| *share <= SETTLED) {
            self.left_open.clear();
        }
        // The reduced structure has these on a frequency far below all others.
        let unfelt = if strainless.count() > 0 { modes.rigid_motions().map_or(0, |(_, unfelt)| unfelt) } else { 0 };
        self.contacts_held.iter_mut().flatten().take(unfelt).for_each(|hz| *hz = 0.0);
        let names = std::iter::repeat_n("rigid body", strainless.rigid);
        let names = names.chain(std::iter::repeat_n("mechanism", strainless.mechanisms));
        for (k, name) in names.enumerate().take(self.mass_kept.len()) {
            self.mass_kept[k] = 0.0;
            if let Some(words) = self.characters.get_mut(k).filter(|words| !words.starts_with(name)) {
                *words = if words.is_empty() { name.to_owned() } else { format!("{name}, {words}") };
            }
        }
    }
}

/// The same where the modes with open contacts are known.
///
/// # Errors
/// [`StructureError`] if an eigenproblem cannot be solved.
pub fn frequencies(
    scene: &Scene,
    model: &StructuralModel,
    massless: &MasslessContactModel,
    open: &OpenLinearModes,
) -> Result<LinearFrequencies, StructureError> {
    let mass_kept = hertz(&open.kept.omega);
    let mut characters = characters(model, &open.kept);
    characters.truncate(mass_kept.len());
    if scene.is_in_open_modes() {
        let held = MasslessContactModel::new(model, &Drop)?;
        let contacts_held = Some(hertz(&held_modes(&held, LISTED)?.omega));
        return Ok(LinearFrequencies { mass_kept, characters, contacts_held, ..LinearFrequencies::default() });
    }
    let of_the_elements = of_the_elements(scene, true)?;
    let Some(rule) = redistribution(scene) else {
        return Ok(LinearFrequencies { mass_kept, characters, of_the_elements, ..LinearFrequencies::default() });
    };
    let held = match scene.method.kind {
        // The tips of the springs would be held, not the nodes.
        MethodKind::Hbm => held_modes(&MasslessContactModel::new(model, rule)?, LISTED)?,
        MethodKind::MsHbm | MethodKind::Shooting => held_modes(massless, LISTED)?,
    };
    Ok(LinearFrequencies {
        mass_warning: mass::warning(scene, open),
        redistributed_as: same_modes(model, &open.kept, &open.own),
        mass_kept,
        characters,
        of_the_elements,
        mass_redistributed: Some(hertz(&open.own.omega)),
        contacts_held: Some(hertz(&held.omega)),
        ..LinearFrequencies::default()
    })
}

/// In open modes the stiffness has the squares of frequencies, none of them negative: where it is not definite the
/// structure floats.
fn floating(scene: &Scene, error: ModelError) -> StructureError {
    match error {
        ModelError::Linalg { source: LinalgError::NotPositiveDefinite { .. }, .. } if scene.is_in_open_modes() => {
            StructureError::Floating
        }
        error => error.into(),
    }
}

/// Those of the elements, where others are imposed on the modes.
fn of_the_elements(scene: &Scene, has_contacts: bool) -> Result<Option<Vec<f64>>, StructureError> {
    let straight = scene.structure.straight();
    let Some(structure) = straight.filter(|structure| structure.modes.is_some()) else { return Ok(None) };
    let elements = element_model(structure, &scene.contacts)?;
    let rule = redistribution(scene).filter(|_| has_contacts);
    let redistributed = rule.map(|rule| rule.redistribute(&elements)).transpose()?;
    let mass = redistributed.as_ref().unwrap_or(elements.mass());
    Ok(Some(hertz(&linear_modes(mass, elements.stiffness(), LISTED)?.omega)))
}

/// The frequencies of the table, Hz.
fn hertz(omega: &[f64]) -> Vec<f64> {
    omega.iter().take(LISTED).map(|omega| nlmodes::report::hertz(*omega)).collect()
}

/// What a structure with imposed frequencies is, in a line: nobody should take it for that of the elements.
pub fn modal_model(structure: &Structure) -> Option<String> {
    let modes = structure.modes.as_ref()?;
    let list: Vec<String> = modes.frequencies_hz.iter().map(|hz| number(*hz)).collect();
    let kind = match structure.kind() {
        StructureKind::Rod => "axial",
        StructureKind::Beam => "bending",
    };
    let which = match list.len() {
        1 => format!("the lowest {kind} mode has its frequency"),
        n => format!("the lowest {n} {kind} modes have their frequencies"),
    };
    Some(format!("modal model: {which} imposed, {} Hz, on the shapes of the elements", list.join(", ")))
}
