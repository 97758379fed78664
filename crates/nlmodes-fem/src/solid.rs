//! Stress of solid elements from the displacements of their nodes.

mod shape;

use nalgebra::{Matrix3, SymmetricEigen};
use nlmodes_linalg::Mat;

use crate::FemError;
pub use shape::SolidShape;

/// A linear elastic, isotropic material without mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elastic {
    /// Young's modulus `E`, Pa.
    pub youngs_modulus: f64,
    /// Poisson's ratio `ν`.
    pub poissons_ratio: f64,
}

/// A solid element.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    /// Its shape and integration.
    pub shape: SolidShape,
    /// Indices of its nodes, corners first.
    pub nodes: Vec<usize>,
    /// What it is made of.
    pub material: Elastic,
}

/// Stress at the nodes of solid elements, in several states.
#[derive(Debug, Clone)]
pub struct NodalStress {
    /// The nodes that belong to an element, ascending.
    pub nodes: Vec<usize>,
    /// Number of states.
    pub states: usize,
    /// `σ_xx, σ_yy, σ_zz, σ_xy, σ_yz, σ_zx` of each node, one line below the other, each with a number a state, Pa.
    pub values: Vec<f64>,
}

impl NodalStress {
    /// Stress at the nodes of the elements, where nodes are at `places` (m) and the columns of `displacements` are
    /// states: `u_x, u_y, u_z` of each node, one below the other, m.
    ///
    /// As in CalculiX: strains at the points of integration, `σ = λ tr(ε) 1 + 2μ ε` there, extrapolated to the nodes
    /// of the element and averaged over the elements of a node.
    ///
    /// # Errors
    /// [`FemError::InsideOut`] for an element without volume or with its nodes in another order;
    /// [`FemError::SolidNodes`] for one with another number of nodes than its shape, or with one that does not exist.
    pub fn of(places: &[[f64; 3]], elements: &[Solid], displacements: &Mat<f64>) -> Result<Self, FemError> {
        let mut counts = vec![0_usize; places.len()];
        for (element, solid) in elements.iter().enumerate() {
            let is_known = |node: &usize| *node < places.len() && 3 * node + 2 < displacements.nrows();
            if solid.nodes.len() != solid.shape.n_nodes() || !solid.nodes.iter().all(is_known) {
                return Err(FemError::SolidNodes { element, expected: solid.shape.n_nodes() });
            }
            solid.nodes.iter().for_each(|node| counts[*node] += 1);
        }
        let nodes: Vec<usize> = (0..places.len()).filter(|node| counts[*node] > 0).collect();
        let mut row = vec![0; places.len()];
        nodes.iter().enumerate().for_each(|(k, node)| row[*node] = k);
        let states = displacements.ncols();
        let mut values = vec![0.0; 6 * nodes.len() * states];
        let (mut moved, mut stress, mut known) = (Vec::new(), Vec::new(), Vec::new());
        for (element, solid) in elements.iter().enumerate() {
            gather(solid, displacements, &mut moved);
            let inside_out = || FemError::InsideOut { element };
            let reference = reference(&mut known, solid.shape).ok_or_else(inside_out)?;
            at_points(solid, places, reference, (&moved, states), &mut stress).ok_or_else(inside_out)?;
            for (node, weights) in solid.nodes.iter().zip(&reference.extrapolation) {
                let (share, first) = (1.0 / counts[*node] as f64, 6 * row[*node] * states);
                for (point, weight) in stress.chunks_exact((6 * states).max(1)).zip(weights) {
                    add_times(share * weight, point, &mut values[first..first + 6 * states]);
                }
            }
        }
        Ok(Self { nodes, states, values })
    }

    /// A component of the stress of a node, by its place among [`nodes`](Self::nodes), a number a state, Pa.
    pub fn line(&self, node: usize, component: usize) -> &[f64] {
        let first = (6 * node + component) * self.states;
        &self.values[first..first + self.states]
    }
}

/// The displacements of the nodes of an element, a line of states for each.
fn gather(solid: &Solid, displacements: &Mat<f64>, moved: &mut Vec<f64>) {
    moved.clear();
    for node in &solid.nodes {
        for axis in 0..3 {
            moved.extend((0..displacements.ncols()).map(|j| displacements[(3 * node + axis, j)]));
        }
    }
}

