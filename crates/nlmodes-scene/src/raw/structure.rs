use schemars::JsonSchema;
use serde::Deserialize;

use super::{RawModeDamping, RawSegment, RawSpring};
use crate::scene::{ImposedModes, MassMatrix, MassPoint, StructureKind, Support};

/// Most elements that a scene may ask for.
pub const MAX_ELEMENTS: u32 = 1_000_000;
/// Most that elements beside stops are refined.
const MAX_REFINEMENT: f64 = 65536.0;

/// Geometry, mesh and supports.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawStructure {
    /// What the structure is
    pub kind: StructureKind,
    /// Length along the axis
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0.0))]
    pub length_m: f64,
    /// Number of elements
    #[schemars(range(min = 1, max = MAX_ELEMENTS))]
    pub elements: u32,
    /// Length of the first element relative to the last, in geometric progression
    #[schemars(range(min = 1e-6, max = 1e6), extend("default" = 1.0))]
    pub grading: Option<f64>,
    /// Mass matrix of the elements
    #[schemars(extend("default" = "consistent"))]
    pub mass_matrix: Option<MassMatrix>,
    /// Support at the start, at position 0
    pub start: Support,
    /// Support at the end, at position `length_m`
    #[schemars(extend("default" = "free"))]
    pub end: Option<Support>,
    /// Material of the structure
    pub material: RawMaterial,
    /// Cross section of the structure
    pub section: RawSection,
    /// Mass per length in addition to the section's, such as the contents of a tube; without rotary inertia
    #[schemars(extend("unit" = "kg/m", "minimum" = 0.0, "default" = 0.0))]
    pub added_mass_kg_m: Option<f64>,
    /// How many times shorter the elements next to stops become: they are halved toward the stop until they are that
    /// short
    #[schemars(extend("default" = 1.0, "minimum" = 1.0, "maximum" = MAX_REFINEMENT))]
    pub refine: Option<f64>,
    /// Segments with their own section and material, any number, each under its own heading `[[structure.segment]]`;
    /// beyond the last one, those of the structure apply
    pub segment: Option<Vec<RawSegment>>,
    /// Point masses at nodes, any number, each under its own heading `[[structure.mass_point]]`
    pub mass_point: Option<Vec<MassPoint>>,
    /// Springs between nodes and the ground, any number, each under its own heading `[[structure.spring]]`
    pub spring: Option<Vec<RawSpring>>,
    /// Frequencies imposed on the lowest modes, for instance measured ones
    pub modes: Option<ImposedModes>,
    /// Damping of this structure, if there are several, instead of `[damping]`
    pub damping: Option<RawModeDamping>,
}

/// A linear elastic material.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RawMaterial {
    /// Young's modulus
    #[schemars(extend("unit" = "Pa", "exclusiveMinimum" = 0.0))]
    pub youngs_modulus_pa: f64,
    /// Mass per volume
    #[schemars(extend("unit" = "kg/m³", "exclusiveMinimum" = 0.0))]
    pub density_kg_m3: f64,
    /// Poisson's ratio, for the shear modulus of a beam
    #[schemars(extend("default" = 0.3, "minimum" = 0.0, "exclusiveMaximum" = 0.5))]
    pub poissons_ratio: Option<f64>,
}

/// Cross section: width and height of a rectangle, outer diameter and wall of a tube, or the area (and, of a beam, the
/// second moment of area).
#[derive(Debug, Default, Deserialize, JsonSchema)]
pub struct RawSection {
    /// Area, instead of width and height
    #[schemars(extend("unit" = "m²", "exclusiveMinimum" = 0.0))]
    pub area_m2: Option<f64>,
    /// Second moment of area of a beam about its bending axis, together with the area
    #[schemars(extend("unit" = "m⁴", "exclusiveMinimum" = 0.0))]
    pub second_moment_m4: Option<f64>,
    /// Width of a rectangle, across the bending direction
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0.0))]
    pub width_m: Option<f64>,
    /// Height of a rectangle, in the bending direction
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0.0))]
    pub height_m: Option<f64>,
    /// Outer diameter of a tube
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0.0))]
    pub outer_m: Option<f64>,
    /// Thickness of the wall of a tube; half of the outer diameter is a round bar
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0.0))]
    pub wall_m: Option<f64>,
    /// Distance of the outermost fibre of a beam from its bending axis, for its stress; default half of the height of a
    /// rectangle or of the diameter of a tube
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0.0))]
    pub outer_fibre_m: Option<f64>,
    /// Shear correction factor of a beam; default 5/6, that of a rectangle, and of tubes that of Cowper
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1.0))]
    pub shear_factor: Option<f64>,
}
