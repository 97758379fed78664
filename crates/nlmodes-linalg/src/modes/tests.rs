use std::sync::Arc;

use super::*;
use crate::{Digits, bilinear, column, multiply, sparse_from_triplets};

/// Springs `k` and masses `m` in a row; fixed at the first end unless `free`.
fn chain(n: usize, free: bool, mass: impl Fn(usize) -> f64) -> (SparseMatrix, SparseMatrix) {
    let mut k = vec![(0, 0, if free { 0.0 } else { 1.0 })];
    for i in 1..n {
        k.extend([(i - 1, i - 1, 1.0), (i, i, 1.0), (i - 1, i, -1.0), (i, i - 1, -1.0)]);
    }
    let m: Vec<_> = (0..n).map(|i| (i, i, mass(i))).collect();
    (sparse_from_triplets(n, n, &k).unwrap(), sparse_from_triplets(n, n, &m).unwrap())
}

/// `λ = 4 sin²((2r − 1) π / (4n + 2))` of `n` unit masses, fixed at one end.
fn held_chain(n: usize, r: usize) -> f64 {
    let angle = (2 * r - 1) as f64 * std::f64::consts::PI / (4 * n + 2) as f64;
    4.0 * angle.sin().powi(2)
}

/// `λ = 4 sin²(r π / 2n)`, r = 0, 1 …, of `n` free unit masses.
fn free_chain(n: usize, r: usize) -> f64 {
    4.0 * (r as f64 * std::f64::consts::PI / (2 * n) as f64).sin().powi(2)
}

fn assert_modes(k: &SparseMatrix, m: &SparseMatrix, modes: &Modes) {
    let largest_k = k.val().iter().fold(0.0_f64, |l, v| l.max(v.abs()));
    for (i, &λ) in modes.eigenvalues.iter().enumerate() {
        let φ = column(&modes.vectors, i);
        let (kφ, mφ) = (multiply(k, φ), multiply(m, φ));
        let size = φ.iter().fold(0.0_f64, |l, v| l.max(v.abs()));
        let worst = kφ.iter().zip(&mφ).fold(0.0_f64, |l, (k, m)| l.max((k - λ * m).abs()));
        assert!(worst <= 1e-10 * largest_k * size, "residual {worst:e} of mode {i}");
        for j in 0..=i {
            let product = bilinear(column(&modes.vectors, j), m, φ);
            assert!((product - f64::from(i == j)).abs() < 1e-12, "modes {i} and {j}: {product:e}");
        }
        let first = φ.iter().find(|v| v.abs() >= (1.0 - 1e-6) * size).unwrap();
        assert!(*first > 0.0, "sign of mode {i}");
    }
}

#[test]
fn every_mode_of_a_short_chain_is_found() {
    for n in [1, 2, 7, 60] {
        let (k, m) = chain(n, false, |_| 1.0);
        let modes = lowest_modes(&k, &m, n + 3).unwrap();
        assert_eq!(modes.eigenvalues.len(), n);
        for (r, λ) in modes.eigenvalues.iter().enumerate() {
            assert!((λ / held_chain(n, r + 1) - 1.0).abs() < 1e-12, "n = {n}, r = {r}: {λ}");
        }
        assert_modes(&k, &m, &modes);
    }
}

#[test]
fn lanczos_is_as_accurate_as_the_closed_form() {
    let n = 5000;
    let (k, m) = chain(n, false, |_| 1.0);
    let modes = lowest_modes(&k, &m, 40).unwrap();
    for (r, λ) in modes.eigenvalues.iter().enumerate() {
        assert!((λ / held_chain(n, r + 1) - 1.0).abs() < 1e-12, "r = {r}: {:e}", λ / held_chain(n, r + 1) - 1.0);
    }
    assert_modes(&k, &m, &modes);
}

