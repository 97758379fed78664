//! Properties of every backend for any positive semidefinite matrix.

use nlmodes_contact::{ActiveSet, Clarabel, LcpError, LcpMatrix, LcpSolver, Lemke, Mat, Proximal};
use proptest::prelude::*;

fn backends() -> Vec<Box<dyn LcpSolver>> {
    vec![
        Box::new(ActiveSet::default()),
        Box::new(ActiveSet { sweeps: 0, patience: 0, ..ActiveSet::default() }),
        Box::new(Lemke::default()),
        Box::new(Clarabel::default()),
        Box::new(Proximal { max_iterations: 2000, ..Proximal::default() }),
    ]
}

/// `A = G Gᵀ` of any rank from small integers, so that dependent contacts and degenerate pairs are frequent, and b.
fn integers() -> impl Strategy<Value = (Mat<f64>, Vec<f64>)> {
    (1usize..7, 1usize..7).prop_flat_map(|(c, rank)| {
        let entries = prop::collection::vec(-2i8..=2, c * rank);
        (entries, prop::collection::vec(-3i8..=3, c)).prop_map(move |(g, b)| {
            let dot =
                |i: usize, j: usize| (0..rank).map(|k| f64::from(g[i * rank + k]) * f64::from(g[j * rank + k])).sum();
            (Mat::from_fn(c, c, dot), b.into_iter().map(f64::from).collect())
        })
    })
}

/// The same with real numbers in units that are far apart.
fn reals() -> impl Strategy<Value = (Mat<f64>, Vec<f64>)> {
    (1usize..9, 1usize..9).prop_flat_map(|(c, rank)| {
        let entries = prop::collection::vec(-1.0..1.0f64, c * rank);
        let units = prop::collection::vec(-8i32..8, c);
        (entries, prop::collection::vec(-1.0..1.0f64, c), units).prop_map(move |(g, b, units)| {
            let unit = |i: usize| 10f64.powi(units[i]);
            let dot = |i: usize, j: usize| (0..rank).map(|k| g[i * rank + k] * g[j * rank + k]).sum::<f64>();
            let a = Mat::from_fn(c, c, |i, j| dot(i.min(j), i.max(j)) * unit(i) * unit(j));
            (a, b.iter().enumerate().map(|(i, b)| b * unit(i)).collect())
        })
    })
}

