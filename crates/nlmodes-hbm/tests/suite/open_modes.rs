//! Modes with the contacts held against those with open contacts of the same structure without the mass of its
//! contact nodes.

use crate::support;

use nlmodes_continuation::{Linearization, ParametricSystem};
use nlmodes_hbm::{CondensedStructure, Coordinates, ModalDamping, PeriodicSystem, Symmetry, modal_grazing};
use nlmodes_linalg::{DenseLu, Mat};
use nlmodes_model::reduction::{HeldModes, ModeCount, OpenModes};
use nlmodes_model::{Drop, MasslessContactModel, Side};
use support::modal::{Open, newton, settings, solver};
use support::rod;

fn solve(a: &Mat<f64>, b: &Mat<f64>) -> Mat<f64> {
    let lu = DenseLu::factor(a).unwrap();
    let mut x = b.clone();
    for j in 0..b.ncols() {
        let mut column: Vec<f64> = b.col(j).iter().copied().collect();
        lu.solve_in_place(&mut column);
        (0..b.nrows()).for_each(|i| x[(i, j)] = column[i]);
    }
    x
}

/// `T(ν²) = T_0 + Σ_k ν²/(λ_k (λ_k − ν²)) h_k g_k`, with `T_0` of the blocks of `K`.
fn held_transfer(structure: &CondensedStructure, nu_squared: f64) -> Mat<f64> {
    let model = structure.model();
    let psi = solve(&model.k_ll().to_dense(), model.k_ln());
    let mut t = solve(model.k_nn(), &(model.k_ln().transpose() * psi));
    for mode in HeldModes::new(model, usize::MAX).unwrap().modes {
        let weight = nu_squared / (mode.lambda * (mode.lambda - nu_squared));
        let h = solve(model.k_nn(), &Mat::from_fn(t.nrows(), 1, |i, _| mode.g[i]));
        for j in 0..t.ncols() {
            (0..t.nrows()).for_each(|i| t[(i, j)] += weight * h[(i, 0)] * mode.g[j]);
        }
    }
    t
}

/// The same from the answer to contact forces: `q_N = R Wλ`, `b = q_N − K_NN⁻¹ Wλ`, so that `T R = R − K_NN⁻¹`, all
/// turned to the directions of the contacts.
#[test]
fn both_reductions_see_the_same_structure() {
    // In metres and kilograms, and the same rod in millimetres and tonnes.
    for (ea, rho_a, length) in [(2.1e7, 0.78, 2.0), (2.1e7, 0.78e-6, 2000.0)] {
        let stops = [(30, Side::Positive, 1.0), (11, Side::Negative, 1.0), (18, Side::Positive, 1.0)];
        let massless = MasslessContactModel::new(&rod(30, ea, rho_a, length, &stops), &Drop).unwrap();
        let held = CondensedStructure::new(massless.clone(), 30).unwrap();
        let open = OpenModes::of_massless(&massless, ModeCount::Lowest(30)).unwrap();
        let (y, w) = (open.contact_rows(), massless.w());
        for share in [0.0, 0.3, 1.7, 4.0, 12.3] {
            let nu_squared = share * open.omega_squared()[0];
            let r = Mat::from_fn(3, 3, |i, j| {
                let modal = open.omega_squared().iter().enumerate();
                let modal: f64 = modal.map(|(k, w2)| y[(i, k)] * y[(j, k)] / (w2 - nu_squared)).sum();
                modal + open.flexibility()[(i, j)]
            });
            // Contacts at different nodes: W is a permutation with signs, W Wᵀ = 1.
            let r = w * &r * w.transpose();
            let expected = held_transfer(&held, nu_squared) * &r;
            let own = solve(massless.k_nn(), &Mat::identity(3, 3));
            for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
                let error = (r[(i, j)] - own[(i, j)] - expected[(i, j)]).abs();
                assert!(error < 1e-9 * r[(0, 0)].abs().max(r[(2, 2)].abs()), "{share}: {error:e}");
            }
        }
        let compliance = held.compliance().a();
        for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
            let error = (compliance[(i, j)] - open.flexibility()[(i, j)]).abs();
            assert!(error < 1e-10 * compliance[(0, 0)], "{error:e}");
        }
    }
}

/// A free motion that begins at another instant is the same motion. Once a point is accepted its phase is held: only
/// that one stays a solution.
#[test]
fn any_phase_of_a_free_motion_is_a_solution_until_one_is_held() {
    let open = Open::massless(&rod(6, 1.0, 1.0, 1.0, &[(6, Side::Positive, 1.0)]));
    let structure = open.structure(ModalDamping::none(open.n_modes()));
    let start = modal_grazing(&structure, 1).unwrap();
    for coordinates in [Coordinates::Contact, Coordinates::Modal] {
        let system = || {
            let (settings, solver) = (settings(4, coordinates), solver());
            PeriodicSystem::conservative_mode(&structure, Symmetry::None, settings, start.scales(), solver.as_ref())
                .unwrap()
        };
        let (mut held, p) = (system(), 0.1);
        let (size, width, series) = (held.n_coefficients(), held.series().width(), held.series());
        let grown = |(i, x): (usize, f64)| if i < size { x * f64::exp(0.5 * p) } else { x };
        let guess: Vec<f64> = start.unknowns(&held).into_iter().enumerate().map(grown).collect();
        held.hold_phase(&guess);
        let (x, residual) = newton(&mut held, guess, p);
        assert!(residual < 1e-12, "{residual:e}");
        let mut at = Linearization::new(held.dim());
        for theta in [0.2, 1.3, -2.0] {
            let mut turned = x.clone();
            for i in (0..size).step_by(width) {
                for n in 1..=series.n_harmonics {
                    let (c, s) = (i + n, i + series.sine(n).unwrap());
                    let (sin, cos) = (n as f64 * theta).sin_cos();
                    (turned[c], turned[s]) = (x[c] * cos + x[s] * sin, x[s] * cos - x[c] * sin);
                }
            }
            system().linearize(&turned, p, &mut at).unwrap();
            assert!(at.residual_norm() < 1e-11, "{coordinates:?} {theta}: {:e}", at.residual_norm());
            held.linearize(&turned, p, &mut at).unwrap();
            assert!(at.residual_norm() > 0.1 * theta.sin().abs(), "{coordinates:?} {theta}: {:e}", at.residual_norm());
        }
    }
}