#[test]
fn nearly_all_modes_are_as_accurate_as_few() {
    let n = 300;
    let (k, m) = chain(n, false, |_| 1.0);
    let modes = lowest_modes(&k, &m, 295).unwrap();
    for (r, λ) in modes.eigenvalues.iter().enumerate() {
        assert!((λ / held_chain(n, r + 1) - 1.0).abs() < 1e-12, "r = {r}: {:e}", λ / held_chain(n, r + 1) - 1.0);
    }
}

#[test]
fn rigid_body_mode_comes_first_with_eigenvalue_zero() {
    for n in [40, 900] {
        let (k, m) = chain(n, true, |_| 1.0);
        let modes = lowest_modes(&k, &m, 12).unwrap();
        assert!(modes.eigenvalues[0] >= 0.0 && modes.eigenvalues[0] < 1e-9 * modes.eigenvalues[1]);
        for r in 1..12 {
            // The entries of K + sM represent λ with the rounding of the largest λ.
            assert!((modes.eigenvalues[r] / free_chain(n, r) - 1.0).abs() < 1e-10, "n = {n}, r = {r}");
        }
        assert_modes(&k, &m, &modes);
    }
}

#[test]
fn massless_coordinates_follow_statically() {
    // Every other mass missing: springs of ½ between the remaining ones.
    for n in [41, 801] {
        let (k, m) = chain(n, false, |i| if i % 2 == 1 { 1.0 } else { 0.0 });
        let modes = lowest_modes(&k, &m, n).unwrap();
        let heavy = n / 2;
        assert_eq!(modes.eigenvalues.len(), heavy);
        for r in 1..=10 {
            // The massless coordinate at the end carries no load.
            assert!((modes.eigenvalues[r - 1] / (0.5 * held_chain(heavy, r)) - 1.0).abs() < 1e-12, "n = {n}, r = {r}");
        }
        let few = lowest_modes(&k, &m, 10).unwrap();
        for (a, b) in few.eigenvalues.iter().zip(&modes.eigenvalues) {
            assert!((a / b - 1.0).abs() < 1e-12);
        }
        assert_modes(&k, &m, &few);
        let φ = column(&few.vectors, 3);
        let kφ = multiply(&k, φ);
        assert!(kφ.iter().step_by(2).all(|f| f.abs() < 1e-13 * φ.iter().fold(0.0_f64, |l, v| l.max(v.abs()))));
    }
}

#[test]
fn repeated_eigenvalues_are_all_found() {
    for n in [100, 700] {
        // Three equal chains that do not touch.
        let (one_k, one_m) = chain(n, false, |_| 1.0);
        let thrice = |a: &SparseMatrix| {
            let entries: Vec<_> =
                (0..3).flat_map(|c| triplets(a).map(move |(i, j, v)| (i + c * n, j + c * n, v))).collect();
            sparse_from_triplets(3 * n, 3 * n, &entries).unwrap()
        };
        let (k, m) = (thrice(&one_k), thrice(&one_m));
        let modes = lowest_modes(&k, &m, 14).unwrap();
        for (i, λ) in modes.eigenvalues.iter().enumerate() {
            assert!((λ / held_chain(n, i / 3 + 1) - 1.0).abs() < 1e-11, "n = {n}, i = {i}: {λ}");
        }
        assert_modes(&k, &m, &modes);
    }
}

/// Masses that move with the mean of the ends of their element: a motion that alternates from node to node has no mass,
/// although every node has.
#[test]
fn a_mass_matrix_without_a_zero_on_its_diagonal_may_be_singular() {
    for n in [4, 21, 60] {
        let (k, _) = chain(n, true, |_| 1.0);
        let entries = (1..n).flat_map(|i| [(i - 1, i - 1), (i - 1, i), (i, i - 1), (i, i)]).map(|(i, j)| (i, j, 0.25));
        let m = sparse_from_triplets(n, n, &entries.collect::<Vec<_>>()).unwrap();
        let modes = lowest_modes(&k, &m, n).unwrap();
        // λ = 4 tan²(r π / 2 (n − 1)) of the rod of n − 1 such elements.
        for r in 1..n - 1 {
            let expected = 4.0 * (r as f64 * std::f64::consts::FRAC_PI_2 / (n - 1) as f64).tan().powi(2);
            let off = modes.eigenvalues[r] / expected - 1.0;
            assert!(off.abs() < 1e-10, "n = {n}, r = {r}: {off:e}");
        }
    }
}

