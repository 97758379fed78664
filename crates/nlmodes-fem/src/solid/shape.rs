use std::array::from_fn;

use nalgebra::DMatrix;

/// Shapes of solid elements with the points at which CalculiX integrates them. Nodes are corners first, then the
/// middles of edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SolidShape {
    /// Four nodes, one point: `C3D4`.
    Tetrahedron4,
    /// Ten nodes, four points: `C3D10`.
    Tetrahedron10,
    /// Eight nodes, eight points: `C3D8`.
    Hexahedron8,
    /// Twenty nodes, 27 points: `C3D20`.
    Hexahedron20,
    /// Twenty nodes, eight points: `C3D20R`.
    Hexahedron20Reduced,
}

const TETRAHEDRON: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const TETRAHEDRON_EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];
const HEXAHEDRON: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];
const HEXAHEDRON_EDGES: [[usize; 2]; 12] =
    [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];

impl SolidShape {
    /// All of them.
    pub const ALL: [Self; 5] =
        [Self::Tetrahedron4, Self::Tetrahedron10, Self::Hexahedron8, Self::Hexahedron20, Self::Hexahedron20Reduced];

    /// The shape of elements of a type of CalculiX or Abaqus; none where its strain needs more than the displacements
    /// of its nodes (`C3D8I`), or is taken otherwise (`C3D8R`), or where it is not known.
    pub fn from_type(name: &str) -> Option<Self> {
        Some(match name {
            "C3D4" => Self::Tetrahedron4,
            "C3D10" => Self::Tetrahedron10,
            "C3D8" => Self::Hexahedron8,
            "C3D20" => Self::Hexahedron20,
            "C3D20R" => Self::Hexahedron20Reduced,
            _ => return None,
        })
    }

    /// Number of nodes.
    pub fn n_nodes(self) -> usize {
        match self {
            Self::Tetrahedron4 => 4,
            Self::Tetrahedron10 => 10,
            Self::Hexahedron8 => 8,
            Self::Hexahedron20 | Self::Hexahedron20Reduced => 20,
        }
    }

    /// Local coordinates of the nodes.
    pub fn corners_and_middles(self) -> Vec<[f64; 3]> {
        let (corners, edges): (&[[f64; 3]], &[[usize; 2]]) = match self {
            Self::Tetrahedron4 => (&TETRAHEDRON, &[]),
            Self::Tetrahedron10 => (&TETRAHEDRON, &TETRAHEDRON_EDGES),
            Self::Hexahedron8 => (&HEXAHEDRON, &[]),
            Self::Hexahedron20 | Self::Hexahedron20Reduced => (&HEXAHEDRON, &HEXAHEDRON_EDGES),
        };
        let middle = |[a, b]: &[usize; 2]| from_fn(|k| 0.5 * (corners[*a][k] + corners[*b][k]));
        corners.iter().copied().chain(edges.iter().map(middle)).collect()
    }

    /// Local coordinates of the points of integration.
    pub(super) fn points(self) -> Vec<[f64; 3]> {
        match self {
            Self::Tetrahedron4 => vec![[0.25; 3]],
            Self::Tetrahedron10 => {
                let (own, other) = four_points();
                let at = |corner: usize| from_fn(|k| if k + 1 == corner { own } else { other });
                (0..4).map(at).collect()
            }
            Self::Hexahedron8 | Self::Hexahedron20Reduced => product(&two_points()),
            Self::Hexahedron20 => product(&three_points()),
        }
    }

    /// Derivatives of the shape functions by the local coordinates, of each node.
    pub(super) fn gradients(self, at: [f64; 3]) -> Vec<[f64; 3]> {
        match self {
            Self::Tetrahedron4 => BARYCENTRIC.to_vec(),
            Self::Tetrahedron10 => {
                let l = barycentric(at);
                let corner = |a: usize| BARYCENTRIC[a].map(|slope| (4.0 * l[a] - 1.0) * slope);
                let middle =
                    |[a, b]: [usize; 2]| from_fn(|k| 4.0 * (l[a] * BARYCENTRIC[b][k] + l[b] * BARYCENTRIC[a][k]));
                (0..4).map(corner).chain(TETRAHEDRON_EDGES.into_iter().map(middle)).collect()
            }
            Self::Hexahedron8 => HEXAHEDRON.map(|node| trilinear(node, at).1).to_vec(),
            Self::Hexahedron20 | Self::Hexahedron20Reduced => {
                self.corners_and_middles().into_iter().map(|node| serendipity(node, at).1).collect()
            }
        }
    }

    /// Weights of the points of integration at each node.
    ///
    /// One point counts everywhere. Four points of a tetrahedron give a linear function, eight of a hexahedron a
    /// trilinear one, whose values at the nodes are taken; 27 points the sum of the shape functions that fits them with
    /// the least squares.
    pub(super) fn extrapolation(self) -> Option<Vec<Vec<f64>>> {
        let nodes = self.corners_and_middles().into_iter();
        Some(match self {
            Self::Tetrahedron4 => nodes.map(|_| vec![1.0]).collect(),
            Self::Tetrahedron10 => {
                let (own, other) = four_points();
                nodes.map(|node| barycentric(node).map(|l| (l - other) / (own - other)).to_vec()).collect()
            }
            Self::Hexahedron8 | Self::Hexahedron20Reduced => {
                // In coordinates in which the points are the corners.
                let (outward, corners) = (3.0_f64.sqrt(), product(&[-1.0, 1.0]));
                let at = |node: [f64; 3]| {
                    let place = node.map(|x| outward * x);
                    corners.iter().map(|corner| trilinear(*corner, place).0).collect()
                };
                nodes.map(at).collect()
            }
            Self::Hexahedron20 => {
                let (nodes, points) = (self.corners_and_middles(), self.points());
                let values = DMatrix::from_fn(points.len(), nodes.len(), |p, i| serendipity(nodes[i], points[p]).0);
                let fitted = (values.transpose() * &values).cholesky()?.solve(&values.transpose());
                fitted.row_iter().map(|row| row.iter().copied().collect()).collect()
            }
        })
    }
}

