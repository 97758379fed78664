use nlmodes_fem::{Beam, Direction, MassMatrix, Material, Mesh, Rod, Section, Stop, Support};
use nlmodes_linalg::SparseMatrix;
use nlmodes_model::{DofKind, LinearModes, Side, StructuralModel, linear_modes};

/// Rod of 20 m.
pub fn rod(elements: usize, mass_matrix: MassMatrix) -> Rod {
    Rod {
        material: Material::new(210e9, 9000.0).unwrap(),
        area: 1.0,
        mesh: Mesh::uniform(20.0, elements).unwrap(),
        mass_matrix,
        start: Support::Clamped,
        end: Support::Free,
    }
}

/// Graded cantilever of 12 mm by 20 mm, with the given Young's modulus.
pub fn cantilever(youngs_modulus: f64) -> Beam {
    Beam {
        material: Material::new(youngs_modulus, 7730.0).unwrap(),
        section: Section::rectangle(0.012, 0.020).unwrap(),
        mesh: Mesh::graded(0.62975520, 21, 9.1958536).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    }
}

/// Steel beam of length 1 m and height `height`, as wide as high, between the given ends.
pub fn square_beam(height: f64, elements: usize, start: Support, end: Support) -> Beam {
    Beam {
        material: Material::new(210e9, 7800.0).unwrap(),
        section: Section::rectangle(height, height).unwrap(),
        mesh: Mesh::uniform(1.0, elements).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start,
        end,
    }
}

pub fn stop(position: f64, direction: Direction) -> Stop {
    Stop::rigid(position, direction, Side::Positive, 1e-3)
}

/// Angular frequencies in rad/s of the lowest modes of the pencil.
pub fn frequencies(mass: &SparseMatrix, stiffness: &SparseMatrix, count: usize) -> Vec<f64> {
    linear_modes(mass, stiffness, count).unwrap().omega
}

/// Frequencies below this fraction of the highest one considered are those of rigid-body modes.
const RIGID: f64 = 1e-4;

/// Number of rigid-body modes.
pub fn rigid_modes(model: &StructuralModel) -> usize {
    let omega = frequencies(model.mass(), model.stiffness(), 15);
    omega.iter().filter(|w| **w < RIGID * omega[omega.len() - 1]).count()
}

/// The lowest `count` angular frequencies of those elastic modes that move in `kind`.
pub fn frequencies_of(model: &StructuralModel, kind: DofKind, count: usize) -> Vec<f64> {
    let LinearModes { omega, shapes } = linear_modes(model.mass(), model.stiffness(), 3 * count + 3).unwrap();
    let moves = |r: usize| {
        if omega[r] < RIGID * omega[omega.len() - 1] {
            return false;
        }
        let largest = |wanted: bool| {
            let sizes = model.dofs().iter().enumerate().filter(|(_, d)| (d.kind == kind) == wanted);
            sizes.fold(0.0_f64, |l, (i, _)| l.max(shapes[(i, r)].abs()))
        };
        // Bending modes have rotation and deflection but no axial part, and vice versa.
        if kind == DofKind::Axial { largest(true) > largest(false) } else { largest(true) > 1e-6 * largest(false) }
    };
    let found: Vec<f64> = (0..omega.len()).filter(|&r| moves(r)).map(|r| omega[r]).take(count).collect();
    assert_eq!(found.len(), count, "modes of this kind among those computed");
    found
}

pub fn assert_close(found: f64, expected: f64, tolerance: f64) {
    let error = (found / expected - 1.0).abs();
    assert!(error <= tolerance, "{found} where {expected} was expected: relative error {error:e}");
}
