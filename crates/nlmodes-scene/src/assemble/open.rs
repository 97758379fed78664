//! Structures in their open modes: of rods, beams and matrices alike.

use std::f64::consts::TAU;
use std::sync::Arc;

use nlmodes::model::reduction::{ModeCount, OpenModes, ReducedStructure, ReductionError};
use nlmodes::model::{Contact, Dof, DofKind, StructuralModel};
use nlmodes_io::{Component, ContactChoice, FeModel, NodeContact, find_contacts};

use super::reduced::{self, PictureMesh, ReducedElsewhere};
use super::{StaticState, Strainless, StructureError, Structures, static_loads};
use crate::scene::{Hertz, Matrices, ReducedModel, ReductionKind, Scene, SceneStructure};

/// Open modes reach so many times as far as the highest harmonic, where the scene does not say how far.
const BEYOND_HARMONICS: f64 = 4.0;
/// And they are so many at least, where the structure has them.
const FEWEST: usize = 12;

/// The model of files and the contacts of its nodes.
pub type NodeContacts = (Arc<FeModel>, Vec<NodeContact>);

/// The model and the contacts of a scene whose structure is from files.
///
/// # Errors
/// [`StructureError`]: files that cannot be read, contacts that do not fit them.
pub fn node_contacts(scene: &Scene, structures: &Structures) -> Result<Option<NodeContacts>, StructureError> {
    let SceneStructure::Matrices(matrices) = &scene.structure else { return Ok(None) };
    let model = structures.model(&matrices.files)?;
    let found = find_contacts(&model, &matrices.files, &matrices.contacts)?;
    Ok(Some((model, found)))
}

/// The contacts of nodes whose stops have a law of force, each with its law.
///
/// # Errors
/// As [`node_contacts`].
pub fn law_contacts(scene: &Scene, structures: &Structures) -> Result<Vec<(NodeContact, Hertz)>, StructureError> {
    let Some(matrices) = scene.structure.matrices().filter(|matrices| !matrices.law_contacts.is_empty()) else {
        return Ok(Vec::new());
    };
    let model = structures.model(&matrices.files)?;
    let choices: Vec<ContactChoice> = matrices.law_contacts.iter().map(|law| law.contact.clone()).collect();
    let found = find_contacts(&model, &matrices.files, &choices)?;
    Ok(found.into_iter().map(|contact| (contact.clone(), matrices.law_contacts[contact.origin].hertz)).collect())
}

/// A structure in open modes, and what its rows and contacts are called.
#[derive(Debug)]
pub struct OpenStructure {
    /// Modes, residual flexibility, recovery of displacements.
    pub modes: OpenModes,
    /// The same as a structure with massless contact nodes.
    pub reduced: ReducedStructure,
    /// Node, position and kind of each degree of freedom of the structure that was reduced.
    pub dofs: Vec<Dof>,
    /// Node and position (m, along x) by which each contact is known.
    pub contacts: Vec<(usize, f64)>,
    /// The model and the contacts of its nodes, of a structure from files.
    pub files: Option<NodeContacts>,
    /// What is known of the numbers of a structure that was reduced elsewhere.
    pub elsewhere: Option<ReducedElsewhere>,
    /// The mesh that pictures of such a structure show.
    pub picture: Option<PictureMesh>,
    /// Motions that strain nothing.
    pub strainless: Strainless,
    /// What static loads and stops that press do to it: the gaps of `modes` and `reduced` are those that they leave.
    pub state: Option<StaticState>,
}

impl OpenStructure {
    /// Reduces the structure of a scene by its open modes, as `[reduction]` says or with its defaults.
    ///
    /// # Errors
    /// [`StructureError`]: files that cannot be read, contacts that do not fit them, a reduction that fails.
    pub fn of(scene: &Scene, structures: &Structures) -> Result<Self, StructureError> {
        match &scene.structure {
            SceneStructure::Straight(_) | SceneStructure::Several(_) => {
                Self::of_model(scene, &super::full_model(scene, structures)?)
            }
            SceneStructure::Matrices(matrices) => Self::of_files(scene, matrices, structures),
            SceneStructure::Reduced(model) => Self::of_reduced(scene, model),
        }
    }

    /// What another program has reduced.
    fn of_reduced(scene: &Scene, model: &ReducedModel) -> Result<Self, StructureError> {
        let reduced::Read { modes, dofs, known, picture } = reduced::read(model, scene.reduction)?;
        let contacts: Vec<(usize, f64)> = model.row_contacts.iter().map(|contact| (contact.row, 0.0)).collect();
        let damped: Vec<bool> = model.row_contacts.iter().map(|contact| contact.damping.is_some()).collect();
        let reduced = |modes: &OpenModes| ReducedStructure::new(modes, &contacts);
        let (modes, reduced) = pressed(scene, modes, (scene.method.mode + 1, &damped), reduced)?;
        let strainless = Strainless::of_rigid_bodies(modes.openness().strainless);
        let (files, elsewhere, state) = (None, Some(known), None);
        Self { modes, reduced, dofs, contacts, files, elsewhere, picture, strainless, state }.under_loads(scene)
    }