/// Solution or typed error, never a silent wrong result. True if solved, false if proven to have no solution, `None` if
/// rejected.
fn is_solved_or_named(
    solver: &dyn LcpSolver,
    a: &LcpMatrix,
    b: &[f64],
    guess: bool,
) -> Result<Option<bool>, TestCaseError> {
    let (mut closed, mut lambda) = (vec![guess; b.len()], vec![0.0; b.len()]);
    match solver.workspace(a).unwrap().solve(b, &mut closed, &mut lambda) {
        Ok(statistics) => {
            prop_assert!(statistics.violation <= 1e-10 && a.violation(b, &lambda) <= 1e-10);
            prop_assert!(lambda.iter().zip(&closed).all(|(l, closed)| *l == 0.0 || (*l > 0.0 && *closed)));
            Ok(Some(true))
        }
        Err(LcpError::Infeasible { ray }) => {
            let mut image = vec![0.0; b.len()];
            a.gaps(&vec![0.0; b.len()], &ray, &mut image).unwrap();
            let work: f64 = b.iter().zip(&ray).map(|(b, z)| b * z).sum();
            prop_assert!(work < 0.0 && ray.iter().all(|z| *z >= 0.0));
            prop_assert!(image.iter().zip(&ray).all(|(i, z)| (i * z).abs() <= 1e-6 * work.abs() * ray.len() as f64));
            Ok(Some(false))
        }
        Err(LcpError::NotConverged { violation, .. }) => {
            // Backends use half of the judge's limit, so that 1e-10 holds for any order of summation.
            prop_assert!(violation > 0.5e-10);
            Ok(None)
        }
        Err(LcpError::Rounding { violation, rounding, lambda, .. }) => {
            prop_assert!(rounding > 0.5e-10 && violation <= rounding && lambda.iter().all(|l| *l >= 0.0));
            Ok(None)
        }
        Err(other) => Err(TestCaseError::fail(format!("{}: {other}", solver.name()))),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn integer_problems_are_solved_or_named((a, b) in integers(), guess: bool) {
        let a = LcpMatrix::new(&a).unwrap();
        // Forces of up to 1e8 may occur, which no rounded numbers verify; `tests/integers.rs` compares them with exact
        // ones.
        let (mut closed, mut lambda) = (vec![guess; b.len()], vec![0.0; b.len()]);
        let default = ActiveSet::default().workspace(&a).unwrap().solve(&b, &mut closed, &mut lambda);
        let is_named = matches!(default, Ok(_) | Err(LcpError::Infeasible { .. } | LcpError::Rounding { .. }));
        prop_assert!(is_named, "{:?}", default);
        let solved = is_solved_or_named(&ActiveSet::default(), &a, &b, guess)?;
        for solver in backends() {
            let other = is_solved_or_named(solver.as_ref(), &a, &b, guess)?;
            prop_assert!(other.is_none() || solved.is_none() || other == solved, "{}", solver.name());
        }
    }

    #[test]
    fn real_problems_are_solved_or_named((a, b) in reals(), guess: bool) {
        let a = LcpMatrix::new(&a).unwrap();
        for solver in backends() {
            is_solved_or_named(solver.as_ref(), &a, &b, guess)?;
        }
    }

    #[test]
    fn gaps_that_some_forces_open_are_solved_by_the_default(
        (a, b) in integers(),
        forces in prop::collection::vec(0i8..3, 6),
    ) {
        let c = b.len();
        // b = |b| − A f: the forces f leave the gaps |b|.
        let pressed = |i: usize| (0..c).map(|j| a[(i, j)] * f64::from(forces[j])).sum::<f64>();
        let b: Vec<f64> = (0..c).map(|i| b[i].abs() - pressed(i)).collect();
        let a = LcpMatrix::new(&a).unwrap();
        prop_assert_eq!(is_solved_or_named(&ActiveSet::default(), &a, &b, false)?, Some(true));
    }

    #[test]
    fn powers_of_two_in_the_units_change_no_bit(
        (a, b) in integers(),
        length in -40i32..40,
        force in -40i32..40,
        one in -20i32..20,
    ) {
        let unit = |e: i32| 2f64.powi(e);
        let c = b.len();
        // A contact without compliance has no scale of its own: it takes that of the others.
        let compliant = (0..c).all(|i| a[(i, i)] > 0.0);
        let own = |i: usize| if i == 0 && compliant { unit(one) } else { 1.0 };
        let other = Mat::from_fn(c, c, |i, j| a[(i, j)] * own(i) * own(j) * unit(length - force));
        let other_b: Vec<f64> = b.iter().enumerate().map(|(i, b)| b * own(i) * unit(length)).collect();
        let solve = |a: &Mat<f64>, b: &[f64]| {
            let (mut closed, mut lambda) = (vec![false; c], vec![0.0; c]);
            let mut workspace = ActiveSet::default().workspace(&LcpMatrix::new(a).unwrap()).unwrap();
            workspace.solve(b, &mut closed, &mut lambda).ok().map(|s| (lambda, closed, s.violation))
        };
        let (first, second) = (solve(&a, &b), solve(&other, &other_b));
        prop_assert_eq!(first.is_some(), second.is_some());
        if let (Some((lambda, closed, violation)), Some(other)) = (first, second) {
            let (other_lambda, other_closed, other_violation) = other;
            let back: Vec<f64> = other_lambda.iter().enumerate().map(|(i, l)| l * own(i) / unit(force)).collect();
            prop_assert_eq!(lambda, back);
            prop_assert_eq!(closed, other_closed);
            prop_assert_eq!(violation, other_violation);
        }
    }

    #[test]
    fn any_numbers_at_all_end_without_panic(
        entries in prop::collection::vec(any::<f64>(), 9),
        b in prop::collection::vec(any::<f64>(), 3),
        guess: bool,
    ) {
        let diagonal = |i: usize| entries[i * 4].abs();
        let diagonal = Mat::from_fn(3, 3, |i, j| if i == j { diagonal(i) } else { 0.0 });
        for a in [Mat::from_fn(3, 3, |i, j| entries[i * 3 + j]), diagonal] {
            let Ok(a) = LcpMatrix::new(&a) else { continue };
            for solver in backends() {
                let (mut closed, mut lambda) = (vec![guess; 3], vec![0.0; 3]);
                if solver.workspace(&a).unwrap().solve(&b, &mut closed, &mut lambda).is_ok() {
                    prop_assert!(a.violation(&b, &lambda) <= 1e-10, "{} {:?} {:?}", solver.name(), a, b);
                }
            }
        }
    }
}

#[test]
fn every_backend_refuses_what_is_not_finite_or_too_short() {
    let a = LcpMatrix::new(&Mat::from_fn(2, 2, |i, j| if i == j { 2.0 } else { 1.0 })).unwrap();
    for solver in backends() {
        let mut workspace = solver.workspace(&a).unwrap();
        let (mut closed, mut lambda) = ([false; 2], [0.0; 2]);
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let error = workspace.solve(&[bad, -1.0], &mut closed, &mut lambda).unwrap_err();
            assert_eq!(error, LcpError::NotFinite { what: "b" });
        }
        assert!(workspace.solve(&[1.0], &mut closed, &mut lambda).is_err());
        assert!(workspace.solve(&[1.0, 1.0], &mut closed[..1], &mut lambda).is_err());
        assert!(workspace.solve(&[1.0, 1.0], &mut closed, &mut lambda[..1]).is_err());
        assert!(workspace.gaps(&mut [0.0; 3]).is_err());
        assert!(workspace.solve(&[-1.0, 1.0], &mut closed, &mut lambda).is_ok());
    }
}

#[test]
fn a_problem_without_contacts_is_solved() {
    let a = LcpMatrix::new(&Mat::zeros(0, 0)).unwrap();
    for solver in backends() {
        assert!(solver.workspace(&a).unwrap().solve(&[], &mut [], &mut []).is_ok());
    }
}
