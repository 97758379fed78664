/// Shapes of elements; midside nodes follow the corner nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ElementKind {
    /// Two or three nodes: bars and beams.
    Line,
    /// Three or six nodes: shells.
    Triangle,
    /// Four or eight nodes: shells.
    Quadrangle,
    /// Four or ten nodes.
    Tetrahedron,
    /// Five or thirteen nodes.
    Pyramid,
    /// Six or fifteen nodes.
    Wedge,
    /// Eight or twenty nodes.
    Hexahedron,
}

impl ElementKind {
    /// Number of corner nodes.
    pub fn corners(self) -> usize {
        match self {
            Self::Line => 2,
            Self::Triangle => 3,
            Self::Quadrangle | Self::Tetrahedron => 4,
            Self::Pyramid => 5,
            Self::Wedge => 6,
            Self::Hexahedron => 8,
        }
    }

    /// Whether it fills a volume.
    pub fn is_solid(self) -> bool {
        matches!(self, Self::Tetrahedron | Self::Pyramid | Self::Wedge | Self::Hexahedron)
    }

    /// Corners at the ends of each edge, in the order of the nodes in the middle.
    pub fn edges(self) -> &'static [[usize; 2]] {
        match self {
            Self::Line => &[[0, 1]],
            Self::Triangle => &[[0, 1], [1, 2], [2, 0]],
            Self::Quadrangle => &[[0, 1], [1, 2], [2, 3], [3, 0]],
            Self::Tetrahedron => &[[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]],
            Self::Pyramid => &[[0, 1], [1, 2], [2, 3], [3, 0], [0, 4], [1, 4], [2, 4], [3, 4]],
            Self::Wedge => &[[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [0, 3], [1, 4], [2, 5]],
            Self::Hexahedron => {
                &[[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]]
            }
        }
    }

    /// Corners of each face, counterclockwise as seen from outside; S1, S2 … of decks in this order.
    pub fn faces(self) -> &'static [&'static [usize]] {
        match self {
            Self::Line => &[],
            Self::Triangle => &[&[0, 1, 2]],
            Self::Quadrangle => &[&[0, 1, 2, 3]],
            Self::Tetrahedron => &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]],
            Self::Pyramid => &[&[0, 3, 2, 1], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]],
            Self::Wedge => &[&[0, 2, 1], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]],
            Self::Hexahedron => {
                &[&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]]
            }
        }
    }

    /// Nodes of a face of an element: its corner nodes, then its midside nodes, if any.
    pub fn face_nodes(self, face: &[usize], nodes: &[u32]) -> Vec<u32> {
        let mut found: Vec<u32> = face.iter().map(|corner| nodes[*corner]).collect();
        if nodes.len() == self.corners() + self.edges().len() {
            let middle = |a: usize, b: usize| self.edges().iter().position(|e| *e == [a, b] || *e == [b, a]);
            let around = (0..face.len()).map(|k| (face[k], face[(k + 1) % face.len()]));
            found.extend(around.filter_map(|(a, b)| middle(a, b)).map(|edge| nodes[self.corners() + edge]));
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOLIDS: [(ElementKind, f64); 4] = [
        (ElementKind::Tetrahedron, 1.0 / 6.0),
        (ElementKind::Pyramid, 1.0 / 3.0),
        (ElementKind::Wedge, 0.5),
        (ElementKind::Hexahedron, 1.0),
    ];

    /// Corners of the unit shapes.
    fn corners(kind: ElementKind) -> Vec<[f64; 3]> {
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let up = |p: [f64; 3]| [p[0], p[1], 1.0];
        let triangle = [square[0], square[1], square[3]];
        match kind {
            ElementKind::Tetrahedron => [&triangle[..], &[[0.0, 0.0, 1.0]]].concat(),
            ElementKind::Pyramid => [&square[..], &[[0.5, 0.5, 1.0]]].concat(),
            ElementKind::Wedge => [triangle, triangle.map(up)].concat(),
            _ => [square, square.map(up)].concat(),
        }
    }

    fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|k| a[k] - b[k])
    }

    #[test]
    fn faces_look_outward_and_close_the_solid() {
        for (kind, volume) in SOLIDS {
            let places = corners(kind);
            // Divergence theorem: a third of the flux of the position through triangles from the first corner node of
            // each face.
            let mut sum = 0.0;
            for face in kind.faces() {
                for k in 1..face.len() - 1 {
                    let (a, b, c) = (places[face[0]], places[face[k]], places[face[k + 1]]);
                    let (u, v) = (minus(b, a), minus(c, a));
                    let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
                    sum += (0..3).map(|k| a[k] * normal[k]).sum::<f64>() / 6.0;
                }
            }
            assert!((sum - volume).abs() < 1e-14, "{kind:?}: {sum}");
            for edge in kind.edges() {
                let count = kind.faces().iter().filter(|face| edge.iter().all(|e| face.contains(e))).count();
                assert_eq!(count, 2, "{kind:?}: an edge belongs to two faces, {edge:?}");
            }
        }
    }

    #[test]
    fn middles_of_a_face_are_those_of_its_edges() {
        for (kind, _) in SOLIDS {
            let nodes: Vec<u32> = (0..(kind.corners() + kind.edges().len()) as u32).collect();
            for face in kind.faces() {
                let found = kind.face_nodes(face, &nodes);
                assert_eq!(found.len(), 2 * face.len());
                for k in 0..face.len() {
                    let edge = kind.edges()[found[face.len() + k] as usize - kind.corners()];
                    assert!(edge.contains(&face[k]) && edge.contains(&face[(k + 1) % face.len()]));
                }
            }
        }
    }
}