    fn of_model(scene: &Scene, model: &StructuralModel) -> Result<Self, StructureError> {
        let place = |contact: &Contact| {
            let dof = model.dofs()[contact.normal.entries()[0].0];
            (dof.node, dof.position)
        };
        let contacts: Vec<(usize, f64)> = model.contacts().iter().map(place).collect();
        let modes = OpenModes::of_model(model, count(scene, model.dofs().len())?)?;
        let damped: Vec<bool> = scene.contacts.iter().map(|contact| contact.damping.is_some()).collect();
        let reduced = |modes: &OpenModes| ReducedStructure::along_axes(modes, &contacts, model.dofs());
        // The elements represent a continuum: what a mode less leaves to statics is an error like that of the mesh.
        let (modes, reduced) = pressed(scene, modes, (scene.method.mode, &damped), reduced)?;
        let dofs = model.dofs().to_vec();
        let strainless = Strainless::of_rigid_bodies(modes.n_rigid());
        let (files, elsewhere, picture, state) = (None, None, None, None);
        Self { modes, reduced, dofs, contacts, files, elsewhere, picture, strainless, state }.under_loads(scene)
    }

    fn of_files(scene: &Scene, matrices: &Matrices, structures: &Structures) -> Result<Self, StructureError> {
        let model = structures.model(&matrices.files)?;
        let found = find_contacts(&model, &matrices.files, &matrices.contacts)?;
        let modes = structures.modes(&matrices.files, &model, &found, count(scene, model.n_dofs())?)?;
        let strainless = strainless(&model, &modes)?;
        let at = |node: u64| model.place_of(node).map_or(0.0, |place| place[0]);
        let contacts: Vec<(usize, f64)> = found.iter().map(|c| (c.node as usize, at(c.node))).collect();
        let damped: Vec<bool> = found.iter().map(|contact| contact.damping.is_some()).collect();
        let reduced = |modes: &OpenModes| ReducedStructure::new(modes, &contacts);
        let (modes, reduced) = pressed(scene, modes, (scene.method.mode + 1, &damped), reduced)?;
        let dofs = dofs(&model);
        let (files, elsewhere, picture, state) = (Some((model, found)), None, None, None);
        Self { modes, reduced, dofs, contacts, files, elsewhere, picture, strainless, state }.under_loads(scene)
    }

    /// Angular frequencies about the place at which the structure of this scene rests, rad/s, with the contacts closed
    /// that press there, on the springs of their stops; none where no contact presses, or where springs and stops with
    /// a law of force are yet to come.
    ///
    /// # Errors
    /// [`StructureError`] if the eigenproblem cannot be solved.
    pub fn about_rest(&self, scene: &Scene) -> Result<Option<Vec<f64>>, StructureError> {
        let pressed = self.state.as_ref().map(|state| &state.rest.closed).filter(|closed| closed.contains(&true));
        let Some(closed) = pressed.filter(|_| !scene.has_laws()) else { return Ok(None) };
        let modes = self.modes.closed_modes(closed)?;
        Ok(Some(modes.omega_squared.iter().map(|square| square.sqrt()).collect()))
    }

    /// The same with the gaps that static loads leave.
    fn under_loads(self, scene: &Scene) -> Result<Self, StructureError> {
        let files = self.files.as_ref().map(|(model, _)| model.as_ref());
        match static_loads::of_open(scene, &self.modes, (files, &self.dofs))? {
            Some(state) => self.resting(state),
            None => Ok(self),
        }
    }

    /// The same with the gaps that this state leaves.
    ///
    /// # Errors
    /// [`StructureError`] for a state of another structure.
    pub fn resting(mut self, state: StaticState) -> Result<Self, StructureError> {
        let gaps = state.free_gaps[..self.modes.n_contacts()].to_vec();
        self.modes = self.modes.with_stops(gaps, self.modes.stop_compliance().to_vec())?;
        if state.is_carried() {
            self.modes = self.modes.with_steady_force(state.steady.clone())?;
        }
        self.reduced = self.reduced.with_gaps(self.modes.gaps())?.with_force_of(&self.modes)?;
        self.state = Some(state);
        Ok(self)
    }

    /// Displacements of these degrees of freedom under the static loads beyond those of the modes, m:
    /// `q − Φ Φᵀ M q`.
    pub fn beyond_modes(&self, state: &StaticState, dofs: &[usize]) -> Vec<f64> {
        let shape = |dof: usize, r: usize| self.modes.shapes()[(dof, r)] * state.modal[r];
        let modal = |dof: usize| (0..self.modes.n_modes()).map(|r| shape(dof, r)).sum::<f64>();
        dofs.iter().map(|&dof| state.displacement[dof] - modal(dof)).collect()
    }

    /// Largest frequency of the retained modes, Hz.
    pub fn highest_hz(&self) -> f64 {
        self.modes.omega_squared().last().map_or(0.0, |w| w.max(0.0).sqrt() / TAU)
    }

