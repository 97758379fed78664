use super::*;
use nlmodes_contact::solver_by_name;
use nlmodes_linalg::Mat;

/// Forces of five contacts before waves that grow, with memory for all closed sets that are met and for none.
#[test]
fn sets_that_are_forgotten_are_found_again() {
    let matrix = LcpMatrix::new(&Mat::from_fn(5, 5, |i, j| 1.0 / (1 + i.abs_diff(j)) as f64)).unwrap();
    let series = RealSeries { symmetry: Symmetry::None, n_harmonics: 3 };
    let solver = solver_by_name("active-set").unwrap();
    let operator = || ContactOperator::new(&matrix, series, Switching::Exact, solver.as_ref()).unwrap();
    let (mut keeping, mut forgetting) = (operator(), operator());
    forgetting.most_bytes = 0;
    let (mut most, mut forgotten) = (0, 0);
    for step in 1..30 {
        let wave = |k: usize| (0.1 * step as f64 + 0.7 * k as f64).sin() * 0.05 * step as f64;
        let gap = |k: usize| if k.is_multiple_of(series.width()) { 0.4 } else { wave(k) };
        let y: Vec<f64> = (0..5 * series.width()).map(gap).collect();
        forgotten += usize::from(forgetting.forget_sets(0));
        for operator in [&mut keeping, &mut forgetting] {
            operator.solve(&y).unwrap();
        }
        let (a, b) = (keeping.apply(&y), forgetting.apply(&y));
        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-12), "{step}: {a:?} {b:?}");
        assert_eq!(keeping.intervals().len(), forgetting.intervals().len());
        most = most.max(forgetting.sets.len());
    }
    assert!(forgotten > 20 && most < keeping.sets.len(), "{forgotten} {most} {}", keeping.sets.len());
    assert!(!keeping.forget_sets(0) && keeping.forget_sets(MOST_BYTES));
}

#[test]
fn integrals_over_short_intervals_are_known_to_as_many_digits_as_over_long_ones() {
    for exponent in [-2, -10, -20, -30] {
        let (from, width) = (1.25, 2.0_f64.powi(exponent));
        for even in [false, true] {
            let mut averages = vec![Complex64::default(); 41];
            add_indicator(from, from + width, even, &mut averages);
            for (k, found) in averages.iter().enumerate() {
                let k = k as f64;
                // sin(x)/x to rounding, at the angles that there are: 40 · 2⁻³ at most.
                let x = 0.5 * k * width;
                let sinc = (1..40).rev().fold(1.0, |s, i| 1.0 - x * x / f64::from(2 * i * (2 * i + 1)) * s);
                let expected = Complex64::cis(-k * (from + 0.5 * width)) * (width / TAU * sinc);
                let expected = if even { Complex64::new(2.0 * expected.re, 0.0) } else { expected };
                assert!((found - expected).norm() < 4e-14 * width / TAU, "{exponent}, {k}: {found} for {expected}");
            }
        }
    }
}
