//! The directions in which a Jacobian leaves a point nearly free to move.

use nlmodes_linalg::{Mat, symmetric_eigen};

/// Singular value over the largest one, or over one where that is less, below which a direction counts as nearly free.
pub(crate) const NEARLY_FREE: f64 = 1e-3;

/// Singular vectors of `J`, n × (n + 1), that belong to its smallest singular values.
pub(crate) struct SingularDirections {
    /// The right singular vector of the value that is zero: the tangent, where there is one.
    pub tangent: Vec<f64>,
    /// The left ones of the values that are nearly zero beside it, ascending; that of the smallest is never missing.
    pub left: Vec<Vec<f64>>,
    /// The smallest singular value, beside the one that is zero, over the largest, or over one where that is less.
    pub ratio: f64,
}

impl SingularDirections {
    pub fn of(jacobian: &Mat<f64>) -> Option<Self> {
        let column = |m: &Mat<f64>, k: usize| -> Vec<f64> { m.col(k).iter().copied().collect() };
        let (_, right) = symmetric_eigen(&(jacobian.transpose() * jacobian)).ok()?;
        let (squares, left) = symmetric_eigen(&(jacobian * jacobian.transpose())).ok()?;
        let largest = squares.last()?.max(1.0);
        let ratio = |square: &f64| (square.max(0.0) / largest).sqrt();
        let free = squares.iter().take_while(|s| ratio(s) < NEARLY_FREE).count().max(1);
        let left = (0..free).map(|k| column(&left, k)).collect();
        Some(Self { tangent: column(&right, 0), left, ratio: ratio(squares.first()?) })
    }
}
