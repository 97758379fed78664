use super::{ForceLaw, LawForce};
use crate::HbmError;

/// A table of displacement (or velocity) and force, joined by monotone cubic pieces with continuous slope (Fritsch,
/// Carlson 1980) and continued by straight lines.
#[derive(Debug, Clone, PartialEq)]
pub struct TableLaw {
    x: Vec<f64>,
    force: Vec<f64>,
    slope: Vec<f64>,
    /// Potential at each node, from the first one on.
    work: Vec<f64>,
    of_velocity: bool,
}

impl TableLaw {
    /// From abscissas (m, or m/s where `of_velocity`) that grow, and forces, N.
    ///
    /// # Errors
    /// [`HbmError::Size`] for less than two rows or columns of different lengths, [`HbmError::NotFinite`] for numbers
    /// that are not finite or abscissas that do not grow.
    pub fn new(x: Vec<f64>, force: Vec<f64>, of_velocity: bool) -> Result<Self, HbmError> {
        if x.len() < 2 || x.len() != force.len() {
            return Err(HbmError::Size { what: "rows of a law's table", expected: x.len().max(2), found: force.len() });
        }
        let grows = x.windows(2).all(|w| w[1] > w[0]);
        if !(grows && x.iter().chain(&force).all(|v| v.is_finite())) {
            return Err(HbmError::NotFinite { what: "a law's table, whose first column has to grow" });
        }
        let slope = slopes(&x, &force);
        let mut table = Self { work: vec![0.0; x.len()], x, force, slope, of_velocity };
        for i in 1..table.x.len() {
            table.work[i] = table.work[i - 1] + table.piece_work(i - 1, 1.0);
        }
        let at_rest = table.work_at(0.0);
        table.work.iter_mut().for_each(|w| *w -= at_rest);
        Ok(table)
    }

    /// The piece that holds `x`, by its left node; `None` outside of the table.
    fn piece(&self, x: f64) -> Option<usize> {
        let last = self.x.len() - 1;
        (x >= self.x[0] && x <= self.x[last]).then(|| self.x.partition_point(|own| *own <= x).clamp(1, last) - 1)
    }

    /// The nearest end of the table.
    fn end(&self, x: f64) -> usize {
        if x < self.x[0] { 0 } else { self.x.len() - 1 }
    }

    /// Force and slope.
    fn value(&self, x: f64) -> (f64, f64) {
        let Some(i) = self.piece(x) else {
            let end = self.end(x);
            return (self.force[end] + self.slope[end] * (x - self.x[end]), self.slope[end]);
        };
        let (h, [a, b, c, d]) = self.cubic(i);
        let s = (x - self.x[i]) / h;
        (a + s * (b + s * (c + s * d)), (b + s * (2.0 * c + 3.0 * s * d)) / h)
    }

    /// Length of a piece and the coefficients of its cubic in the share of that length.
    fn cubic(&self, i: usize) -> (f64, [f64; 4]) {
        let h = self.x[i + 1] - self.x[i];
        let (f, g) = (self.force[i], self.force[i + 1]);
        let (p, q) = (h * self.slope[i], h * self.slope[i + 1]);
        (h, [f, p, 3.0 * (g - f) - 2.0 * p - q, 2.0 * (f - g) + p + q])
    }

    /// Work over the first share `s` of a piece.
    fn piece_work(&self, i: usize, s: f64) -> f64 {
        let (h, [a, b, c, d]) = self.cubic(i);
        h * s * (a + s * (b / 2.0 + s * (c / 3.0 + s * d / 4.0)))
    }

    fn work_at(&self, x: f64) -> f64 {
        match self.piece(x) {
            Some(i) => self.work[i] + self.piece_work(i, (x - self.x[i]) / (self.x[i + 1] - self.x[i])),
            None => {
                let end = self.end(x);
                let beyond = x - self.x[end];
                self.work[end] + beyond * (self.force[end] + 0.5 * self.slope[end] * beyond)
            }
        }
    }
}

/// Slopes at the nodes: harmonic means of the neighbouring ones where these have one sign, else zero; at the ends
/// those of the neighbouring piece.
fn slopes(x: &[f64], force: &[f64]) -> Vec<f64> {
    let h: Vec<f64> = x.windows(2).map(|w| w[1] - w[0]).collect();
    let secant: Vec<f64> = force.windows(2).zip(&h).map(|(w, h)| (w[1] - w[0]) / h).collect();
    let within = |i: usize| {
        let (a, b) = (secant[i - 1], secant[i]);
        if a * b <= 0.0 {
            return 0.0;
        }
        let (near, far) = (2.0 * h[i] + h[i - 1], h[i] + 2.0 * h[i - 1]);
        (near + far) / (near / a + far / b)
    };
    let last = x.len() - 1;
    let at = |i: usize| {
        if i == 0 {
            secant[0]
        } else if i == last {
            secant[last - 1]
        } else {
            within(i)
        }
    };
    (0..=last).map(at).collect()
}

impl ForceLaw for TableLaw {
    fn at(&self, v: f64, rate: f64) -> LawForce {
        let (force, slope) = self.value(if self.of_velocity { rate } else { v });
        let (stiffness, damping) = if self.of_velocity { (0.0, slope) } else { (slope, 0.0) };
        LawForce { force, stiffness, damping }
    }

    fn potential(&self, v: f64) -> f64 {
        if self.of_velocity { 0.0 } else { self.work_at(v) }
    }

    fn dissipates(&self) -> bool {
        self.of_velocity
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_passes_its_nodes_monotonically_and_its_potential_has_the_force_as_derivative() {
        let x = vec![-2.0, -0.5, 0.0, 0.4, 1.0, 3.0];
        let force = vec![-5.0, -0.4, 0.0, 0.1, 2.0, 2.5];
        let law = TableLaw::new(x.clone(), force.clone(), false).unwrap();
        x.iter().zip(&force).for_each(|(x, f)| assert!((law.at(*x, 0.0).force - f).abs() < 1e-14));
        let mut before = f64::NEG_INFINITY;
        for j in 0..=700 {
            let v = -3.0 + 0.01 * f64::from(j) + 1e-3;
            let at = law.at(v, 0.0);
            assert!(at.force >= before && at.stiffness >= 0.0, "{v}");
            before = at.force;
            let h = 1e-6;
            let force = (law.potential(v + h) - law.potential(v - h)) / (2.0 * h);
            let slope = (law.at(v + h, 0.0).force - law.at(v - h, 0.0).force) / (2.0 * h);
            assert!(
                (force - at.force).abs() < 1e-8 && (slope - at.stiffness).abs() < 2e-5,
                "{v}: {force} {slope} {at:?}"
            );
        }
        assert_eq!(law.potential(0.0), 0.0);
        assert!(TableLaw::new(vec![0.0, 0.0], vec![1.0, 2.0], false).is_err());
        assert!(TableLaw::new(vec![0.0], vec![1.0], false).is_err());
    }
}
