use crate::mesh::ElementKind;

/// Nodes of an element type of Gmsh, and their order here.
#[derive(Debug, Clone, Copy)]
pub(super) struct ElementType {
    /// Nothing for a point.
    pub(super) kind: Option<ElementKind>,
    pub(super) nodes: usize,
    /// The nodes after the corner nodes; nodes within faces and volumes are omitted.
    middles: &'static [usize],
}

/// The type of this number.
pub(super) fn element_type(number: i64) -> Option<ElementType> {
    use ElementKind::{Hexahedron, Line, Pyramid, Quadrangle, Tetrahedron, Triangle, Wedge};
    const TRIANGLE: &[usize] = &[3, 4, 5];
    const QUADRANGLE: &[usize] = &[4, 5, 6, 7];
    const TETRAHEDRON: &[usize] = &[4, 5, 6, 7, 9, 8];
    const HEXAHEDRON: &[usize] = &[8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15];
    const WEDGE: &[usize] = &[6, 9, 7, 12, 14, 13, 8, 10, 11];
    const PYRAMID: &[usize] = &[5, 8, 10, 6, 7, 9, 11, 12];
    let (kind, nodes, middles): (_, _, &[usize]) = match number {
        1 => (Line, 2, &[]),
        2 => (Triangle, 3, &[]),
        3 => (Quadrangle, 4, &[]),
        4 => (Tetrahedron, 4, &[]),
        5 => (Hexahedron, 8, &[]),
        6 => (Wedge, 6, &[]),
        7 => (Pyramid, 5, &[]),
        8 => (Line, 3, &[2]),
        9 => (Triangle, 6, TRIANGLE),
        10 => (Quadrangle, 9, QUADRANGLE),
        11 => (Tetrahedron, 10, TETRAHEDRON),
        12 => (Hexahedron, 27, HEXAHEDRON),
        13 => (Wedge, 18, WEDGE),
        15 => return Some(ElementType { kind: None, nodes: 1, middles: &[] }),
        16 => (Quadrangle, 8, QUADRANGLE),
        17 => (Hexahedron, 20, HEXAHEDRON),
        18 => (Wedge, 15, WEDGE),
        19 => (Pyramid, 13, PYRAMID),
        _ => return None,
    };
    Some(ElementType { kind: Some(kind), nodes, middles })
}

impl ElementType {
    /// Corners, then the middles of edges in the order of [`ElementKind::edges`].
    pub(super) fn ordered(&self, nodes: &[u64]) -> Vec<u64> {
        let corners = self.kind.map_or(1, ElementKind::corners);
        (0..corners).chain(self.middles.iter().copied()).map(|k| nodes[k]).collect()
    }
}
