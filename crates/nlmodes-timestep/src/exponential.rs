use nlmodes_linalg::Mat;

/// Terms of the series for a matrix of norm ½ at most: the first that is left out is below 1e-22.
const TERMS: usize = 16;

/// `e^A` of a square matrix: Taylor's series of `A/2^s`, squared s times.
pub(crate) fn exponential(a: &Mat<f64>) -> Mat<f64> {
    let n = a.nrows();
    let norm = (0..n).map(|j| a.col(j).iter().map(|v| v.abs()).sum::<f64>()).fold(0.0_f64, f64::max);
    let squarings = (2.0 * norm).log2().ceil().clamp(0.0, 200.0);
    let scaled = Mat::from_fn(n, n, |i, j| a[(i, j)] * 2.0_f64.powf(-squarings));
    let (mut sum, mut term) = (Mat::<f64>::identity(n, n), Mat::<f64>::identity(n, n));
    for k in 1..=TERMS {
        let next = &scaled * &term;
        term = Mat::from_fn(n, n, |i, j| next[(i, j)] / k as f64);
        sum += &term;
    }
    for _ in 0..squarings as usize {
        sum = &sum * &sum;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponential_of_a_damped_oscillator_is_its_closed_form() {
        for (omega, sigma, t) in [(1.0, 0.1, 0.3), (7.0, 0.2, 5.0), (3.0, 0.0, 40.0)] {
            // ẋ = (−σ x + ω y, −ω x − σ y) turns and shrinks.
            let a = Mat::from_fn(2, 2, |i, j| t * [[-sigma, omega], [-omega, -sigma]][i][j]);
            let (e, size) = (exponential(&a), (-sigma * t).exp());
            let (sin, cos) = (omega * t).sin_cos();
            for (i, j, expected) in [(0, 0, cos), (0, 1, sin), (1, 0, -sin), (1, 1, cos)] {
                assert!((e[(i, j)] - size * expected).abs() < 1e-13, "{omega} {t}");
            }
        }
    }
}
