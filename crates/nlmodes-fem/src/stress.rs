//! Stress along rods and beams, from the displacements of their nodes.

use nlmodes_model::{Dof, DofKind};

use crate::step::step_of;
use crate::timoshenko::shear_parameter;
use crate::{Beam, Material, Mesh, Rod, Section, Step};

/// Axial stress at a place of a rod or beam, as a function of its displacements: `σ = Σ weight q`, Pa.
#[derive(Debug, Clone, PartialEq)]
pub struct StressRow {
    /// Position along the axis, m.
    pub position: f64,
    /// Degrees of freedom with weights, Pa/m and Pa.
    pub weights: Vec<(usize, f64)>,
    /// Young's modulus there, Pa: a strain that heat causes takes so many times itself away.
    pub youngs_modulus: f64,
}

impl Rod {
    /// `σ = E u′` of each element, in a model with these degrees of freedom.
    pub fn stress_rows(&self, steps: &[Step<f64>], dofs: &[Dof]) -> Vec<StressRow> {
        let row = |element: usize| {
            let material = step_of(steps, element).map_or(self.material, |step| step.material);
            let [from, to] = ends(&self.mesh, element);
            let strain = axial(&material, element, to - from);
            row(dofs, 0.5 * (from + to), &material, &strain)
        };
        (0..self.mesh.elements()).map(row).collect()
    }
}

impl Beam {
    /// `σ = E u′ ± M c/I` on both sides of either end of each element, with `c` the distance of the outermost fibre, in
    /// a model with these degrees of freedom; none where the distance is not known of each section.
    ///
    /// The bending moments are those with which the nodes hold the element, `M = E I φ′` of its own functions: exact
    /// for loads at nodes.
    pub fn stress_rows(&self, steps: &[Step<Section>], dofs: &[Dof]) -> Option<Vec<StressRow>> {
        let mut rows = Vec::new();
        for element in 0..self.mesh.elements() {
            let step = step_of(steps, element);
            let material = step.map_or(self.material, |step| step.material);
            let section = step.map_or(self.section, |step| step.section);
            let [from, to] = ends(&self.mesh, element);
            let fibre = section.outer_fibre()?;
            let strain = axial(&material, element, to - from);
            for (position, slopes) in [from, to].into_iter().zip(curvatures(&material, &section, to - from)) {
                for side in [fibre, -fibre] {
                    let bent = slopes.into_iter().enumerate().map(|(k, slope)| {
                        let kind = if k % 2 == 0 { DofKind::Deflection } else { DofKind::Rotation };
                        (element + k / 2, kind, side * material.youngs_modulus() * slope)
                    });
                    let all: Vec<_> = strain.iter().copied().chain(bent).collect();
                    rows.push(row(dofs, position, &material, &all));
                }
            }
        }
        Some(rows)
    }
}

fn ends(mesh: &Mesh, element: usize) -> [f64; 2] {
    [mesh.nodes()[element], mesh.nodes()[element + 1]]
}

/// `E u′` of an element.
fn axial(material: &Material, element: usize, length: f64) -> [(usize, DofKind, f64); 2] {
    let stiff = material.youngs_modulus() / length;
    [(element, DofKind::Axial, -stiff), (element + 1, DofKind::Axial, stiff)]
}

/// `φ′` at both ends of a Timoshenko element in `w_1, φ_1, w_2, φ_2`: its rows of moments over `E I`, the first one
/// with the other sign.
fn curvatures(material: &Material, section: &Section, length: f64) -> [[f64; 4]; 2] {
    let (l, phi) = (length, shear_parameter(material, section, length));
    let [near, far] = [4.0 + phi, 2.0 - phi].map(|share| share / (l * (1.0 + phi)));
    let slope = 6.0 / (l * l * (1.0 + phi));
    [[-slope, -near, slope, -far], [slope, far, -slope, near]]
}

