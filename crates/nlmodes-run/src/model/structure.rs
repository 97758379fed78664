//! Structure in free-interface modes from a scene, and positions on it.

use nlmodes::linalg::{multiply, triplets};
use nlmodes::modal::Coordinate;
use nlmodes::model::reduction::{ModeCount, OpenModes, ReductionError};
use nlmodes::model::{Dof, MassShift, MasslessContactModel, StructuralModel};
use nlmodes::response::{BaseMotion, BaseUnit, Weights};
use nlmodes_scene::SceneFile;
use nlmodes_scene::assemble::{
    Assembly, Body, Elements, OpenStructure, StaticState, StructureError, Structures, element_model, node_weights,
    redistribution, row_weights,
};
use nlmodes_scene::scene::{BaseDirection, BaseMotion as SceneBase, Place, Scene, StopOfBase, Structure};

use crate::physical::recorded;
use crate::{RunError, chain, mass, refusal};

/// A structure in free-interface modes, and its positions.
pub struct Reduced {
    /// Its free-interface modes.
    pub open: OpenModes,
    /// Degrees of freedom whose motion is written.
    pub recorded: Vec<usize>,
    /// What they are.
    pub coordinates: Vec<Coordinate>,
    /// What the mode of the scene loses with the mass of the contact nodes, where that is left out or moved.
    pub shift: Option<MassShift>,
    /// What is to be known about the mass that is left out.
    pub warning: Option<String>,
    /// The reduction, if the scene or its structure requires free-interface modes.
    pub reduction: Option<OpenStructure>,
    /// What static loads and stops that press do to it.
    pub state: Option<StaticState>,
    source: Source,
}

/// What the structure was made from.
enum Source {
    /// Elements along an axis; the structure without the mass of its contact nodes, where that is left out or moved.
    Straight { body: Box<Body>, massless: Option<Box<MasslessContactModel>> },
    /// Degrees of freedom of files.
    Files(Vec<Dof>),
    /// So many rows of a structure that was reduced elsewhere.
    Rows(usize),
    /// Several rods and beams, with consecutive degrees of freedom.
    Several(Vec<Body>),
}

/// Modes: up to this many times the highest harmonic of the mode, but within these numbers; what they leave over
/// answers statically.
const REACH: f64 = 3.0;
const FEWEST: usize = 12;
const MOST: usize = 40;

/// Reduces the structure of a scene.
///
/// # Errors
/// [`RunError`] at the key that it is about.
pub fn reduced(file: &SceneFile, structures: &Structures) -> Result<Reduced, RunError> {
    let scene = &file.scene;
    let Assembly { model, open: reduction, state } =
        Assembly::sharing(scene, structures).map_err(|error| refusal::at(file, &error.path(), &error))?;
    let Some(straight) = scene.structure.straight() else {
        let Some(reduction) = reduction else {
            let error =
                file.error_at("reduction.kind", "responses are computed in open modes", "expected \"open-modes\"", &[]);
            return Err(error.into());
        };
        let (recorded, mut coordinates) = recorded(&reduction.dofs, &reduction.modes);
        let bodies = Body::all(scene.structure.bodies()).map_err(|error| refusal::at(file, "structure", &error))?;
        for (dof, coordinate) in recorded.iter().zip(&mut coordinates).filter(|_| !bodies.is_empty()) {
            let number = bodies.partition_point(|body| body.first <= *dof);
            coordinate.kind = format!("{}-{number}", coordinate.kind);
        }
        let source = match reduction.elsewhere.as_ref().map(|elsewhere| elsewhere.rows) {
            Some(rows) => Source::Rows(rows),
            None if bodies.is_empty() => Source::Files(reduction.dofs.clone()),
            None => Source::Several(bodies),
        };
        let warning = scene.base_motion.and_then(|base| missing_mass(&reduction, base.direction));
        return Ok(Reduced { warning, ..Reduced::in_open_modes(reduction, (recorded, coordinates), source) });
    };
    let elements = Elements::new(straight).map_err(|error| refusal::at(file, "structure", &error))?;
    if let Some(reduction) = reduction {
        // The full structure of the modes.
        let model = element_model(straight, &scene.contacts).map_err(|error| refusal::at(file, "structure", &error))?;
        let written = recorded(model.dofs(), &reduction.modes);
        let source = Source::Straight { body: Box::new(Body { elements, model, first: 0 }), massless: None };
        return Ok(Reduced::in_open_modes(reduction, written, source));
    }
    let massless = redistribution(scene)
        .map(|rule| MasslessContactModel::new(&model, rule))
        .transpose()
        .map_err(|error| refusal::at(file, "method.mass_redistribution", &error))?;
    let open = modes(scene, &model, massless.as_ref()).map_err(|error| refusal::at(file, "structure", &error))?;
    let (recorded, coordinates) = recorded(model.dofs(), &open);
    let shift = mass::shift_of(file)?;
    let warning = shift.and_then(|shift| mass::warning_about(scene, &shift));
    let body = Box::new(Body { elements, model, first: 0 });
    let source = Source::Straight { body, massless: massless.map(Box::new) };
    Ok(Reduced { open, recorded, coordinates, shift, warning, reduction: None, state, source })
}

