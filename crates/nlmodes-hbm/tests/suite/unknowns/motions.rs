//! What is reported of a motion: responses before they touch, multipliers, power, the way to contacts that touch at
//! rest.

use crate::unknowns::support::modal::{Open, newton, settings, solver};
use crate::unknowns::support::{condense, on_springs, rod};
use crate::unknowns::{SYMMETRIES, support};
use nlmodes_continuation::conformance::jacobian_defect;
use nlmodes_continuation::{Bound, Continuation, Linearization, ParametricSystem};
use nlmodes_hbm::{
    Coordinates, ModalDamping, PeriodicSettings, PeriodicSystem, Scales, Symmetry, grazing_opened, modal_grazing,
};
use nlmodes_model::{Contact, Dof, DofKind, Side, StructuralModel};

/// A damped rod under a force of two harmonics that drives it against a stop.
fn forced(open: &Open, coordinates: Coordinates) -> PeriodicSystem {
    let first = open.omega_squared[0];
    let structure = open.structure(ModalDamping::ratios(&open.omega_squared, &[0.03]));
    let unit = |re: f64, im: f64| num_complex::Complex64::new(re, im) * first;
    let load = open.load(&structure, vec![open.force(5, 1, unit(0.3, 0.1)), open.force(2, 2, unit(0.1, -0.2))]);
    let scales = Scales::new(1.0, first.sqrt(), first);
    let omega = 1.06 * first.sqrt();
    PeriodicSystem::force_response(&structure, load, omega, 1.0, settings(6, coordinates), scales, solver().as_ref())
        .unwrap()
}

/// Two rods side by side, each before its stop. Where they are alike every mode is there twice, and motions of the
/// contacts do not tell both.
#[test]
fn of_modes_with_the_same_frequency_all_are_unknowns() {
    for (ratio, coordinates) in [(1.3, Coordinates::Contact), (1.0, Coordinates::Modal)] {
        let mut k = Vec::new();
        let mut m = Vec::new();
        for (rod, mass) in [(0, 1.0), (1, ratio)] {
            for i in (0..3).map(|i| 3 * rod + i) {
                k.push((i, i, if i % 3 == 2 { 1.0 } else { 2.0 }));
                m.push((i, i, mass));
                if i % 3 > 0 {
                    k.extend([(i, i - 1, -1.0), (i - 1, i, -1.0)]);
                }
            }
        }
        let matrix = |entries: &[_]| nlmodes_linalg::sparse_from_triplets(6, 6, entries).unwrap();
        let dofs = (0..6).map(|node| Dof { node, position: node as f64, kind: DofKind::Axial }).collect();
        let stops = vec![Contact::rigid(2, Side::Positive, 1.0), Contact::rigid(5, Side::Positive, 0.8)];
        let open = Open::massless(&StructuralModel::new(matrix(&m), matrix(&k), dofs, stops).unwrap());
        let structure = open.structure(ModalDamping::none(open.n_modes()));
        let [own, expected] = [Coordinates::Automatic, coordinates].map(|coordinates| {
            let (settings, scales) = (settings(3, coordinates), Scales::new(1.0, 1.0, 1.0));
            PeriodicSystem::conservative_mode(&structure, Symmetry::Even, settings, scales, solver().as_ref()).unwrap()
        });
        assert_eq!(own.n_coefficients(), expected.n_coefficients(), "{ratio}");
    }
}