/// What all elements of a shape have in common.
struct Reference {
    shape: SolidShape,
    /// Derivatives of the shape functions at each point of integration.
    gradients: Vec<Vec<[f64; 3]>>,
    /// Weights of these points at each node.
    extrapolation: Vec<Vec<f64>>,
}

/// That of a shape, which is formed where it is not known yet.
fn reference(known: &mut Vec<Reference>, shape: SolidShape) -> Option<&Reference> {
    let place = known.iter().position(|own| own.shape == shape);
    if place.is_none() {
        let gradients = shape.points().into_iter().map(|point| shape.gradients(point)).collect();
        known.push(Reference { shape, gradients, extrapolation: shape.extrapolation()? });
    }
    place.map_or(known.last(), |place| known.get(place))
}

/// Stress at the points of integration of an element, six lines of states for each, from the displacements `moved` of
/// its nodes; none where its volume is turned inside out.
fn at_points(
    solid: &Solid,
    places: &[[f64; 3]],
    reference: &Reference,
    (moved, states): (&[f64], usize),
    stress: &mut Vec<f64>,
) -> Option<()> {
    let own: Vec<[f64; 3]> = solid.nodes.iter().map(|node| places[*node]).collect();
    stress.clear();
    stress.resize(6 * reference.gradients.len() * states, 0.0);
    for (gradients, of) in reference.gradients.iter().zip(stress.chunks_exact_mut((6 * states).max(1))) {
        let gradients = in_space(gradients, &own)?;
        for (gradient, node) in gradients.iter().zip(moved.chunks_exact((3 * states).max(1))) {
            add_strain(*gradient, node, of);
        }
        to_stress(solid.material, of);
    }
    Some(())
}

/// Adds `ε_xx, ε_yy, ε_zz, γ_xy, γ_yz, γ_zx`, a line of states each, of a node that moves by the lines `u_x, u_y, u_z`.
fn add_strain([x, y, z]: [f64; 3], moved: &[f64], strain: &mut [f64]) {
    let states = moved.len() / 3;
    let [u, v, w] = [0, 1, 2].map(|axis| &moved[axis * states..(axis + 1) * states]);
    let parts = [[Some((x, u)), None], [Some((y, v)), None], [Some((z, w)), None]];
    let shears = [[Some((y, u)), Some((x, v))], [Some((z, v)), Some((y, w))], [Some((x, w)), Some((z, u))]];
    for (line, parts) in strain.chunks_exact_mut(states.max(1)).zip(parts.into_iter().chain(shears)) {
        parts.into_iter().flatten().for_each(|(slope, moved)| add_times(slope, moved, line));
    }
}

/// `σ = λ tr(ε) 1 + 2μ ε` in place of the strains.
fn to_stress(material: Elastic, strain: &mut [f64]) {
    let Elastic { youngs_modulus: e, poissons_ratio: nu } = material;
    let (mu, lambda) = (0.5 * e / (1.0 + nu), e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)));
    let states = strain.len() / 6;
    let (normal, shear) = strain.split_at_mut(3 * states);
    for j in 0..states {
        let volume = lambda * (normal[j] + normal[states + j] + normal[2 * states + j]);
        [0, 1, 2].into_iter().for_each(|i| normal[i * states + j] = volume + 2.0 * mu * normal[i * states + j]);
    }
    shear.iter_mut().for_each(|gamma| *gamma *= mu);
}

/// `to += factor · from`.
fn add_times(factor: f64, from: &[f64], to: &mut [f64]) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to += factor * from);
}

/// Derivatives of the shape functions by x, y and z; none where the volume is not positive.
fn in_space(gradients: &[[f64; 3]], places: &[[f64; 3]]) -> Option<Vec<[f64; 3]>> {
    let mut jacobian = Matrix3::<f64>::zeros();
    for (gradient, place) in gradients.iter().zip(places) {
        for i in 0..3 {
            (0..3).for_each(|j| jacobian[(i, j)] += gradient[i] * place[j]);
        }
    }
    let inverse = jacobian.try_inverse().filter(|_| jacobian.determinant() > 0.0)?;
    let turned = |gradient: &[f64; 3]| std::array::from_fn(|j| (0..3).map(|i| inverse[(j, i)] * gradient[i]).sum());
    Some(gradients.iter().map(turned).collect())
}

