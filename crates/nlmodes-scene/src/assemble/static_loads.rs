//! Static loads, and where the structure stands under them.
//!
//! A constant force field `f` moves the linear structure by `K⁻¹ f` while its contacts are open. About that place its
//! motions are those of the same structure with the gaps `g₀ + Wᵀ K⁻¹ f`.

use std::path::Path;

use nlmodes::contact::solver_by_name;
use nlmodes::linalg::{Mat, multiply, multiply_transposed};
use nlmodes::model::{Contact, DofKind, StructuralModel};
use nlmodes::response::BaseUnit;
use nlmodes_io::{ContactNodes, FeModel, ReadError, read_nodal_values};
use nlmodes_reduction::{ModeCount, OpenModes, RestState};

use super::places::{Body, node_weights, row_weights, unsupported};
use super::{Elements, StructureError, Structures, dofs};
use crate::scene::{
    BaseDirection, ForcePlace, Gravity, Matrices, Place, Scene, SceneStructure, StaticLoads, Structure, Thermal,
};

/// A structure that its stops press, or that static loads move.
#[derive(Debug, Clone, Default)]
pub struct StaticState {
    /// Displacement of each degree of freedom under the loads with the contacts open, n, m.
    pub displacement: Vec<f64>,
    /// The same in the free-interface modes with which it was computed, `η = Φᵀ M q`, m·√kg.
    pub modal: Vec<f64>,
    /// By how much that opens the gaps, c, m.
    pub opening: Vec<f64>,
    /// The gaps that this leaves, with the contacts open, c, m.
    pub free_gaps: Vec<f64>,
    /// Where the structure rests, and the forces of its contacts there.
    pub rest: RestState,
}

impl StaticState {
    /// Energy of the structure and of its elastic stops at rest, above that of the place with open contacts, J:
    /// `½ λᵀ (F + C) λ = −½ λᵀ g`.
    pub fn energy(&self) -> f64 {
        self.rest.forces.iter().zip(&self.free_gaps).map(|(force, gap)| -0.5 * force * gap).sum()
    }

    /// Displacement of a contact toward its stop under the loads with the contacts open, m.
    pub fn toward(&self, contact: usize) -> f64 {
        self.opening.get(contact).map_or(0.0, |opening| -opening)
    }
}

/// What the loads of a scene do to its structure with the contacts open.
enum Moved {
    /// Forces on the degrees of freedom, N.
    Force(Vec<f64>),
    /// Their displacements, m.
    Displacement(Vec<f64>),
}

/// The state of a structure in free-interface modes: with loads, or with stops that press.
pub(super) fn of_open(
    scene: &Scene,
    modes: &OpenModes,
    files: Option<&FeModel>,
) -> Result<Option<StaticState>, StructureError> {
    let moved = match (&scene.structure, files) {
        (SceneStructure::Matrices(matrices), Some(model)) => of_files(&scene.static_loads, matrices, model)?,
        (SceneStructure::Reduced(_), _) => of_rows(&scene.static_loads, modes.n_dofs())?,
        (structure, _) => of_bodies(&scene.static_loads, structure.bodies())?,
    };
    if moved.is_none() && modes.gaps().iter().all(|gap| *gap >= 0.0) {
        return Ok(None);
    }
    if modes.floats() && !scene.static_loads.is_empty() {
        return Err(StructureError::FloatsUnderLoad { key: first_key(&scene.static_loads) });
    }
    let (displacement, modal) = match moved {
        None => (vec![0.0; modes.n_dofs()], vec![0.0; modes.n_modes()]),
        Some(Moved::Displacement(displacement)) => {
            let column = Mat::from_fn(displacement.len(), 1, |i, _| displacement[i]);
            let modal = modes.modal_coordinates(&column).map(|eta| eta.col(0).iter().copied().collect());
            (displacement, modal.unwrap_or_default())
        }
        Some(Moved::Force(force)) => under(modes, &force)?,
    };
    let column = Mat::from_fn(displacement.len(), 1, |i, _| displacement[i]);
    let opening: Vec<f64> = multiply_transposed(modes.directions(), &column).col(0).iter().copied().collect();
    let gaps: Vec<f64> = modes.gaps().iter().zip(&opening).map(|(gap, opening)| gap + opening).collect();
    let loaded = modes.with_stops(gaps.clone(), modes.stop_compliance().to_vec())?;
    let rest = if loaded.floats() {
        RestState::default()
    } else {
        let solver = solver_by_name("active-set").map_err(StructureError::Rest)?;
        loaded.rest(&[], solver.as_ref())?
    };
    Ok(Some(StaticState { displacement, modal, opening, free_gaps: gaps, rest }))
}