#[test]
fn results_are_the_same_in_every_run() {
    let (k, m) = chain(800, false, |i| 1.0 + (i % 5) as f64);
    let (a, b) = (lowest_modes(&k, &m, 9).unwrap(), lowest_modes(&k, &m, 9).unwrap());
    assert_eq!((a.eigenvalues, a.vectors), (b.eigenvalues, b.vectors));
}

#[test]
fn improper_pencils_are_refused() {
    let (k, m) = chain(3, false, |_| 1.0);
    let (_, small) = chain(2, false, |_| 1.0);
    let error = lowest_modes(&k, &small, 1).unwrap_err();
    assert_eq!(error, LinalgError::Dimension { what: "mass matrix", expected: 3, found: 2 });
    let lopsided = sparse_from_triplets(3, 3, &[(0, 0, 1.0), (1, 1, 1.0), (2, 2, 1.0), (0, 1, 0.5)]).unwrap();
    assert!(matches!(lowest_modes(&k, &lopsided, 1), Err(LinalgError::NotSymmetric { row: 0, column: 1, .. })));
    let negative = add_scaled(&m, -2.0, &m).unwrap();
    assert!(matches!(lowest_modes(&negative, &m, 1), Err(LinalgError::NotPositiveDefinite { .. })));
    assert!(lowest_modes(&k, &m, 0).unwrap().eigenvalues.is_empty());
}

/// Unit masses on a cube of `n`³ nodes, each joined to its neighbours and to walls all around by unit springs, `copies`
/// times.
fn cubes(n: usize, copies: usize, stiffness: f64, mass: f64) -> (SparseMatrix, SparseMatrix) {
    let size = n.pow(3) * copies;
    let step = |i: usize, axis: u32| (i / n.pow(axis) % n + 1 < n).then(|| i + n.pow(axis));
    let entries = (0..size).flat_map(|i| {
        let sides = (0..3).filter_map(move |axis| step(i, axis));
        let coupled = sides.flat_map(move |j| [(i, j, -stiffness), (j, i, -stiffness)]);
        std::iter::once((i, i, 6.0 * stiffness)).chain(coupled)
    });
    let k = sparse_from_triplets(size, size, &entries.collect::<Vec<_>>()).unwrap();
    (k, sparse_from_triplets(size, size, &(0..size).map(|i| (i, i, mass)).collect::<Vec<_>>()).unwrap())
}

/// `λ = Σ 4 sin²(r_i π / (2n + 2))` of the cube, ascending: most of them three or six times.
fn cube_values(n: usize, copies: usize) -> Vec<f64> {
    let one = |r: usize| 4.0 * (r as f64 * std::f64::consts::PI / (2 * n + 2) as f64).sin().powi(2);
    let all = (1..=n).flat_map(|a| (1..=n).flat_map(move |b| (1..=n).map(move |c| one(a) + one(b) + one(c))));
    let mut values: Vec<f64> = all.flat_map(|value| vec![value; copies]).collect();
    values.sort_by(f64::total_cmp);
    values
}

#[test]
fn repeated_eigenvalues_of_solids_are_all_found_in_any_units() {
    // Two cubes have each λ up to twelve times: more often than a block has vectors. The last requested mode may be one
    // of several equal ones.
    for (n, copies, counts) in [(13, 1, [10, 41]), (12, 2, [3, 30])] {
        let expected = cube_values(n, copies);
        for (stiffness, mass) in [(1.0, 1.0), (2.1e8, 7.8e-12)] {
            let (k, m) = cubes(n, copies, stiffness, mass);
            let pencil = Pencil::new(&k, &m).unwrap();
            assert!(pencil.factor().has_dense_blocks());
            for count in counts {
                let modes = pencil.lowest(count).unwrap();
                assert_eq!(modes.eigenvalues.len(), count);
                for (i, λ) in modes.eigenvalues.iter().enumerate() {
                    let off = λ * mass / stiffness / expected[i] - 1.0;
                    assert!(off.abs() < 1e-12, "{copies} of {n}, mode {i} of {count}: {off:e}");
                }
                assert_modes(&k, &m, &modes);
            }
        }
    }
}