/// Equivalent stress of von Mises of `σ_xx, σ_yy, σ_zz, σ_xy, σ_yz, σ_zx`.
pub fn von_mises([x, y, z, xy, yz, zx]: [f64; 6]) -> f64 {
    let normal = (x - y).powi(2) + (y - z).powi(2) + (z - x).powi(2);
    (0.5 * normal + 3.0 * (xy * xy + yz * yz + zx * zx)).sqrt()
}

/// The principal stress of the largest magnitude, with its sign: the largest normal stress in any direction.
pub fn largest_principal([x, y, z, xy, yz, zx]: [f64; 6]) -> f64 {
    if ![x, y, z, xy, yz, zx].iter().all(|value| value.is_finite()) {
        return f64::NAN;
    }
    let found = SymmetricEigen::new(Matrix3::new(x, xy, zx, xy, y, yz, zx, yz, z)).eigenvalues;
    found.iter().copied().fold(0.0, |largest: f64, value| if value.abs() > largest.abs() { value } else { largest })
}

#[cfg(test)]
mod tests {
    use super::*;

    const MATERIAL: Elastic = Elastic { youngs_modulus: 210e9, poissons_ratio: 0.3 };

    /// `∂u_i/∂x_j` of a linear field of displacements.
    const GRADIENT: [[f64; 3]; 3] = [[1e-3, -2e-4, 5e-4], [3e-4, -4e-4, 7e-4], [-6e-4, 2e-4, 8e-4]];

    fn linear(place: [f64; 3]) -> [f64; 3] {
        GRADIENT.map(|row| 0.1 + (0..3).map(|j| row[j] * place[j]).sum::<f64>())
    }

