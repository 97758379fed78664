//! A scene that was checked: plain values in SI units, every default filled in.

mod choices;
mod continuation;
mod output;
mod parts;
mod records;
mod reduced;
mod reduction;
mod response;
mod sensitivity;
mod springs;
mod static_loads;
mod supports;
mod transient;
mod updating;
mod virtual_test;

pub use choices::{
    AtBranchPoint, BackboneMethod, ChannelRole, ContactSolver, Direction, ExciterKind, FrequencyDirection,
    InternalResonance, LevelOrder, LoopDetector, MassMatrix, MassRule, MatricesKind, MeasuredQuantity, MethodKind,
    RecordFormat, ReducedKind, ReductionKind, ResponseKind, Side, SpringDirection, StabilityChoice, StopOfBase,
    StructureKind, Support, Switching, Symmetry, UpdatedParameter,
};

pub use continuation::{Continuation, Start};
pub use output::{Directory, Output, OutputFiles, Overlay, Requirement};
pub use parts::{GroundSpring, MassPoint, Refined, Segment};
pub use records::{RecordScene, SegmentRule, SegmentTold};
pub use reduced::{Flexibility, LawContact, Numbers, Picture, ReducedModel, RowContact};
pub use reduction::{Matrices, Reduction, SceneStructure};
pub use response::{BaseDirection, BaseMotion, Damping, Dashpot, Force, ModeDamping, Place, Response};
pub use sensitivity::{SceneState, Sensitivity};
pub use springs::{LawSpring, SpringLaw};
pub use static_loads::{ForcePlace, Gravity, StaticForce, StaticLoads, Thermal};
pub use supports::{free_dofs, holds};
pub use transient::{Course, LoadOn, Transient, TransientLoad, TransientStart};
pub use updating::{Updating, UpdatingDone};
pub use virtual_test::{Backbone, KeptRecords, TestLoop, TestScene, TestSensor, TestStop};

use std::path::PathBuf;

use nlmodes_fem::{FemError, Mesh};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Most harmonics that a scene may ask for.
pub const MAX_HARMONICS: u32 = 1000;

/// A structure with one-sided stops, and how its nonlinear mode is to be computed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// Title of tables and figures.
    pub title: String,
    /// The structure.
    pub structure: SceneStructure,
    /// One-sided stops of a rod or beam, in the order of the file.
    pub contacts: Vec<Contact>,
    /// How the structure is reduced; `None` is by held modes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reduction: Option<Reduction>,
    /// Parameters that are fitted to given linear frequencies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub updating: Option<Updating>,
    /// Loads that do not change in time.
    #[serde(default, skip_serializing_if = "StaticLoads::is_empty")]
    pub static_loads: StaticLoads,
    /// Springs and dampers with a law of force.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub springs: Vec<LawSpring>,
    /// Damping with open contacts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub damping: Option<Damping>,
    /// Periodic forces.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub forces: Vec<Force>,
    /// A base that shakes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub base_motion: Option<BaseMotion>,
    /// Damped and forced motions; none where the conservative nonlinear mode is computed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub responses: Vec<Response>,
    /// A motion in time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub transient: Option<Transient>,
    /// Parameters by which the points of every curve are differentiated.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sensitivities: Vec<Sensitivity>,
    /// How the periodic motion is computed.
    pub method: Method,
    /// Where the branch starts, where it ends, and what it does on the way.
    pub continuation: Continuation,
    /// Directory of the result files.
    pub output_directory: PathBuf,
    /// Results that figures and page show beside those of the scene.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub overlays: Vec<Overlay>,
    /// Which files are written there.
    #[serde(default, skip_serializing_if = "OutputFiles::is_default")]
    pub files: OutputFiles,
    /// For which points Floquet multipliers are computed.
    #[serde(default = "auto")]
    pub stability: StabilityChoice,
    /// Wall time for them, s, if given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stability_budget_s: Option<f64>,
    /// Largest errors that are wanted.
    #[serde(default, skip_serializing_if = "Requirement::is_empty")]
    pub require: Requirement,
    /// What looks wrong with the scene, in words.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
}

impl Scene {
    /// Number of `[[contact]]` tables.
    pub fn n_contact_tables(&self) -> usize {
        match &self.structure {
            SceneStructure::Straight(_) | SceneStructure::Several(_) => self.contacts.len(),
            SceneStructure::Matrices(matrices) => matrices.contacts.len() + matrices.law_contacts.len(),
            SceneStructure::Reduced(model) => model.row_contacts.len() + model.law_contacts.len(),
        }
    }

    /// Whether a spring or a stop has a law of force.
    pub fn has_laws(&self) -> bool {
        let has_stops = match &self.structure {
            SceneStructure::Straight(_) | SceneStructure::Several(_) => {
                self.contacts.iter().any(|contact| contact.hertz.is_some())
            }
            SceneStructure::Matrices(matrices) => !matrices.law_contacts.is_empty(),
            SceneStructure::Reduced(model) => !model.law_contacts.is_empty(),
        };
        !self.springs.is_empty() || has_stops
    }

