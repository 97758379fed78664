//! Static loads, and where they leave the structure.
//!
//! A constant force field `f` moves the linear structure by `K⁻¹ f` while its contacts are open. About that place its
//! motions are those of the same structure with the gaps `g₀ + Wᵀ K⁻¹ f`. What acts on the rigid-body motions of a
//! structure that floats is no gap: it stays as a force, which the contacts alone balance.

use std::path::Path;

use nlmodes::contact::solver_by_name;
use nlmodes::hbm::LawAtRest;
use nlmodes::linalg::{DenseLu, Mat, SparseMatrix, multiply, multiply_many, multiply_transposed};
use nlmodes::model::reduction::{ModeCount, OpenModes, ReductionError, RestState};
use nlmodes::model::{Contact, Dof, DofKind, SteadyForce, StructuralModel};
use nlmodes::response::{BaseUnit, HeldByLaws};
use nlmodes_io::{ContactNodes, FeModel, ReadError, read_nodal_values};

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
    /// By how much that opens the gaps, c, m; of stops with a law of force, which follow the contacts, too.
    pub opening: Vec<f64>,
    /// The gaps that this leaves, with the contacts open, c, m.
    pub free_gaps: Vec<f64>,
    /// Where the structure rests, and the forces of its contacts there.
    pub rest: RestState,
    /// What acts on each rigid-body motion of a structure that floats, N/√kg; empty where nothing does.
    pub steady: Vec<f64>,
    /// The same as a force on the degrees of freedom of a structure that is not reduced.
    pub carried: Option<SteadyForce>,
    /// Energy of the structure and of its elastic stops at rest, above that of the place with open contacts, J:
    /// `½ λᵀ (F + C) λ = −½ λᵀ g`; with a force on rigid-body motions, whose work `pᵀ η` counts, `−½ λᵀ g − ½ pᵀ η`.
    /// Laws of force count theirs from rest.
    pub energy: f64,
}

impl StaticState {
    /// Of a structure with these modes that nothing moves.
    pub fn still(modes: &OpenModes) -> Self {
        let free_gaps = modes.gaps().to_vec();
        let rest = RestState::still(modes.n_modes(), &free_gaps);
        let (displacement, opening) = (vec![0.0; modes.n_dofs()], vec![0.0; free_gaps.len()]);
        Self { displacement, modal: rest.eta.clone(), opening, free_gaps, rest, ..Self::default() }
    }

    /// The same where laws of force hold the structure as well; `stops` are those with a law, their clearances in the
    /// drawing (m) and where they rest: they follow the contacts.
    pub fn held(mut self, by: &HeldByLaws, stops: &[(f64, LawAtRest)]) -> Self {
        let add = |to: &mut [f64], by: &[f64]| to.iter_mut().zip(by).for_each(|(to, by)| *to += by);
        add(&mut self.displacement, &by.displacement);
        add(&mut self.modal, &by.modal);
        add(&mut self.opening, &by.opening);
        add(&mut self.free_gaps, &by.opening);
        self.rest = by.rest.clone();
        let rest = &mut self.rest;
        self.energy = -0.5 * rest.forces.iter().zip(&self.free_gaps).map(|(force, gap)| force * gap).sum::<f64>();
        for (gap, at) in stops {
            self.opening.push(-at.origin);
            self.free_gaps.push(gap - at.origin);
            rest.gaps.push((gap - at.place).max(0.0));
            rest.forces.push(at.force);
            rest.closed.push(at.force > 0.0);
        }
        self
    }

