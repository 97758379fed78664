use std::f64::consts::PI;

/// Nodes and weights of the rule of Gauss and Legendre on [−1, 1], ascending, by Newton's method for the roots of
/// Legendre's polynomial.
pub fn gauss_legendre(count: usize) -> Vec<[f64; 2]> {
    let n = count as f64;
    let polynomial = |x: f64| {
        let (mut before, mut at) = (1.0, x);
        for k in 2..=count {
            let k = k as f64;
            (before, at) = (at, ((2.0 * k - 1.0) * x * at - (k - 1.0) * before) / k);
        }
        (at, n * (x * at - before) / (x * x - 1.0))
    };
    let node = |i: usize| {
        let mut x = -((i as f64 + 0.75) / (n + 0.5) * PI).cos();
        for _ in 0..8 {
            let (value, slope) = polynomial(x);
            x -= value / slope;
        }
        let slope = polynomial(x).1;
        [x, 2.0 / ((1.0 - x * x) * slope * slope)]
    };
    (0..count).map(node).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rule_of_gauss_integrates_polynomials_of_twice_its_degree() {
        for count in [24, 40, 96] {
            let rule = gauss_legendre(count);
            for degree in [0, 2, 10, 2 * count - 2] {
                let sum: f64 = rule.iter().map(|[x, w]| w * x.powi(degree as i32)).sum();
                let exact = 2.0 / (degree as f64 + 1.0);
                assert!((sum / exact - 1.0).abs() < 1e-12, "{count} {degree}: {sum}");
            }
        }
    }
}