/// A row of node, kind and weight; what is held does not move.
fn row(dofs: &[Dof], position: f64, material: &Material, weights: &[(usize, DofKind, f64)]) -> StressRow {
    // Degrees of freedom are in the order of their nodes.
    let find = |node: usize, kind: DofKind| {
        let first = dofs.partition_point(|dof| dof.node < node);
        let own = dofs[first..].iter().take_while(|dof| dof.node == node).position(|dof| dof.kind == kind);
        own.map(|k| first + k)
    };
    let weights = weights.iter().filter_map(|&(node, kind, weight)| Some((find(node, kind)?, weight))).collect();
    StressRow { position, weights, youngs_modulus: material.youngs_modulus() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MassMatrix, Support};
    use nlmodes_linalg::{SparseCholesky, multiply};

    fn material() -> Material {
        Material::new(200e9, 7800.0).unwrap().with_poissons_ratio(0.3).unwrap()
    }

    fn cantilever(section: Section) -> Beam {
        let mesh = Mesh::graded(0.8, 7, 3.0).unwrap();
        let (mass_matrix, start, end) = (MassMatrix::Consistent, Support::Clamped, Support::Free);
        Beam { material: material(), section, mesh, mass_matrix, start, end }
    }

    fn value(row: &StressRow, q: &[f64]) -> f64 {
        row.weights.iter().map(|(dof, weight)| weight * q[*dof]).sum()
    }

    /// Displacements under forces at degrees of freedom.
    fn answer(model: &nlmodes_model::StructuralModel, force: &[(usize, DofKind, f64)]) -> Vec<f64> {
        let mut q = vec![0.0; model.dofs().len()];
        for (node, kind, f) in force {
            let at = model.dofs().iter().position(|dof| (dof.node, dof.kind) == (*node, *kind)).unwrap();
            q[at] += f;
        }
        let load = q.clone();
        SparseCholesky::factor(model.stiffness(), "stiffness").unwrap().solve_in_place(&mut q);
        assert!(multiply(model.stiffness(), &q).iter().zip(&load).all(|(a, b)| (a - b).abs() < 1e-6));
        q
    }

    /// Under a force across its tip and one along it: `N/A ± F (L − x) c/I` at every node, on both sides.
    #[test]
    fn a_cantilever_has_the_stress_of_its_moment_and_of_its_normal_force() {
        for (section, fibre) in [
            (Section::rectangle(0.01, 0.02).unwrap(), 0.01),
            (Section::tube(0.05, 0.004, 0.3).unwrap(), 0.025),
            (Section::new(2e-4, 3e-9).unwrap().with_outer_fibre(0.013).unwrap(), 0.013),
        ] {
            let beam = cantilever(section);
            let model = beam.assemble(&[]).unwrap();
            let q = answer(&model, &[(7, DofKind::Deflection, 30.0), (7, DofKind::Axial, 500.0)]);
            let rows = beam.stress_rows(&[], model.dofs()).unwrap();
            assert_eq!(rows.len(), 4 * 7);
            for (k, row) in rows.iter().enumerate() {
                let side = if k % 2 == 0 { 1.0 } else { -1.0 };
                let bent = side * 30.0 * (0.8 - row.position) * fibre / section.second_moment();
                let expected = 500.0 / section.area() + bent;
                let found = value(row, &q);
                let largest = 30.0 * 0.8 * fibre / section.second_moment();
                assert!((found - expected).abs() < 1e-7 * largest, "{}: {found} {expected}", row.position);
            }
        }
    }

    /// A stepped rod under a force at its end: `F/A` of each part.
    #[test]
    fn a_stepped_rod_has_the_stress_of_each_part() {
        let mesh = Mesh::uniform(1.0, 4).unwrap();
        let (mass_matrix, start, end) = (MassMatrix::Consistent, Support::Clamped, Support::Free);
        let rod = Rod { material: material(), area: 1e-4, mesh, mass_matrix, start, end };
        let soft = Material::new(70e9, 2700.0).unwrap();
        let steps = [Step { to_node: 2, material: soft, section: 3e-4, added_mass: 0.0 }];
        let model = rod.assemble_stepped(&steps, &[]).unwrap();
        let q = answer(&model, &[(4, DofKind::Axial, 900.0)]);
        let rows = rod.stress_rows(&steps, model.dofs());
        let found: Vec<f64> = rows.iter().map(|row| value(row, &q)).collect();
        let expected = [3e6, 3e6, 9e6, 9e6];
        assert!(found.iter().zip(expected).all(|(a, b)| (a / b - 1.0).abs() < 1e-9), "{found:?}");
        assert_eq!(rows[1].position, 0.375);
        assert_eq!([rows[0].youngs_modulus, rows[3].youngs_modulus], [70e9, 200e9]);
    }

    #[test]
    fn a_beam_without_the_height_of_its_section_has_none() {
        let beam = cantilever(Section::new(2e-4, 3e-9).unwrap());
        assert!(beam.stress_rows(&[], beam.assemble(&[]).unwrap().dofs()).is_none());
        assert!(Section::new(1.0, 1.0).unwrap().with_outer_fibre(0.0).is_err());
    }
}
