//! When a Jacobian is singular: one function whose zero says so, and its derivative.

use nlmodes_hbm::HbmError;
use nlmodes_linalg::{DenseLu, Mat};

/// Borders of the Jacobian: near its null vectors they keep the bordered matrix regular.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Border {
    /// Beside the Jacobian, n; near its left null vector.
    pub b: Vec<f64>,
    /// Below it, n; near its right null vector.
    pub c: Vec<f64>,
}

/// What a bordered Jacobian says.
#[derive(Debug, Clone, PartialEq)]
pub struct Singular {
    /// Zero where the Jacobian is singular.
    pub g: f64,
    /// The right null vector there, n.
    pub v: Vec<f64>,
    /// The left one.
    pub w: Vec<f64>,
}

/// Solutions with the bordered matrix that bring its borders to the null vectors.
const ROUNDS: usize = 3;

impl Border {
    /// The function of a Jacobian (its first n columns).
    ///
    /// # Errors
    /// [`HbmError::Linalg`] where the bordered matrix is singular, too.
    pub fn function(&self, jacobian: &Mat<f64>) -> Result<Singular, HbmError> {
        let n = jacobian.nrows();
        let (b, c) = (&self.b, &self.c);
        let bordered = Mat::from_fn(n + 1, n + 1, |i, j| match (i < n, j < n) {
            (true, true) => jacobian[(i, j)],
            (true, false) => b[i],
            (false, true) => c[j],
            (false, false) => 0.0,
        });
        let failed = |source| HbmError::Linalg { what: "bordered Jacobian of a fold", source };
        let solve = |matrix: &Mat<f64>| -> Result<Vec<f64>, HbmError> {
            let mut last = vec![0.0; n + 1];
            last[n] = 1.0;
            DenseLu::factor(matrix).map_err(failed)?.solve_in_place(&mut last);
            Ok(last)
        };
        let (mut v, mut w) = (solve(&bordered)?, solve(&bordered.transpose().to_owned())?);
        let g = v.pop().unwrap_or(f64::NAN);
        w.pop();
        Ok(Singular { g, v, w })
    }

    /// The borders of a Jacobian that is nearly singular.
    ///
    /// # Errors
    /// [`HbmError::Linalg`] where no border makes it regular.
    pub fn of(jacobian: &Mat<f64>) -> Result<Self, HbmError> {
        let n = jacobian.nrows();
        // No entry is zero or as large as another, so that this is at right angles to no null vector.
        let any: Vec<f64> = (0..n).map(|k| 1.0 + (k as f64 * 0.618_033_988_749_894_9).fract()).collect();
        let mut border = Self { b: unit(&any), c: unit(&any) };
        for _ in 0..ROUNDS {
            border = border.moved(&border.function(jacobian)?);
        }
        Ok(border)
    }

    /// The borders along the null vectors.
    pub fn moved(&self, to: &Singular) -> Self {
        Self { b: unit(&to.w), c: unit(&to.v) }
    }
}

fn unit(v: &[f64]) -> Vec<f64> {
    let size = v.iter().map(|v| v * v).sum::<f64>().sqrt();
    v.iter().map(|v| v / size).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix(t: f64) -> Mat<f64> {
        // Singular at t = 0.
        let at = [[2.0, 1.0, 0.5], [1.0, 0.5 + t, 0.25], [0.3, -1.0, 1.0 + t * t]];
        Mat::from_fn(3, 3, |i, j| at[i][j])
    }

    #[test]
    fn the_function_vanishes_with_the_determinant_and_its_derivative_is_that_of_null_vectors() {
        let border = Border::of(&matrix(1e-3)).unwrap();
        let at = |t: f64| border.function(&matrix(t)).unwrap();
        assert!(at(0.0).g.abs() < 1e-14, "{}", at(0.0).g);
        assert!(at(1e-2).g * at(-1e-2).g < 0.0);
        let (own, step) = (at(0.3), 1e-5);
        // dJ/dt has ones at (1, 1) and 2 t at (2, 2).
        let exact = -(own.w[1] * own.v[1] + 0.6 * own.w[2] * own.v[2]);
        let difference = (at(0.3 + step).g - at(0.3 - step).g) / (2.0 * step);
        assert!((exact / difference - 1.0).abs() < 1e-8, "{exact} {difference}");
    }
}
