use std::path::PathBuf;

/// Contacts as specified by a user: of one or many nodes with a wall, or of pairs.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ContactChoice {
    /// The nodes that touch.
    pub nodes: ContactNodes,
    /// What they touch.
    pub partner: Partner,
    /// Direction from them to their obstacle; with a table of pairs it may be given there.
    pub normal: Option<NormalChoice>,
    /// Clearance at rest; with a table of pairs it may be given there, and for automatically paired nodes it may be
    /// omitted: then it is their distance along the normal in the mesh.
    pub gap: Option<GapChoice>,
    /// Contact stiffness, N/m; none of rigid contacts.
    pub stiffness: Option<f64>,
    /// Damper parallel to the stiffness, N s/m; none without dissipation.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub damping: Option<f64>,
    /// Coefficient of friction of which the power is estimated; the contact itself has none.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub friction_estimate: Option<f64>,
}

/// Nodes, one by one or as a set of the mesh.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum ContactNodes {
    /// A node set of the mesh.
    Set(String),
    /// Nodes by their numbers.
    Numbers(Vec<u64>),
    /// Those of a table of pairs.
    OfPairs,
}

/// What nodes touch.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Partner {
    /// A rigid wall.
    Wall,
    /// The one of these nodes that is nearest to the line along the normal, and no farther from it than the tolerance
    /// in m (default: a thousandth of their extent).
    Nearest(ContactNodes, Option<f64>),
    /// Node by node as in a table `node_a,node_b[,nx,ny,nz,gap_m]`.
    Table(PathBuf),
}

/// A direction of contact.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum NormalChoice {
    /// A vector of any length but zero.
    Vector([f64; 3]),
    /// The outward normal of the mesh at each node.
    Surface,
}

/// A clearance.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum GapChoice {
    /// The same at each node, m; negative where it presses.
    Same(f64),
    /// To a plane through this point, m, across the normal of each node.
    WallPoint([f64; 3]),
}