#[test]
fn solids_that_float_and_masses_of_few_nodes_come_out_of_blocks_too() {
    // Without walls: λ = Σ 4 sin²(r_i π / 2n), r_i = 0, 1 …
    let n = 12;
    let (held, m) = cubes(n, 1, 1.0, 1.0);
    let at_wall = |i: usize| (0..3).filter(|&axis| [0, n - 1].contains(&(i / n.pow(axis) % n))).count() as f64;
    let walls: Vec<_> = (0..n.pow(3)).map(|i| (i, i, at_wall(i))).collect();
    let k = add_scaled(&held, -1.0, &sparse_from_triplets(n.pow(3), n.pow(3), &walls).unwrap()).unwrap();
    let modes = lowest_modes(&k, &m, 12).unwrap();
    let first = free_chain(n, 1);
    let expected = [0.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 3.0].map(|times| times * first);
    for (λ, expected) in modes.eigenvalues.iter().zip(expected) {
        assert!((λ - expected).abs() < 1e-11 * first, "{λ} {expected}");
    }
    assert_modes(&k, &m, &modes);
    // Five masses: five modes, however many are requested.
    let few: Vec<_> = (0..5).map(|i| (300 * i + 7, 300 * i + 7, 1.0 + i as f64)).collect();
    let m = sparse_from_triplets(n.pow(3), n.pow(3), &few).unwrap();
    let modes = lowest_modes(&held, &m, 9).unwrap();
    assert_eq!(modes.eigenvalues.len(), 5);
    assert_modes(&held, &m, &modes);
}

#[test]
fn modes_are_the_same_to_the_last_bit_with_any_number_of_threads() {
    let (k, m) = chain(200_000, false, |i| 1.0 + 0.1 * (i % 3) as f64);
    let modes = |helpers: usize| crate::threads::tests::with_helpers(helpers, || lowest_modes(&k, &m, 3).unwrap());
    let alone = modes(0);
    for together in [modes(1), modes(3)] {
        assert_eq!(together.eigenvalues, alone.eigenvalues);
        assert!(together.vectors == alone.vectors);
    }
}

/// Digits of a text: what is read is not what was computed.
fn cut(a: &SparseMatrix, digits: usize) -> SparseMatrix {
    let entries: Vec<_> =
        triplets(a).map(|(i, j, v)| (i, j, format!("{v:.*e}", digits - 1).parse().unwrap())).collect();
    sparse_from_triplets(a.nrows(), a.ncols(), &entries).unwrap()
}

/// A bar of `n` uneven elements with density and modulus one, lumped; free, or held at its first node.
fn bar(n: usize, unit: f64, held: bool) -> (SparseMatrix, SparseMatrix) {
    let length = |e: usize| 1.0 + 0.3 * ((e * 37 % 11) as f64 / 11.0 - 0.5) * std::f64::consts::FRAC_1_SQRT_2;
    let (mut k, mut m) = (Vec::new(), Vec::new());
    for e in 0..n {
        let stiffness = unit / length(e);
        k.extend([(e, e, stiffness), (e + 1, e + 1, stiffness), (e, e + 1, -stiffness), (e + 1, e, -stiffness)]);
        m.extend([(e, e, 0.5 * length(e)), (e + 1, e + 1, 0.5 * length(e))]);
    }
    let k = sparse_from_triplets(n + 1, n + 1, &k).unwrap();
    let m = sparse_from_triplets(n + 1, n + 1, &m).unwrap();
    let free: Vec<usize> = (usize::from(held)..=n).collect();
    (select(&k, &free, &free).unwrap(), select(&m, &free, &free).unwrap())
}

