//! The structures of the paper.

// Each test binary uses some of them.
#![allow(dead_code)]

use nlmodes::fem::{Beam, Direction, MassMatrix, Material, Mesh, Rod, Section, Stop, Support};
use nlmodes::model::{Drop, MasslessContactModel, Side, StructuralModel};

/// Gap of the rod, m.
pub const ROD_GAP: f64 = 0.5;

/// Length of the beam, m.
pub const BEAM_LENGTH: f64 = 0.629_755_20;

/// Gap of the beam, m.
pub const BEAM_GAP: f64 = 1.03e-3;

/// The rod of Section 3.
pub fn rod(elements: usize, mass_matrix: MassMatrix) -> MasslessContactModel {
    let rod = Rod {
        material: Material::new(210e9, 9000.0).unwrap(),
        area: 1.0,
        mesh: Mesh::uniform(20.0, elements).unwrap(),
        mass_matrix,
        start: Support::Clamped,
        end: Support::Free,
    };
    let stop = Stop::rigid(20.0, Direction::Axial, Side::Positive, ROD_GAP);
    MasslessContactModel::new(&rod.assemble(&[stop]).unwrap(), &Drop).unwrap()
}

/// Clamped-free rod with `EA = ρA = L = 1`, consistent mass, that of the stops' nodes dropped.
pub fn unit_rod(elements: usize, stops: &[Stop]) -> MasslessContactModel {
    let rod = Rod {
        material: Material::new(1.0, 1.0).unwrap(),
        area: 1.0,
        mesh: Mesh::uniform(1.0, elements).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    MasslessContactModel::new(&rod.assemble(stops).unwrap(), &Drop).unwrap()
}

/// The beam of Section 4 with its contact mass.
pub fn beam(youngs_modulus: f64) -> StructuralModel {
    let beam = Beam {
        material: Material::new(youngs_modulus, 7730.0).unwrap().with_poissons_ratio(0.3).unwrap(),
        section: Section::rectangle(0.012, 0.020).unwrap().with_shear_factor(5.0 / 6.0).unwrap(),
        mesh: Mesh::graded(BEAM_LENGTH, 21, 9.195_853_6).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    let stop = Stop::rigid(BEAM_LENGTH, Direction::Transverse, Side::Positive, BEAM_GAP);
    beam.assemble(&[stop]).unwrap()
}

/// The beam of Section 4 with the mass of its contact node dropped, and the modulus that goes with that.
pub fn massless_beam() -> MasslessContactModel {
    MasslessContactModel::new(&beam(181.36e9), &Drop).unwrap()
}
