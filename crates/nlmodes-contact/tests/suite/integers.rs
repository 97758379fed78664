//! The default solver on millions of small integer problems. Too slow for every run: see CONTRIBUTING.

use nlmodes_contact::{ActiveSet, LcpError, LcpMatrix, LcpSolver, Mat};

/// Multiplicative congruential generator, scrambled.
struct Random(u64);

impl Random {
    /// Uniform in `0..n`.
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let mixed = (self.0 ^ (self.0 >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        (mixed >> 33) % n
    }

    fn integer(&mut self, largest: i64) -> i64 {
        self.below(2 * largest as u64 + 1) as i64 - largest
    }
}

/// `A = G Gᵀ` of any rank and `b`, integers.
fn problem(random: &mut Random) -> (Mat<f64>, Vec<f64>) {
    let (c, rank) = (1 + random.below(8) as usize, 1 + random.below(8) as usize);
    let largest = 1 + random.below(3) as i64;
    let g: Vec<i64> = (0..c * rank).map(|_| random.integer(largest)).collect();
    let entry = |i: usize, j: usize| (0..rank).map(|k| g[i * rank + k] * g[j * rank + k]).sum::<i64>() as f64;
    let b = (0..c).map(|_| random.integer(3) as f64).collect();
    (Mat::from_fn(c, c, entry), b)
}

/// Determinant, exact: elimination without fractions.
fn determinant(mut m: Vec<Vec<i128>>) -> i128 {
    let (n, mut sign, mut before) = (m.len(), 1, 1);
    for k in 0..n {
        let Some(pivot) = (k..n).find(|&i| m[i][k] != 0) else { return 0 };
        if pivot != k {
            m.swap(pivot, k);
            sign = -sign;
        }
        for i in k + 1..n {
            for j in k + 1..n {
                m[i][j] = (m[i][j] * m[k][k] - m[i][k] * m[k][j]) / before;
            }
        }
        before = m[k][k];
    }
    sign * before
}

/// The forces of the closed contacts by Cramer's rule, if they and the gaps are correct in exact arithmetic.
fn exact_forces(a: &Mat<f64>, b: &[f64], closed: &[bool]) -> Option<Vec<f64>> {
    let at = |i: usize, j: usize| a[(i, j)] as i128;
    let set: Vec<usize> = (0..b.len()).filter(|&i| closed[i]).collect();
    let block = |column: Option<usize>| {
        let entry = |i: usize, j: usize| if column == Some(j) { -b[i] as i128 } else { at(i, j) };
        determinant(set.iter().map(|&i| set.iter().map(|&j| entry(i, j)).collect()).collect())
    };
    let all = block(None);
    let mut forces = vec![0; b.len()];
    set.iter().for_each(|&j| forces[j] = block(Some(j)));
    let gap = |i: usize| b[i] as i128 * all + (0..b.len()).map(|j| at(i, j) * forces[j]).sum::<i128>();
    let right = all > 0 && forces.iter().all(|f| *f >= 0) && (0..b.len()).all(|i| gap(i) >= 0);
    right.then(|| forces.iter().map(|f| *f as f64 / all as f64).collect())
}

/// Solved, proven to have no solution, or rejected because the forces are so large that their rounding matters; then
/// they are exact to rounding. True in the last case.
fn check(solver: &ActiveSet, a: &Mat<f64>, b: &[f64], guess: bool) -> Result<bool, String> {
    let matrix = LcpMatrix::new(a).map_err(|e| e.to_string())?;
    let (mut closed, mut lambda) = (vec![guess; b.len()], vec![0.0; b.len()]);
    match solver.workspace(&matrix).map_err(|e| e.to_string())?.solve(b, &mut closed, &mut lambda) {
        Ok(_) | Err(LcpError::Infeasible { .. }) => Ok(false),
        Err(LcpError::Rounding { violation, rounding, lambda, .. }) => {
            let exact = exact_forces(a, b, &closed).ok_or("the closed contacts are wrong")?;
            let largest = exact.iter().fold(0.0, |m: f64, l| m.max(*l));
            // The error of the forces is the condition number of the closed block, about 1e9, times rounding.
            let close = lambda.iter().zip(&exact).all(|(l, e)| (l - e).abs() <= 1e-5 * largest);
            // Diagonals up to 72 and |b| up to 3 make 2e4 N scaled forces of 1e5 at least.
            if close && largest > 2e4 && violation <= rounding && rounding < 1e-5 {
                Ok(true)
            } else {
                Err(format!("violation {violation:e}, rounding {rounding:e}, {lambda:?}, exact {exact:?}"))
            }
        }
        Err(other) => Err(other.to_string()),
    }
}

/// Found among millions: regular closed blocks with a determinant near one and minors of a million.
#[test]
fn forces_too_large_to_be_verified_are_declined_for_that_reason() {
    let five: [&[f64]; 5] = [
        &[32.0, 6.0, -23.0, 2.0, -4.0],
        &[6.0, 27.0, -9.0, -1.0, -9.0],
        &[-23.0, -9.0, 28.0, 6.0, -9.0],
        &[2.0, -1.0, 6.0, 26.0, -21.0],
        &[-4.0, -9.0, -9.0, -21.0, 27.0],
    ];
    let eight: [&[f64]; 8] = [
        &[23.0, -4.0, -4.0, 7.0, -1.0, 5.0, -1.0, 0.0],
        &[-4.0, 35.0, -18.0, -7.0, -15.0, 12.0, 4.0, 3.0],
        &[-4.0, -18.0, 27.0, -8.0, 9.0, -15.0, 3.0, 5.0],
        &[7.0, -7.0, -8.0, 18.0, -7.0, -1.0, 7.0, -2.0],
        &[-1.0, -15.0, 9.0, -7.0, 16.0, 0.0, -12.0, -5.0],
        &[5.0, 12.0, -15.0, -1.0, 0.0, 22.0, -2.0, -13.0],
        &[-1.0, 4.0, 3.0, 7.0, -12.0, -2.0, 18.0, 1.0],
        &[0.0, 3.0, 5.0, -2.0, -5.0, -13.0, 1.0, 13.0],
    ];
    let singular: [&[f64]; 8] = [
        &[18.0, -3.0, 11.0, 13.0, -1.0, 1.0, 0.0, -1.0],
        &[-3.0, 32.0, -13.0, -23.0, 9.0, 0.0, -11.0, -7.0],
        &[11.0, -13.0, 16.0, 18.0, -6.0, 3.0, 11.0, -2.0],
        &[13.0, -23.0, 18.0, 26.0, -11.0, 2.0, 7.0, 3.0],
        &[-1.0, 9.0, -6.0, -11.0, 14.0, 9.0, 4.0, -8.0],
        &[1.0, 0.0, 3.0, 2.0, 9.0, 35.0, 8.0, -20.0],
        &[0.0, -11.0, 11.0, 7.0, 4.0, 8.0, 24.0, -8.0],
        &[-1.0, -7.0, -2.0, 3.0, -8.0, -20.0, -8.0, 15.0],
    ];
    let problems: [(&[&[f64]], &[f64]); 3] = [
        (&five, &[-2.0, -3.0, 1.0, 0.0, -2.0]),
        (&eight, &[3.0, -1.0, 0.0, 1.0, -3.0, 1.0, -2.0, 1.0]),
        (&singular, &[-3.0, -2.0, -3.0, 0.0, 2.0, 1.0, -3.0, -1.0]),
    ];
    let mut declined = 0;
    for (rows, b) in problems {
        let a = Mat::from_fn(b.len(), b.len(), |i, j| rows[i][j]);
        for guess in [false, true] {
            for solver in [ActiveSet::default(), ActiveSet { sweeps: 0, patience: 0, ..ActiveSet::default() }] {
                declined += usize::from(check(&solver, &a, b, guess).unwrap());
            }
        }
    }
    // Rounding may happen to be small enough for the first one, which is close to the limit.
    assert!(declined >= 8, "{declined}");
}

/// Dependent contacts whose forces grew until `b` was lost in `A λ`, so that the gaps came out as zero: there is no
/// solution.
#[test]
fn gaps_that_are_lost_in_rounding_prove_nothing() {
    let rows: [&[f64]; 5] = [
        &[6.0, 2.0, 0.0, 0.0, -5.0],
        &[2.0, 3.0, 0.0, -1.0, -5.0],
        &[0.0, 0.0, 0.0, 0.0, 0.0],
        &[0.0, -1.0, 0.0, 3.0, 1.0],
        &[-5.0, -5.0, 0.0, 1.0, 9.0],
    ];
    let (a, b) = (Mat::from_fn(5, 5, |i, j| rows[i][j]), [-1.0, 0.0, 0.0, 0.0, 0.0]);
    // A (2, 9, 0, 1, 6) = 0, and these forces do work on the gaps: no forces open them.
    let ray = [2.0, 9.0, 0.0, 1.0, 6.0];
    assert!((0..5).all(|i| (0..5).map(|j| rows[i][j] * ray[j]).sum::<f64>() == 0.0));
    let matrix = LcpMatrix::new(&a).unwrap();
    let huge: Vec<f64> = ray.iter().map(|r| r * 2f64.powi(60)).collect();
    assert!(matrix.violation(&b, &huge) > 1e-10);
    for guess in [false, true] {
        let (mut closed, mut lambda) = ([guess; 5], [0.0; 5]);
        let outcome = ActiveSet::default().workspace(&matrix).unwrap().solve(&b, &mut closed, &mut lambda);
        assert!(matches!(outcome, Err(LcpError::Infeasible { .. })), "{outcome:?}");
    }
}

/// `NLMODES_PROBLEMS`: number of problems; `NLMODES_SEED`: random seed.
#[test]
#[ignore = "takes minutes"]
fn the_default_declines_nothing_but_what_rounding_hides() {
    let setting = |name: &str, default: u64| std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default);
    let (problems, seed) = (setting("NLMODES_PROBLEMS", 1_000_000), setting("NLMODES_SEED", 1));
    let (mut random, mut wrong, mut declined) = (Random(seed), 0, 0);
    let solvers = [ActiveSet::default(), ActiveSet { sweeps: 0, patience: 0, ..ActiveSet::default() }];
    for number in 0..problems {
        let (a, b) = problem(&mut random);
        for (solver, guess) in [(&solvers[0], false), (&solvers[0], true), (&solvers[1], false)] {
            match check(solver, &a, &b, guess) {
                Ok(hidden) => declined += u64::from(hidden),
                Err(reason) => {
                    wrong += 1;
                    println!("{number} {solver:?} guess {guess}: {reason}\n  a = {a:?}\n  b = {b:?}");
                }
            }
        }
    }
    println!("{problems} problems, {declined} of {} solutions hidden by rounding", 3 * problems);
    assert_eq!(wrong, 0, "of {problems} problems");
}