/// A linear response with damping that couples modes: `(K − ω² M + iωC) q = f`, solved for real and imaginary part at
/// once.
#[test]
fn a_response_before_it_touches_is_that_of_the_matrices_with_any_damping() {
    let model = on_springs(&rod(4, 1.0, 1.0, 1.0, &[(4, Side::Positive, 1e6)]), &[5.0]);
    let open = Open::lowest(&model, 4);
    let (k, m, n) = (open.stiffness(), support::dense(model.mass()), 4);
    let c: Vec<Vec<f64>> =
        (0..n).map(|i| (0..n).map(|j| if i == j { 0.3 * i as f64 } else { -0.02 }).collect()).collect();
    let structure = open.structure(open.viscous(&c));
    for (omega, unit) in [(1.3, 1.0), (2.9, 1e3)] {
        let load = open.load(&structure, vec![open.force(1, 1, num_complex::Complex64::new(0.2, -0.1) * unit)]);
        for coordinates in [Coordinates::Contact, Coordinates::Modal] {
            let (settings, scales) = (settings(2, coordinates), Scales::new(unit, 1.0, unit * unit));
            let mut system = PeriodicSystem::frequency_response(
                &structure,
                load.clone(),
                1.0,
                1.0,
                settings,
                scales,
                solver().as_ref(),
            )
            .unwrap();
            let zero = vec![0.0; system.dim()];
            let (x, residual) = newton(&mut system, zero, omega);
            assert!(residual < 1e-13, "{residual:e}");
            let motion = system.motion(&x, omega).unwrap();
            // [S, −ωC; ωC, S] [Re q; Im q] = [Re f; Im f], with S = K − ω² M.
            let entry = |i: usize, j: usize| match (i < n, j < n) {
                (true, true) | (false, false) => k[i % n][j % n] - omega * omega * m[i % n][j % n],
                (true, false) => -omega * c[i][j - n],
                (false, true) => omega * c[i - n][j],
            };
            let matrix = (0..2 * n).map(|i| (0..2 * n).map(|j| entry(i, j)).collect()).collect();
            let mut force = vec![0.0; 2 * n];
            (force[1], force[1 + n]) = (0.2 * unit, -0.1 * unit);
            let q = support::solve_dense(matrix, force);
            for d in 0..n {
                let found = motion.displacement(&open.row(d, false))[1];
                let off = (found.re - q[d]).hypot(found.im - q[d + n]);
                assert!(off < 1e-11 * unit, "{coordinates:?} {d}: {found} {} {}", q[d], q[d + n]);
            }
        }
    }
}

/// Refined across a direction, a disturbed solution comes back to rounding, and has moved by nothing along that
/// direction.
#[test]
fn a_refined_solution_balances_its_power_and_stays_along_the_border() {
    let open = Open::massless(&rod(6, 1.0, 1.0, 1.0, &[(6, Side::Positive, 1.0)]));
    for coordinates in [Coordinates::Contact, Coordinates::Modal] {
        let mut system = forced(&open, coordinates);
        let n = system.dim();
        // In small steps of the level, so that Newton's method has its way.
        let solution = (1..=20).fold(vec![0.0; n], |x, k| newton(&mut system, x, 0.05 * f64::from(k)).0);
        let disturbed: Vec<f64> = (0..n).map(|i| solution[i] + 1e-4 * (1.7 * i as f64).sin()).collect();
        let held: Vec<f64> = (0..=n).map(|i| if i == n { 1.0 } else { 0.0 }).collect();
        let found = system.refine(&disturbed, 1.0, &held);
        assert!(found.p == 1.0 && found.residual < 1e-13, "{} {:e}", found.p, found.residual);
        found.x.iter().zip(&solution).for_each(|(a, b)| assert!((a - b).abs() < 1e-11, "{a} {b}"));
        let motion = system.motion(&found.x, found.p).unwrap();
        assert!(motion.contacts[0].closed_share > 0.05, "{}", motion.contacts[0].closed_share);
        assert!((motion.input_power / motion.dissipated_power - 1.0).abs() < 1e-11, "{}", motion.input_power);
        let slanted: Vec<f64> = (0..=n).map(|i| if i == n { 1.0 } else { 0.3 * (0.9 * i as f64).cos() }).collect();
        let found = system.refine(&disturbed, 1.0, &slanted);
        let moved: f64 = (0..n).map(|i| slanted[i] * (found.x[i] - disturbed[i])).sum::<f64>() + found.p - 1.0;
        assert!(found.residual < 1e-13 && found.p != 1.0 && moved.abs() < 1e-13, "{:e} {moved:e}", found.residual);
    }
}

#[test]
fn coefficients_of_modal_coordinates_are_those_coordinates_as_the_contacts_see_them() {
    use num_complex::Complex64;
    let open = Open::massless(&rod(6, 1.0, 1.0, 1.0, &[(6, Side::Positive, 1.0), (2, Side::Negative, 0.45)]));
    let m = open.n_modes();
    let eta: Vec<Vec<Complex64>> = (0..=6)
        .map(|n| {
            (0..m).map(|k| Complex64::new((n + k) as f64 + 0.3, if n > 0 { k as f64 - 1.2 } else { 0.0 })).collect()
        })
        .collect();
    for coordinates in [Coordinates::Contact, Coordinates::Modal] {
        let system = forced(&open, coordinates);
        let (series, x) = (system.series(), system.coefficients_of(&eta));
        let rows = system.structure().rows();
        for (j, own) in x.chunks(series.width()).enumerate() {
            let mut z = vec![Complex64::default(); 7];
            series.to_complex(own, &mut z);
            for (n, z) in z.iter().enumerate() {
                let expected: Complex64 = match coordinates {
                    Coordinates::Modal => eta[n][j],
                    _ => (0..m).map(|k| eta[n][k] * rows[(j, k)]).sum(),
                };
                assert!((z * system.unit() - expected).norm() < 1e-12 * (1.0 + expected.norm()), "{j} {n}: {z}");
            }
        }
    }
}