/// The key of the first of these loads.
fn first_key(loads: &StaticLoads) -> &'static str {
    match loads {
        StaticLoads { gravity: Some(_), .. } => "gravity",
        StaticLoads { thermal: Some(_), .. } => "thermal",
        StaticLoads { displacement: Some(_), .. } => "static_displacement",
        _ => "static_force",
    }
}

/// Most rigid-body motions of a straight structure in its plane; of one in space twice as many.
const RIGID_MOTIONS: usize = 3;

/// The same of a structure that is not reduced.
pub(super) fn of_model(
    scene: &Scene,
    model: &StructuralModel,
    structures: &Structures,
) -> Result<Option<StaticState>, StructureError> {
    if scene.static_loads.is_empty() && model.contacts().iter().all(|contact| contact.gap >= 0.0) {
        return Ok(None);
    }
    // How many modes are taken beside the static flexibility does not matter, but one more than rigid-body motions.
    let count = (RIGID_MOTIONS * scene.structure.bodies().len().max(2) + 1).min(model.dofs().len());
    let modes = OpenModes::of_model(model, ModeCount::Lowest(count))?;
    let files = scene.structure.matrices().map(|matrices| structures.model(&matrices.files)).transpose()?;
    of_open(scene, &modes, files.as_deref())
}

/// The model with the gaps that the loads leave.
pub(super) fn moved(model: StructuralModel, state: &StaticState) -> Result<StructuralModel, StructureError> {
    let contacts = model.contacts().iter().zip(&state.free_gaps);
    let contacts = contacts.map(|(of, &gap)| Contact { gap, ..of.clone() }).collect();
    Ok(model.with_contacts(contacts)?)
}

/// Displacements under a force with the contacts open, `K⁻¹ f`, and the modal coordinates of them.
fn under(modes: &OpenModes, force: &[f64]) -> Result<(Vec<f64>, Vec<f64>), StructureError> {
    let load = modes.load(force)?;
    let mut displacement = load.residual.clone();
    let modal: Vec<f64> = load.modal.iter().zip(modes.omega_squared()).map(|(p, square)| p / square).collect();
    for (r, eta) in modal.iter().enumerate() {
        displacement.iter_mut().enumerate().for_each(|(i, q)| *q += modes.shapes()[(i, r)] * eta);
    }
    Ok((displacement, modal))
}

/// The loads of a structure that was reduced elsewhere, with so many rows.
fn of_rows(loads: &StaticLoads, rows: usize) -> Result<Option<Moved>, StructureError> {
    if loads.is_empty() {
        return Ok(None);
    }
    let mut force = vec![0.0; rows];
    for (i, load) in loads.forces.iter().enumerate() {
        let ForcePlace::One(Place::Row { row }) = load.at else { continue };
        let weights = row_weights(rows, row).map_err(|why| StructureError::StaticForce { force: i, why })?;
        weights.iter().for_each(|&(dof, w)| force[dof] += w * load.force);
    }
    Ok(Some(Moved::Force(force)))
}

/// The loads of rods and beams.
fn of_bodies(loads: &StaticLoads, structures: &[Structure]) -> Result<Option<Moved>, StructureError> {
    if loads.is_empty() {
        return Ok(None);
    }
    let bodies = Body::all(structures)?;
    let mut force = vec![0.0; bodies.iter().map(|body| body.model.dofs().len()).sum()];
    for (body, structure) in bodies.iter().zip(structures) {
        if let Some(Gravity { acceleration, direction: BaseDirection::Along(direction) }) = loads.gravity {
            let weight = body.on_base(structure, direction, BaseUnit::Acceleration, false)?;
            let inertia = weight.map_or_else(Vec::new, |base| base.inertia);
            force[body.first..].iter_mut().zip(&inertia).for_each(|(f, mass)| *f += acceleration * mass);
        }
        if let Some(Thermal::Strain { expansion, temperature }) = loads.thermal {
            let push = thermal(body, structure, expansion * temperature)?;
            force[body.first..].iter_mut().zip(push).for_each(|(f, push)| *f += push);
        }
    }
    for load in &loads.forces {
        if let ForcePlace::One(Place::Along { at, direction, structure }) = load.at {
            let weights = bodies.get(structure).map(|body| body.weights(at, direction)).transpose()?;
            weights.iter().flatten().for_each(|&(dof, w)| force[dof] += w * load.force);
        }
    }
    Ok(Some(Moved::Force(force)))
}

