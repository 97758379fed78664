use nlmodes_model::{DofKind, ModelError};
use thiserror::Error;

use crate::{Direction, Support};

/// Why a structure cannot be assembled.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum FemError {
    /// A number that must be positive and finite is not.
    #[error("the {what} is {value}, but has to be a positive finite number")]
    NotPositive {
        /// The quantity.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// Poisson's ratio outside of 0 ≤ ν < 0.5.
    #[error("Poisson's ratio is {value}, but has to be at least 0 and less than 0.5")]
    PoissonsRatio {
        /// The value.
        value: f64,
    },
    /// Steps of a structure that are not in order.
    #[error(
        "step {step} reaches from node {from} to node {to}; it has to end behind its start, at node {last} at the \
         latest"
    )]
    Step {
        /// The step, counted from 0.
        step: usize,
        /// Node at which the previous step ends.
        from: usize,
        /// Node at which it ends.
        to: usize,
        /// Last node of the mesh.
        last: usize,
    },
    /// An added mass that is negative or not finite.
    #[error("the added mass of step {step} is {value} kg/m, but has to be zero or more")]
    AddedMass {
        /// The step, counted from 0.
        step: usize,
        /// Its added mass, kg/m.
        value: f64,
    },
    /// A tube whose wall is thicker than half of its diameter.
    #[error("the wall of {wall} m is more than half of the outer diameter of {outer} m")]
    Wall {
        /// Thickness of the wall, m.
        wall: f64,
        /// Outer diameter, m.
        outer: f64,
    },
    /// A solid element whose volume is not positive.
    #[error("element {element} has no volume, or its nodes are in another order")]
    InsideOut {
        /// The element, counted from 0.
        element: usize,
    },
    /// A solid element with other nodes than its shape has, or with one that does not exist.
    #[error("element {element} has to have {expected} nodes of the mesh")]
    SolidNodes {
        /// The element, counted from 0.
        element: usize,
        /// Nodes of its shape.
        expected: usize,
    },
    /// Nodes that do not ascend from 0.
    #[error("the nodes of element {element} are not in order: nodes ascend from 0 m")]
    Nodes {
        /// The element, counted from 0.
        element: usize,
    },
    /// A mesh without elements.
    #[error("a mesh needs at least one element")]
    NoElements,
    /// Two neighbouring nodes have the same position in double precision.
    #[error("element {element} of the mesh has no length: {elements} elements with grading {grading} are too many")]
    DegenerateMesh {
        /// The element, counted from 0.
        element: usize,
        /// Number of elements.
        elements: usize,
        /// First element length over last one.
        grading: f64,
    },
    /// There is no node at the requested position.
    #[error("there is no node at {asked} m; the nearest one is node {node} at {nearest} m")]
    NotANode {
        /// Requested position, m.
        asked: f64,
        /// Position of the nearest node, m.
        nearest: f64,
        /// Index of the nearest node.
        node: usize,
    },
    /// A point that is not on the structure.
    #[error("there is nothing at {asked} m: the structure reaches from 0 to {length} m")]
    OutsideMesh {
        /// Requested position, m.
        asked: f64,
        /// Length of the structure, m.
        length: f64,
    },
    /// A stop in a direction in which the elements have no displacement.
    #[error("the stop at {position} m is {direction}, but a rod moves axially only")]
    NoSuchDirection {
        /// Position of the stop, m.
        position: f64,
        /// Its direction.
        direction: Direction,
    },
    /// A stop at a degree of freedom that a support fixes.
    #[error("the {direction} stop at {position} m can never be touched: the end is {support} there")]
    HeldDof {
        /// Position of the stop, m.
        position: f64,
        /// Its direction.
        direction: Direction,
        /// The support that fixes it.
        support: Support,
    },
    /// The supports fix every degree of freedom.
    #[error("the supports hold every degree of freedom: nothing is left to move")]
    NothingMoves,
    /// An element matrix has an entry that overflows.
    #[error("the element from {from} m to {to} m has a {kind} entry that is not finite", kind = .kind.name())]
    Overflow {
        /// Start of the element, m.
        from: f64,
        /// End of the element, m.
        to: f64,
        /// Kind of the degree of freedom of the row.
        kind: DofKind,
    },
    /// The assembled model is rejected.
    #[error("the assembled structure is not a valid model")]
    Model(#[from] ModelError),
}

/// Checks a number that has to be positive and finite.
pub(crate) fn positive(what: &'static str, value: f64) -> Result<f64, FemError> {
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(FemError::NotPositive { what, value }) }
}