    /// Estimate of what the truncation does to the frequency of the scene's mode with its first contact closed, from
    /// half as many modes; `None` where half of the modes do not reach that mode.
    pub fn truncation_error(&self, mode: usize, contact: usize) -> Option<f64> {
        let mut closed = vec![false; self.modes.n_contacts()];
        *closed.get_mut(contact)? = true;
        self.modes.truncation_error(&closed, mode.checked_sub(1)?).ok().filter(|error| error.is_finite())
    }
}

/// Modes of a structure from files without its contacts: what is known of it where these cannot be reduced.
///
/// # Errors
/// [`StructureError`]: files that cannot be read, modes that are not found.
pub fn free_modes(scene: &Scene, structures: &Structures) -> Result<Option<(OpenModes, Strainless)>, StructureError> {
    let SceneStructure::Matrices(matrices) = &scene.structure else { return Ok(None) };
    let model = structures.model(&matrices.files)?;
    let modes = structures.modes(&matrices.files, &model, &[], count(scene, model.n_dofs())?)?;
    let strainless = strainless(&model, &modes)?;
    Ok(Some((modes, strainless)))
}

/// Motions that strain nothing, if the digits of the files leave no mode open.
fn strainless(model: &FeModel, modes: &OpenModes) -> Result<Strainless, StructureError> {
    Strainless::of(model, modes).ok_or_else(|| StructureError::Digits {
        digits: model.digits[0],
        up_to_hz: modes.openness().unseen.sqrt() / TAU,
    })
}

/// The degrees of freedom of a model from files.
pub fn dofs(model: &FeModel) -> Vec<Dof> {
    let of = |label: &nlmodes_io::DofLabel| Dof {
        node: label.node as usize,
        position: model.place_of(label.node).map_or(0.0, |place| place[0]),
        kind: kind(label.component),
    };
    model.labels.iter().map(of).collect()
}

fn kind(component: Component) -> DofKind {
    match component {
        Component::X => DofKind::X,
        Component::Y => DofKind::Y,
        Component::Z => DofKind::Z,
        Component::RX => DofKind::RX,
        Component::RY => DofKind::RY,
        Component::RZ => DofKind::RZ,
        _ => DofKind::Modal,
    }
}

/// How many modes the scene retains, of a structure with so many degrees of freedom.
fn count(scene: &Scene, dofs: usize) -> Result<ModeCount, StructureError> {
    let asked = scene.reduction.filter(|reduction| reduction.kind == Some(ReductionKind::OpenModes));
    Ok(match (asked.and_then(|asked| asked.modes), asked.and_then(|asked| asked.up_to_hz)) {
        (Some(asked), _) if asked > dofs => return Err(StructureError::TooManyModes { asked, dofs }),
        (Some(modes), _) => ModeCount::Lowest(modes),
        (None, Some(hz)) => ModeCount::UpTo(TAU * hz),
        (None, None) => {
            let method = &scene.method;
            let harmonics = method.accuracy.map_or(method.harmonics, |accuracy| accuracy.max_harmonics.min(20));
            let factor = BEYOND_HARMONICS * harmonics.max(1) as f64;
            ModeCount::Beyond { mode: method.mode, factor, least: FEWEST.max(2 * method.mode) }
        }
    })
}

/// Share of its static flexibility that each contact keeps beyond the modes, where the scene does not say how many of
/// these are retained: with less, digits are lost in the stiffness of the reduced structure.
const WELL_CONDITIONED: f64 = 1e-5;

/// The reduced structure. Where the scene does not say how many modes are retained and these leave the contacts next to
/// no flexibility of their own, fewer are, but `fewest` at least; a stop with a damper (`damped`) needs one as a rigid
/// stop does.
fn pressed(
    scene: &Scene,
    mut modes: OpenModes,
    (fewest, damped): (usize, &[bool]),
    reduced: impl Fn(&OpenModes) -> Result<ReducedStructure, ReductionError>,
) -> Result<(OpenModes, ReducedStructure), StructureError> {
    let is_said = scene.reduction.is_some_and(|asked| asked.modes.is_some() || asked.up_to_hz.is_some());
    loop {
        let found = reduced(&modes);
        let fewer = modes.n_modes() - modes.n_modes().div_ceil(4);
        let can_have_fewer = !is_said && fewer >= fewest;
        match found {
            Ok(reduced) if well_conditioned(&modes, &reduced, damped) => return Ok((modes, reduced)),
            Ok(_) | Err(ReductionError::DependentContact { .. }) if can_have_fewer => modes = modes.truncated(fewer)?,
            Ok(reduced) => return Ok((modes, reduced)),
            Err(error) => return Err(error.into()),
        }
    }
}

fn well_conditioned(modes: &OpenModes, reduced: &ReducedStructure, damped: &[bool]) -> bool {
    let share = |contact: usize| {
        let (own, elastic) = (modes.flexibility()[(contact, contact)], modes.omega_squared().iter().enumerate());
        let elastic = elastic.filter(|(_, square)| **square > 0.0);
        own / (own + elastic.map(|(r, square)| modes.contact_rows()[(contact, r)].powi(2) / square).sum::<f64>())
    };
    let of_damped = (0..damped.len()).filter(|&contact| damped[contact]).map(share);
    of_damped.fold(reduced.least_share(), f64::min) >= WELL_CONDITIONED
}
