//! The same structure in metres and kilograms and in millimetres and tonnes.

use nlmodes_fem::{Beam, Direction, MassMatrix, Material, Mesh, Rod, Section};
use nlmodes_model::{Drop, MassRedistribution, MasslessContactModel, Move, StructuralModel, held_modes};

use crate::common::{assert_close, cantilever, frequencies, rod, stop};

fn assert_same_frequencies(si: &StructuralModel, mm: &StructuralModel) {
    let rules: [&dyn MassRedistribution; 2] = [&Drop, &Move];
    for [si, mm] in rules.map(|rule| [si, mm].map(|model| MasslessContactModel::new(model, rule).unwrap())) {
        let open = [&si, &mm].map(|model| frequencies(model.mass(), model.stiffness(), 8));
        let held = [&si, &mm].map(|model| held_modes(model, 8).unwrap().omega);
        for r in 0..8 {
            assert_close(open[1][r], open[0][r], 1e-10);
            assert_close(held[1][r], held[0][r], 1e-10);
        }
    }
}

#[test]
fn rod_in_millimetres_and_tonnes() {
    let si = rod(100, MassMatrix::Consistent);
    let mm = Rod {
        material: Material::new(210e3, 9000e-12).unwrap(),
        area: 1e6,
        mesh: Mesh::uniform(20e3, 100).unwrap(),
        ..si.clone()
    };
    let [si, mm] = [(si, 20.0), (mm, 20e3)].map(|(rod, end)| rod.assemble(&[stop(end, Direction::Axial)]).unwrap());
    assert_same_frequencies(&si, &mm);
}

#[test]
fn beam_in_millimetres_and_tonnes() {
    let si = cantilever(181.36e9);
    let mm = Beam {
        material: Material::new(181.36e3, 7730e-12).unwrap(),
        section: Section::rectangle(12.0, 20.0).unwrap(),
        mesh: Mesh::graded(629.75520, 21, 9.1958536).unwrap(),
        ..si.clone()
    };
    let stopped = |beam: Beam| {
        let end = beam.mesh.length();
        beam.assemble(&[stop(end, Direction::Transverse)]).unwrap()
    };
    assert_same_frequencies(&stopped(si), &stopped(mm));
}