/// Before contacts that touch at rest: derivatives along the way from those that are set back, its begin and its end.
#[test]
fn the_way_to_contacts_that_touch_at_rest_is_smooth_and_begins_and_ends_as_it_is_told() {
    for stops in [vec![(5, Side::Positive, 0.0)], vec![(5, Side::Positive, 0.0), (2, Side::Negative, 0.0)]] {
        let structure = condense(&rod(5, 1.0, 1.0, 1.0, &stops));
        let start = grazing_opened(&structure, 1, 1.0).unwrap();
        assert!(start.touches_at_rest());
        for symmetry in SYMMETRIES {
            let settings = (PeriodicSettings { harmonics: 4, ..PeriodicSettings::default() }, symmetry);
            let mut problem = structure.conservative_mode(settings, start.scales(), solver().as_ref()).unwrap();
            let (n, series, size) = (problem.dim(), problem.series(), problem.n_coefficients());
            let mut x: Vec<f64> = (0..n).map(|i| 0.1 * (1.7 * i as f64 + 0.4).sin()).collect();
            (0..size).filter(|i| i % series.width() == 1).for_each(|i| x[i] = 1.9 - 0.1 * i as f64);
            x[size..].iter_mut().zip([1.06, 0.02]).for_each(|(x, given)| *x = given);
            let mut at = Linearization::new(n);
            {
                let own = structure.conservative_mode(settings, start.scales(), solver().as_ref()).unwrap();
                let mut way = own.beside_opening(&start.opening).unwrap();
                for s in [0.9, 0.3] {
                    let defect = jacobian_defect(&mut way, &x, s, 1e-6).unwrap();
                    assert!(defect < 1e-6, "{symmetry:?} {s}: {defect:e}");
                }
                let begin = start.unknowns(&way);
                way.accepted(&begin, 1.0);
                problem.accepted(&begin, 0.0);
                way.linearize(&begin, 1.0, &mut at).unwrap();
                assert!(at.residual_norm() < 1e-9, "{symmetry:?}: {:e}", at.residual_norm());
                way.linearize(&x, 0.0, &mut at).unwrap();
            }
            let mut end = Linearization::new(n);
            problem.linearize(&x, 0.0, &mut end).unwrap();
            at.residual.iter().zip(&end.residual).for_each(|(a, b)| assert!((a - b).abs() < 1e-13, "{a} {b}"));
        }
    }
}

/// Nothing is lost: the multipliers of a motion that is even in time have the product one, and two of them are one.
#[test]
fn multipliers_of_a_conservative_motion_keep_its_volume_and_its_phase() {
    let model = rod(5, 2e8, 40.0, 3.0, &[(5, Side::Positive, 1e-3)]);
    [f64::INFINITY, 3e7].into_iter().for_each(|spring| keeps_volume(&on_springs(&model, &[spring])));
}

fn keeps_volume(model: &StructuralModel) {
    let p = 1.6_f64.ln();
    let open = Open::massless(model);
    let modal = open.structure(ModalDamping::none(open.n_modes()));
    let start = modal_grazing(&modal, 1).unwrap();
    let settings = settings(6, Coordinates::Contact);
    let mut system =
        PeriodicSystem::conservative_mode(&modal, Symmetry::Even, settings, start.scales(), solver().as_ref()).unwrap();
    let n = system.dim();
    let to_the_end = Continuation { bounds: vec![Bound { coordinate: n, min: -8.0, max: p }], ..Default::default() };
    let (x, direction) = (start.unknowns(&system), start.direction(&system));
    let branch = to_the_end.run(&mut system, &x, 0.0, &direction, |_| std::ops::ControlFlow::Continue(())).unwrap();
    let (x, residual) = newton(&mut system, branch.points.last().unwrap().x.clone(), p);
    assert!(residual < 1e-12, "{residual:e}");
    let floquet = system.floquet(&x, p, solver().as_ref()).unwrap();
    let product: num_complex::Complex64 = floquet.multipliers.iter().product();
    assert!((product - 1.0).norm() < 1e-9, "{product}");
    let mut from_one: Vec<f64> = floquet.multipliers.iter().map(|z| (z - 1.0).norm()).collect();
    from_one.sort_by(f64::total_cmp);
    assert!(from_one[1] < floquet.error, "{from_one:?} {}", floquet.error);
}