    /// Averaged kinetic energy at which a mode ends, relative to that where it starts, within a frequency window or
    /// not.
    pub fn max_energy_ratio(&self, has_window: bool) -> f64 {
        self.continuation.energy_limit(has_window || !self.springs.is_empty())
    }

    /// Whether nothing in it is nonlinear: no stop, and no spring with a law of force.
    pub fn is_linear(&self) -> bool {
        self.n_contact_tables() == 0 && self.springs.is_empty()
    }

    /// Whether the structure is reduced by its open modes.
    pub fn is_in_open_modes(&self) -> bool {
        self.reduction.is_some_and(|reduction| reduction.kind == Some(ReductionKind::OpenModes))
    }
}

/// What a scene that was written before there was a choice means.
fn auto() -> StabilityChoice {
    StabilityChoice::Auto
}

/// Geometry, mesh, supports, material and section.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Structure {
    /// Length along the axis, m.
    pub length: f64,
    /// Number of elements.
    pub elements: usize,
    /// Length of the first element over that of the last.
    pub grading: f64,
    /// Mass matrix of the elements.
    pub mass_matrix: MassMatrix,
    /// Support at position 0.
    pub start: Support,
    /// Support at position `length`.
    pub end: Support,
    /// Young's modulus, Pa.
    pub youngs_modulus: f64,
    /// Density, kg/m³.
    pub density: f64,
    /// Cross section, and with it the theory.
    pub section: Section,
    /// Mass per length beside that of the section, kg/m.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub added_mass: f64,
    /// Parts with their own sections and materials, one behind the other from the start; beyond the last one the
    /// structure's own go on.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub segments: Vec<Segment>,
    /// Positions of its nodes before refinement, m, where some were moved or put to stops and parts; else the mesh is
    /// graded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nodes: Option<Vec<f64>>,
    /// Elements that are shorter beside some nodes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refined: Option<Refined>,
    /// Point masses at its nodes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mass_points: Vec<MassPoint>,
    /// Springs between its nodes and the ground.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub springs: Vec<GroundSpring>,
    /// Frequencies that are imposed on the lowest modes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub modes: Option<ImposedModes>,
    /// Damping of this structure of several; otherwise that of the scene counts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub damping: Option<ModeDamping>,
}

/// Most modes with imposed frequencies.
const MAX_MODES: u32 = 1000;

/// Frequencies imposed on the lowest bending modes of a beam or axial modes of a rod. Mass, shapes and all other modes
/// stay.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ImposedModes {
    /// Frequencies from the lowest mode upwards, with open contacts and the contact mass as in `method`
    #[schemars(inner(range(min = 1e-9)), length(min = 1, max = MAX_MODES), extend("unit" = "Hz"))]
    pub frequencies_hz: Vec<f64>,
    /// Damping ratios of these modes, for a virtual test; nonlinear modes are conservative
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = 0.0, max = 0.999)), length(min = 1, max = MAX_MODES))]
    pub damping_ratios: Option<Vec<f64>>,
}

impl Structure {
    /// Rod or beam.
    pub fn kind(&self) -> StructureKind {
        match self.section {
            Section::Rod { .. } => StructureKind::Rod,
            Section::Beam { .. } => StructureKind::Beam,
        }
    }

    /// Mass of the sections, kg, without added and point masses.
    pub fn section_mass(&self) -> f64 {
        self.along(|density, section, _| density * section.area())
    }

    /// Mass of all parts, kg.
    pub fn total_mass(&self) -> f64 {
        let points: f64 = self.mass_points.iter().map(|point| point.mass).sum();
        self.along(|density, section, added| density * section.area() + added) + points
    }

    /// Integral along the axis of what density, section and added mass per length come to.
    fn along(&self, per_length: impl Fn(f64, Section, f64) -> f64) -> f64 {
        let (mut from, mut sum) = (0.0, 0.0);
        for segment in &self.segments {
            sum += per_length(segment.density, segment.section, segment.added_mass) * (segment.to - from);
            from = segment.to;
        }
        sum + per_length(self.density, self.section, self.added_mass) * (self.length - from)
    }

    /// The mesh.
    ///
    /// # Errors
    /// [`FemError`] for elements that cannot be distinguished.
    pub fn mesh(&self) -> Result<Mesh, FemError> {
        let mesh = match &self.nodes {
            Some(nodes) => Mesh::of_nodes(nodes.clone())?,
            None => Mesh::graded(self.length, self.elements, self.grading)?,
        };
        match &self.refined {
            Some(Refined { beside, factor }) => mesh.refined(beside, *factor),
            None => Ok(mesh),
        }
    }

    /// The same with each element halved, with its parts at the same places; none where they are at nodes beside
    /// which the mesh is refined.
    pub fn with_twice_the_elements(&self) -> Option<Self> {
        let mut finer = Self { elements: 2 * self.elements, ..self.clone() };
        let has_places = !(self.segments.is_empty() && self.mass_points.is_empty() && self.springs.is_empty());
        if !has_places && self.refined.is_none() && self.nodes.is_none() {
            return Some(finer);
        }
        if has_places && self.refined.is_some() {
            return None;
        }
        if self.grading != 1.0 || self.nodes.is_some() {
            let coarse = Self { refined: None, ..self.clone() }.mesh().ok()?;
            finer.nodes = Some(coarse.halved().nodes().to_vec());
        }
        finer.segments.iter_mut().for_each(|segment| segment.to_node *= 2);
        finer.mass_points.iter_mut().for_each(|point| point.node *= 2);
        finer.springs.iter_mut().for_each(|spring| spring.node *= 2);
        finer.refined.iter_mut().flat_map(|refined| &mut refined.beside).for_each(|node| *node *= 2);
        Some(finer)
    }

