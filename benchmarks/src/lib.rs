//! The structures that benches (`benches/`) and studies (`examples/`) are about.

use nlmodes::fem::{Beam, Direction, MassMatrix, Material, Mesh, Rod, Section, Stop, Support};
use nlmodes::model::{Drop, MasslessContactModel, Side};

/// Whatever goes wrong.
pub type Failure = Box<dyn std::error::Error>;

/// The rod of Section 3 of the paper.
///
/// # Errors
/// None, with positive `elements`.
pub fn rod(elements: usize, mass_matrix: MassMatrix) -> Result<MasslessContactModel, Failure> {
    let rod = Rod {
        material: Material::new(210e9, 9000.0)?,
        area: 1.0,
        mesh: Mesh::uniform(20.0, elements)?,
        mass_matrix,
        start: Support::Clamped,
        end: Support::Free,
    };
    let stop = Stop::rigid(20.0, Direction::Axial, Side::Positive, 0.5);
    Ok(MasslessContactModel::new(&rod.assemble(&[stop])?, &Drop)?)
}

/// The beam of Section 4 of the paper, the mass of its contact node dropped.
///
/// # Errors
/// None.
pub fn beam() -> Result<MasslessContactModel, Failure> {
    let length = 0.629_755_20;
    let beam = Beam {
        material: Material::new(181.36e9, 7730.0)?.with_poissons_ratio(0.3)?,
        section: Section::rectangle(0.012, 0.020)?.with_shear_factor(5.0 / 6.0)?,
        mesh: Mesh::graded(length, 21, 9.195_853_6)?,
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    let stop = Stop::rigid(length, Direction::Transverse, Side::Positive, 1.03e-3);
    Ok(MasslessContactModel::new(&beam.assemble(&[stop])?, &Drop)?)
}