    /// Hooke's law, written out.
    fn expected() -> [f64; 6] {
        let Elastic { youngs_modulus: e, poissons_ratio: nu } = MATERIAL;
        let g = GRADIENT;
        let normal = |i: usize| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            e / (1.0 + nu) / (1.0 - 2.0 * nu) * ((1.0 - nu) * g[i][i] + nu * (g[j][j] + g[k][k]))
        };
        let shear = |i: usize, j: usize| e / (2.0 * (1.0 + nu)) * (g[i][j] + g[j][i]);
        [normal(0), normal(1), normal(2), shear(0, 1), shear(1, 2), shear(2, 0)]
    }

    fn column(places: &[[f64; 3]], of: impl Fn([f64; 3]) -> [f64; 3]) -> Mat<f64> {
        Mat::from_fn(3 * places.len(), 1, |i, _| of(places[i / 3])[i % 3])
    }

    /// The patch test: distorted elements of every shape have the constant stress of a linear field, at all nodes.
    #[test]
    fn a_linear_displacement_has_a_constant_stress_in_elements_of_every_shape() {
        for shape in SolidShape::ALL {
            let bent = |p: [f64; 3]| [p[0] + 0.1 * p[1] * p[2], p[1] - 0.07 * p[0], p[2] + 0.05 * p[0] * p[1]];
            let places: Vec<[f64; 3]> = shape.corners_and_middles().into_iter().map(bent).collect();
            let solid = Solid { shape, nodes: (0..places.len()).collect(), material: MATERIAL };
            let found = NodalStress::of(&places, &[solid], &column(&places, linear)).unwrap();
            assert_eq!(found.nodes.len(), shape.n_nodes());
            let largest = expected().iter().fold(0.0_f64, |m, s| m.max(s.abs()));
            for (i, value) in found.values.iter().enumerate() {
                assert!((value - expected()[i % 6]).abs() < 1e-12 * largest, "{shape:?}, row {i}: {value}");
            }
        }
    }

    /// `u_x = x²/2` strains by x: shapes with quadratic functions have `E' x` at every node, extrapolated from their
    /// points and meeting at the corners.
    #[test]
    fn a_quadratic_displacement_has_a_linear_stress_in_quadratic_elements() {
        for shape in SolidShape::ALL.into_iter().filter(|shape| shape.n_nodes() >= 10) {
            let places = shape.corners_and_middles();
            let solid = Solid { shape, nodes: (0..places.len()).collect(), material: MATERIAL };
            let moved = column(&places, |p| [0.5 * p[0] * p[0], 0.0, 0.0]);
            let found = NodalStress::of(&places, &[solid], &moved).unwrap();
            let Elastic { youngs_modulus, poissons_ratio: nu } = MATERIAL;
            let stiff = youngs_modulus * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
            for (k, place) in places.iter().enumerate() {
                let value = found.line(k, 0)[0];
                assert!((value - stiff * place[0]).abs() < 1e-12 * stiff, "{shape:?} {place:?}: {value}");
            }
        }
    }

    /// Two bars in a row that are stretched differently share the mean at the nodes between them; a node of no element
    /// has no stress.
    #[test]
    fn nodes_between_elements_have_the_mean() {
        let cube = SolidShape::Hexahedron8.corners_and_middles();
        let mut places: Vec<[f64; 3]> = cube.clone();
        places.push([9.0; 3]);
        places.extend([1, 2, 5, 6].map(|k: usize| [cube[k][0] + 2.0, cube[k][1], cube[k][2]]));
        let material = Elastic { youngs_modulus: 100.0, poissons_ratio: 0.0 };
        let solid = |nodes: [usize; 8]| Solid { shape: SolidShape::Hexahedron8, nodes: nodes.to_vec(), material };
        let solids = [solid([0, 1, 2, 3, 4, 5, 6, 7]), solid([1, 9, 10, 2, 5, 11, 12, 6])];
        let moved = column(&places, |p| [if p[0] > 1.0 { 1.0 + 3.0 * (p[0] - 1.0) } else { p[0] }, 0.0, 0.0]);
        let found = NodalStress::of(&places, &solids, &moved).unwrap();
        assert_eq!(found.nodes, [0, 1, 2, 3, 4, 5, 6, 7, 9, 10, 11, 12]);
        for (k, node) in found.nodes.iter().enumerate() {
            let expected = if places[*node][0] < 0.0 {
                100.0
            } else if *node < 8 {
                200.0
            } else {
                300.0
            };
            let value = found.line(k, 0)[0];
            assert!((value - expected).abs() < 1e-11, "{node}: {value}");
        }
    }

    #[test]
    fn elements_that_are_inside_out_or_lack_nodes_are_refused() {
        let places = SolidShape::Tetrahedron4.corners_and_middles();
        let solid =
            |nodes: &[usize]| Solid { shape: SolidShape::Tetrahedron4, nodes: nodes.to_vec(), material: MATERIAL };
        let of = |nodes: &[usize]| NodalStress::of(&places, &[solid(nodes)], &column(&places, linear)).unwrap_err();
        assert_eq!(of(&[0, 2, 1, 3]), FemError::InsideOut { element: 0 });
        assert_eq!(of(&[0, 1, 2]), FemError::SolidNodes { element: 0, expected: 4 });
        assert_eq!(of(&[0, 1, 2, 4]), FemError::SolidNodes { element: 0, expected: 4 });
    }

    #[test]
    fn equivalent_and_principal_stress_of_known_states() {
        assert_eq!(von_mises([5.0, 0.0, 0.0, 0.0, 0.0, 0.0]), 5.0);
        assert_eq!(von_mises([-7.0; 3].into_iter().chain([0.0; 3]).collect::<Vec<_>>().try_into().unwrap()), 0.0);
        assert!((von_mises([0.0, 0.0, 0.0, 0.0, 2.0, 0.0]) - 2.0 * 3.0_f64.sqrt()).abs() < 1e-15);
        // A plane state: (σ_x + σ_y)/2 ± √(((σ_x − σ_y)/2)² + τ²).
        assert!((largest_principal([4.0, -2.0, 0.0, 4.0, 0.0, 0.0]) - 6.0).abs() < 1e-14);
        assert!((largest_principal([-4.0, 2.0, 0.0, 4.0, 0.0, 0.0]) + 6.0).abs() < 1e-14);
        assert!(largest_principal([f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0]).is_nan());
    }
}
