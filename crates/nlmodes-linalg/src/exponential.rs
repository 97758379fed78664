use crate::{DenseLu, LinalgError, Mat};

/// Coefficients of the diagonal Padé approximation of order 13.
const PADE: [f64; 14] = [
    64764752532480000.0,
    32382376266240000.0,
    7771770303897600.0,
    1187353796428800.0,
    129060195264000.0,
    10559470521600.0,
    670442572800.0,
    33522128640.0,
    1323241920.0,
    40840800.0,
    960960.0,
    16380.0,
    182.0,
    1.0,
];

/// Largest 1-norm for which this approximation is accurate to rounding.
const LARGEST: f64 = 5.371920351148152;

/// Minimum relative reduction of the norms of a row and column by balancing, and the maximum number of rounds.
const WORTHWHILE: f64 = 0.95;
const ROUNDS: usize = 100;

/// `e^A` of a square matrix (n × n), by scaling and squaring (N. J. Higham, SIAM J. Matrix Anal. Appl. 26 (2005)
/// 1179-1193) of the matrix with balanced rows and columns (E. E. Osborne, J. ACM 7 (1960) 338-345): each squaring
/// doubles the error, and without balancing a system with positions and velocities of a fast motion would need many of
/// them.
///
/// ```
/// use nlmodes_linalg::{Mat, matrix_exponential};
/// // A quarter of a turn.
/// let quarter = std::f64::consts::FRAC_PI_2;
/// let e = matrix_exponential(&Mat::from_fn(2, 2, |i, j| [[0.0, quarter], [-quarter, 0.0]][i][j]))?;
/// assert!(e[(0, 0)].abs() < 1e-15 && (e[(0, 1)] - 1.0).abs() < 1e-15);
/// # Ok::<(), nlmodes_linalg::LinalgError>(())
/// ```
///
/// # Errors
/// [`LinalgError::Dimension`] if `a` is not square, [`LinalgError::NotFinite`].
pub fn matrix_exponential(a: &Mat<f64>) -> Result<Mat<f64>, LinalgError> {
    let n = a.nrows();
    if a.ncols() != n {
        return Err(LinalgError::Dimension { what: "columns of a square matrix", expected: n, found: a.ncols() });
    }
    let sizes = balance(a);
    let a = &Mat::from_fn(n, n, |i, j| a[(i, j)] * (sizes[j] / sizes[i]));
    let norm = (0..n).map(|j| a.col(j).iter().map(|v| v.abs()).sum::<f64>()).fold(0.0_f64, f64::max);
    if !norm.is_finite() {
        return Err(LinalgError::NotFinite { what: "matrix in an exponential" });
    }
    let squarings = (norm / LARGEST).log2().ceil().max(0.0);
    let scale = 2.0_f64.powf(-squarings);
    let a = Mat::from_fn(n, n, |i, j| a[(i, j)] * scale);
    let identity = Mat::<f64>::identity(n, n);
    let a2 = &a * &a;
    let a4 = &a2 * &a2;
    let a6 = &a4 * &a2;
    let sum = |from: usize| {
        let term = |i: usize, j: usize| {
            let at = |k: usize, m: &Mat<f64>| PADE[from + k] * m[(i, j)];
            at(0, &identity) + at(2, &a2) + at(4, &a4) + at(6, &a6)
        };
        Mat::from_fn(n, n, term)
    };
    let high = |from: usize| {
        let inner = Mat::from_fn(n, n, |i, j| {
            PADE[from + 8] * a2[(i, j)] + PADE[from + 10] * a4[(i, j)] + PADE[from + 12] * a6[(i, j)]
        });
        &a6 * inner
    };
    let u = &a * (sum(1) + high(1));
    let v = sum(0) + high(0);
    let lu = DenseLu::factor(&(&v - &u))?;
    let mut exponential = &v + &u;
    for j in 0..n {
        let mut column: Vec<f64> = exponential.col(j).iter().copied().collect();
        lu.solve_in_place(&mut column);
        exponential.col_mut(j).iter_mut().zip(&column).for_each(|(to, from)| *to = *from);
    }
    for _ in 0..squarings as usize {
        exponential = &exponential * &exponential;
    }
    Ok(Mat::from_fn(n, n, |i, j| exponential[(i, j)] * (sizes[i] / sizes[j])))
}