#[test]
fn a_motion_that_strains_nothing_is_found_whatever_the_last_digits_are() {
    for digits in [6, 8, 10, 14] {
        for unit in [1.0, 2.1e11, 7e-3] {
            for n in [12, 45, 200] {
                let (k, m) = bar(n, unit, false);
                let (k, m) = (cut(&k, digits), cut(&m, digits));
                let known = [Digits::Decimal(digits as u32); 2];
                let pencil = Pencil::known_to(&k, &m, known).unwrap();
                let modes = pencil.lowest(6).unwrap();
                assert_eq!(pencil.openness(&modes).strainless, 1, "{digits} digits, {unit}, {n}");
                assert!(pencil.shift() > 0.0);
                let (exact_k, exact_m) = bar(n, unit, false);
                let exact = lowest_modes(&exact_k, &exact_m, 6).unwrap();
                let open = pencil.openness(&modes).deviations;
                for (r, open) in open.iter().enumerate().take(6).skip(1) {
                    let (found, exact) = (modes.eigenvalues[r], exact.eigenvalues[r]);
                    let off = (found - exact).abs();
                    assert!(off < 5.0 * open + 1e-9 * exact, "{digits}, {unit}, {n}: {off:e} {open:e}");
                }
            }
        }
    }
}

#[test]
fn what_the_digits_leave_open_is_what_they_change() {
    // Ten digits of ten random units: the mean square of the change is that which is predicted.
    for digits in [5, 7] {
        let (mut squares, mut count) = (0.0, 0);
        for unit in (1..40).map(|u| 1.0 + 0.173 * u as f64) {
            let (k, m) = bar(60, unit, true);
            let known = [Digits::Decimal(digits), Digits::DOUBLE];
            let rough = cut(&k, digits as usize);
            let pencil = Pencil::known_to(&rough, &m, known).unwrap();
            assert_eq!(pencil.shift(), 0.0);
            let (found, exact) = (pencil.lowest(3).unwrap(), lowest_modes(&k, &m, 3).unwrap());
            let open = pencil.openness(&found);
            assert_eq!(open.strainless, 0);
            squares += (0..3)
                .map(|r| ((found.eigenvalues[r] - exact.eigenvalues[r]) / open.deviations[r]).powi(2))
                .sum::<f64>();
            count += 3;
        }
        let mean = squares / f64::from(count);
        assert!((0.5..2.0).contains(&mean), "{digits}: {mean}");
    }
}

/// Masses in pairs on one spring to their neighbours: what moves the two of the first pair against each other has
/// neither stiffness nor mass.
#[test]
fn motions_with_neither_stiffness_nor_mass_are_found_and_held() {
    for (unit, weight) in [(1.0, 1.0), (2.1e11, 7.8e3), (3e-3, 1e-9)] {
        let (inner_k, inner_m) = bar(30, unit, true);
        // Rows 0 and 1 of the wide pencil are a third and two thirds of the first of the narrow one.
        let n = inner_k.nrows();
        let part = |i: usize| if i == 0 { vec![(0, 0.3), (1, 0.7)] } else { vec![(i + 1, 1.0)] };
        let wide = |a: &SparseMatrix, factor: f64| {
            let entries: Vec<_> = triplets(a)
                .flat_map(|(i, j, v)| {
                    part(i)
                        .into_iter()
                        .flat_map(move |(p, a)| part(j).into_iter().map(move |(q, b)| (p, q, factor * v * a * b)))
                })
                .collect();
            cut(&sparse_from_triplets(n + 1, n + 1, &entries).unwrap(), 14)
        };
        let (k, m) = (wide(&inner_k, 1.0), wide(&inner_m, weight));
        let digits = [Digits::Decimal(14); 2];
        let refused = Pencil::known_to(&k, &m, digits).map(|pencil| pencil.shift());
        assert_eq!(refused, Err(LinalgError::NeitherStiffnessNorMass { motions: 1 }));
        let common = CommonMotions::of(&k, &m, &digits.into()).unwrap();
        assert_eq!(common.len(), 1);
        assert!((common.shapes[(0, 0)] * 0.3 / (common.shapes[(1, 0)] * 0.7) + 1.0).abs() < 1e-6);
        let held = common.held(&k).unwrap();
        let found = Pencil::known_to(&held, &m, digits).unwrap().lowest(5).unwrap();
        let exact = lowest_modes(&inner_k, &inner_m, 5).unwrap();
        for r in 0..5 {
            let off = found.eigenvalues[r] * weight / exact.eigenvalues[r] - 1.0;
            assert!(off.abs() < 1e-9, "{unit:e} {r}: {off:e}");
        }
        let directions = sparse_from_triplets(n + 1, 3, &[(5, 0, 1.0), (0, 1, 0.3), (1, 1, 0.7), (0, 2, 1.0)]).unwrap();
        assert_eq!(common.felt_by(&directions), Some(2));
    }
}

