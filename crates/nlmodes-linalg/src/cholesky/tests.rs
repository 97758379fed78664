use super::*;
use crate::threads::tests::with_helpers;
use crate::{max_norm, multiply, sparse_from_triplets};

/// Springs between all neighbouring nodes of a cube of `n`³, with weak springs to ground: dense blocks.
fn solid(n: usize) -> SparseMatrix {
    let near = |x: usize| x.saturating_sub(1)..(x + 2).min(n);
    let mut entries = Vec::new();
    for (x, y, z) in (0..n.pow(3)).map(|i| (i / n / n, i / n % n, i % n)) {
        let around = near(x).flat_map(|u| near(y).flat_map(move |v| near(z).map(move |w| (u * n + v) * n + w)));
        let own = (x * n + y) * n + z;
        entries.extend(around.map(|other| (own, other, if own == other { 26.5 } else { -1.0 })));
    }
    sparse_from_triplets(n.pow(3), n.pow(3), &entries).unwrap()
}

/// Stiffness of `n` unit springs in a row; the first end is fixed if `ground` is one.
fn chain(n: usize, ground: f64) -> SparseMatrix {
    let mut entries = vec![(0, 0, ground)];
    for i in 1..n {
        entries.extend([(i - 1, i - 1, 1.0), (i, i, 1.0), (i - 1, i, -1.0), (i, i - 1, -1.0)]);
    }
    sparse_from_triplets(n, n, &entries).unwrap()
}

/// Five-point stencil on a grid: enough fill for supernodes.
fn grid(n: usize) -> SparseMatrix {
    let mut entries = Vec::new();
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        let at = |i: usize, j: usize| i * n + j;
        entries.push((at(i, j), at(i, j), 4.0));
        if i + 1 < n {
            entries.extend([(at(i, j), at(i + 1, j), -1.0), (at(i + 1, j), at(i, j), -1.0)]);
        }
        if j + 1 < n {
            entries.extend([(at(i, j), at(i, j + 1), -1.0), (at(i, j + 1), at(i, j), -1.0)]);
        }
    }
    sparse_from_triplets(n * n, n * n, &entries).unwrap()
}

#[test]
fn solution_reproduces_the_right_hand_side() {
    for a in [chain(1, 2.0), chain(37, 1.0), grid(30)] {
        let n = a.nrows();
        let factor = SparseCholesky::factor(&a, "test matrix").unwrap();
        let b: Vec<f64> = (0..n).map(|i| ((7 * i) % 11) as f64 - 5.0).collect();
        let mut x = b.clone();
        factor.solve_in_place(&mut x);
        assert!(multiply(&a, &x).iter().zip(&b).all(|(l, r)| (l - r).abs() < 1e-10));
        let mut both = Mat::from_fn(n, 2, |i, j| b[i] * (1 + j) as f64);
        factor.solve_many(&mut both);
        assert!((0..n).all(|i| (both[(i, 1)] - 2.0 * x[i]).abs() < 1e-9));
    }
}

#[test]
fn two_half_solutions_in_the_order_of_elimination_make_a_whole_one() {
    for (a, blocks) in [(chain(37, 1.0), false), (grid(30), false), (solid(9), true)] {
        let n = a.nrows();
        let factor = SparseCholesky::factor(&a, "test matrix").unwrap();
        assert_eq!(factor.has_dense_blocks(), blocks);
        let (order, b) = (factor.order(), Mat::from_fn(n, 3, |i, j| ((7 * i + j) % 11) as f64 - 5.0));
        let mut half = Mat::from_fn(n, 3, |k, j| b[(order[k], j)]);
        factor.forward(half.as_mut());
        // bᵀ A⁻¹ b, from the forward and from the full solution.
        let mut x = b.clone();
        factor.solve_many(&mut x);
        let (form, expected) = (half.transpose() * &half, b.transpose() * &x);
        assert!((0..9).all(|i| (form[(i / 3, i % 3)] - expected[(i / 3, i % 3)]).abs() < 1e-11 * expected[(0, 0)]));
        factor.backward(half.as_mut());
        let size = max_norm(x.col(0).iter().copied());
        assert!((0..n).all(|k| (0..3).all(|j| (half[(k, j)] - x[(order[k], j)]).abs() < 1e-12 * size)));
    }
}

/// The bits of all of these numbers.
fn bits(x: &Mat<f64>) -> Vec<u64> {
    x.col_iter().flat_map(|column| column.iter().map(|v| v.to_bits()).collect::<Vec<_>>()).collect()
}