    /// Whether contacts alone carry the structure, which floats without them.
    pub fn is_carried(&self) -> bool {
        !self.steady.is_empty()
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
    (files, dofs): (Option<&FeModel>, &[Dof]),
) -> Result<Option<StaticState>, StructureError> {
    state(scene, modes, (files, dofs), None)
}

/// The same; a force that contacts alone balance is carried by the degrees of freedom with `mass`, where that is given.
fn state(
    scene: &Scene,
    modes: &OpenModes,
    (files, dofs): (Option<&FeModel>, &[Dof]),
    mass: Option<&SparseMatrix>,
) -> Result<Option<StaticState>, StructureError> {
    let mut moved = match (&scene.structure, files) {
        (SceneStructure::Matrices(matrices), Some(model)) => of_files(&scene.static_loads, matrices, model)?,
        (SceneStructure::Reduced(_), _) => of_rows(&scene.static_loads, modes.n_dofs())?,
        (structure, _) => of_bodies(&scene.static_loads, structure.bodies())?,
    };
    if moved.is_none() && modes.gaps().iter().all(|gap| *gap >= 0.0) {
        return Ok(None);
    }
    let key = scene.static_loads.first_key();
    let refused = |error: ReductionError| falls(error, key, dofs);
    let push = match &moved {
        Some(Moved::Displacement(_)) if modes.floats() => return Err(StructureError::FloatsUnderLoad { key }),
        Some(Moved::Force(force)) => on_rigid_motions(modes, force),
        _ => Vec::new(),
    };
    let pushed =
        if push.is_empty() { modes.clone() } else { modes.clone().with_steady_force(push).map_err(refused)? };
    let steady = pushed.steady_force().iter().copied().take(modes.n_rigid()).collect::<Vec<f64>>();
    let carried = mass.filter(|_| !steady.is_empty()).map(|mass| carried(modes, mass, &steady)).transpose()?;
    if let (Some(Moved::Force(force)), Some(carried)) = (&mut moved, &carried) {
        force.iter_mut().zip(&carried.force).for_each(|(force, own)| *force -= own);
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
    let free_gaps: Vec<f64> = modes.gaps().iter().zip(&opening).map(|(gap, opening)| gap + opening).collect();
    let loaded = pushed.with_stops(free_gaps.clone(), modes.stop_compliance().to_vec())?;
    let solver = solver_by_name("active-set").map_err(StructureError::Rest)?;
    // What the carried force strains is not in the gaps.
    let load = carried.as_ref().map(|carried| modes.load(&carried.force)).transpose()?;
    let beside = load.clone().map(|mut load| {
        load.modal[..steady.len()].fill(0.0);
        load
    });
    let rest = match loaded.rest(beside.as_ref().as_slice(), solver.as_ref()) {
        // Nothing holds it at a stop that it interferes with: it gives way.
        Err(ReductionError::FloatingRest) if steady.is_empty() => RestState::default(),
        rest => rest.map_err(refused)?,
    };
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let work = match (&carried, &load) {
        (Some(carried), Some(load)) => {
            product(&load.modal, &rest.eta)
                + product(&load.gaps, &rest.forces)
                + product(&carried.force, &load.residual)
        }
        _ => product(&steady, &rest.eta),
    };
    let energy = -0.5 * (product(&rest.forces, &free_gaps) + work);
    Ok(Some(StaticState { displacement, modal, opening, free_gaps, rest, steady, carried, energy }))
}

/// Share of the sum of its parts up to which a force on a rigid-body motion is in balance.
const BALANCED: f64 = 1e-9;

/// `Φᵀ f` of the rigid-body motions; empty where the force is in balance by itself.
fn on_rigid_motions(modes: &OpenModes, force: &[f64]) -> Vec<f64> {
    let parts = |r: usize| force.iter().enumerate().map(move |(i, f)| modes.shapes()[(i, r)] * f);
    let rigid = 0..modes.n_rigid();
    let most = rigid.clone().map(|r| parts(r).map(f64::abs).sum::<f64>()).fold(0.0, f64::max);
    let on: Vec<f64> = rigid.map(|r| parts(r).sum()).collect();
    if on.iter().all(|p: &f64| p.abs() <= BALANCED * most) { Vec::new() } else { on }
}

/// The force with these resultants `p` on the rigid-body motions that the inertia of `mass` has in them,
/// `f = M Φ_r (Φ_rᵀ M Φ_r)⁻¹ p`, and those of the motions that contacts feel.
fn carried(modes: &OpenModes, mass: &SparseMatrix, p: &[f64]) -> Result<SteadyForce, StructureError> {
    let shapes = modes.shapes().subcols(0, p.len()).to_owned();
    let inertia = multiply_many(mass, &shapes);
    let mut share = p.to_vec();
    DenseLu::factor(&(shapes.transpose() * &inertia))?.solve_in_place(&mut share);
    let along = |i: usize| share.iter().enumerate().map(|(r, share)| inertia[(i, r)] * share).sum();
    let unfelt = modes.unfelt_motions();
    let felt: Vec<usize> = (0..p.len()).filter(|r| !unfelt.contains(r)).collect();
    let motions = Mat::from_fn(shapes.nrows(), felt.len(), |i, k| shapes[(i, felt[k])]);
    Ok(SteadyForce { force: (0..shapes.nrows()).map(along).collect(), motions })
}

/// Why a structure that floats does not rest under a load.
fn falls(error: ReductionError, key: &'static str, dofs: &[Dof]) -> StructureError {
    let place = |motion: &[f64]| {
        let largest = (0..motion.len().min(dofs.len())).max_by(|a, b| motion[*a].abs().total_cmp(&motion[*b].abs()));
        largest.map_or_else(String::new, |dof| {
            let Dof { node, kind, .. } = dofs[dof];
            let side = if motion[dof] < 0.0 { "negative" } else { "positive" };
            format!("; node {node} goes farthest, toward {side} {}", kind.name())
        })
    };
    match error {
        ReductionError::FallsAway { motion } => {
            StructureError::Falls { key, why: "no forces of its contacts balance the load", place: place(&motion) }
        }
        ReductionError::FallsUnfelt { motion } => StructureError::Falls {
            key,
            why: "it moves as a rigid body in a way that no contact feels",
            place: place(&motion),
        },
        ReductionError::FloatingRest => StructureError::Tips { key },
        error => error.into(),
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
    let redistributed = super::redistribution(scene).map(|rule| rule.redistribute(model)).transpose()?;
    state(scene, &modes, (files.as_deref(), model.dofs()), Some(redistributed.as_ref().unwrap_or(model.mass())))
}

/// The model with the gaps that the loads leave, and the force that its contacts carry.
pub(super) fn moved(model: StructuralModel, state: &StaticState) -> Result<StructuralModel, StructureError> {
    let contacts = model.contacts().iter().zip(&state.free_gaps);
    let contacts = contacts.map(|(of, &gap)| Contact { gap, ..of.clone() }).collect();
    let model = model.with_contacts(contacts)?;
    Ok(match &state.carried {
        Some(carried) => model.with_steady_force(carried.clone())?,
        None => model,
    })
}

/// Displacements under a force with the contacts open, `K⁻¹ f`, and the modal coordinates of them; those of what floats
/// stay where they are.
fn under(modes: &OpenModes, force: &[f64]) -> Result<(Vec<f64>, Vec<f64>), StructureError> {
    let load = modes.load(force)?;
    let mut displacement = load.residual.clone();
    let rigid = modes.n_rigid();
    let answer = |(r, (p, square)): (usize, (&f64, &f64))| if r < rigid { 0.0 } else { p / square };
    let modal: Vec<f64> = load.modal.iter().zip(modes.omega_squared()).enumerate().map(answer).collect();
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
    let of = |dof: &Dof| {
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
