use std::path::PathBuf;

/// Contacts as a user says them: of a node or of many with a wall, or of pairs.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ContactChoice {
    /// The nodes that touch.
    pub nodes: ContactNodes,
    /// What they touch.
    pub partner: Partner,
    /// Direction from them to what they touch; with a table of pairs it may stand there.
    pub normal: Option<NormalChoice>,
    /// Clearance at rest; with a table of pairs it may stand there, and between nodes that are sought it may be left
    /// out: then it is their distance along the normal in the mesh.
    pub gap: Option<GapChoice>,
    /// Contact stiffness, N/m; none of rigid contacts.
    pub stiffness: Option<f64>,
    /// Damper beside that stiffness, N s/m; none of contacts that do not dissipate.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub damping: Option<f64>,
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
