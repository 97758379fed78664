use std::collections::HashMap;

/// Kind of a degree of freedom.
///
/// Straight structures have the first three, structures in space the displacements and rotations of their nodes along
/// the axes of coordinates. [`Self::Axial`], [`Self::Deflection`] and [`Self::Rotation`] are X, Y and RZ of a structure
/// on the axis X.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum DofKind {
    /// Displacement along the axis, m.
    Axial,
    /// Displacement across the axis, m.
    Deflection,
    /// Rotation of the cross section, rad; positive with the slope, so that a rigid rotation `θ` about `x = 0`
    /// displaces by `θ x`.
    Rotation,
    /// Displacement of a node in space along X, m.
    X,
    /// Displacement of a node in space along Y, m.
    Y,
    /// Displacement of a node in space along Z, m.
    Z,
    /// Rotation of a node in space about X, rad.
    RX,
    /// Rotation of a node in space about Y, rad.
    RY,
    /// Rotation of a node in space about Z, rad.
    RZ,
    /// A coordinate without node, of a structure that was already reduced. Rigid-body motions leave it at rest.
    Modal,
    /// Displacement of a contact toward its obstacle, m, of a structure that was already reduced: a massless coordinate
    /// in addition to the modal ones.
    Contact,
    /// One of the displacements by which a structure is known that was reduced elsewhere, m: of a contact, or of a
    /// place where a force acts.
    Row,
}

impl DofKind {
    /// All of them.
    pub(crate) const ALL: [Self; 12] = [
        Self::Axial,
        Self::Deflection,
        Self::Rotation,
        Self::X,
        Self::Y,
        Self::Z,
        Self::RX,
        Self::RY,
        Self::RZ,
        Self::Modal,
        Self::Contact,
        Self::Row,
    ];

    /// Lower-case name, as used in result files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Axial => "axial",
            Self::Deflection => "deflection",
            Self::Rotation => "rotation",
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
            Self::RX => "rx",
            Self::RY => "ry",
            Self::RZ => "rz",
            Self::Modal => "modal",
            Self::Contact => "contact",
            Self::Row => "row",
        }
    }

    /// The axis of coordinates (0 to 2) of its displacement; none for rotations and modal coordinates.
    pub fn translation_axis(self) -> Option<usize> {
        match self {
            Self::Axial | Self::X => Some(0),
            Self::Deflection | Self::Y => Some(1),
            Self::Z => Some(2),
            Self::Rotation | Self::RX | Self::RY | Self::RZ | Self::Modal | Self::Contact | Self::Row => None,
        }
    }

    /// The axis of coordinates (0 to 2) of its rotation; none for displacements and modal coordinates.
    pub fn rotation_axis(self) -> Option<usize> {
        match self {
            Self::RX => Some(0),
            Self::RY => Some(1),
            Self::Rotation | Self::RZ => Some(2),
            Self::Axial | Self::Deflection | Self::X | Self::Y | Self::Z | Self::Modal | Self::Contact | Self::Row => {
                None
            }
        }
    }

    /// Whether it belongs to a node in space, with three coordinates.
    pub fn is_spatial(self) -> bool {
        matches!(self, Self::X | Self::Y | Self::Z | Self::RX | Self::RY | Self::RZ)
    }
}

/// A free degree of freedom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dof {
    /// Its node.
    pub node: usize,
    /// Position of the node along the axis, m. For structures in space the coordinate x, or zero if it is unknown:
    /// [`StructuralModel::place`](crate::StructuralModel::place) has all three.
    pub position: f64,
    /// Its kind.
    pub kind: DofKind,
}

/// Finds degrees of freedom by node and axis.
#[derive(Debug, Clone, Default)]
pub struct DofIndex {
    translations: HashMap<(usize, usize), usize>,
}

impl DofIndex {
    /// The index of `dofs`. If two have the same node and axis, the first is found.
    pub fn new(dofs: &[Dof]) -> Self {
        let mut translations = HashMap::with_capacity(dofs.len());
        for (i, dof) in dofs.iter().enumerate() {
            if let Some(axis) = dof.kind.translation_axis() {
                translations.entry((dof.node, axis)).or_insert(i);
            }
        }
        Self { translations }
    }

    /// The displacement of `node` along `axis` (0 to 2); none if it is fixed or there is no such node.
    pub fn translation(&self, node: usize, axis: usize) -> Option<usize> {
        self.translations.get(&(node, axis)).copied()
    }
}