/// Powers of two, `d`, for which rows and columns of `D⁻¹ A D` have nearly equal norms.
fn balance(a: &Mat<f64>) -> Vec<f64> {
    let n = a.nrows();
    let mut sizes = vec![1.0; n];
    for _ in 0..ROUNDS {
        let mut is_balanced = true;
        for i in 0..n {
            let others = || (0..n).filter(|j| *j != i);
            let column: f64 = others().map(|j| (a[(j, i)] * sizes[i] / sizes[j]).abs()).sum();
            let row: f64 = others().map(|j| (a[(i, j)] * sizes[j] / sizes[i]).abs()).sum();
            let ratio = row / column;
            if !(ratio.is_finite() && ratio > 0.0) {
                continue;
            }
            let factor = (0.5 * ratio.log2()).round().exp2();
            if column * factor + row / factor < WORTHWHILE * (column + row) {
                sizes[i] *= factor;
                is_balanced = false;
            }
        }
        if is_balanced {
            break;
        }
    }
    sizes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_and_a_decay_come_out_exactly() {
        for angle in [1e-3, 0.7, 40.0, 900.0] {
            let a = Mat::from_fn(2, 2, |i, j| [[0.0, angle], [-angle, 0.0]][i][j]);
            let e = matrix_exponential(&a).unwrap();
            assert!((e[(0, 0)] - f64::cos(angle)).abs() < 1e-12 * (1.0 + angle), "{angle}");
            assert!((e[(0, 1)] - f64::sin(angle)).abs() < 1e-12 * (1.0 + angle), "{angle}");
        }
        // A damped oscillator in coordinates in which it is a rotation with decay.
        for (omega, sigma, t) in [(1.0, 0.1, 0.3), (7.0, 0.2, 5.0), (3.0, 0.0, 40.0)] {
            let a = Mat::from_fn(2, 2, |i, j| t * [[-sigma, omega], [-omega, -sigma]][i][j]);
            let (e, size, (sin, cos)) = (matrix_exponential(&a).unwrap(), (-sigma * t).exp(), (omega * t).sin_cos());
            for (i, j, expected) in [(0, 0, cos), (0, 1, sin), (1, 0, -sin), (1, 1, cos)] {
                assert!((e[(i, j)] - size * expected).abs() < 1e-12, "{omega} {t}");
            }
        }
        // The same with position and velocity, whose magnitudes differ by 10⁸ for a fast oscillator: after 10⁸ turns it
        // has decayed or not.
        for (omega, sigma) in [(3.0, 0.1), (2e8, 1e-9), (2e8, 1e6)] {
            let a = Mat::from_fn(2, 2, |i, j| [[0.0, 1.0], [-omega * omega - sigma * sigma, -2.0 * sigma]][i][j]);
            let (e, size, (sin, cos)) = (matrix_exponential(&a).unwrap(), f64::exp(-sigma), f64::sin_cos(omega));
            let expected = [
                [cos + sigma / omega * sin, sin / omega],
                [-(omega * omega + sigma * sigma) / omega * sin, cos - sigma / omega * sin],
            ];
            for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let unit = omega.powi(i as i32 - j as i32);
                let off = (e[(i, j)] - size * expected[i][j]).abs() / unit;
                assert!(off < 1e-15 * omega * (1.0 + omega.log2()), "{omega} {sigma} ({i}, {j}): {off:e}");
            }
        }
        // A Jordan block: e^{a} [1 1; 0 1].
        let e = matrix_exponential(&Mat::from_fn(2, 2, |i, j| [[-3.0, 1.0], [0.0, -3.0]][i][j])).unwrap();
        assert!((e[(0, 1)] - f64::exp(-3.0)).abs() < 1e-16 && e[(1, 0)].abs() < 1e-16);
    }
}
