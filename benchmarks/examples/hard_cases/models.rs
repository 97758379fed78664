//! The structures of the cases.

use nlmodes::fem::{Beam, Direction, MassMatrix, Material, Mesh, Rod, Section, Stop, Support};
use nlmodes::linalg::{Triplet, sparse_from_triplets};
use nlmodes::model::{Contact, Dof, DofKind, Drop, MasslessContactModel, Side, StructuralModel};
use nlmodes_benchmarks::Failure;

/// A stop: node position over the length, side, gap.
pub type At = (f64, Side, f64);

/// The paper's rod on another mesh, with other stops.
pub fn rod(mesh: Mesh, stops: &[At]) -> Result<StructuralModel, Failure> {
    let length = mesh.length();
    let rod = Rod {
        material: Material::new(210e9, 9000.0)?,
        area: 1.0,
        mesh,
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    Ok(rod.assemble(&placed(stops, length, Direction::Axial))?)
}

/// A clamped steel beam of this length and height, 12 mm wide.
pub fn beam(mesh: Mesh, height: f64, stops: &[At]) -> Result<StructuralModel, Failure> {
    let length = mesh.length();
    let beam = Beam {
        material: Material::new(210e9, 7850.0)?.with_poissons_ratio(0.3)?,
        section: Section::rectangle(0.012, height)?.with_shear_factor(5.0 / 6.0)?,
        mesh,
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    Ok(beam.assemble(&placed(stops, length, Direction::Transverse))?)
}

fn placed(stops: &[At], length: f64, direction: Direction) -> Vec<Stop> {
    stops.iter().map(|&(at, side, gap)| Stop::rigid(at * length, direction, side, gap)).collect()
}

/// Masses in a row, the first spring held by a wall, contacts given by mass from 0.
pub fn chain(masses: &[f64], springs: &[f64], contacts: Vec<Contact>) -> Result<StructuralModel, Failure> {
    let n = masses.len();
    let m: Vec<Triplet> = masses.iter().enumerate().filter(|(_, m)| **m > 0.0).map(|(i, m)| (i, i, *m)).collect();
    let mut k: Vec<Triplet> = Vec::new();
    for (i, &spring) in springs.iter().enumerate() {
        k.push((i, i, spring));
        if i > 0 {
            k.extend([(i - 1, i - 1, spring), (i - 1, i, -spring), (i, i - 1, -spring)]);
        }
    }
    let dofs = (0..n).map(|node| Dof { node, position: (node + 1) as f64, kind: DofKind::Axial }).collect();
    Ok(StructuralModel::new(sparse_from_triplets(n, n, &m)?, sparse_from_triplets(n, n, &k)?, dofs, contacts)?)
}

/// MS-HBM: the mass of the contact nodes dropped.
pub fn massless(model: &StructuralModel) -> Result<MasslessContactModel, Failure> {
    Ok(MasslessContactModel::new(model, &Drop)?)
}

/// Conventional harmonic balance: the contact nodes keep their mass.
pub fn with_spring_tips(model: &StructuralModel) -> Result<MasslessContactModel, Failure> {
    Ok(MasslessContactModel::with_spring_tips(model, None)?)
}

/// A mass of 1 on a spring of 1, before a stop of stiffness `k_c`.
pub fn oscillator(gap: f64, k_c: f64) -> Result<MasslessContactModel, Failure> {
    with_spring_tips(&chain(&[1.0], &[1.0], vec![Contact::elastic(0, Side::Positive, gap, k_c)])?)
}