/// A bar that floats on springs too soft for the digits of its stiffness is not said to be free: it is seen that
/// something holds it, or the frequency is reported below which that does not show.
#[test]
fn a_bar_on_soft_springs_is_not_taken_for_a_free_one() {
    let digits = [Digits::Decimal(10); 2];
    let (mut held, mut unseen) = (0, 0);
    for n in 30..36 {
        let (free, m) = bar(n, 1.0 + 0.173 * n as f64, false);
        let mass: f64 = triplets(&m).map(|(_, _, v)| v).sum();
        let rough = cut(&free, 10);
        let pencil = Pencil::known_to(&rough, &m, digits).unwrap();
        let deviation = pencil.openness(&pencil.lowest(2).unwrap()).deviations[0];
        for square in (1..25).map(|k| 0.5 * f64::from(k) * deviation) {
            // Springs at both ends, on which the bar bounces with this ω².
            let soft = |i: usize, j: usize| i == j && (i == 0 || i + 1 == free.nrows());
            let with = |(i, j, v)| (i, j, if soft(i, j) { v + 0.5 * square * mass } else { v });
            let entries: Vec<_> = triplets(&free).map(with).collect();
            let k = cut(&sparse_from_triplets(free.nrows(), free.ncols(), &entries).unwrap(), 10);
            let pencil = Pencil::known_to(&k, &m, digits).unwrap();
            let open = pencil.openness(&pencil.lowest(4).unwrap());
            if open.strainless == 0 {
                held += 1;
                continue;
            }
            assert_eq!(open.strainless, 1);
            assert!(square < 1.6 * open.unseen, "{n}: {square:e} for {:e}", open.unseen);
            unseen += 1;
        }
    }
    assert!(held > 20 && unseen > 20, "{held} {unseen}");
}

/// Equal elements are cut off alike, so that a free bar has no stiffness at all; springs at each node of less than half
/// a unit of the last digit leave these digits as they are, and their frequency is below what is reported not to show.
#[test]
fn springs_that_the_last_digit_swallows_are_below_what_is_said_not_to_show() {
    let (n, stiffness) = (40, 1.0 / 3.0);
    let springs = |of: f64| -> SparseMatrix {
        let end = |i: usize| if i == 0 || i == n - 1 { 1.0 } else { 2.0 };
        let diagonal = (0..n).map(|i| (i, i, end(i) * stiffness + of));
        let beside = (1..n).flat_map(|i| [(i, i - 1, -stiffness), (i - 1, i, -stiffness)]);
        sparse_from_triplets(n, n, &diagonal.chain(beside).collect::<Vec<_>>()).unwrap()
    };
    let m = sparse_from_triplets(n, n, &(0..n).map(|i| (i, i, 1.0)).collect::<Vec<_>>()).unwrap();
    for digits in [6_usize, 8, 10] {
        let soft = 0.1 * 10f64.powi(-(digits as i32));
        let written = cut(&springs(soft), digits);
        assert!(triplets(&written).eq(triplets(&cut(&springs(0.0), digits))), "{digits}");
        let pencil = Pencil::known_to(&written, &m, [Digits::Decimal(digits as u32), Digits::DOUBLE]).unwrap();
        let open = pencil.openness(&pencil.lowest(3).unwrap());
        assert_eq!(open.strainless, 1);
        assert!(soft < open.unseen && open.unseen < 100.0 * soft, "{digits}: {soft:e} {:e}", open.unseen);
    }
}

