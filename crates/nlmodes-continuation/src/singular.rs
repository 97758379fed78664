//! The directions in which a Jacobian leaves a point nearly free to move.

use nlmodes_linalg::{Mat, symmetric_eigen};

use crate::Linearization;

/// Singular value over the largest one, or over one where that is less, below which a direction counts as nearly free.
pub(crate) const NEARLY_FREE: f64 = 1e-3;

/// Singular vectors of `J`, n × (n + 1), that belong to its smallest singular values, each row over the size of its equation.
pub(crate) struct SingularDirections {
    /// The right singular vector of the value that is zero: the tangent, where there is one.
    pub tangent: Vec<f64>,
    /// The left ones of the values that are nearly zero beside it, ascending; that of the smallest is never missing. As combinations of the
    /// equations as they are.
    pub left: Vec<Vec<f64>>,
    /// The smallest singular value, beside the one that is zero, over the largest, or over one where that is less.
    pub ratio: f64,
    /// That singular value itself: what is stiff does not make the rest free.
    pub value: f64,
}

impl SingularDirections {
    pub fn of(linearization: &Linearization) -> Option<Self> {
        let Linearization { jacobian, sizes, .. } = linearization;
        let jacobian = Mat::from_fn(jacobian.nrows(), jacobian.ncols(), |i, j| jacobian[(i, j)] / sizes[i]);
        let (_, right) = symmetric_eigen(&(jacobian.transpose() * &jacobian)).ok()?;
        let (squares, left) = symmetric_eigen(&(&jacobian * jacobian.transpose())).ok()?;
        let largest = squares.last()?.max(1.0);
        let ratio = |square: &f64| (square.max(0.0) / largest).sqrt();
        let free = squares.iter().take_while(|s| ratio(s) < NEARLY_FREE).count().max(1);
        let left = (0..free).map(|k| unit(left.col(k).iter().zip(sizes).map(|(u, size)| u * size))).collect();
        Some(Self {
            tangent: unit(right.col(0).iter().copied()),
            left,
            ratio: ratio(squares.first()?),
            value: squares.first()?.max(0.0).sqrt(),
        })
    }
}

fn unit(vector: impl Iterator<Item = f64>) -> Vec<f64> {
    let vector: Vec<f64> = vector.collect();
    let length = vector.iter().map(|v| v * v).sum::<f64>().sqrt();
    vector.iter().map(|v| v / length).collect()
}