    /// Number of elements, those beside refined nodes included.
    pub fn all_elements(&self) -> usize {
        match self.refined {
            Some(_) => self.mesh().map_or(self.elements, |mesh| mesh.elements()),
            None => self.elements,
        }
    }

    /// Whether material, section and mass are the same everywhere.
    pub fn is_uniform(&self) -> bool {
        self.segments.is_empty() && self.added_mass == 0.0 && self.mass_points.is_empty() && self.springs.is_empty()
    }

    /// Number of degrees of freedom that the supports leave free.
    pub fn free_dofs(&self) -> usize {
        free_dofs(self.kind(), self.all_elements(), [self.start, self.end])
    }
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// Cross section, and with it the theory.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum Section {
    /// Axial motion only.
    Rod {
        /// Area, m².
        area: f64,
    },
    /// Axial motion, deflection and rotation (Timoshenko).
    Beam {
        /// Area, m².
        area: f64,
        /// Second moment of area about the bending axis, m⁴.
        second_moment: f64,
        /// Shear correction factor.
        shear_factor: f64,
        /// Poisson's ratio.
        poissons_ratio: f64,
        /// Distance of the outermost fibre from the bending axis, m, where it is known.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        outer_fibre: Option<f64>,
    },
}

impl Section {
    /// Area, m².
    pub fn area(self) -> f64 {
        match self {
            Self::Rod { area } | Self::Beam { area, .. } => area,
        }
    }
}

/// A stop on one side of a node.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// Number of the node, 0 at the start.
    pub node: usize,
    /// Position of the node, m.
    pub at: f64,
    /// Direction of the motion that the stop limits.
    pub direction: Direction,
    /// Side on which the stop is.
    pub side: Side,
    /// Clearance at rest, m; 0 touches, a negative one presses.
    pub gap: f64,
    /// Contact stiffness, N/m; a rigid stop has none. Always there for [`MethodKind::Hbm`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stiffness: Option<f64>,
    /// Damper beside it, N s/m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub damping: Option<f64>,
    /// Its law of force, where that is not linear: then it is no contact of the structural model, but a law beside it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hertz: Option<Hertz>,
    /// Coefficient of friction of which the power is estimated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction_estimate: Option<f64>,
    /// Index of the structure of several, from 0.
    #[serde(default, skip_serializing_if = "is_first")]
    pub structure: usize,
    /// The node of another structure that is touched in place of a stop.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub against: Option<Facing>,
}

/// `k δⁿ max(0, 1 + χ δ̇)` at the approach δ.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Hertz {
    /// `k`, N/mⁿ.
    pub stiffness: f64,
    /// `n`.
    pub exponent: f64,
    /// `χ`, s/m.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub dissipation: f64,
}

/// A node of another structure that a node can touch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Facing {
    /// Index of the structure, from 0.
    pub structure: usize,
    /// Number of the node, 0 at its start.
    pub node: usize,
    /// Position of the node along the axis of that structure, m.
    pub at: f64,
}

fn is_first(structure: &usize) -> bool {
    *structure == 0
}

/// How the periodic motion is computed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Method {
    /// Method.
    pub kind: MethodKind,
    /// Number of the linear mode, 1 for the lowest.
    pub mode: usize,
    /// Number of harmonics beside the mean; the largest where several are asked for.
    pub harmonics: usize,
    /// What chooses harmonics and held modes instead; `harmonics` is then the smallest number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub accuracy: Option<Accuracy>,
    /// All numbers of harmonics for which a branch is computed, ascending.
    #[serde(default, skip_serializing_if = "is_single")]
    pub harmonics_list: Vec<usize>,
    /// How the instants of closing and opening are found.
    pub switching: Switching,
    /// Samples of the contact a period.
    pub samples: usize,
    /// What happens to the mass of the contact degrees of freedom.
    pub mass_redistribution: MassRule,
    /// Solver of the contact problem.
    pub contact_solver: ContactSolver,
    /// Stiffness of the stops that have none of their own, N/m; not for [`MethodKind::MsHbm`].
    pub contact_stiffness: Option<f64>,
    /// Symmetry in time that the motion is assumed to have.
    pub symmetry: Symmetry,
    /// Number of held modes that carry the dynamics; `None`: chosen by the program.
    pub held_modes: Option<usize>,
}

/// An accuracy by which harmonics and held modes are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Accuracy {
    /// Largest relative error of the frequency at the same energy.
    pub error: f64,
    /// Most harmonics.
    pub max_harmonics: usize,
}

fn is_single(list: &[usize]) -> bool {
    list.len() == 1
}
