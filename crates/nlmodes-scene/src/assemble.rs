//! From a checked scene to the structural model.

mod contact;
mod open;
mod parts;
mod places;
mod reduced;
mod several;
mod shared;
mod static_loads;
mod steps;
mod strainless;

use std::f64::consts::TAU;
use std::path::PathBuf;

use nlmodes::contact::LcpError;
use nlmodes::fem::{Beam, FemError, MassMatrix, Material, Mesh, Rod, Section, Step, Stop, StressRow, Support};
use nlmodes::model::reduction::ReductionError;
use nlmodes::model::{
    Conserve, Contact, Dof, DofIndex, DofKind, Drop, ImposedFrequencies, MassRedistribution, MasslessContactModel,
    ModelError, Move, StructuralModel,
};
use nlmodes_io::{ContactError, DofLabel, ReadError, find_contacts};
use nlmodes_linalg::{Digits, LinalgError};
use thiserror::Error;

pub use open::{NodeContacts, OpenStructure, dofs, free_modes, law_contacts, node_contacts};
pub use places::{Body, node_weights, row_weights};
pub use reduced::{PictureMesh, ReducedElsewhere, ReducedProblem};
pub use shared::Structures;
pub use static_loads::StaticState;
pub use strainless::Strainless;

use crate::scene::{self, GroundSpring, MassPoint, MassRule, MethodKind, Scene, SceneStructure, StructureKind};

/// A structure of one of the two theories, with what is fixed to it.
#[derive(Debug, Clone)]
pub struct Elements {
    theory: Theory,
    masses: Vec<MassPoint>,
    springs: Vec<GroundSpring>,
}

#[derive(Debug, Clone)]
enum Theory {
    /// A rod, which moves along itself.
    Rod(Rod, Vec<Step<f64>>),
    /// A beam, which bends and moves along itself.
    Beam(Beam, Vec<Step<Section>>),
}

impl Elements {
    /// Of a checked structure.
    ///
    /// # Errors
    /// What the element library has against it; a checked scene gives no reason for that.
    pub fn new(structure: &scene::Structure) -> Result<Self, FemError> {
        let mesh = structure.mesh()?;
        let material = Material::new(structure.youngs_modulus, structure.density)?;
        let mass_matrix = match structure.mass_matrix {
            scene::MassMatrix::Consistent => MassMatrix::Consistent,
            scene::MassMatrix::Lumped => MassMatrix::Lumped,
        };
        let [start, end] = [structure.start, structure.end].map(support);
        let theory = match structure.section {
            scene::Section::Rod { area } => {
                let steps = steps::of_rod(structure, &mesh)?;
                Theory::Rod(Rod { material, area, mesh, mass_matrix, start, end }, steps)
            }
            scene::Section::Beam { .. } => {
                let steps = steps::of_beam(structure, &mesh)?;
                let (material, section) = steps::material_and_section(material, structure.section)?;
                Theory::Beam(Beam { material, section, mesh, mass_matrix, start, end }, steps)
            }
        };
        Ok(Self { theory, masses: structure.mass_points.clone(), springs: structure.springs.clone() })
    }

    /// The assembled model.
    ///
    /// # Errors
    /// [`FemError`].
    pub fn assemble(&self, stops: &[Stop]) -> Result<StructuralModel, FemError> {
        let model = match &self.theory {
            Theory::Rod(rod, steps) => rod.assemble_stepped(steps, stops),
            Theory::Beam(beam, steps) => beam.assemble_stepped(steps, stops),
        }?;
        parts::fixed_to(model, &self.masses, &self.springs)
    }

    /// Axial stress of a model with these degrees of freedom; none of a beam with a section whose height is not known.
    pub fn stress_rows(&self, dofs: &[Dof]) -> Option<Vec<StressRow>> {
        match &self.theory {
            Theory::Rod(rod, steps) => Some(rod.stress_rows(steps, dofs)),
            Theory::Beam(beam, steps) => beam.stress_rows(steps, dofs),
        }
    }