#[test]
fn factor_and_solutions_are_the_same_to_the_last_bit_with_any_number_of_threads() {
    let a = solid(26);
    let plan = CholeskyPlan::new(&a, "test matrix").unwrap();
    let Kind::Blocks(blocks) = &plan.kind else { panic!("dense blocks") };
    assert!(blocks.panels.subtrees.parts.len() > 1);
    let b = Mat::from_fn(a.nrows(), 5, |i, j| ((7 * i + j) % 11) as f64 - 5.0);
    let s = sparse_from_triplets(a.nrows(), 2, &[(17, 0, 1.0), (5000, 1, 2.0), (40, 1, -1.0)]).unwrap();
    let with = |helpers: usize| {
        with_helpers(helpers, || {
            let factor = plan.factor(&a, "test matrix").unwrap();
            let (mut x, mut half) = (b.clone(), b.clone());
            factor.solve_many(&mut x);
            factor.forward(half.as_mut());
            let form = factor.inverse_form(&s, &b, &Mat::from_fn(5, 2, |i, j| (i + j) as f64));
            (factor.diagonal(), bits(&x), bits(&half), bits(&form))
        })
    };
    let alone = with(0);
    assert!([1, 2, 7].into_iter().all(|helpers| with(helpers) == alone));
    let mut x = b.clone();
    plan.factor(&a, "test matrix").unwrap().solve_many(&mut x);
    assert!((&b - a.as_ref() * &x).norm_max() < 1e-10);
}

#[test]
fn of_several_bad_pivots_the_first_is_named_with_any_number_of_threads() {
    let n = 26;
    let bad = |i: usize| [400, 3000, 8700, 17_000].contains(&i);
    let entries: Vec<_> =
        crate::triplets(&solid(n)).map(|(i, j, v)| (i, j, if i == j && bad(i) { -v } else { v })).collect();
    let a = sparse_from_triplets(n.pow(3), n.pow(3), &entries).unwrap();
    let column = |helpers: usize| with_helpers(helpers, || SparseCholesky::factor(&a, "test matrix").unwrap_err());
    let alone = column(0);
    assert!(matches!(alone, LinalgError::NotPositiveDefinite { column, .. } if bad(column)), "{alone}");
    assert!([1, 2, 7].into_iter().all(|helpers| column(helpers) == alone));
}

#[test]
fn pivots_multiply_to_the_determinant() {
    let log_det = |a: &SparseMatrix| {
        SparseCholesky::factor(a, "test matrix").unwrap().diagonal().iter().map(|l| 2.0 * l.ln()).sum::<f64>()
    };
    assert!(log_det(&chain(50, 1.0)).abs() < 1e-12);
    let dense = grid(12).to_dense().self_adjoint_eigenvalues(Side::Lower).unwrap();
    let expected: f64 = dense.iter().map(|v| v.ln()).sum();
    assert!((log_det(&grid(12)) - expected).abs() < 1e-10);
}

#[test]
fn singular_and_indefinite_matrices_are_refused_with_the_column() {
    for n in [2, 10, 200] {
        let error = SparseCholesky::factor(&chain(n, 0.0), "stiffness matrix").unwrap_err();
        assert!(matches!(error, LinalgError::NotPositiveDefinite { what: "stiffness matrix", .. }), "{error}");
    }
    let entries = [(0, 0, 1.0), (1, 1, 1.0), (2, 2, -1.0)];
    let error = SparseCholesky::factor(&sparse_from_triplets(3, 3, &entries).unwrap(), "diagonal").unwrap_err();
    assert_eq!(error, LinalgError::NotPositiveDefinite { what: "diagonal", column: 2 });
}

#[test]
fn misshapen_matrices_are_refused() {
    for (rows, columns) in [(2, 3), (0, 0)] {
        let a = sparse_from_triplets(rows, columns, &[]).unwrap();
        assert!(matches!(SparseCholesky::factor(&a, "a"), Err(LinalgError::Dimension { .. })));
    }
}

#[test]
fn refactoring_keeps_the_pattern() {
    let mut factor = SparseCholesky::factor(&chain(5, 1.0), "chain").unwrap();
    factor.refactor(&chain(5, 2.0), "chain").unwrap();
    let mut x = [0.0, 0.0, 0.0, 0.0, 1.0];
    factor.solve_in_place(&mut x);
    assert!((x[4] - 4.5).abs() < 1e-14);
}
