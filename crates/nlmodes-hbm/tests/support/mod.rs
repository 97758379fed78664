//! Structures made by hand, so that these tests owe nothing to the finite-element crate.
#![allow(dead_code)]

use nlmodes_contact::solver_by_name;
use nlmodes_hbm::{CondensedStructure, Grazing, MixedShooting, MixedShootingSettings, Switching, Symmetry, grazing};
use nlmodes_linalg::sparse_from_triplets;
use nlmodes_model::{Contact, Dof, DofKind, Drop, MasslessContactModel, Side, StructuralModel};

/// Clamped-free rod of `elements` linear elements with consistent mass, a stop at each `(node, side, gap)`.
pub fn rod(elements: usize, ea: f64, rho_a: f64, length: f64, stops: &[(usize, Side, f64)]) -> StructuralModel {
    let l = length / elements as f64;
    let (mut k, mut m) = (Vec::new(), Vec::new());
    for e in 0..elements {
        for (a, b) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            if e + a == 0 || e + b == 0 {
                continue;
            }
            let (i, j) = (e + a - 1, e + b - 1);
            k.push((i, j, ea / l * if a == b { 1.0 } else { -1.0 }));
            m.push((i, j, rho_a * l / 6.0 * if a == b { 2.0 } else { 1.0 }));
        }
    }
    let dofs = (1..=elements).map(|node| Dof { node, position: l * node as f64, kind: DofKind::Axial }).collect();
    let contacts = stops.iter().map(|&(node, side, gap)| Contact { dof: node - 1, side, gap }).collect();
    StructuralModel::new(
        sparse_from_triplets(elements, elements, &m).unwrap(),
        sparse_from_triplets(elements, elements, &k).unwrap(),
        dofs,
        contacts,
    )
    .unwrap()
}

/// The rod of Section 3 with a stop at its tip, the mass of the tip dropped.
pub fn paper_rod() -> CondensedStructure {
    condense(&rod(100, 210e9, 9000.0, 20.0, &[(100, Side::Positive, 0.5)]))
}

/// Two elements, `EA = ρA = L = g₀ = 1`: one massive degree of freedom.
pub fn two_element_rod() -> CondensedStructure {
    condense(&rod(2, 1.0, 1.0, 1.0, &[(2, Side::Positive, 1.0)]))
}

pub fn condense(model: &StructuralModel) -> CondensedStructure {
    let n = model.dofs().len();
    CondensedStructure::new(MasslessContactModel::new(model, &Drop).unwrap(), n).unwrap()
}

pub fn problem<'s>(
    structure: &'s CondensedStructure,
    mode: usize,
    harmonics: usize,
    symmetry: Symmetry,
    switching: Switching,
) -> (MixedShooting<'s>, Grazing) {
    let start = grazing(structure, mode).unwrap();
    let settings = MixedShootingSettings { harmonics, symmetry, switching };
    let solver = solver_by_name("active-set").unwrap();
    (MixedShooting::new(structure, settings, start.scales(), solver.as_ref()).unwrap(), start)
}