    /// Rod or beam.
    pub fn kind(&self) -> StructureKind {
        match self.theory {
            Theory::Rod(..) => StructureKind::Rod,
            Theory::Beam(..) => StructureKind::Beam,
        }
    }

    /// The nodes.
    pub fn mesh(&self) -> &Mesh {
        match &self.theory {
            Theory::Rod(rod, _) => &rod.mesh,
            Theory::Beam(beam, _) => &beam.mesh,
        }
    }

    /// Displacement along a rod or across a beam at a position (m), as indices and weights of the degrees of freedom.
    ///
    /// # Errors
    /// [`FemError::OutsideMesh`].
    pub fn displacement_at(&self, model: &StructuralModel, position: f64) -> Result<Vec<(usize, f64)>, FemError> {
        match &self.theory {
            Theory::Rod(rod, _) => rod.displacement_at(model.dofs(), position),
            Theory::Beam(beam, steps) => steps::beam_there(beam, steps, position).deflection_at(model.dofs(), position),
        }
    }
}

/// Why there is no structure.
#[derive(Debug, Error)]
pub enum StructureError {
    /// What the element library has against it; a checked scene gives no reason for that.
    #[error(transparent)]
    Elements(#[from] FemError),
    /// Frequencies that cannot be imposed on its modes.
    #[error(transparent)]
    Imposed(#[from] ModelError),
    /// The mass of the files is negative for some motion.
    #[error(transparent)]
    Mass(ModelError),
    /// A file of a finite-element program is not what it should be.
    #[error("{source}")]
    Read {
        /// The key below `structure` that names the file.
        key: &'static str,
        /// What is wrong with it.
        source: ReadError,
    },
    /// More modes are asked for than there are.
    #[error("`reduction.modes` asks for {asked} modes of a structure with {dofs} degrees of freedom")]
    TooManyModes {
        /// What the scene asks for.
        asked: usize,
        /// Degrees of freedom of the structure.
        dofs: usize,
    },
    /// What another program computed of a structure is not what it should be.
    #[error("{problem}")]
    Reduced {
        /// The key below `structure` that it is about.
        key: &'static str,
        /// What is wrong with it.
        #[source]
        problem: ReducedProblem,
    },
    /// A contact of a row that there is not.
    #[error(
        "`contact.{contact}.row` is {row}, but `structure.contact_rows` has {rows} rows; expected one of them, from 1"
    )]
    NoSuchRow {
        /// The contact, from 0.
        contact: usize,
        /// The row that it names.
        row: usize,
        /// How many there are.
        rows: usize,
    },
    /// More modes are asked for than another program computed.
    #[error(
        "`reduction.modes` asks for {asked} modes, and `structure.frequencies_hz` has {available}; expected at most \
        as many"
    )]
    TooManyGivenModes {
        /// What the scene asks for.
        asked: usize,
        /// Modes that there are.
        available: usize,
    },
    /// A contact does not fit the model of the files.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// The matrices of the files make no structure.
    #[error("the matrices")]
    Matrices(#[from] LinalgError),
    /// A preload has taken more stiffness than there is.
    #[error(
        "the stiffness is negative in mode {mode} (ω² = {omega_squared:.3e} rad²/s²): the structure has buckled \
        under the preload of its matrices, and does not vibrate \
         about this state; expected matrices of a smaller preload"
    )]
    Buckled {
        /// The mode, from 1.
        mode: usize,
        /// `φᵀ K φ`, rad²/s².
        omega_squared: f64,
    },
    /// A mode of which the digits of the files leave nothing.
    #[error(
        "the stiffness is known to {digits}, which leaves nothing of its lowest mode: it may be any up to \
        {up_to_hz:.3} Hz; expected more digits (double precision, at best in \
         binary), or the matrices of a coarser or reduced model"
    )]
    Digits {
        /// Those of the stiffness.
        digits: Digits,
        /// The highest frequency that it may have, Hz.
        up_to_hz: f64,
    },
    /// Modes of a structure that nothing holds, beside contacts that are much stiffer.
    #[error(
        "the structure can move as a rigid body: its modes are not found beside the stiffness at its contacts; a \
        support is missing (boundary conditions of the model before \
         its matrices are written, or nodes in `structure.fixed`)"
    )]
    Floating,
    /// No shift makes the stiffness positive.
    #[error(
        "the stiffness is far from that of a structure at rest: even with mass beside it, it is negative for some \
        motion; expected matrices without a preload far beyond \
         buckling, and the stiffness where the stiffness is named"
    )]
    Negative,
    /// Displacements under static loads of a structure that nothing holds.
    #[error(
        "the structure floats, so that its displacements under loads with its contacts open are not determined; \
        expected the loads themselves: [gravity] or [[static_force]]"
    )]
    FloatsUnderLoad {
        /// The key of the load.
        key: &'static str,
    },
    /// Static loads on a structure that floats, which its contacts cannot balance.
    #[error(
        "the structure falls away under `{key}`: {why}{place}; expected a contact on that side, or a support, or a \
        load that it can carry"
    )]
    Falls {
        /// The key of the load.
        key: &'static str,
        /// Why.
        why: &'static str,
        /// Where it moves most.
        place: String,
    },
    /// A structure that floats under static loads and rests on too few contacts.
    #[error(
        "under `{key}` the structure rests on contacts that do not hold it: it can still roll or tip over them \
        without strain; expected more contacts below it, or a support"
    )]
    Tips {
        /// The key of the load.
        key: &'static str,
    },
    /// A table of nodal values cannot be read.
    #[error("{source}")]
    StaticFile {
        /// The key that names it.
        key: &'static str,
        /// What is wrong with it.
        source: ReadError,
    },
    /// A table of nodal values names what the structure does not have.
    #[error("{}: the structure has no row for {label}; expected a degree of freedom of its matrices", path.display())]
    StaticRow {
        /// The key that names the table.
        key: &'static str,
        /// The degree of freedom.
        label: DofLabel,
        /// The table.
        path: PathBuf,
    },
    /// A constant force acts where there is nothing.
    #[error("{why}")]
    StaticForce {
        /// Number of the force in the scene, from 0.
        force: usize,
        /// What is wrong with the place.
        why: String,
    },
    /// Stops that leave it no place at all.
    #[error(
        "the structure does not fit between stops {contacts} (counted from 0): wherever it rests, it penetrates one of \
        them; expected larger gaps, or stops that yield (`stiffness_n_m`)"
    )]
    NoRoom {
        /// The stops, from 0.
        contacts: String,
    },
    /// The contact forces at rest are not found.
    #[error("contact forces at rest under the static loads")]
    Rest(#[source] LcpError),
    /// It cannot be reduced.
    #[error("the structure cannot be reduced by its open modes")]
    Reduction(#[source] ReductionError),
}

impl From<ReductionError> for StructureError {
    fn from(error: ReductionError) -> Self {
        match error {
            ReductionError::Rest(LcpError::Infeasible { ray }) => Self::NoRoom { contacts: pressing(&ray) },
            ReductionError::Unstable { mode, omega_squared } => Self::Buckled { mode, omega_squared },
            ReductionError::Linalg {
                source: LinalgError::NotPositiveDefinite { what: "shifted stiffness matrix", .. },
                ..
            } => Self::Negative,
            error => Self::Reduction(error),
        }
    }
}

/// Share of the largest force of a proof of contradictory contacts up to which a contact has no part in it.
const NO_PART: f64 = 1e-6;

/// The contacts that contradict each other.
fn pressing(ray: &[f64]) -> String {
    let largest = ray.iter().copied().fold(0.0, f64::max);
    let part = ray.iter().enumerate().filter(|(_, force)| **force > NO_PART * largest);
    part.map(|(contact, _)| contact.to_string()).collect::<Vec<_>>().join(", ")
}

impl StructureError {
    /// The key of the scene that it is about.
    pub fn path(&self) -> String {
        match self {
            Self::Elements(_) | Self::Matrices(_) | Self::Floating => "structure".into(),
            Self::Read { key, .. } => format!("structure.{key}"),
            Self::Reduced { key, .. } => format!("structure.{key}"),
            Self::NoSuchRow { contact, .. } => format!("contact.{contact}.row"),
            Self::TooManyModes { .. } | Self::TooManyGivenModes { .. } => "reduction.modes".into(),
            Self::Mass(_) => "structure.mass".into(),
            Self::Buckled { .. } | Self::Negative | Self::Digits { .. } => "structure.stiffness".into(),
            Self::Imposed(_) => "structure.modes.frequencies_hz".into(),
            Self::Contact(error) => format!("contact.{}", error.contact),
            Self::FloatsUnderLoad { key }
            | Self::Falls { key, .. }
            | Self::Tips { key }
            | Self::StaticFile { key, .. }
            | Self::StaticRow { key, .. } => (*key).to_owned(),
            Self::StaticForce { force, .. } => format!("static_force.{force}"),
            Self::NoRoom { .. } | Self::Rest(_) => "contact".into(),
            Self::Reduction(ReductionError::NoMode { .. } | ReductionError::OnlyRigidModes { .. }) => {
                "reduction".into()
            }
            Self::Reduction(_) => "structure".into(),
        }
    }
}

/// A structure that a method works on, and the open modes from which it is made if it is.
#[derive(Debug)]
pub struct Assembly {
    /// The structure; in open modes, that of modal coordinates and contacts.
    pub model: StructuralModel,
    /// What it was reduced from.
    pub open: Option<OpenStructure>,
    /// What static loads and stops that press do to it: its gaps are those that they leave.
    pub state: Option<StaticState>,
}

impl Assembly {
    /// The structure of the scene, reduced by its open modes where the scene asks for that.
    ///
    /// # Errors
    /// [`StructureError`].
    pub fn of(scene: &Scene) -> Result<Self, StructureError> {
        Self::sharing(scene, &Structures::default())
    }

    /// The same, where what is known of files need not be read and reduced again.
    ///
    /// # Errors
    /// [`StructureError`].
    pub fn sharing(scene: &Scene, structures: &Structures) -> Result<Self, StructureError> {
        if scene.is_in_open_modes() {
            let open = OpenStructure::of(scene, structures)?;
            return Ok(Self { model: open.reduced.model().clone(), state: open.state.clone(), open: Some(open) });
        }
        let model = full_model(scene, structures)?;
        let state = static_loads::of_model(scene, &model, structures)?;
        let model = if let Some(state) = &state { static_loads::moved(model, state)? } else { model };
        Ok(Self { model, open: None, state })
    }
}

/// The structure of the scene with its stops, contact mass kept, and with the frequencies that are imposed on it; in
/// open modes where the scene asks for that.
///
/// # Errors
/// [`StructureError`].
pub fn structural_model(scene: &Scene) -> Result<StructuralModel, StructureError> {
    Assembly::of(scene).map(|assembly| assembly.model)
}

/// The structure of the scene, not reduced.
fn full_model(scene: &Scene, structures: &Structures) -> Result<StructuralModel, StructureError> {
    match &scene.structure {
        SceneStructure::Straight(structure) => {
            let model = element_model(structure, &scene.contacts)?;
            match imposed(structure, &model, redistribution(scene).filter(|_| !scene.is_in_open_modes()))? {
                Some(imposed) => Ok(imposed.model),
                None => Ok(model),
            }
        }
        SceneStructure::Several(structures) => several::model(structures, &scene.contacts),
        SceneStructure::Matrices(matrices) => {
            let files = structures.model(&matrices.files)?;
            let found = find_contacts(&files, &matrices.files, &matrices.contacts)?;
            let dofs = dofs(&files);
            let index = DofIndex::new(&dofs);
            let contact = |c: &nlmodes_io::NodeContact| {
                let normal = c.normal;
                let contact = match c.against {
                    None => Contact::point(&index, c.node as usize, normal, c.gap),
                    Some(other) => Contact::pair(&index, c.node as usize, other as usize, normal, c.gap),
                }?;
                Ok(match c.stiffness {
                    Some(stiffness) => contact.on_spring(stiffness),
                    None => contact,
                })
            };
            let contacts = found.iter().map(contact).collect::<Result<Vec<Contact>, ModelError>>()?;
            let places = files.labels.iter().map(|label| files.place_of(label.node).unwrap_or([0.0; 3])).collect();
            let model = StructuralModel::new(files.mass.symmetric()?, files.stiffness.symmetric()?, dofs, contacts)?;
            Ok(model.with_places(places)?)
        }
        // Nothing but its reduced equations is known of it.
        SceneStructure::Reduced(_) => Ok(OpenStructure::of(scene, structures)?.reduced.model().clone()),
    }
}

/// A rod or beam with its stops as its elements give it; those with a law of force of their own are given beside it.
///
/// # Errors
/// What the element library has against it.
pub fn element_model(structure: &scene::Structure, contacts: &[scene::Contact]) -> Result<StructuralModel, FemError> {
    let model = Elements::new(structure)?.assemble(&[])?;
    let stops = contacts.iter().filter(|of| of.hertz.is_none());
    let contacts = stops.map(|of| contact::contact(of, model.dofs(), &[0])).collect::<Result<Vec<_>, _>>()?;
    Ok(model.with_contacts(contacts)?)
}

/// The model with the frequencies of `[structure.modes]`, imposed with the mass that `rule` leaves; `None` where there
/// are none.
///
/// # Errors
/// [`ModelError`].
pub fn imposed(
    structure: &scene::Structure,
    model: &StructuralModel,
    rule: Option<&dyn MassRedistribution>,
) -> Result<Option<ImposedFrequencies>, ModelError> {
    let Some(modes) = &structure.modes else { return Ok(None) };
    let kind = moving_kind(structure.kind());
    let omega: Vec<f64> = modes.frequencies_hz.iter().map(|hz| TAU * hz).collect();
    let rule = rule.filter(|_| !model.contacts().is_empty());
    model.with_frequencies(rule, kind, &omega).map(Some)
}

/// What moves in the modes that a test sees: across a beam, along a rod.
pub fn moving_kind(kind: StructureKind) -> DofKind {
    match kind {
        StructureKind::Rod => DofKind::Axial,
        StructureKind::Beam => DofKind::Deflection,
    }
}

/// The rule by which the scene takes the mass away from its contacts; `None` where it stays.
pub fn redistribution(scene: &Scene) -> Option<&'static dyn MassRedistribution> {
    match scene.method.mass_redistribution {
        MassRule::Drop => Some(&Drop),
        MassRule::Move => Some(&Move),
        MassRule::Conserve => Some(&Conserve),
        MassRule::None => None,
    }
}

/// The model that the method of the scene works on: massless contact nodes, or nodes that carry the springs of their
/// stops.
///
/// # Errors
/// [`ModelError`] if the mass cannot be redistributed.
pub fn contact_model(scene: &Scene, model: &StructuralModel) -> Result<MasslessContactModel, ModelError> {
    let rule = redistribution(scene);
    match (scene.method.kind, rule) {
        (MethodKind::MsHbm | MethodKind::Shooting, Some(rule)) => MasslessContactModel::new(model, rule),
        // The contacts of open modes have no mass that could be taken away.
        (MethodKind::MsHbm | MethodKind::Shooting, None) if scene.is_in_open_modes() => {
            MasslessContactModel::new(model, &Drop)
        }
        // A checked scene has no ms-hbm without a rule but in open modes, and no shooting without one on rigid stops.
        (_, rule) => MasslessContactModel::with_spring_tips(model, rule),
    }
}

fn support(support: scene::Support) -> Support {
    match support {
        scene::Support::Clamped => Support::Clamped,
        scene::Support::Pinned => Support::Pinned,
        scene::Support::Sliding => Support::Sliding,
        scene::Support::Free => Support::Free,
    }
}