/// Missing in the files of a structure with base motion: the mass between free nodes and those that were fixed before
/// the files were written.
fn missing_mass(reduction: &OpenStructure, direction: BaseDirection) -> Option<String> {
    let (BaseDirection::Vector(direction), Some((files, _))) = (direction, &reduction.files) else { return None };
    if !files.fixed_mass.is_empty() {
        return None;
    }
    let mut force = vec![0.0; files.n_dofs()];
    files.stiffness.multiply(&files.rigid_displacement(direction), &mut force);
    let diagonal = files.stiffness.diagonal();
    // A free structure would follow without any force.
    let next_to_supports = force.iter().zip(&diagonal).filter(|(f, k)| f.abs() > FOLLOWS * **k).count();
    (next_to_supports > 0).then(|| {
        "the base moves the mass that is in the files; that between supported nodes and their neighbours is not, where \
            the files hold the supports \
         already (write matrices of the free structure and name its supports in `fixed` to have it)"
            .to_owned()
    })
}

/// Force in a rigid motion, over the stiffness of the row, up to which it is rounding.
const FOLLOWS: f64 = 1e-6;

fn modes(
    scene: &Scene,
    structure: &StructuralModel,
    massless: Option<&MasslessContactModel>,
) -> Result<OpenModes, ReductionError> {
    // Without the mass of the contact nodes there are fewer modes; a rigid stop needs flexibility that they leave over,
    // one with a stiffness has its own.
    let has_rigid_stop = structure.contacts().iter().any(|contact| contact.law.compliance() == 0.0);
    let available = structure.dofs().len().saturating_sub(usize::from(has_rigid_stop)).max(1);
    let open = match massless {
        Some(massless) => OpenModes::of_massless(massless, ModeCount::Lowest(MOST))?,
        None => OpenModes::of_model(structure, ModeCount::Lowest(MOST.min(available)))?,
    };
    let mode = open.omega_squared().get(scene.method.mode - 1).copied().unwrap_or(0.0).max(0.0).sqrt();
    let reach = (REACH * scene.method.harmonics as f64 * mode).powi(2);
    let within = open.omega_squared().iter().take_while(|w| **w <= reach).count();
    let wanted = within.max(FEWEST).max(scene.method.mode + 1);
    if wanted < open.n_modes() { open.truncated(wanted) } else { Ok(open) }
}

impl Reduced {
    /// A structure in free-interface modes, with the coordinates that are written: massless stops and residual
    /// flexibility.
    fn in_open_modes(
        reduction: OpenStructure,
        (recorded, coordinates): (Vec<usize>, Vec<Coordinate>),
        source: Source,
    ) -> Self {
        let (open, state) = (reduction.modes.clone(), reduction.state.clone());
        let (reduction, warning) = (Some(reduction), None);
        Self { open, recorded, coordinates, shift: None, warning, reduction, state, source }
    }

    /// The same where it rests in this state.
    ///
    /// # Errors
    /// [`StructureError`] for a state of another structure.
    pub fn resting(self, state: StaticState) -> Result<Self, StructureError> {
        let gaps = state.free_gaps[..self.open.n_contacts()].to_vec();
        let open = self.open.with_stops(gaps, self.open.stop_compliance().to_vec())?;
        let reduction = self.reduction.map(|reduction| reduction.resting(state.clone())).transpose()?;
        Ok(Self { open, reduction, state: Some(state), ..self })
    }

    /// The displacement at a place that moves; what is wrong with it is said at this key of the scene.
    ///
    /// # Errors
    /// [`RunError`].
    pub fn moving(&self, file: &SceneFile, path: &str, place: &Place) -> Result<Weights, RunError> {
        let weights = self.weights(place).map_err(|why| file.error_at(path, &why, "here", &[]))?;
        if weights.is_empty() {
            let title = "the structure does not move there in this direction";
            return Err(file.error_at(path, title, "expected a place that moves", &[]).into());
        }
        Ok(weights)
    }

    /// The displacement at a position, as degrees of freedom with weights; none if the structure is fixed there.
    ///
    /// # Errors
    /// What is wrong with the place, in words.
    fn weights(&self, place: &Place) -> Result<Weights, String> {
        match (&self.source, place) {
            (Source::Straight { body, .. }, Place::Along { at, direction, .. }) => {
                body.weights(*at, *direction).map_err(|error| chain(&error))
            }
            (Source::Several(bodies), Place::Along { at, direction, structure }) => {
                let body = bodies.get(*structure).ok_or_else(|| format!("there is no structure {}", structure + 1))?;
                body.weights(*at, *direction).map_err(|error| chain(&error))
            }
            (Source::Files(dofs), Place::Node { node, direction }) => node_weights(dofs, *node, *direction),
            (Source::Rows(rows), Place::Row { row }) => row_weights(*rows, *row),
            (_, Place::Node { node, .. }) => Err(format!("node {node} is one of a structure from files")),
            (_, Place::Row { row }) => Err(format!("row {row} is one of a structure that was reduced elsewhere")),
            (Source::Files(_) | Source::Rows(_), Place::Along { .. }) => {
                Err("a structure from files has no axis".to_owned())
            }
        }
    }

