use nlmodes_linalg::{Mat, column};

/// `y = row · x + constant + input · (u, u̇, ü)`: an output of a linear system with state `x` and input `u`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Functional {
    pub(crate) row: Vec<f64>,
    pub(crate) constant: f64,
    pub(crate) input: [f64; 3],
}

impl Functional {
    pub(crate) fn zero(n: usize) -> Self {
        Self { row: vec![0.0; n], constant: 0.0, input: [0.0; 3] }
    }

    pub(crate) fn value(&self, x: &[f64], input: &[f64; 3]) -> f64 {
        dot(&self.row, x) + self.constant + dot(&self.input, input)
    }

    /// `self + factor · other`.
    pub(crate) fn plus(mut self, factor: f64, other: &Self) -> Self {
        self.row.iter_mut().zip(&other.row).for_each(|(a, b)| *a += factor * b);
        self.constant += factor * other.constant;
        self.input.iter_mut().zip(&other.input).for_each(|(a, b)| *a += factor * b);
        self
    }

    /// Time derivative along `ẋ = A x + c + b u`. At most two derivatives of the input are kept, as required for an
    /// acceleration with direct feedthrough of the drive.
    pub(crate) fn derivative(&self, a: &Mat<f64>, c: &[f64], b: &[f64]) -> Self {
        let [now, first, _] = self.input;
        let row = (0..a.ncols()).map(|j| dot(column(a, j), &self.row)).collect();
        Self { row, constant: dot(&self.row, c), input: [dot(&self.row, b), now, first] }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
