use nlmodes_linalg::Mat;

/// A contact problem of the suite.
#[derive(Debug, Clone)]
pub struct Case {
    /// Name, with the number of contacts where there are several sizes.
    pub name: String,
    /// `A` (c × c, m/N).
    pub a: Mat<f64>,
    /// `b` (c, m).
    pub b: Vec<f64>,
    /// What is known of the solution.
    pub expected: Expected,
}

/// What is known of a solution.
#[derive(Debug, Clone, PartialEq)]
pub enum Expected {
    /// There is a solution.
    Solution,
    /// Its gaps, which are unique.
    Gaps {
        /// The gaps (c, m).
        gaps: Vec<f64>,
        /// Tolerance (m).
        tolerance: f64,
    },
    /// There is no solution.
    Infeasible,
}

impl Case {
    pub(super) fn new(name: impl Into<String>, a: &[&[f64]], b: &[f64], expected: Expected) -> Self {
        Self { name: name.into(), a: Mat::from_fn(b.len(), b.len(), |i, j| a[i][j]), b: b.to_vec(), expected }
    }

    /// The problem that has the forces `lambda` and the gaps `gaps` for a solution.
    pub(super) fn with_solution(name: impl Into<String>, a: Mat<f64>, lambda: &[f64], gaps: &[f64]) -> Self {
        let product = |i: usize| (0..lambda.len()).map(|j| a[(i, j)] * lambda[j]).sum::<f64>();
        let b: Vec<f64> = gaps.iter().enumerate().map(|(i, g)| g - product(i)).collect();
        // With a violation of 1e-10 the gaps differ from the exact ones by at most about its square root times that of
        // the condition number; the tolerance is meant to detect a wrong closed set, not rounding.
        let tolerance = 1e-6 * b.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        Self { name: name.into(), a, b, expected: Expected::Gaps { gaps: gaps.to_vec(), tolerance } }
    }

    /// The same problem in other units: contact `i` in `1 / units(i)` times the unit of length and `units(i)` times
    /// that of force.
    pub(super) fn in_units(mut self, name: impl Into<String>, unit: impl Fn(usize) -> f64) -> Self {
        let c = self.b.len();
        self.a = Mat::from_fn(c, c, |i, j| self.a[(i, j)] * unit(i) * unit(j));
        self.b.iter_mut().enumerate().for_each(|(i, b)| *b *= unit(i));
        self.name = name.into();
        self.expected = Expected::Solution;
        self
    }
}