/// Barycentric coordinates of a point of integration of a tetrahedron: that of its own corner, and the others.
fn four_points() -> (f64, f64) {
    let root = 5.0_f64.sqrt();
    ((5.0 + 3.0 * root) / 20.0, (5.0 - root) / 20.0)
}

/// Gauss points of degree three.
fn two_points() -> [f64; 2] {
    let x = 1.0 / 3.0_f64.sqrt();
    [-x, x]
}

/// Gauss points of degree five.
fn three_points() -> [f64; 3] {
    let x = 0.6_f64.sqrt();
    [-x, 0.0, x]
}

/// All points with these coordinates, the first one changing fastest.
fn product(one: &[f64]) -> Vec<[f64; 3]> {
    let plane = |z: f64| one.iter().flat_map(move |y| one.iter().map(move |x| [*x, *y, z]));
    one.iter().flat_map(|z| plane(*z)).collect()
}

/// Slopes of the barycentric coordinates.
const BARYCENTRIC: [[f64; 3]; 4] = [[-1.0, -1.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn barycentric([x, y, z]: [f64; 3]) -> [f64; 4] {
    [1.0 - x - y - z, x, y, z]
}

/// `Π (1 + ξ ξ_i) / 8` of a corner node, and its derivatives.
fn trilinear(node: [f64; 3], at: [f64; 3]) -> (f64, [f64; 3]) {
    let factors: [f64; 3] = from_fn(|k| 1.0 + node[k] * at[k]);
    let slope = |k: usize| node[k] * factors[(k + 1) % 3] * factors[(k + 2) % 3] / 8.0;
    (factors.iter().product::<f64>() / 8.0, from_fn(slope))
}

/// The function of a node of the hexahedron with twenty nodes, and its derivatives: of a corner
/// `Π (1 + ξ ξ_i) (Σ ξ ξ_i − 2) / 8`, of a middle `(1 − ξ²) (1 + η η_i) (1 + ζ ζ_i) / 4`.
fn serendipity(node: [f64; 3], at: [f64; 3]) -> (f64, [f64; 3]) {
    let Some(along) = (0..3).find(|k| node[*k] == 0.0) else {
        let (value, slope) = trilinear(node, at);
        let sum = (0..3).map(|k| node[k] * at[k]).sum::<f64>() - 2.0;
        return (value * sum, from_fn(|k| slope[k] * sum + value * node[k]));
    };
    let (j, k) = ((along + 1) % 3, (along + 2) % 3);
    let (bubble, a, b) = (1.0 - at[along].powi(2), 1.0 + node[j] * at[j], 1.0 + node[k] * at[k]);
    let mut slope = [0.0; 3];
    slope[along] = -2.0 * at[along] * a * b / 4.0;
    slope[j] = bubble * node[j] * b / 4.0;
    slope[k] = bubble * node[k] * a / 4.0;
    (bubble * a * b / 4.0, slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums over the nodes: the functions are a partition of one, and reproduce their own coordinates.
    #[test]
    fn functions_reproduce_places() {
        for shape in SolidShape::ALL {
            let nodes = shape.corners_and_middles();
            assert_eq!(nodes.len(), shape.n_nodes());
            for at in [[0.1, 0.2, 0.3], [0.3, -0.1, 0.25]] {
                let gradients = shape.gradients(at);
                for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
                    let sum: f64 = gradients.iter().zip(&nodes).map(|(g, node)| g[i] * node[j]).sum();
                    assert!((sum - f64::from(u8::from(i == j))).abs() < 1e-14, "{shape:?} {i} {j}: {sum}");
                    let flat: f64 = gradients.iter().map(|g| g[i]).sum();
                    assert!(flat.abs() < 1e-14, "{shape:?}: {flat}");
                }
            }
        }
    }

    /// The extrapolation is exact for what its points determine: functions that are linear in each coordinate, or of
    /// a tetrahedron in all.
    #[test]
    fn extrapolation_is_exact_for_linear_functions() {
        let f = |[x, y, z]: [f64; 3]| 1.0 + 2.0 * x - 3.0 * y + 0.5 * z;
        for shape in SolidShape::ALL.into_iter().filter(|shape| shape.points().len() > 1) {
            let points = shape.points();
            for (node, weights) in shape.corners_and_middles().into_iter().zip(shape.extrapolation().unwrap()) {
                let found: f64 = weights.iter().zip(&points).map(|(w, at)| w * f(*at)).sum();
                assert!((found - f(node)).abs() < 1e-13, "{shape:?} {node:?}: {found}");
            }
        }
    }

    #[test]
    fn types_have_their_shapes() {
        for (name, shape) in [("C3D10", SolidShape::Tetrahedron10), ("C3D20R", SolidShape::Hexahedron20Reduced)] {
            assert_eq!(SolidShape::from_type(name), Some(shape));
        }
        assert_eq!([SolidShape::from_type("C3D8I"), SolidShape::from_type("S8R")], [None, None]);
    }
}
