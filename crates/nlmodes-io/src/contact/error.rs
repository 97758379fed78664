use thiserror::Error;

use crate::ReadError;

/// A choice of contacts that does not fit the model.
#[derive(Debug, Error)]
#[error("{problem}")]
pub struct ContactError {
    /// Which choice, from 0.
    pub contact: usize,
    /// What is wrong with it.
    #[source]
    pub problem: ContactProblem,
}

/// What is wrong with a choice of contacts.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ContactProblem {
    /// A set, or a table of pairs.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The node has no row.
    #[error(
        "node {node} has no displacement in the matrices: it is fixed, dependent on other nodes (*EQUATION, *MPC, \
         *TIE, nodes of a *RIGID BODY or *COUPLING; the reference node of a rigid body or of a *KINEMATIC coupling has \
         rows, \
         that of a *DISTRIBUTING one has none), a node of rotations (ROT NODE), one \
         of which CalculiX made several that are not all free, or not there"
    )]
    NoDisplacement {
        /// The node.
        node: u64,
    },
    /// The node is fixed along the normal.
    #[error(
        "node {node} cannot move along its normal [{}, {}, {}]: it is fixed there, or dependent on other nodes \
         (*EQUATION, *MPC, *TIE, *COUPLING, *RIGID BODY), or one of several nodes that CalculiX made of it is; take a \
         node that is free, or the one that it follows",
        normal[0], normal[1], normal[2]
    )]
    HeldAlongNormal {
        /// The node.
        node: u64,
        /// Its normal.
        normal: [f64; 3],
    },
    /// A gap to a plane, or a partner, of a node without a place.
    #[error("the place of node {node} is not known; expected it in the mesh or the table of degrees of freedom")]
    NoPlace {
        /// The node.
        node: u64,
    },
    /// A normal of length zero.
    #[error("the normal of node {node} has no direction")]
    NoDirection {
        /// The node.
        node: u64,
    },
    /// Given neither by the choice nor by the table of pairs.
    #[error(
        "node {node} has no {what}: its line in the table of pairs says none; expected it there, as \
            node_a,node_b,nx,ny,nz,gap_m, or `{}` beside `pairs` for all such lines",
        if *.what == "gap" { "gap_m" } else { what }
    )]
    Unsaid {
        /// The node.
        node: u64,
        /// `normal` or `gap`.
        what: &'static str,
    },
    /// The surface is not known, or does not reach the node.
    #[error("node {node} is not on the surface of the mesh; expected a node of a face of its solids or shells")]
    NotOnSurface {
        /// The node.
        node: u64,
    },
    /// No node of the other body lies on the normal.
    #[error(
        "node {node} has no partner: node {nearest} is the nearest along the normal, {distance:.3e} m beside it; \
            expected at most {tolerance:.3e} m: nodes face each other \
         within `pair_tolerance_m`. Take meshes that match there, a larger `pair_tolerance_m`, or a table `pairs`"
    )]
    NoPartner {
        /// The node.
        node: u64,
        /// The node that is nearest to the line along its normal.
        nearest: u64,
        /// How far it is from that line, m.
        distance: f64,
        /// How far it may be, m.
        tolerance: f64,
    },
    /// The other node lies on the wrong side.
    #[error(
        "node {other} lies {distance:.3e} m behind node {node}, which touches what its normal [{}, {}, {}] points to: \
            turn the normal round, or take a node ahead",
        .normal[0], .normal[1], .normal[2]
    )]
    Behind {
        /// The node.
        node: u64,
        /// The node that it was to touch.
        other: u64,
        /// The normal, from the node to its obstacle.
        normal: [f64; 3],
        /// Distance behind, m.
        distance: f64,
    },
    /// Two rigid walls that face each other overlap.
    #[error(
        "node {node} has no room: this gap and that of contact {before}, on the other side, sum up to {room:.3e} m"
    )]
    NoRoom {
        /// The node.
        node: u64,
        /// Number of the contact on the other side, from 0.
        before: usize,
        /// Sum of the gaps, m.
        room: f64,
    },
    /// There are no nodes to touch.
    #[error("node {node} has nothing to touch but itself")]
    Itself {
        /// The node.
        node: u64,
    },
    /// The same contact was there before.
    #[error("node {node} has this contact already, from contact {before} (counted from 0); expected each contact once")]
    Twice {
        /// The node.
        node: u64,
        /// The choice that made it, from 0.
        before: usize,
    },
}
