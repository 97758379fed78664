//! What supports hold, and what they leave free.

use super::{Direction, StructureKind, Support};

/// Whether a support holds the motion in a direction. A sliding end of a beam moves across its axis, that of a rod
/// along it.
pub fn holds(kind: StructureKind, support: Support, direction: Direction) -> bool {
    match support {
        Support::Clamped | Support::Pinned => true,
        Support::Sliding => (kind, direction) == (StructureKind::Beam, Direction::Axial),
        Support::Free => false,
    }
}

/// Number of degrees of freedom that the supports leave free.
pub fn free_dofs(kind: StructureKind, elements: usize, ends: [Support; 2]) -> usize {
    let a_node = match kind {
        StructureKind::Rod => 1,
        StructureKind::Beam => 3,
    };
    let held: usize = ends.iter().map(|end| held_dofs(kind, *end)).sum();
    (a_node * (elements + 1)).saturating_sub(held)
}

fn held_dofs(kind: StructureKind, support: Support) -> usize {
    match (kind, support) {
        (StructureKind::Rod, _) => usize::from(holds(kind, support, Direction::Axial)),
        (StructureKind::Beam, Support::Clamped) => 3,
        (StructureKind::Beam, Support::Pinned | Support::Sliding) => 2,
        (StructureKind::Beam, Support::Free) => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nlmodes_fem::Mesh;

    #[test]
    fn degrees_of_freedom_are_those_of_the_assembled_structure() {
        use nlmodes_fem as fem;
        let pairs = [
            (Support::Clamped, fem::Support::Clamped),
            (Support::Pinned, fem::Support::Pinned),
            (Support::Sliding, fem::Support::Sliding),
            (Support::Free, fem::Support::Free),
        ];
        for ((start, fem_start), (end, fem_end)) in pairs.into_iter().flat_map(|a| pairs.map(|b| (a, b))) {
            let material = fem::Material::new(1.0, 1.0).unwrap();
            let mesh = Mesh::uniform(1.0, 3).unwrap();
            let mass_matrix = fem::MassMatrix::Consistent;
            let rod = fem::Rod { material, area: 1.0, mesh: mesh.clone(), mass_matrix, start: fem_start, end: fem_end };
            let section = fem::Section::rectangle(0.1, 0.1).unwrap();
            let beam = fem::Beam { material, section, mesh, mass_matrix, start: fem_start, end: fem_end };
            let count = |kind| free_dofs(kind, 3, [start, end]);
            assert_eq!(count(StructureKind::Rod), rod.assemble(&[]).unwrap().dofs().len());
            assert_eq!(count(StructureKind::Beam), beam.assemble(&[]).unwrap().dofs().len());
        }
    }
}