/// Bars apart, each a little stiffer than the one before, have as many motions at zero and nothing else twice: none of
/// them is missed, however many modes are asked for.
#[test]
fn no_mode_of_a_multiple_eigenvalue_is_missed() {
    let (bars, n) = (6, 40);
    let entries = |of: usize| -> Vec<(usize, usize, f64)> {
        let one = |c: usize| {
            let (k, m) = bar(n - 1, 1.0 + 0.217 * c as f64, false);
            let (a, at) = (if of == 0 { k } else { m }, c * n);
            triplets(&a).map(|(i, j, v)| (at + i, at + j, v)).collect::<Vec<_>>()
        };
        (0..bars).flat_map(one).collect()
    };
    let of = |k: usize| sparse_from_triplets(bars * n, bars * n, &entries(k)).unwrap();
    let (k, m) = (of(0), of(1));
    let exact = Pencil::known_to(&k, &m, [Digits::DOUBLE; 2]).unwrap().lowest(bars * n).unwrap().eigenvalues;
    for shift in (0..6).map(|i| exact[bars] * (0.3 + 0.35 * f64::from(i))) {
        let pencil = Pencil::shifted(&k, &m, shift, None).unwrap();
        for count in 7..30 {
            let found = pencil.solve(count).unwrap().eigenvalues;
            assert_eq!(found.len(), count);
            let off = |(λ, exact): (&f64, &f64)| (λ - exact).abs() > 1e-8 * exact + 1e-6 * shift;
            assert!(!found.iter().zip(&exact).any(off), "{count} modes: {found:?}");
        }
    }
}

/// A free bar of pairs of points on stiff springs, written point by point to 14 digits: of the means and differences of
/// the pairs, the means are small differences of large entries. What is written tells that the bar floats, and how far
/// its other modes are known.
#[test]
fn digits_are_those_of_what_was_written() {
    for n in [12, 45, 80] {
        let (narrow, light) = bar(n - 1, 1.0 / 3.0, false);
        let stiff = |i: usize| 1e6 * (1.0 + 0.3 * (1.9 * i as f64).sin());
        let half = triplets(&narrow).flat_map(|(i, j, v)| {
            let points = move |a: usize| [2 * a, 2 * a + 1];
            points(i).into_iter().flat_map(move |p| points(j).into_iter().map(move |q| (p, q, 0.25 * v)))
        });
        let pairs = (0..n).flat_map(|i| {
            let (p, q, s) = (2 * i, 2 * i + 1, stiff(i));
            [(p, p, s), (q, q, s), (p, q, -s), (q, p, -s)]
        });
        let stiffness = cut(&sparse_from_triplets(2 * n, 2 * n, &half.chain(pairs).collect::<Vec<_>>()).unwrap(), 14);
        let mass: Vec<_> = (0..2 * n).map(|p| (p, p, 0.5 * diagonal(&light, p / 2))).collect();
        let mass = sparse_from_triplets(2 * n, 2 * n, &mass).unwrap();
        // The points of a pair are its mean less or plus half of the difference.
        let motion: Vec<_> =
            (0..2 * n).flat_map(|p| [(p, p / 2, 1.0), (p, n + p / 2, if p % 2 == 0 { -0.5 } else { 0.5 })]).collect();
        let motion = sparse_from_triplets(2 * n, 2 * n, &motion).unwrap();
        let made = |a: &SparseMatrix| {
            let dense = |a: &SparseMatrix| {
                let mut full = Mat::<f64>::zeros(a.nrows(), a.ncols());
                triplets(a).for_each(|(i, j, v)| full[(i, j)] += v);
                full
            };
            let product = dense(&motion).transpose() * dense(a) * dense(&motion);
            let entries = (0..2 * n).flat_map(|i| (0..2 * n).map(move |j| (i, j)));
            let entry = |(i, j): (usize, usize)| (i, j, 0.5 * (product[(i, j)] + product[(j, i)]));
            let entries: Vec<_> = entries.map(entry).filter(|entry| entry.2 != 0.0).collect();
            sparse_from_triplets(2 * n, 2 * n, &entries).unwrap()
        };
        let (k, m) = (made(&stiffness), made(&mass));
        let digits = [Digits::Decimal(14); 2];
        let written = Written { digits, origin: Some(Arc::new(Origin { stiffness, mass, motion })) };
        let found = |written: Written| {
            let pencil = Pencil::known_to(&k, &m, written).unwrap();
            let modes = pencil.lowest(4).unwrap();
            (pencil.openness(&modes), modes.eigenvalues)
        };
        let (open, squares) = found(written);
        assert_eq!(open.strainless, 1, "{n}");
        assert_eq!(found(digits.into()).0.strainless, 0, "{n}: the entries of the means do not tell");
        let exact = lowest_modes(&narrow, &light, 4).unwrap().eigenvalues;
        for r in 1..4 {
            let (off, open) = ((squares[r] - exact[r]).abs(), open.deviations[r]);
            assert!(off < 5.0 * open && open < 1e-4 * exact[r], "{n} {r}: {off:e} {open:e}");
        }
    }
}

