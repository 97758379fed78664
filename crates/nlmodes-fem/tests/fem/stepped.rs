//! Steps of section and material, tubes and added mass, compared with closed forms.

use std::f64::consts::PI;

use nlmodes_fem::{Beam, FemError, MassMatrix, Material, Mesh, Rod, Section, Step, Support};
use nlmodes_linalg::{SparseCholesky, bilinear};
use nlmodes_model::{DofKind, StructuralModel};

use crate::closed_forms::clamped_free_rod;
use crate::common::{assert_close, frequencies, frequencies_of};

/// `E`, `ρ`, `A` and length of the two parts of a rod, in SI.
const PARTS: [[f64; 4]; 2] = [[210e9, 7800.0, 4e-4, 0.7], [70e9, 2700.0, 1e-4, 0.5]];

/// The same in units of `metre` and `kilogram`, with elements of 0.1 m over `fine`.
fn stepped_rod(fine: usize, metre: f64, kilogram: f64) -> StructuralModel {
    let material =
        |[e, rho, ..]: [f64; 4]| Material::new(e * metre / kilogram, rho * metre.powi(3) / kilogram).unwrap();
    let area = |part: [f64; 4]| part[2] / metre.powi(2);
    let rod = Rod {
        material: material(PARTS[1]),
        area: area(PARTS[1]),
        mesh: Mesh::uniform(1.2 / metre, 12 * fine).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    let step = Step { to_node: 7 * fine, material: material(PARTS[0]), section: area(PARTS[0]), added_mass: 0.0 };
    rod.assemble_stepped(&[step], &[]).unwrap()
}

/// `tan(k₁ l₁) tan(k₂ l₂) = E₁ A₁ k₁ / (E₂ A₂ k₂)` without its poles.
fn frequency_equation(omega: f64) -> f64 {
    let [(s1, c1, z1), (s2, c2, z2)] = PARTS.map(|[e, rho, area, length]| {
        let k = omega * (rho / e).sqrt();
        ((k * length).sin(), (k * length).cos(), e * area * k)
    });
    s1 * s2 * z2 - c1 * c2 * z1
}

/// The root closest to `near`, by bisection.
fn root(near: f64) -> f64 {
    let [mut low, mut high] = [0.999 * near, 1.001 * near];
    assert!(frequency_equation(low) * frequency_equation(high) < 0.0, "no root near {near}");
    while high - low > 1e-15 * near {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if frequency_equation(low) * frequency_equation(middle) <= 0.0 { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}

#[test]
fn a_stepped_rod_has_the_roots_of_its_frequency_equation() {
    for (metre, kilogram) in [(1.0, 1.0), (1e-3, 1e3)] {
        let [coarse, fine] = [10, 20].map(|fine| {
            let model = stepped_rod(fine, metre, kilogram);
            frequencies(model.mass(), model.stiffness(), 4)
        });
        for (coarse, fine) in coarse.iter().zip(&fine) {
            // The error decreases with the square of the element length; the remainder with the fourth power.
            let exact = root(*fine);
            assert_close((coarse / exact - 1.0) / (fine / exact - 1.0), 4.0, 0.01);
            assert_close(fine + (fine - coarse) / 3.0, exact, 2e-7);
        }
    }
}

#[test]
fn added_mass_lowers_all_frequencies_of_a_rod_by_one_factor() {
    for mass_matrix in [MassMatrix::Consistent, MassMatrix::Lumped] {
        let material = Material::new(210e9, 9000.0).unwrap();
        let rod = Rod {
            material,
            area: 0.5,
            mesh: Mesh::uniform(20.0, 30).unwrap(),
            mass_matrix,
            start: Support::Clamped,
            end: Support::Free,
        };
        let bare = rod.assemble(&[]).unwrap();
        let step = Step { to_node: 30, material, section: 0.5, added_mass: 1200.0 };
        let heavy = rod.assemble_stepped(&[step], &[]).unwrap();
        let factor = (4500.0_f64 / 5700.0).sqrt();
        let [bare, heavy] = [bare, heavy].map(|model| frequencies(model.mass(), model.stiffness(), 6));
        for (bare, heavy) in bare.iter().zip(&heavy) {
            assert_close(*heavy, factor * bare, 1e-11);
        }
        let c = (210e9_f64 / 9000.0).sqrt();
        assert_close(heavy[0], factor * clamped_free_rod(c, 20.0, 1), 2e-4);
    }
}

/// A steel tube of 1 m, 20 mm by 2 mm, filled over its outer half with 0.3 kg/m; a round bar of 16 mm in the inner
/// half.
fn stepped_beam() -> (Beam, [Step<Section>; 2]) {
    let steel = Material::new(210e9, 7800.0).unwrap();
    let [bar, tube] = [(0.016, 0.008), (0.020, 0.002)].map(|(outer, wall)| Section::tube(outer, wall, 0.3).unwrap());
    let beam = Beam {
        material: steel,
        section: bar,
        mesh: Mesh::uniform(1.0, 8).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    let step = |to_node, section, added_mass| Step { to_node, material: steel, section, added_mass };
    (beam, [step(4, bar, 0.0), step(8, tube, 0.3)])
}

#[test]
fn a_stepped_beam_yields_as_its_parts_do() {
    let (beam, steps) = stepped_beam();
    let model = beam.assemble_stepped(&steps, &[]).unwrap();
    let tip = model.dofs().iter().position(|d| d.node == 8 && d.kind == DofKind::Deflection).unwrap();
    let mut q = vec![0.0; model.dofs().len()];
    q[tip] = 1.0;
    SparseCholesky::factor(model.stiffness(), "stiffness").unwrap().solve_in_place(&mut q);
    // ∫ (L − x)²/EI + 1/κGA dx, piece by piece.
    let part = |s: &Section, from: f64, to: f64| {
        let (ei, kga) = (210e9 * s.second_moment(), s.shear_factor() * 210e9 / 2.6 * s.area());
        ((1.0 - from).powi(3) - (1.0 - to).powi(3)) / (3.0 * ei) + (to - from) / kga
    };
    assert_close(q[tip], part(&steps[0].section, 0.0, 0.5) + part(&steps[1].section, 0.5, 1.0), 1e-11);
}

#[test]
fn the_mass_of_a_stepped_beam_is_that_of_its_parts() {
    let (beam, steps) = stepped_beam();
    let loose = Beam { start: Support::Free, ..beam };
    let model = loose.assemble_stepped(&steps, &[]).unwrap();
    let expected = 0.5 * 7800.0 * PI * 0.008_f64.powi(2) + 0.5 * (7800.0 * PI * 0.002 * 0.018 + 0.3);
    for kind in [DofKind::Axial, DofKind::Deflection] {
        let r: Vec<f64> = model.dofs().iter().map(|d| f64::from(u8::from(d.kind == kind))).collect();
        assert_close(bilinear(&r, model.mass(), &r), expected, 1e-13);
    }
    // Added mass has no rotary inertia: its contribution does not depend on the section.
    let thin = Section::tube(0.0016, 0.0008, 0.3).unwrap();
    let added = |added_mass| {
        let step = Step { to_node: 8, material: beam.material, section: thin, added_mass };
        loose.assemble_stepped(&[step], &[]).unwrap().mass().to_dense()
    };
    let [with, without] = [0.3, 0.0].map(added);
    let turn = 2;
    assert_eq!(model.dofs()[turn].kind, DofKind::Rotation);
    // 4 ρA l³/420 of a slender element, here with a shear parameter of 4e-4.
    assert_close(with[(turn, turn)] - without[(turn, turn)], 4.0 * 0.3 * 0.125_f64.powi(3) / 420.0, 1e-3);
}

#[test]
fn a_slender_tube_has_the_frequency_of_its_second_moment() {
    let tube = Section::tube(0.01, 0.001, 0.3).unwrap();
    let beam = Beam {
        material: Material::new(200e9, 7850.0).unwrap(),
        section: tube,
        mesh: Mesh::uniform(4.0, 40).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Pinned,
        end: Support::Pinned,
    };
    let found = frequencies_of(&beam.assemble(&[]).unwrap(), DofKind::Deflection, 1)[0];
    let i = PI * (0.01_f64.powi(4) - 0.008_f64.powi(4)) / 64.0;
    let area = PI * (0.01_f64.powi(2) - 0.008_f64.powi(2)) / 4.0;
    assert_close(found, (PI / 4.0).powi(2) * (200e9 * i / (7850.0 * area)).sqrt(), 2e-5);
}

#[test]
fn steps_that_do_not_follow_one_another_are_refused() {
    let (beam, steps) = stepped_beam();
    let refused = |steps: &[Step<Section>]| beam.assemble_stepped(steps, &[]).unwrap_err();
    assert_eq!(refused(&[steps[1], steps[0]]), FemError::Step { step: 1, from: 8, to: 4, last: 8 });
    assert_eq!(refused(&[Step { to_node: 9, ..steps[0] }]), FemError::Step { step: 0, from: 0, to: 9, last: 8 });
    assert_eq!(refused(&[Step { added_mass: -1.0, ..steps[0] }]), FemError::AddedMass { step: 0, value: -1.0 });
}