/// Forces of a uniform strain on the free degrees of freedom, `∫ Bᵀ E A ε dx`: those that would hold the structure
/// without its supports stretched by ε.
fn thermal(body: &Body, structure: &Structure, strain: f64) -> Result<Vec<f64>, StructureError> {
    let loose = Structure { springs: Vec::new(), ..unsupported(structure) };
    let free = Elements::new(&loose)?.assemble(&[])?;
    let stretched: Vec<f64> =
        free.dofs().iter().map(|dof| if dof.kind == DofKind::Axial { strain * dof.position } else { 0.0 }).collect();
    let push = multiply(free.stiffness(), &stretched);
    let of = |dof: &nlmodes::model::Dof| {
        let same = free.dofs().iter().position(|other| (other.node, other.kind) == (dof.node, dof.kind));
        same.map_or(0.0, |i| push[i])
    };
    Ok(body.model.dofs().iter().map(of).collect())
}

/// The loads of a structure from files.
fn of_files(loads: &StaticLoads, matrices: &Matrices, model: &FeModel) -> Result<Option<Moved>, StructureError> {
    if let Some(path) = &loads.displacement {
        return column(model, path, "displacement_m", "static_displacement.file").map(Moved::Displacement).map(Some);
    }
    if loads.is_empty() {
        return Ok(None);
    }
    let mut force = match &loads.thermal {
        Some(Thermal::Forces(path)) => column(model, path, "force_n", "thermal.forces")?,
        _ => vec![0.0; model.n_dofs()],
    };
    if let Some(Gravity { acceleration, direction: BaseDirection::Vector(direction) }) = loads.gravity {
        force.iter_mut().zip(model.inertia_along(direction)).for_each(|(f, mass)| *f += acceleration * mass);
    }
    let all = dofs(model);
    for (i, load) in loads.forces.iter().enumerate() {
        let (nodes, direction) = match &load.at {
            ForcePlace::One(Place::Node { node, direction }) => (vec![*node], *direction),
            ForcePlace::Nodes { nodes: ContactNodes::Numbers(nodes), direction } => (nodes.clone(), *direction),
            ForcePlace::Nodes { nodes: ContactNodes::Set(name), direction } => {
                let wrong = |source: ReadError| StructureError::StaticForce { force: i, why: source.to_string() };
                (model.nodes_of_set(&matrices.files, name).map_err(wrong)?, *direction)
            }
            ForcePlace::One(Place::Along { .. } | Place::Row { .. })
            | ForcePlace::Nodes { nodes: ContactNodes::OfPairs, .. } => continue,
        };
        let (share, mut is_felt) = (load.force / nodes.len() as f64, false);
        for node in nodes {
            let weights = node_weights(&all, node, direction);
            let weights = weights.map_err(|why| StructureError::StaticForce { force: i, why })?;
            is_felt |= !weights.is_empty();
            weights.iter().for_each(|&(dof, w)| force[dof] += w * share);
        }
        if !is_felt {
            let why = "the structure does not move there in this direction".to_owned();
            return Err(StructureError::StaticForce { force: i, why });
        }
    }
    Ok(Some(Moved::Force(force)))
}

/// A quantity of the degrees of freedom from a table; zero where it says nothing, and nothing of what is held.
fn column(model: &FeModel, path: &Path, quantity: &'static str, key: &'static str) -> Result<Vec<f64>, StructureError> {
    let values = read_nodal_values(path, quantity).map_err(|source| StructureError::StaticFile { key, source })?;
    let (mut all, mut is_empty) = (vec![0.0; model.n_dofs()], true);
    let (missing, path) = (values.first().map(|first| first.0), path.to_owned());
    for (label, value) in values {
        match model.row_of(label.node, label.component) {
            Some(row) => (all[row], is_empty) = (value, false),
            // What depends on others has no place of its own in the matrices.
            None if model.is_held(label.node, label.component) == Some(false) => {
                return Err(StructureError::StaticRow { key, label, path });
            }
            None => {}
        }
    }
    match missing.filter(|_| is_empty) {
        Some(label) => Err(StructureError::StaticRow { key, label, path }),
        None => Ok(all),
    }
}