/// A bar of pairs of points that have mass in their weighted mean alone, on springs between them: every diagonal entry
/// of the mass is positive, half of the motions have none. There are as many modes as means, however many are asked
/// for, and their shapes have the energy that belongs to λ.
#[test]
fn motions_without_mass_are_neither_modes_nor_mixed_into_them() {
    for held in [true, false] {
        for n in [8, 14] {
            let (narrow, light) = bar(n, 1.0 / 3.0, held);
            let order = narrow.nrows();
            let part = |i: usize| [(2 * i, 0.3), (2 * i + 1, 0.7)];
            let wide = |a: &SparseMatrix, springs: f64| {
                let of = |(i, j, v): (usize, usize, f64)| {
                    part(i).into_iter().flat_map(move |(p, a)| part(j).into_iter().map(move |(q, b)| (p, q, v * a * b)))
                };
                let between = (0..order).flat_map(|i| {
                    let (p, q, s) = (2 * i, 2 * i + 1, springs * (1.0 + 0.3 * (1.9 * i as f64).sin()));
                    [(p, p, s), (q, q, s), (p, q, -s), (q, p, -s)]
                });
                let entries: Vec<_> = triplets(a).flat_map(of).chain(between).filter(|entry| entry.2 != 0.0).collect();
                sparse_from_triplets(2 * order, 2 * order, &entries).unwrap()
            };
            let (k, m) = (wide(&narrow, 1e3), wide(&light, 0.0));
            let exact = lowest_modes(&narrow, &light, order).unwrap().eigenvalues;
            let pencil = Pencil::new(&k, &m).unwrap();
            for count in [order / 2, order - 1, order, order + 3, 2 * order] {
                let found = pencil.lowest(count).unwrap();
                assert_eq!(found.eigenvalues.len(), count.min(order), "{held} {n} {count}");
                for (r, λ) in found.eigenvalues.iter().enumerate() {
                    let size = exact[r] + pencil.shift();
                    assert!((λ - exact[r]).abs() < 1e-9 * size, "{held} {n} {count} {r}: {λ} {}", exact[r]);
                    let shape: Vec<f64> = found.vectors.col(r).iter().copied().collect();
                    let energy: f64 = shape.iter().zip(multiply(&k, &shape)).map(|(a, b)| a * b).sum();
                    assert!((energy - exact[r]).abs() < 1e-6 * size, "{held} {n} {count} {r}: {energy} {}", exact[r]);
                }
            }
        }
    }
}
