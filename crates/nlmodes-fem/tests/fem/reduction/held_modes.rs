//! Fixed-interface modes: all of them together give the statics, and those of equal spans are separated.

use nlmodes_fem::{Direction, MassMatrix, Material, Mesh, Rod, Stop, Support};
use nlmodes_linalg::Mat;
use nlmodes_model::reduction::HeldModes;
use nlmodes_model::{Drop, MasslessContactModel, Side};

/// Modulus and density in SI units, and in t, mm, N.
const STEEL: [(f64, f64, f64); 2] = [(210e9, 7850.0, 1.0), (210e3, 7.85e-9, 1e3)];

fn rod((modulus, density, metre): (f64, f64, f64), at: &[f64]) -> MasslessContactModel {
    let rod = Rod {
        material: Material::new(modulus, density).unwrap(),
        area: 2e-4 * metre * metre,
        mesh: Mesh::uniform(2.0 * metre, 20).unwrap(),
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Clamped,
    };
    let stop = |at: &f64| Stop::rigid(at * metre, Direction::Axial, Side::Positive, 1e-3 * metre);
    let stops: Vec<Stop> = at.iter().map(stop).collect();
    MasslessContactModel::new(&rod.assemble(&stops).unwrap(), &Drop).unwrap()
}

#[test]
fn all_modes_together_are_the_statics() {
    for units in STEEL {
        // K_NL Ψ = −Σ_k g_kᵀ g_k/λ_k, and K_LN = −K_LL Ψ.
        let model = rod(units, &[0.6, 1.5]);
        let held = HeldModes::new(&model, usize::MAX).unwrap();
        assert!(held.is_all() && held.count() == 17);
        let sum = |i: usize, j: usize| held.modes.iter().map(|mode| mode.g[i] * mode.g[j] / mode.lambda).sum::<f64>();
        let (sum, carried) = (Mat::from_fn(2, 2, sum), -(model.k_ln().transpose() * &held.statics));
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let off = (sum[(i, j)] - carried[(i, j)]).abs();
            assert!(off < 1e-12 * carried[(i, i)], "{i}, {j}: {off:e}");
        }
        let balance = model.k_ll().as_ref() * &held.statics + model.k_ln();
        let size = model.k_ln().col(0).iter().fold(0.0_f64, |size, k| size.max(k.abs()));
        assert!((0..17).all(|i| (0..2).all(|j| balance[(i, j)].abs() < 1e-12 * size)));
    }
}

/// Two equal spans have each frequency twice: of each two modes one moves the node between them, and the other leaves
/// it at rest.
#[test]
fn of_modes_with_one_frequency_only_one_moves_a_contact() {
    for units in STEEL {
        let held = HeldModes::new(&rod(units, &[1.0]), usize::MAX).unwrap();
        assert_eq!((held.count(), held.modes.len()), (18, 9));
        let few = HeldModes::new(&rod(units, &[1.0]), 6).unwrap();
        assert!(!few.is_all() && few.modes.len() == 3);
        // Six elements and fourteen have one frequency in common: three half-waves on the one, seven on the other.
        let held = HeldModes::new(&rod(units, &[0.6]), usize::MAX).unwrap();
        assert_eq!((held.count(), held.modes.len()), (18, 17));
    }
}