    /// Of each of several structures its first degree of freedom and its model; of one none.
    pub fn bodies(&self) -> impl Iterator<Item = (usize, &StructuralModel)> {
        let bodies = if let Source::Several(bodies) = &self.source { bodies.as_slice() } else { &[] };
        bodies.iter().map(|body| (body.first, &body.model))
    }

    /// Node, position and kind of each degree of freedom.
    pub fn dofs(&self) -> &[Dof] {
        match (&self.source, &self.reduction) {
            (Source::Straight { body, .. }, _) => body.model.dofs(),
            (Source::Files(dofs), _) => dofs,
            (Source::Several(_) | Source::Rows(_), reduction) => {
                reduction.as_ref().map_or(&[], |reduction| &reduction.dofs)
            }
        }
    }

    /// Displacement of each contact toward its obstacle: `−w` of its gap `g = g₀ + wᵀ q`.
    pub fn toward_stops(&self) -> Vec<Weights> {
        let mut all = vec![Weights::new(); self.open.n_contacts()];
        triplets(self.open.directions()).for_each(|(dof, contact, w)| all[contact].push((dof, -w)));
        all
    }
}

/// The motion of the base of a scene, with the mass that couples supported nodes to free ones.
///
/// # Errors
/// Why there is none, in words.
pub fn base_motion(scene: &Scene, parts: &Reduced) -> Result<BaseMotion, String> {
    let base = scene.base_motion.ok_or("there is no base motion")?;
    moving_base(scene, parts, parts.reduction.as_ref(), base)
}

/// The forces on the structure of a scene for each m/s² of the acceleration of its base, N.
///
/// # Errors
/// Why there are none, in words.
pub fn base_force(
    scene: &Scene,
    parts: &Reduced,
    reduction: Option<&OpenStructure>,
    direction: BaseDirection,
) -> Result<Vec<f64>, String> {
    let base = SceneBase { direction, amplitude: 1.0, is_acceleration: true, stop: StopOfBase::Moves };
    Ok(moving_base(scene, parts, reduction, base)?.inertia.iter().map(|m| -m).collect())
}

fn moving_base(
    scene: &Scene,
    parts: &Reduced,
    reduction: Option<&OpenStructure>,
    base: SceneBase,
) -> Result<BaseMotion, String> {
    let unit = if base.is_acceleration { BaseUnit::Acceleration } else { BaseUnit::Displacement };
    let stop_is_fixed = base.stop == StopOfBase::Fixed;
    let direction = match base.direction {
        BaseDirection::Along(direction) => direction,
        BaseDirection::Vector(direction) => {
            let (files, _) = reduction.and_then(|r| r.files.as_ref()).ok_or("the structure has an axis")?;
            let (inertia, rigid) = (files.inertia_along(direction), files.rigid_displacement(direction));
            return Ok(BaseMotion { inertia, rigid, unit, stop_is_fixed });
        }
    };
    let shaking = |structure: &Structure, body: &Body| -> Result<BaseMotion, String> {
        let motion = body.on_base(structure, direction, unit, stop_is_fixed).map_err(|error| chain(&error))?;
        motion.ok_or_else(|| "the nodes of the structure are not those of its elements".to_owned())
    };
    let (mut motion, model, massless) = match (&parts.source, scene.structure.bodies()) {
        (Source::Several(bodies), structures) => {
            let mut whole = BaseMotion { inertia: Vec::new(), rigid: Vec::new(), unit, stop_is_fixed };
            for (body, structure) in bodies.iter().zip(structures) {
                let own = shaking(structure, body)?;
                whole.inertia.extend(own.inertia);
                whole.rigid.extend(own.rigid);
            }
            return Ok(whole);
        }
        (Source::Straight { body, massless }, [structure]) => (shaking(structure, body)?, &body.model, massless),
        _ => return Err("a structure from files has no axis".to_owned()),
    };
    let Some(massless) = massless else { return Ok(motion) };
    // The mass used in the computation, and that without the contact nodes.
    let [with, without] = [model.mass(), massless.mass()].map(|mass| multiply(mass, &motion.rigid));
    motion.inertia.iter_mut().zip(without.iter().zip(&with)).for_each(|(m, (new, old))| *m += new - old);
    massless.contacts().iter().for_each(|contact| motion.inertia[contact.dof] = 0.0);
    Ok(motion)
}
