/// A small square matrix, column-major: one product per step, of the size of a modal model with a shaker.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Matrix {
    n: usize,
    values: Vec<f64>,
}

impl Matrix {
    pub(crate) fn zeros(n: usize) -> Self {
        Self { n, values: vec![0.0; n * n] }
    }

    /// With so many rows and columns of zeros more.
    pub(crate) fn enlarged(&self, by: usize) -> Self {
        let mut larger = Self::zeros(self.n + by);
        for (j, column) in self.values.chunks_exact(self.n.max(1)).enumerate() {
            larger.column_mut(j)[..self.n].copy_from_slice(column);
        }
        larger
    }

    pub(crate) fn add(&mut self, i: usize, j: usize, value: f64) {
        self.values[j * self.n + i] += value;
    }

    pub(crate) fn column_mut(&mut self, j: usize) -> &mut [f64] {
        &mut self.values[j * self.n..(j + 1) * self.n]
    }

    /// `y += factor · A x`.
    pub(crate) fn multiply_add(&self, factor: f64, x: &[f64], y: &mut [f64]) {
        for (column, x) in self.values.chunks_exact(self.n).zip(x) {
            add_scaled(y, factor * x, column);
        }
    }

    /// `Aᵀ x`.
    pub(crate) fn transposed_times(&self, x: &[f64]) -> Vec<f64> {
        self.values.chunks_exact(self.n).map(|column| dot(column, x)).collect()
    }

    /// Largest sum of absolute values of a column: a bound of all eigenvalues.
    pub(crate) fn norm(&self) -> f64 {
        self.values.chunks_exact(self.n).map(|column| column.iter().map(|a| a.abs()).sum()).fold(0.0, f64::max)
    }
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `y += factor · x`.
pub(crate) fn add_scaled(y: &mut [f64], factor: f64, x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += factor * x;
    }
}
