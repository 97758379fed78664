//! The contact problems of a period: from `b` to `q_N`, and where their pattern changes.

use nlmodes_linalg::Mat;
use num_complex::Complex64;

use super::{MixedShooting, subtract};
use crate::HbmError;
use crate::closed_set::NodeResponse;
use crate::energy::inner;
use crate::series::RealSeries;
use crate::trigonometric::Trigonometric;

impl MixedShooting<'_> {
    /// Contact pattern, coefficients of `q_N` and their derivative for the unknown vector `x`.
    pub(crate) fn solve_contact(&mut self, x: &[f64]) -> Result<(), HbmError> {
        let (n, width) = (self.structure.n_contact_dofs(), self.sweep.series.width());
        if self.sweep.forget_sets(self.nodes.iter().flatten().count() * n * n * size_of::<f64>()) {
            self.nodes.clear();
        }
        self.b.iter_mut().zip(x).for_each(|(b, x)| *b = x * self.scales.length);
        self.form_gaps();
        self.sweep.run()?;
        self.nodes.resize(self.sweep.sets.len(), None);
        let size = n * width;
        self.dkept_db.fill(0.0);
        self.kept.fill(0.0);
        for spectrum in &self.sweep.spectra {
            let set = match &mut self.nodes[spectrum.set] {
                Some(known) => known,
                unknown => {
                    let closed = &self.sweep.sets.get(spectrum.set).closed;
                    unknown.insert(NodeResponse::new(&self.structure.body, closed)?)
                }
            };
            let product = spectrum.product(self.sweep.series);
            let constant = self.sweep.series.coefficients_of(&spectrum.averages);
            for d in 0..n {
                for (m, constant) in constant.iter().enumerate() {
                    let row = &mut self.dkept_db[(d * width + m) * size..(d * width + m + 1) * size];
                    for e in 0..n {
                        let factor = set.d[d * n + e];
                        let block = &mut row[e * width..(e + 1) * width];
                        subtract(block, -factor, &product[m * width..(m + 1) * width]);
                    }
                    self.kept[d * width + m] -= set.r[d] * constant;
                }
            }
        }
        for i in 0..size {
            let row = &self.dkept_db[i * size..(i + 1) * size];
            self.kept[i] += inner(row, &self.b);
            self.q[i] = self.b[i] - self.kept[i];
        }
        self.open_contacts();
        Ok(())
    }

    /// The contact pattern alone at `z = (x, p)`.
    pub(super) fn intervals_at(&mut self, z: &[f64]) -> Option<()> {
        self.b.iter_mut().zip(z).for_each(|(b, x)| *b = x * self.scales.length);
        self.form_gaps();
        self.sweep.run().ok()
    }

    /// Gaps of the contacts where the motion is zero, m, c.
    pub(super) fn gaps_at_rest(&self) -> Vec<f64> {
        opened(self.structure.body.gaps(), &self.standing_back).collect()
    }

    /// Gaps without contact forces, `y = Wᵀ b + g₀`, of each contact.
    fn form_gaps(&mut self) {
        let (series, w) = (self.sweep.series, self.structure.model.w());
        let (width, mut of_dof) = (series.width(), vec![Complex64::default(); series.n_harmonics + 1]);
        let at_rest = opened(self.structure.body.gaps(), &self.standing_back);
        for ((i, y), gap) in self.sweep.y.iter_mut().enumerate().zip(at_rest) {
            y.fill(Complex64::default());
            y[0].re = gap;
            for d in (0..w.nrows()).filter(|&d| w[(d, i)] != 0.0) {
                series.to_complex(&self.b[d * width..(d + 1) * width], &mut of_dof);
                y.iter_mut().zip(&of_dof).for_each(|(y, b)| *y += b * w[(d, i)]);
            }
        }
    }

    /// Writes the coefficients of `b` and `q_N` belonging to real coefficient `m`, for the point evaluated last.
    pub(crate) fn coefficients(&self, m: usize, b: &mut [f64], q: &mut [f64]) {
        let width = self.sweep.series.width();
        for (to, from) in [(b, &self.b), (q, &self.q)] {
            to.iter_mut().zip(from.iter().skip(m).step_by(width)).for_each(|(to, from)| *to = *from);
        }
    }
}

/// What makes gaps of the unknowns, by itself.
pub(super) struct Gaps {
    pub series: RealSeries,
    /// n_N × c.
    pub w: Mat<f64>,
    pub at_rest: Vec<f64>,
}

impl Gaps {
    /// The weighted sum of all gaps without contact forces over time, for the unknowns `z`.
    pub fn sum(&self, weights: &[f64], z: &[f64], length: f64) -> Trigonometric {
        let width = self.series.width();
        let mut real = vec![0.0; width];
        for d in 0..self.w.nrows() {
            let factor: f64 = (0..weights.len()).map(|i| self.w[(d, i)] * weights[i]).sum::<f64>() * length;
            if factor != 0.0 {
                real.iter_mut().zip(&z[d * width..]).for_each(|(sum, x)| *sum += factor * x);
            }
        }
        real[0] += inner(weights, &self.at_rest);
        let mut sum = Trigonometric { z: vec![Complex64::default(); self.series.n_harmonics + 1] };
        self.series.to_complex(&real, &mut sum.z);
        sum
    }
}

/// Gaps of contacts that stand back.
fn opened<'a>(gaps: &'a [f64], standing_back: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
    gaps.iter().zip(standing_back).map(|(gap, back)| gap + back)
}
